//! How the time of an update of PI2 grows with the size of the task, as the table of docs/performance.md:
//! `cargo run --release -p hpf-sim --example linear_growth`.
//!
//! One thread; an update is draws, rollouts and improvement. Each time is the least of many, which other work on the
//! machine does not touch.

use core::time::Duration;
use std::time::Instant;

use hpf_learn::{Batch, Cost, Draws, Parameters, Pi2, Pi2Options, Problem};
use hpf_sim::{Policy, Simulation, Task};

/// How long each size is measured.
const LONG: Duration = Duration::from_millis(1500);

#[derive(Clone, Copy)]
struct Size {
    steps: usize,
    bases: usize,
    axes: usize,
    rollouts: usize,
}

/// Seconds that one update takes.
fn update(size: Size) -> f64 {
    let Size { steps, bases, axes, rollouts } = size;
    let axis = |a: usize| format!("{{ name = \"a{a}\", start = 0.0, goal = 1.0 }}");
    let axes: Vec<String> = (0..axes).map(axis).collect();
    let task = Task::parse(&format!(
        "name = \"grown\"\nduration = 5.0\nrate = {}\naxis = [{}]\nmovement = {{ basis = {bases} }}\n\
         stiffness = {{ basis = {bases}, initial = 100.0, min = 30.0, max = 400.0 }}\n\
         damping = {{ basis = {bases}, initial = 50.0, min = 10.0, max = 100.0 }}\n\
         cost = {{ goal = 1e4, acceleration = 1e-2, stiffness = 1e-5, damping = 1e-4 }}\n\
         learning = {{ noise = {{ movement = 10.0 }} }}\n",
        steps as f64 / 5.0,
        axes.join(", "),
    ))
    .expect("a task of any of these sizes is valid");
    let policy = Policy::initial(&task).expect("ordinary numbers");
    let simulation = Simulation::new(&task, &policy).expect("the policy is the task's");
    let options = Pi2Options { rollouts, ..Pi2Options::default() };
    let mut learner = Pi2::new(simulation.blocks(), simulation.steps(), policy.weights(), options).unwrap();
    let (mut batch, mut workspace) = (Batch::default(), simulation.workspace());
    let mut costs = vec![Cost::default(); rollouts];
    let (start, mut least) = (Instant::now(), f64::INFINITY);
    while start.elapsed() < LONG {
        let begin = Instant::now();
        learner.ask_into(&mut batch);
        let samples: Vec<Parameters<'_>> = (0..rollouts).map(|k| batch.sample(k)).collect();
        simulation.rollouts(Draws::Update(0), &samples, &mut workspace, &mut costs);
        learner.tell(&batch, &costs).expect("all costs are finite");
        least = least.min(begin.elapsed().as_secs_f64());
    }
    least
}

/// A quantity, four values of it, and how it is set.
type Row = (&'static str, [usize; 4], fn(&mut Size, usize));

fn main() {
    let middle = Size { steps: 500, bases: 20, axes: 2, rollouts: 32 };
    let rows: [Row; 7] = [
        ("steps", [250, 500, 1000, 2000], |size, value| size.steps = value),
        ("basis functions", [20, 40, 80, 160], |size, value| size.bases = value),
        ("basis functions", [40, 80, 160, 320], |size, value| size.bases = value),
        ("axes", [1, 2, 4, 6], |size, value| size.axes = value),
        ("axes", [2, 3, 4, 6], |size, value| size.axes = value),
        ("rollouts K", [16, 32, 64, 128], |size, value| size.rollouts = value),
        ("rollouts K", [32, 64, 128, 256], |size, value| size.rollouts = value),
    ];
    println!("| | sizes | ms per update | slope | from a line |\n|---|---|---|---|---|");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        for (name, values, set) in rows {
            let times = values.map(|value| {
                let mut size = middle;
                set(&mut size, value);
                update(size)
            });
            let sizes = values.map(|value| value as f64);
            let (slope, _) = line(sizes.map(f64::ln), times.map(f64::ln));
            let (rise, start) = line(sizes, times);
            let off = |i: usize| (times[i] / (start + rise * sizes[i]) - 1.0).abs();
            let off = (0..4).map(off).fold(0.0, f64::max);
            let [values, times] = [values.map(|v| v.to_string()), times.map(|t| format!("{:.3}", 1e3 * t))];
            println!("| {name} | {} | {} | {slope:.2} | {:.0} % |", values.join(", "), times.join(", "), 1e2 * off);
        }
    });
}

/// The straight line nearest to the points: its slope, and its value at zero.
fn line(x: [f64; 4], y: [f64; 4]) -> (f64, f64) {
    let mean = |values: [f64; 4]| values.iter().sum::<f64>() / 4.0;
    let (x_mean, y_mean) = (mean(x), mean(y));
    let above: f64 = x.iter().zip(y).map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
    let slope = above / x.iter().map(|x| (x - x_mean) * (x - x_mean)).sum::<f64>();
    (slope, y_mean - slope * x_mean)
}
