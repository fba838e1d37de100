//! Sensor and actuator: the loop of a controller in the simulator.

use hpf_sim::{Policy, Simulation, Task, Trace};

const REACH: &str = include_str!("../../../tasks/reach.toml");
const REST: f64 = 0.1;

/// The task of a tool that holds its place at 0.1 m: stiffness 100 N/m, damping 50 N s/m.
fn task(rate: f64, more: &str) -> Task {
    let text = format!(
        "name = \"robot\"\nduration = 2.0\nrate = {rate}\n[[axis]]\nname = \"x\"\nstart = {REST}\ngoal = {REST}\n\
         [movement]\nscaling = \"unit\"\n[stiffness]\ninitial = 100\nmin = 30\nmax = 400\n\
         [damping]\ninitial = 50\nmin = 10\nmax = 100\n[cost]\ngoal = 1\n{more}"
    );
    let task = Task::parse(&text).unwrap_or_else(|found| panic!("{found:?}"));
    Task { ends_at_duration: true, ..task }
}

fn run(task: &Task) -> Trace {
    let policy = Policy::initial(task).unwrap();
    Simulation::new(task, &policy).unwrap().rollout(&policy.weights())
}

const STEP: &str = "[[disturbance]]\nkind = \"step\"\naxis = \"x\"\namplitude = 8.0\nstart = 0.5\n";

/// Offset under 8 N from `start` on: exact for a force that is held.
fn settling(start: f64, t: f64) -> f64 {
    if t <= start { 0.0 } else { 0.08 * (1.0 - (-2.0 * (t - start)).exp()) }
}

fn distance(signal: &[f64], trace: &Trace, exact: impl Fn(f64) -> f64) -> f64 {
    signal.iter().zip(&trace.time).map(|(found, &t)| (found - exact(t)).abs()).fold(0.0, f64::max)
}

#[test]
fn a_step_is_followed_exactly_and_as_late_as_the_sensor_is() {
    for (sensor, late) in [("[sensor]\n", 0.0), ("[sensor]\ndelay = 0.05\n", 0.05)] {
        let trace = run(&task(100.0, &format!("{STEP}{sensor}")));
        let error = distance(&trace.axes[0].position, &trace, |t| REST + settling(0.5 + late, t));
        assert!(error < 1e-12, "{sensor}: {error:e}");
    }
    // Half a step older, a reading lies between two samples.
    let trace = run(&task(100.0, &format!("{STEP}[sensor]\ndelay = 0.045\n")));
    let at = trace.time.iter().position(|t| (t - 0.54).abs() < 1e-9).unwrap();
    assert!((trace.axes[0].force[at] - 4.0).abs() < 1e-9, "{}", trace.axes[0].force[at]);
}

#[test]
fn bias_quantisation_and_lost_readings_are_what_they_say() {
    let forces = |sensor: &str| run(&task(100.0, &format!("{STEP}[sensor]\n{sensor}"))).axes[0].force.clone();
    let biased = forces("bias = -0.5\n");
    assert!(biased[..50].iter().all(|force| *force == -0.5) && biased[50..].iter().all(|force| *force == 7.5));
    let rough = forces("noise = 1.0\nquantisation = 0.25\n");
    assert!(rough.iter().all(|force| force % 0.25 == 0.0));
    let lossy = forces("noise = 1.0\ndropout = 0.4\n");
    let repeated = lossy.windows(2).filter(|pair| pair[0] == pair[1]).count();
    // 200 readings, 80 of them lost on average; five standard deviations of the count are 35.
    assert!((45..=115).contains(&repeated), "{repeated}");
    let noisy = forces("noise = 1.0\n");
    let mean = noisy[..50].iter().sum::<f64>() / 50.0;
    let deviation = (noisy[..50].iter().map(|force| (force - mean).powi(2)).sum::<f64>() / 49.0).sqrt();
    assert!(mean.abs() < 0.7 && (0.5..1.5).contains(&deviation), "{mean} {deviation}");
    assert_eq!(noisy, forces("noise = 1.0\n"), "the same seed, the same noise");
}

#[test]
fn an_actuator_with_lag_follows_its_command_exactly() {
    // Command and tool start together at rest; the force steps at the start. With rates 2 and 1/lag:
    let (rate, lag): (f64, f64) = (2.0, 0.1);
    let exact = |t: f64| {
        let fast = 1.0 / lag;
        REST + 0.08 * (1.0 - (fast * (-rate * t).exp() - rate * (-fast * t).exp()) / (fast - rate))
    };
    let errors = [100.0, 200.0].map(|rate| {
        let text = STEP.replace("start = 0.5", "start = 0.0") + "[actuator]\nlag = 0.1\n";
        let trace = run(&task(rate, &text));
        distance(&trace.axes[0].position, &trace, exact)
    });
    // The command runs linearly over a step: second order.
    assert!(errors[0] < 1e-5 && (errors[0] / errors[1] - 4.0).abs() < 0.1, "{errors:?}");
}

#[test]
fn a_perfect_sensor_comes_to_the_known_force_with_the_step() {
    let swing = "[[disturbance]]\nkind = \"sine\"\naxis = \"x\"\namplitude = 8.0\nperiod = 1.0\n";
    for law in ["", "[admittance]\norder = 2\nmass = 2.0\n"] {
        let errors = [100.0, 200.0, 400.0].map(|rate| {
            let (known, measured) =
                (task(rate, &format!("{swing}{law}")), task(rate, &format!("{swing}{law}[sensor]\n")));
            let (known, measured) = (run(&known), run(&measured));
            let pairs = known.axes[0].position.iter().zip(&measured.axes[0].position);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        });
        // Held from the start of the step: half a step late, first order.
        let ratios = [errors[0] / errors[1], errors[1] / errors[2]];
        assert!(ratios.iter().all(|ratio| (ratio - 2.0).abs() < 0.05), "{errors:?}");
    }
}

/// How far the contact force swings in the second and in the last fifth of the motion [N].
fn swings(stiffness: f64, delay: f64, law: &str) -> [f64; 2] {
    let wall = format!(
        "[contact]\nkind = \"wall\"\naxis = \"x\"\nposition = {REST}\nstiffness = {stiffness}\nforce = 10.0\n\
         [sensor]\ndelay = {delay}\n{law}"
    );
    let trace = run(&task(1000.0, &wall));
    let force = &trace.contact.as_ref().unwrap().force;
    let fifth = force.len() / 5;
    [&force[fifth..2 * fifth], &force[4 * fifth..]].map(|part| {
        let most = part.iter().fold(0.0, |most: f64, force| most.max(*force));
        most - part.iter().fold(f64::INFINITY, |least, force| least.min(*force))
    })
}

#[test]
fn a_measured_contact_is_stable_below_the_limit_and_not_above_it() {
    for law in ["", "[admittance]\norder = 2\nmass = 2.0\n", "[admittance]\norder = 2\nmass = 50.0\n"] {
        for delay in [0.0, 0.001, 0.002, 0.005] {
            let wall = "[contact]\nkind = \"wall\"\naxis = \"x\"\nposition = 0.1\nstiffness = 1\n";
            let mut judged = task(1000.0, &format!("{wall}[sensor]\ndelay = {delay}\n{law}"));
            // The limit at the damping that the tool has.
            judged.damping.min = hpf_sim::task::PerAxis::All(50.0);
            let limit = judged.measured_contact().unwrap().limit;
            let [early, late] = swings(0.9 * limit, delay, law);
            assert!(late < 0.95 * early || late < 0.01, "{law} {delay}: {early} {late} at 0.9 of {limit}");
            let [early, late] = swings(1.1 * limit, delay, law);
            assert!(late > 0.98 * early && late > 5.0, "{law} {delay}: {early} {late} at 1.1 of {limit}");
        }
    }
}

#[test]
fn a_task_without_sensor_has_no_measured_contact() {
    assert_eq!(Task::parse(REACH).unwrap().measured_contact(), None);
}
