//! Forces and contacts against their closed forms: a tool held by a constant spring k and damper d to a reference at
//! rest moves on exponentials, which the steps must hit to the last digits.

use hpf_sim::{Policy, Simulation, Task, Trace};

const K: f64 = 200.0;
const D: f64 = 40.0;
/// Where the reference rests [m].
const REST: f64 = 0.3;

/// A task of one axis at rest for 2 s, with constant gains and `extra` tables.
fn task(rate: f64, extra: &str) -> Task {
    Task::parse(&format!(
        "name = \"rest\"\nduration = 2.0\nrate = {rate}\naxis = [{{ name = \"x\", start = {REST}, goal = {REST} }}]\n\
         movement = {{ scaling = \"unit\" }}\nstiffness = {{ initial = {K}, min = 30.0, max = 400.0 }}\n\
         damping = {{ initial = {D}, min = 10.0, max = 100.0 }}\ncost = {{ stiffness = 1.0 }}\n{extra}"
    ))
    .unwrap()
}

fn run(task: &Task) -> Trace {
    let policy = Policy::initial(task).unwrap();
    Simulation::new(task, &policy).unwrap().rollout(&policy.weights())
}

/// Largest distance of the tool from `exact(t)`.
fn distance(trace: &Trace, exact: impl Fn(f64) -> f64) -> f64 {
    let pairs = trace.time.iter().zip(&trace.axes[0].position);
    pairs.map(|(&t, position)| (position - exact(t)).abs()).fold(0.0, f64::max)
}

/// The answer of the offset to a jump to `force` at `start`.
fn jump(force: f64, start: f64, t: f64) -> f64 {
    force / K * -(-K / D * (t - start).max(0.0)).exp_m1()
}

/// The answer of the offset to a force that grows by `slope` per second from `start` on.
fn growth(slope: f64, start: f64, t: f64) -> f64 {
    let t = (t - start).max(0.0);
    slope / K * (t + D / K * (-K / D * t).exp_m1())
}

fn disturbance(kind: &str) -> String {
    format!("[[disturbance]]\naxis = \"x\"\n{kind}\n")
}

/// The motion is a sum of 200 exponential steps: their rounding.
const EXACT: f64 = 1e-14;

#[test]
fn without_forces_the_tool_stays_at_rest() {
    let trace = run(&task(100.0, ""));
    // 2 s (0.1 + 13.277/25) are 1.262 s of rest.
    assert_eq!((trace.steps(), trace.time.len()), (200, 200 + 127 + 1));
    assert_eq!(distance(&trace, |_| REST), 0.0);
    assert!(trace.axes[0].velocity.iter().all(|v| *v == 0.0));
}

#[test]
fn steps_pulses_and_ramps_on_the_grid_are_exact() {
    for rate in [50.0, 100.0, 1000.0] {
        let step = task(rate, &disturbance("kind = \"step\"\namplitude = -8.0\nstart = 0.3"));
        assert!(distance(&run(&step), |t| REST + jump(-8.0, 0.3, t)) < EXACT);

        let pulse = task(rate, &disturbance("kind = \"pulse\"\namplitude = 8.0\nstart = 0.3\nlength = 0.4"));
        assert!(distance(&run(&pulse), |t| REST + jump(8.0, 0.3, t) - jump(8.0, 0.7, t)) < EXACT);

        let ramp = task(rate, &disturbance("kind = \"ramp\"\namplitude = 8.0\nstart = 0.3\nlength = 0.4"));
        assert!(distance(&run(&ramp), |t| REST + growth(20.0, 0.3, t) - growth(20.0, 0.7, t)) < EXACT);
    }
}

#[test]
fn a_table_is_a_chain_of_ramps() {
    let mut task = task(100.0, &disturbance("kind = \"table\"\nfile = \"forces.csv\""));
    let hpf_sim::environment::Disturbance::Table(table) = &mut task.disturbance[0] else { panic!("not a table") };
    let rows = [(0.2, 0.0), (0.5, 6.0), (0.6, -3.0), (1.0, -3.0)];
    table.samples = hpf_sim::environment::disturbance::Samples::new(&rows).unwrap();
    let slopes = [(20.0, 0.2), (-110.0, 0.5), (90.0, 0.6)];
    let exact = |t: f64| REST + slopes.iter().map(|&(slope, start)| growth(slope, start, t)).sum::<f64>();
    assert!(distance(&run(&task), exact) < EXACT);
}

#[test]
fn forces_on_one_axis_add_up() {
    let one = disturbance("kind = \"step\"\namplitude = 5.0\nstart = 0.0");
    let other = disturbance("kind = \"step\"\namplitude = -2.0\nstart = 0.5");
    let trace = run(&task(100.0, &(one + &other)));
    assert!(distance(&trace, |t| REST + jump(5.0, 0.0, t) + jump(-2.0, 0.5, t)) < EXACT);
    assert_eq!((trace.axes[0].force[0], trace.axes[0].force[49], trace.axes[0].force[50]), (5.0, 5.0, 3.0));
}

#[test]
fn a_sine_is_followed_to_second_order() {
    let (amplitude, period, start) = (10.0, 0.5, 0.4_f64);
    let omega = 2.0 * core::f64::consts::PI / period;
    let text = disturbance(&format!("kind = \"sine\"\namplitude = {amplitude}\nperiod = {period}\nphase = {start}"));
    // d e' + k e = A sin(w t + p) from rest: the steady swing, and what makes it start at zero.
    let square = K * K + D * D * omega * omega;
    let steady = |t: f64| amplitude / square * (K * (omega * t + start).sin() - D * omega * (omega * t + start).cos());
    let exact = |t: f64| REST + steady(t) - steady(0.0) * (-K / D * t).exp();
    let errors = [100.0, 200.0, 400.0].map(|rate| distance(&run(&task(rate, &text)), exact));
    // A line instead of the arc over a step: A (w h)^2/8 at most, through the spring.
    assert!(errors[0] < amplitude * (omega / 100.0).powi(2) / 8.0 / K, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] / 4.0 - 1.0).abs() < 0.02, "{errors:?}");
    }
}

#[test]
fn a_jump_between_samples_costs_at_most_half_a_step_of_its_impulse() {
    for share in [0.1, 0.25, 0.5, 0.9] {
        for rate in [100.0, 200.0] {
            let dt = 1.0 / rate;
            let start = 0.3 + share * dt;
            let step = task(rate, &disturbance(&format!("kind = \"step\"\namplitude = 8.0\nstart = {start}")));
            let error = distance(&run(&step), |t| REST + jump(8.0, start, t));
            // Seen as a ramp over its step, whose impulse is that of a jump in the middle: A h |share - 1/2| apart.
            let impulse = 8.0 * dt * (share - 0.5_f64).abs();
            // The force itself differs for a part of the step, damped by k h/d = 5 %: a tenth of what the step can do.
            assert!(error < impulse / D + 0.1 * 8.0 * dt / D * K * dt / D, "{share} {rate}: {error:e}");
            assert!(error < 8.0 * dt / (2.0 * D));
        }
    }
}

#[test]
fn a_pulse_may_begin_and_end_between_samples() {
    let pulse = task(100.0, &disturbance("kind = \"pulse\"\namplitude = 8.0\nstart = 0.3037\nlength = 0.5004"));
    let error = distance(&run(&pulse), |t| REST + jump(8.0, 0.3037, t) - jump(8.0, 0.8041, t));
    // Half a step's impulse at either end.
    assert!(error < 8.0 * 0.01 / D, "{error:e}");
}

/// A push of 10 N from 0.2 s on against a wall 0.02 m away; the tool alone would go 0.05 m.
const GAP: f64 = 0.02;
const WALL: f64 = 3000.0;

fn wall(position: f64, stiffness: f64, side: &str, force: f64) -> String {
    format!(
        "[contact]\nkind = \"wall\"\naxis = \"x\"\nposition = {position}\nstiffness = {stiffness}\nside = \"{side}\"\n\
         force = {force}\n"
    )
}

fn push(amplitude: f64) -> String {
    disturbance(&format!("kind = \"pulse\"\namplitude = {amplitude}\nstart = 0.2\nlength = 1.0"))
}

/// Where a tool pushed with `force` rests against the wall: `k (y - x_r) = f - K (y - y_s)`.
fn resting(force: f64) -> f64 {
    (K * REST + force + WALL * (REST + GAP)) / (K + WALL)
}

/// The motion of a tool that is pushed with 10 N over [0.2, 1.2] s, meets the wall, and comes back.
fn against_the_wall(t: f64) -> f64 {
    let surface = REST + GAP;
    let (free, held) = (K / D, (K + WALL) / D);
    let meets = 0.2 - (1.0 - GAP * K / 10.0).ln() / free;
    let leaves = 1.2 + ((resting(10.0) - resting(0.0)) / (surface - resting(0.0))).ln() / held;
    if t < meets {
        REST + jump(10.0, 0.2, t)
    } else if t < 1.2 {
        resting(10.0) + (surface - resting(10.0)) * (-held * (t - meets)).exp()
    } else if t < leaves {
        resting(0.0) + (resting(10.0) - resting(0.0)) * (-held * (t - 1.2)).exp()
    } else {
        REST + GAP * (-free * (t - leaves)).exp()
    }
}

#[test]
fn impact_and_release_are_resolved_inside_the_step() {
    for rate in [50.0, 100.0, 1000.0] {
        let trace = run(&task(rate, &(wall(REST + GAP, WALL, "above", 0.0) + &push(10.0))));
        // By 1.2 s the tool stands still (exp(-72)); the crossings are found to the last bit of the step.
        let error = distance(&trace, against_the_wall);
        assert!(error < 1e-13, "{rate}: {error:e}");
    }
}

#[test]
fn the_first_contact_is_when_the_free_motion_reaches_the_surface() {
    let trace = run(&task(100.0, &(wall(REST + GAP, WALL, "above", 0.0) + &push(10.0))));
    let force = &trace.contact.as_ref().unwrap().force;
    let first = force.iter().position(|force| *force > 0.0).unwrap();
    // Back from the first sample in contact, on the motion against the wall, to the surface.
    let share = (trace.axes[0].position[first] - resting(10.0)) / (REST + GAP - resting(10.0));
    let found = trace.time[first] + share.ln() * D / (K + WALL);
    let exact = 0.2 - (1.0 - GAP * K / 10.0).ln() * D / K;
    assert!((found - exact).abs() < 1e-13, "{found} {exact}");
    assert!((exact / 0.01).fract() > 0.1 && (exact / 0.01).fract() < 0.9, "the impact lies inside a step");
}

#[test]
fn a_tool_against_a_wall_rests_where_the_forces_are_equal() {
    let trace = run(&task(100.0, &(wall(REST + GAP, WALL, "above", 0.0) + &push(10.0))));
    let y = trace.axes[0].position[119];
    let [spring, contact] = [K * (y - REST), WALL * (y - REST - GAP)];
    assert!((spring + contact - 10.0).abs() < 1e-10, "{spring} {contact}"); // 3000 N/m times the rounding of a metre
    assert!((trace.contact.as_ref().unwrap().force[119] - contact).abs() < 1e-10);
    assert!((trace.axes[0].force[119] - (10.0 - contact)).abs() < 1e-10);
}

#[test]
fn a_set_point_presses_until_the_contact_answers_it() {
    // The reference rests on the surface: the tool sinks in until k e + K e = 6 N. Deviation counts from 6 N/K.
    let trace = run(&task(100.0, &wall(REST, WALL, "above", 6.0)));
    assert!(distance(&trace, |t| REST - 6.0 / (K + WALL) * (-(K + WALL) / D * t).exp_m1()) < 1e-14);
    let contact = trace.contact.as_ref().unwrap();
    assert_eq!((contact.set_point, contact.deflection[0]), (6.0, 6.0 / WALL));
    let depth = 6.0 / (K + WALL);
    assert!((contact.deviation[200] - (depth - 6.0 / WALL)).abs() < 1e-15);
    assert!((contact.force[200] - WALL * depth).abs() < 1e-11);
}

#[test]
fn walls_on_either_side_are_mirror_images() {
    for (gap, force) in [(GAP, 0.0), (GAP, 4.0), (0.0, 4.0), (-0.01, 0.0)] {
        let above = run(&task(100.0, &(wall(REST + gap, WALL, "above", force) + &push(10.0))));
        let below = run(&task(100.0, &(wall(REST - gap, WALL, "below", force) + &push(-10.0))));
        let (a, b) = (&above.axes[0], &below.axes[0]);
        let (up, down) = (above.contact.unwrap(), below.contact.unwrap());
        for i in 0..=200 {
            // The rounding of positions, times the stiffness where it is a force.
            assert!((a.position[i] - REST + (b.position[i] - REST)).abs() < 1e-14);
            assert!((a.velocity[i] + b.velocity[i]).abs() < 1e-11 && (a.force[i] + b.force[i]).abs() < 1e-11);
            assert!((up.force[i] - down.force[i]).abs() < 1e-11);
            assert!((up.deviation[i] - down.deviation[i]).abs() < 1e-14);
        }
        assert!(up.force.iter().any(|force| *force > 0.0));
    }
}

#[test]
fn a_wall_pushes_and_never_pulls() {
    for (side, sign) in [("above", 1.0), ("below", -1.0)] {
        for amplitude in [10.0, -10.0] {
            let trace = run(&task(100.0, &(wall(REST, WALL, side, 0.0) + &push(amplitude))));
            let contact = trace.contact.as_ref().unwrap();
            for i in 0..=200 {
                let depth = sign * (trace.axes[0].position[i] - REST);
                assert!(contact.force[i] >= 0.0 && (contact.force[i] > 0.0) == (depth > 0.0));
            }
            if sign * amplitude < 0.0 {
                let away = distance(&trace, |t| REST + jump(amplitude, 0.2, t) - jump(amplitude, 1.2, t));
                // On the way back the surface is reached only in the limit: the motion is the free one.
                assert!(away < EXACT, "{away:e}");
            }
        }
    }
}

#[test]
fn a_wall_as_stiff_as_rock_is_stable_at_any_rate() {
    for stiffness in [1e6, 1e9, 1e12] {
        for rate in [20.0, 100.0] {
            for gap in [GAP, 0.0, -1e-4] {
                let trace = run(&task(rate, &(wall(REST + gap, stiffness, "above", 3.0) + &push(10.0))));
                let contact = trace.contact.as_ref().unwrap();
                for i in 0..trace.time.len() {
                    let depth = trace.axes[0].position[i] - (REST + gap);
                    let signals = [trace.axes[0].velocity[i], trace.axes[0].force[i], contact.force[i]];
                    assert!(signals.iter().all(|value| value.is_finite()));
                    // From the second sample on, when a tool that starts inside is out: no deeper than all forces
                    // press, 13 N and the spring's 200 N/m times 1e-4 m, and the rounding of a position.
                    assert!(i == 0 || depth < 13.1 / stiffness + 1e-15, "{stiffness:e} {rate} {gap}: {depth:e}");
                }
            }
        }
    }
}

const TIP_LOAD: &str = include_str!("../../../tasks/cantilever.toml");
const MOVING_LOAD: &str = include_str!("../../../tasks/cantilever_moving_load.toml");
const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");
const REACH: &str = include_str!("../../../tasks/reach.toml");

/// Numbers in [-1, 1) that depend on `index` alone.
fn scatter(index: usize) -> f64 {
    let mixed = (index as u64).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Weights about those of `policy`, the gains' within their bounds.
fn scattered(task: &Task, policy: &Policy, draw: usize) -> Vec<f64> {
    let mut index = 1000 * draw;
    let mut next = || {
        index += 1;
        scatter(index)
    };
    let mut policy = policy.clone();
    for axis in &mut policy.axes {
        let noise = task.learning.noise.movement.of(0);
        axis.movement.weights.iter_mut().for_each(|w| *w += noise * next());
        for gain in [&mut axis.stiffness, &mut axis.damping] {
            let (middle, half) = (0.5 * (gain.max + gain.min), 0.5 * (gain.max - gain.min));
            gain.weights.iter_mut().for_each(|w| *w = middle + half * next());
        }
    }
    policy.weights()
}

#[test]
fn a_cantilever_starts_in_contact_equilibrium_and_is_not_lost_at_the_start() {
    for text in [TIP_LOAD, MOVING_LOAD] {
        for rate in [100.0, 1000.0] {
            let mut task = Task::parse(text).unwrap();
            task.rate = rate;
            let policy = Policy::initial(&task).unwrap();
            let simulation = Simulation::new(&task, &policy).unwrap();
            for draw in 0..20 {
                let weights = if draw == 0 { policy.weights() } else { scattered(&task, &policy, draw) };
                let trace = simulation.rollout(&weights);
                let contact = trace.contact.as_ref().unwrap();
                assert!((contact.force[0] - 10.0).abs() < 1e-12);
                // The contact balances the set-point, and the reference starts where the tool is: nothing moves it.
                let axis = &trace.axes[0];
                assert!(axis.position[0] == axis.reference_position[0] && axis.velocity[0].abs() < 1e-12);
                let early = (0.1 * rate) as usize;
                assert!(contact.force[..=early].iter().all(|force| *force > 0.0), "{rate} {draw}");
            }
        }
    }
}

#[test]
fn velocity_is_the_reference_and_what_the_force_makes_the_damper_give() {
    for text in [VIA_POINT, TIP_LOAD, MOVING_LOAD, REACH] {
        let task = Task::parse(text).unwrap();
        let policy = Policy::initial(&task).unwrap();
        let simulation = Simulation::new(&task, &policy).unwrap();
        for draw in 0..5 {
            for axis in &simulation.rollout(&scattered(&task, &policy, draw)).axes {
                for i in 0..axis.position.len() {
                    let offset = axis.position[i] - axis.reference_position[i];
                    let give = (axis.force[i] - axis.stiffness[i] * offset) / axis.damping[i];
                    let expected = axis.reference_velocity[i] + give;
                    // The contact's 1e6 N/m times the rounding of a position, over 10 N s/m.
                    assert!((axis.velocity[i] - expected).abs() < 1e-11, "{i}: {} {expected}", axis.velocity[i]);
                }
            }
        }
    }
}

#[test]
fn gains_stay_within_their_bounds_at_every_sample() {
    let task = Task::parse(VIA_POINT).unwrap();
    let policy = Policy::initial(&task).unwrap();
    let simulation = Simulation::new(&task, &policy).unwrap();
    for draw in 0..5 {
        for axis in &simulation.rollout(&scattered(&task, &policy, draw)).axes {
            // A mixture of weights within bounds; the sum of the mixture's shares is 1 but for rounding.
            assert!(axis.stiffness.iter().all(|k| (30.0 - 1e-12..=400.0 + 1e-12).contains(k)));
            assert!(axis.damping.iter().all(|d| (10.0 - 1e-12..=100.0 + 1e-12).contains(d)));
        }
    }
}

#[test]
fn metrics_measure_the_trace() {
    let task = Task::parse(TIP_LOAD).unwrap();
    let policy = Policy::initial(&task).unwrap();
    let simulation = Simulation::new(&task, &policy).unwrap();
    let trace = simulation.rollout(&policy.weights());
    let metrics = simulation.metrics(&trace);
    let value = |name: &str| metrics.iter().find(|metric| metric.name == name).unwrap().value;
    let contact = trace.contact.as_ref().unwrap();
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(value("max_deviation"), most(&mut contact.deviation.iter().map(|d| d.abs())));
    assert_eq!(value("max_force_error"), most(&mut contact.force[10..].iter().map(|f| (f - 10.0).abs())));
    let lost = contact.force[1..].iter().filter(|force| **force <= 0.0).count();
    assert!((value("max_contact_loss") - 0.01 * lost as f64).abs() < 1e-12);
    assert_eq!(value("max_goal_error"), (trace.axes[0].position[500] - 0.032).abs());
    assert_eq!(value("max_end_speed"), trace.axes[0].velocity[500].abs());
    assert_eq!(value("max_cost"), simulation.cost(&trace).total());
    assert!((value("stiffness_min") - 100.0).abs() < 1e-12 && (value("damping_max") - 50.0).abs() < 1e-12);
    let target = metrics.iter().find(|metric| metric.name == "max_deviation").unwrap();
    assert_eq!((target.target, target.pass()), (Some(0.02e-3), Some(false)));
    assert_eq!(metrics.iter().find(|metric| metric.name == "max_cost").unwrap().pass(), None);
}
