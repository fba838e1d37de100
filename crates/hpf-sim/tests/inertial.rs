//! The law of second order in the simulator, against a fine solution of the continuous equations by other means.

use crate::solver::mixture::mixture;
use hpf_learn::{Draws, Parameters, Problem};
use hpf_sim::{AxisPolicy, GainPolicy, Policy, Simulation, Task, Trace};

const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");
const BEAM: &str = include_str!("../../../tasks/cantilever.toml");
const REACH: &str = include_str!("../../../tasks/reach.toml");
const MASS: f64 = 2.0;

fn task(text: &str, rate: f64) -> Task {
    let mut task = Task::parse(&format!("{text}\n[admittance]\norder = 2\nmass = {MASS}\n")).unwrap();
    task.rate = rate;
    task
}

/// A policy whose gains rise and fall.
fn policy(task: &Task, size: f64) -> Policy {
    let mut policy = Policy::initial(task).unwrap();
    for axis in &mut policy.axes {
        axis.movement.weights.iter_mut().enumerate().for_each(|(i, w)| *w = size * (1.1 * i as f64).sin());
        axis.stiffness.weights.iter_mut().enumerate().for_each(|(i, w)| *w = 200.0 + 150.0 * (0.7 * i as f64).sin());
        axis.damping.weights.iter_mut().enumerate().for_each(|(i, w)| *w = 55.0 + 35.0 * (0.9 * i as f64).sin());
    }
    policy
}

/// Position and velocity of the tool at `samples` + 1 times by Runge-Kutta 4, `finer` steps between them; `load` is the
/// force on it at a time and a position.
fn solve(
    policy: &Policy,
    axis: &AxisPolicy,
    start: f64,
    load: impl Fn(f64, f64) -> f64,
    [samples, finer]: [usize; 2],
) -> Vec<[f64; 2]> {
    let duration = policy.duration_s;
    let m = &axis.movement;
    let gain = |s: f64, gain: &GainPolicy| mixture(s, &gain.centers, &gain.widths, &gain.weights);
    let slope = |t: f64, [x, v, e, w]: [f64; 4]| {
        let s = (-policy.phase.decay * t / duration).exp();
        let forcing = s * m.forcing_scale * mixture(s, &m.centers, &m.widths, &m.weights);
        let acceleration = (m.alpha * (m.beta * (axis.goal - x) - duration * v) + forcing) / (duration * duration);
        let (k, d) = (gain(s, &axis.stiffness), gain(s, &axis.damping));
        [v, acceleration, w, (load(t, x + e) - d * w - k * e) / MASS]
    };
    let h = duration / (samples * finer) as f64;
    let mut state = [start, 0.0, 0.0, 0.0];
    let mut found = vec![[start, 0.0]];
    for i in 0..samples * finer {
        let t = i as f64 * h;
        let at = |by: f64, slope: [f64; 4]| core::array::from_fn(|j| state[j] + by * slope[j]);
        let a = slope(t, state);
        let b = slope(t + 0.5 * h, at(0.5 * h, a));
        let c = slope(t + 0.5 * h, at(0.5 * h, b));
        let d = slope(t + h, at(h, c));
        state = core::array::from_fn(|j| state[j] + h / 6.0 * (a[j] + 2.0 * b[j] + 2.0 * c[j] + d[j]));
        if (i + 1) % finer == 0 {
            found.push([state[0] + state[2], state[1] + state[3]]);
        }
    }
    found
}

fn rollout(text: &str, policy: &Policy, rate: f64) -> Trace {
    Simulation::new(&task(text, rate), policy).unwrap().rollout(&policy.weights())
}

/// Largest errors of position and velocity of the first axis at the samples of 100 Hz.
fn errors(trace: &Trace, exact: &[[f64; 2]]) -> [f64; 2] {
    let finer = trace.steps() / (exact.len() - 1);
    let axis = &trace.axes[0];
    [(&axis.position, 0), (&axis.velocity, 1)].map(|(signal, column)| {
        let pairs = signal.iter().step_by(finer).zip(exact);
        pairs.map(|(found, exact)| (found - exact[column]).abs()).fold(0.0, f64::max)
    })
}

#[test]
fn a_free_tool_with_inertia_follows_the_continuous_law_to_second_order() {
    let policy = policy(&task(VIA_POINT, 100.0), 60.0);
    let push = |t: f64, _: f64| 10.0 * (2.0 * core::f64::consts::PI * t / 5.0).sin();
    let exact = solve(&policy, &policy.axes[0], 0.0, push, [500, 20]);
    let found = [100.0, 200.0, 400.0].map(|rate| errors(&rollout(VIA_POINT, &policy, rate), &exact));
    // Measured at 100 Hz: 4.2e-6 m and 1.6e-4 m/s.
    assert!(found[0][0] < 1e-5 && found[0][1] < 3e-4, "{found:?}");
    for pair in found.windows(2) {
        assert!(pair[0].iter().zip(pair[1]).all(|(a, b)| (a / b - 4.0).abs() < 0.2), "{found:?}");
    }
}

#[test]
fn a_tool_with_inertia_on_the_beam_follows_the_continuous_law() {
    let policy = policy(&task(BEAM, 100.0), 0.0);
    let stiffness = |t: f64| {
        let u = t / 5.0;
        let x = 0.8 * (10.0 * u.powi(3) - 15.0 * u.powi(4) + 6.0 * u.powi(5));
        let bending = 200e9 * 0.05 * 0.004_f64.powi(3) / 12.0;
        1.0 / (x * x * (3.0 * 0.8 - x) / (6.0 * bending) + 1e-6)
    };
    let load = |t: f64, y: f64| 10.0 - stiffness(t) * y.max(0.0);
    let exact = solve(&policy, &policy.axes[0], 1e-5, load, [500, 200]);
    let found = [100.0, 200.0, 400.0, 800.0, 1600.0].map(|rate| errors(&rollout(BEAM, &policy, rate), &exact));
    // The tool swings on the beam seven radians in a step of 10 ms, by 2.8e-7 m and 1.9e-4 m/s; from 200 Hz on, what
    // is left falls with the square of the step, without any regard to the swing.
    assert!(found[0][0] < 1e-6 && found[0][1] < 5e-4, "{found:?}");
    for pair in found[1..].windows(2) {
        assert!(pair[0].iter().zip(pair[1]).all(|(a, b)| (a / b - 4.0).abs() < 0.5), "{found:?}");
    }
}

#[test]
fn a_tool_with_inertia_bounces_off_a_wall_within_a_step() {
    let wall = "[contact]\nkind = \"wall\"\naxis = \"x\"\nposition = 0.2\nstiffness = 2e4\n";
    let text = format!("{REACH}\n{wall}");
    let policy = policy(&task(&text, 100.0), 0.0);
    let load = |t: f64, y: f64| if t >= 0.5 { -2.0 } else { 0.0 } - 2e4 * (y - 0.2).max(0.0);
    let exact = solve(&policy, &policy.axes[0], 0.0, load, [100, 4000]);
    let found = [100.0, 200.0, 400.0, 800.0, 1600.0].map(|rate| errors(&rollout(&text, &policy, rate), &exact));
    // Measured 1.2e-5 m and 2.1e-3 m/s at 100 Hz, where a bounce takes three steps; at 1600 Hz a 200th and a 260th of it:
    // second order through every crossing.
    assert!(found[0][0] < 3e-5 && found[0][1] < 5e-3, "{found:?}");
    for column in 0..2 {
        let order = (found[0][column] / found[4][column]).log2() / 4.0;
        assert!(order > 1.8, "order {order}: {found:?}");
    }
}

#[test]
fn rollouts_together_cost_what_each_costs_alone() {
    let wall = "[contact]\nkind = \"wall\"\naxis = \"x\"\nposition = 0.2\nstiffness = 2e4\n";
    for text in [VIA_POINT, BEAM, &format!("{REACH}\n{wall}")] {
        let task = task(text, 100.0);
        let policy = policy(&task, 1.0);
        let simulation = Simulation::new(&task, &policy).unwrap();
        let samples: Vec<Vec<f64>> = (0..5)
            .map(|k| {
                let mut weights = policy.weights();
                weights.iter_mut().enumerate().for_each(|(i, w)| *w += 3.0 * ((i + 31 * k) as f64).sin());
                weights
            })
            .collect();
        let parameters: Vec<Parameters<'_>> = samples.iter().map(|sample| Parameters::Constant(sample)).collect();
        let mut costs = vec![hpf_learn::Cost::default(); samples.len()];
        simulation.rollouts(Draws::HeldOut, &parameters, &mut simulation.workspace(), &mut costs);
        for (sample, cost) in samples.iter().zip(&costs) {
            assert_eq!(&simulation.cost(&simulation.rollout(sample)), cost);
        }
    }
}
