//! Recordings that once went wrong: what is right of each is stated beside it (the files' own README).

use hpf_recordings::{Mapping, Read, Refusal, align_turns, read};

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/../../tests/recordings/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn plain(name: &str) -> Result<Read, Refusal> {
    read(&bytes(name), &Mapping::default())
}

fn with(name: &str, mapping: Mapping) -> Result<Read, Refusal> {
    read(&bytes(name), &mapping)
}

fn first(refusal: &Refusal) -> String {
    refusal.mistakes[0].to_string()
}

#[test]
fn case_02_angles_beyond_half_a_turn_apart_are_the_same_angle() {
    let mut both = ["02_plus_minus_pi/a.csv", "02_plus_minus_pi/b.csv"].map(|name| plain(name).unwrap().recording);
    let notes = align_turns(&mut both);
    assert!(notes.len() == 1 && notes[0].contains("`yaw` of recording 2"), "{notes:?}");
    // 3.10 and -3.10 are 2 pi - 6.2 apart.
    let [a, b] = both.map(|one| one.axes[0].position[0]);
    assert!((b - a - (core::f64::consts::TAU - 6.2)).abs() < 1e-12, "{a} {b}");
}

#[test]
fn case_05_a_gap_is_refused_with_its_lines_and_filled_in_where_asked() {
    let told = first(&plain("05_gap/a.csv").unwrap_err());
    assert!(told.contains("no sample between lines") && told.contains("--bridge"), "{told}");
    let filled = with("05_gap/a.csv", Mapping { bridge: true, ..Mapping::default() }).unwrap();
    let truth = plain("05_gap/truth.csv").unwrap().recording;
    // As many samples as the motion without the hole: 100 Hz, not 74.5.
    assert_eq!(filled.recording.time.len(), truth.time.len());
    assert!(filled.notes.iter().any(|note| note.contains("filled in by a cubic, which is a guess")), "{filled:?}");
}

#[test]
fn case_06_nanoseconds_under_seconds_are_refused_with_the_option_that_reads_them() {
    let told = first(&plain("06_time_unit/ns.csv").unwrap_err());
    assert!(told.starts_with("3: column `time_s`") && told.contains("--time time_s:ns"), "{told}");
    let mapping = Mapping { time: Some("time_s:ns".parse().unwrap()), ..Mapping::default() };
    let found = with("06_time_unit/ns.csv", mapping).unwrap().recording;
    assert!((found.time[1] - 0.05).abs() < 1e-12 && (found.duration() - 2.0).abs() < 1e-12, "{:?}", &found.time[..3]);
}

#[test]
fn case_08_what_is_not_read_may_hold_anything() {
    let found = plain("08_nan_in_unread/a.csv").unwrap();
    assert!(found.recording.axes[0].position.iter().all(|x| x.is_finite()));
}

#[test]
fn case_10_a_refusal_of_thousands_of_columns_is_fast() {
    let start = std::time::Instant::now();
    let refusal = plain("10_wide/wide.csv").unwrap_err();
    // It took 3.6 s; the bound leaves room for a busy machine.
    assert!(start.elapsed().as_secs_f64() < 1.0, "{:?}", start.elapsed());
    assert_eq!(refusal.mistakes.len(), 20);
}

#[test]
fn case_15_two_joints_may_begin_alike() {
    let found = plain("15_axis_names/a.csv").unwrap().recording;
    assert_eq!(found.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>(), ["elbow", "elbow_yaw"]);
}

#[test]
fn case_16_a_header_may_be_a_comment() {
    let found = plain("16_commented_header/a.csv").unwrap().recording;
    assert_eq!(found.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>(), ["x", "y"]);
    assert_eq!(found.time[1], 0.05);
}

#[test]
fn case_21_stamps_in_bursts_are_put_on_even_steps() {
    for name in ["21_burst_stamps/a.csv", "21_burst_stamps/b.csv"] {
        let found = plain(name).unwrap();
        assert!(found.notes[0].contains("1 time stamps, the first in line 22"), "{:?}", found.notes);
        for (i, (t, x)) in found.recording.time.iter().zip(&found.recording.axes[0].position).enumerate() {
            assert!((t - 0.05 * i as f64).abs() < 1e-9, "{name}: {t} at {i}");
            // Minimum jerk from 0 to 0.3 m in 2 s, in five digits.
            let u = t / 2.0;
            let made = 0.3 * u * u * u * (10.0 - u * (15.0 - 6.0 * u));
            assert!((x - made).abs() < 6e-6, "{name}: {x} {made}");
        }
    }
}
