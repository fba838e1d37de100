//! Rollouts in batches and whole runs of learning: `cargo bench -p hpf-sim`.

#[path = "../tests/stepped/mod.rs"]
mod stepped;

use core::hint::black_box;

use criterion::Criterion;
use hpf_learn::{Cost, Draws, Parameters, Pi2, Pi2Options, Problem, learn};
use hpf_sim::Policy;
use hpf_sim::environment::disturbance::Side;
use stepped::{prepared, stepped};

const CANTILEVER: &str = include_str!("../../../tasks/cantilever.toml");
const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");

/// The size of the via-point task of dmpbbo: 76 steps, 2 axes, 10 functions.
const SMALL: &str = r#"
name = "small"
duration = 0.5
rate = 152.0
axis = [{ name = "x", start = 1.8, goal = 4.0 }, { name = "y", start = 2.0, goal = 3.0 }]
movement = { basis = 10 }
stiffness = { basis = 10, initial = 100.0, min = 30.0, max = 400.0 }
damping = { basis = 10, initial = 50.0, min = 10.0, max = 100.0 }
via_point = [{ time = 0.25, position = [3.0, 3.0] }]
cost = { via_point = 1e4, acceleration = 1e-3 }
learning = { noise = { movement = 10.0 } }
"#;

/// The same 20 rollouts of the via point, on one thread: stepped as a robot does, and as a batch.
fn batch_against_controller(criterion: &mut Criterion) {
    let (task, policy, simulation) = prepared(VIA_POINT);
    let options = Pi2Options { rollouts: 20, ..Pi2Options::default() };
    let batch = Pi2::new(simulation.blocks(), simulation.steps(), policy.weights(), options).unwrap().ask();
    let samples: Vec<Parameters<'_>> = (0..batch.len()).map(|k| batch.sample(k)).collect();
    let policies: Vec<Policy> =
        samples.iter().map(|sample| policy.clone().with_weights(sample.at(0)).unwrap()).collect();
    let middle = |i: usize| (i as f64 + 0.5) * task.duration / task.steps() as f64;
    let force = |i: usize| [0, 1].map(|axis| task.disturbance[axis].force(middle(i), Side::After));
    let forces: Vec<[f64; 2]> = (0..task.steps()).map(force).collect();
    for (policy, sample) in policies.iter().zip(&samples) {
        let trace = simulation.rollout(sample.at(0));
        for (i, command) in stepped(policy, &forces).into_iter().enumerate() {
            for (command, axis) in command.into_iter().zip(&trace.axes) {
                assert!((command - axis.position[i + 1]).abs() < 5e-6, "the same motion to 5 um");
            }
        }
    }
    let mut group = criterion.benchmark_group("20 rollouts of the via point, 20 000 axis-steps");
    group.bench_function("Controller", |bencher| {
        bencher.iter(|| policies.iter().map(|policy| stepped(policy, black_box(&forces))[499][0]).sum::<f64>());
    });
    for (name, simulation) in [("batch", simulation.clone()), ("batch, portable", simulation.clone().portable())] {
        let (mut workspace, mut costs) = (simulation.workspace(), vec![Cost::default(); samples.len()]);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                simulation.rollouts(Draws::Update(0), black_box(&samples), &mut workspace, &mut costs);
                costs[19].terminal
            });
        });
    }
    group.finish();
}

/// Whole runs of learning, evaluations included.
fn learning(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("learning");
    group.sample_size(10);
    for (name, text, updates, rollouts, threads) in [
        ("cantilever, 600 updates x 20 rollouts, 1 thread", CANTILEVER, 600, 20, 1),
        ("cantilever, 600 updates x 20 rollouts, 2 threads", CANTILEVER, 600, 20, 2),
        ("cantilever, 600 updates x 64 rollouts, 1 thread", CANTILEVER, 600, 64, 1),
        ("cantilever, 600 updates x 64 rollouts, 2 threads", CANTILEVER, 600, 64, 2),
        ("76 steps, 2 axes, 10 functions: 100 updates x 10 rollouts, 1 thread", SMALL, 100, 10, 1),
        ("76 steps, 2 axes, 10 functions: 100 updates x 10 rollouts, 2 threads", SMALL, 100, 10, 2),
    ] {
        let (task, policy, simulation) = prepared(text);
        let options = Pi2Options { updates, rollouts, ..task.learning.pi2_options() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        group.bench_function(name, |bencher| {
            bencher.iter(|| pool.install(|| learn(&simulation, policy.weights(), options, None, |_| true).unwrap()));
        });
    }
    // What the machine allows at most: two threads that have nothing to do with each other.
    let (task, policy, simulation) = prepared(CANTILEVER);
    let options = Pi2Options { updates: 600, rollouts: 64, ..task.learning.pi2_options() };
    let pools = [1, 1].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    group.bench_function("cantilever, 600 updates x 64 rollouts, twice side by side", |bencher| {
        let run = || learn(&simulation, policy.weights(), options, None, |_| true).unwrap();
        bencher.iter(|| {
            std::thread::scope(|scope| {
                let other = scope.spawn(|| pools[0].install(run));
                (pools[1].install(run), other.join().unwrap())
            })
        });
    });
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    batch_against_controller(&mut criterion);
    learning(&mut criterion);
    criterion.final_summary();
}
