//! Writes the demonstrations of `tasks/demonstrations/`: `cargo run -p hpf-sim --example demonstrations`.
//!
//! They are made, not recorded: each is a formula and a little noise, so that what should come of it is known.

use core::f64::consts::PI;
use std::path::Path;

/// The demonstrations: file name and text.
pub fn files() -> Vec<(&'static str, String)> {
    vec![
        ("wipe.csv", wipe()),
        ("reach_1.csv", reach(1.9, -1.0, 1)),
        ("reach_2.csv", reach(2.0, 0.1, 2)),
        ("reach_3.csv", reach(2.1, 0.9, 3)),
        ("insert_emg.csv", insert()),
        ("push.csv", push()),
        ("turn.csv", turn()),
    ]
}

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tasks/demonstrations");
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    for (name, text) in files() {
        std::fs::write(folder.join(name), text).expect("the file can be written");
        println!("tasks/demonstrations/{name}");
    }
}

/// Even noise in [-1, 1]: Steele, Lea, Flood, SplitMix, OOPSLA 2014, doi 10.1145/2660193.2660195.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0
    }
}

/// Minimum jerk from 0 to 1.
fn minimum_jerk(t: f64) -> f64 {
    t * t * t * (10.0 - t * (15.0 - 6.0 * t))
}

fn table(comment: &str, header: &str, rows: impl Iterator<Item = Vec<f64>>) -> String {
    let mut text = format!("# {comment}\n{header}\n");
    for row in rows {
        let numbers: Vec<String> = row.iter().map(|number| format!("{number:.5}")).collect();
        text += &(numbers.join(",") + "\n");
    }
    text
}

/// Wiping: along x, three strokes across in y, which ends where it starts.
fn wipe() -> String {
    let mut noise = Noise(1);
    let rows = (0..=150).map(|i| {
        let s = minimum_jerk(f64::from(i) / 150.0);
        // The clock of a recorder starts anywhere.
        vec![
            12.4 + 0.02 * f64::from(i),
            0.4 * s + 2e-5 * noise.next(),
            0.1 * (3.0 * PI * s).sin().powi(2) + 2e-5 * noise.next(),
        ]
    });
    table("a wiping motion in a plane, 3 s at 50 Hz", "time_s,x_m,y_m", rows)
}

/// Reaching: the hands agree at start and goal and differ by 2 cm between.
fn reach(duration: f64, share: f64, seed: u64) -> String {
    let mut noise = Noise(seed);
    let rows = (0..=100).map(|i| {
        let t = f64::from(i) / 100.0;
        let x = 0.5 * minimum_jerk(t) + 0.02 * share * (PI * t).sin().powi(2);
        vec![duration * t, x + 2e-5 * noise.next()]
    });
    table("one of three reaches that agree at both ends", "time_s,x_m", rows)
}

/// Insertion: muscles work harder towards the end.
fn insert() -> String {
    let mut noise = Noise(7);
    let rows = (0..=500).map(|i| {
        let t = f64::from(i) / 500.0;
        let activity = 0.05 + 0.9 * minimum_jerk((2.0 * t - 0.8).clamp(0.0, 1.0));
        vec![2.5 * t, 0.15 * minimum_jerk(t), activity * noise.next()]
    });
    table("an insertion with muscle activity in mV, 2.5 s at 200 Hz", "time_s,z_m,z_emg", rows)
}

/// Pushing: a force on the tool and how it gave way, `30 e' + k e = f`, k rising from 80 to 300 N/m.
fn push() -> String {
    let mut noise = Noise(11);
    let (mut e, dt) = (0.0, 1e-4);
    let force = |t: f64| 6.0 * (2.0 * PI * 1.5 * t).sin() + 3.0 * (2.0 * PI * 0.4 * t).sin();
    let stiffness = |t: f64| 80.0 + 220.0 * minimum_jerk(t / 4.0);
    let rows = (0..=400).map(|i| {
        let t = 0.01 * f64::from(i);
        let reference = 0.3 * minimum_jerk(t / 4.0);
        let row = vec![t, reference + e, reference, force(t) + 0.1 * noise.next()];
        for j in 0..100 {
            // The midpoint rule: second order, and far finer than the rows.
            let t = t + dt * f64::from(j);
            let half = e + 0.5 * dt * (force(t) - stiffness(t) * e) / 30.0;
            let middle = t + 0.5 * dt;
            e += dt * (force(middle) - stiffness(middle) * half) / 30.0;
        }
        row
    });
    table(
        "a hand that pushes a compliant tool off its reference, 4 s at 100 Hz",
        "time_s,x_m,x_reference_m,x_force_n",
        rows,
    )
}

/// Turning: a joint, with stiffness and damping recorded.
fn turn() -> String {
    let rows = (0..=100).map(|i| {
        let t = f64::from(i) / 100.0;
        let stiffness = 40.0 + 60.0 * minimum_jerk(t);
        vec![2.0 * t, 0.2 + 1.2 * minimum_jerk(t), stiffness, 2.0 * stiffness.sqrt()]
    });
    let header = "time_s,elbow_rad,elbow_stiffness_nm_rad,elbow_damping_nm_s_rad";
    table("a joint that turns while it stiffens, 2 s at 50 Hz", header, rows)
}
