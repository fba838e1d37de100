//! Movement and compliance of orientation on a chart, against 40-digit numbers and their energy.

use hpf_core::frame::PathFrame;
use hpf_core::orientation::{
    Chart, Commanded, OffsetStep, angular_velocity, commanded, offset_rate, reference_power, step_rotation,
    step_rotation_coupled, within_cone,
};
use hpf_core::passivity::EnergyTank;
use hpf_core::rotation::{Quaternion, Wxyz, dot, left_jacobian, length, times, transposed_times};
use hpf_core::{AxisPrimitives, Basis, Gain, HybridPrimitive, Law, Movement, Phase, Real, Symmetric};
use serde_json::Value;

fn table(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect()
}

fn gap(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn numbers<T: Real>(q: &Quaternion<T>) -> [f64; 4] {
    let Wxyz { w, x, y, z } = q.numbers();
    [w, x, y, z].map(T::to_f64)
}

fn reference() -> Value {
    serde_json::from_str(include_str!("data/pose/reference.json")).unwrap()
}

fn list<const N: usize>(value: &Value) -> [f64; N] {
    let numbers: Vec<f64> = serde_json::from_value(value.clone()).unwrap();
    numbers.try_into().unwrap()
}

fn quaternion<T: Real>(value: &Value) -> Quaternion<T> {
    let [w, x, y, z] = list::<4>(value).map(T::of);
    Quaternion::new(Wxyz { w, x, y, z }).unwrap()
}

/// The skill of the reference: three axes of a chart.
fn skill<T: Real>() -> (Chart<T>, HybridPrimitive<T, [T; 20], 3>) {
    let pose = &reference()["pose"];
    let number = |key: &str| T::of(pose[key].as_f64().unwrap());
    let chart = Chart::new(quaternion::<T>(&pose["goal_wxyz"]));
    let start = chart.coordinates(&quaternion(&pose["start_wxyz"]));
    assert!(gap(&start.map(T::to_f64), &list::<3>(&pose["start_rotation_vector"])) < 1e-6);
    let decay = number("decay");
    let basis = Basis::equally_spaced(decay, number("overlap"), [T::ZERO; 20], [T::ZERO; 20]).unwrap();
    let axes = core::array::from_fn(|i| {
        let weights = list::<20>(&pose["weights"][i]).map(T::of);
        let movement = Movement::new(start[i], T::ZERO, number("alpha"), number("forcing_scale"), weights).unwrap();
        let gain = |value: f64| Gain::new(T::of(value), T::of(value), [T::of(value); 20]).unwrap();
        AxisPrimitives { movement, stiffness: gain(10.0), damping: gain(1.0), law: Law::FirstOrder }
    });
    let phase = Phase::new(number("duration"), decay).unwrap();
    (chart, HybridPrimitive::new(phase, [basis; 3], axes).unwrap())
}

/// Coordinates, their rates, quaternion and angular velocity every 10 ms, in steps of 10 ms over `substeps`.
fn move_along<T: Real>(substeps: u32) -> Vec<[f64; 13]> {
    let (chart, skill) = skill::<T>();
    let mut state = skill.initial_state();
    let dt = T::of(0.01 / f64::from(substeps));
    let mut rows = Vec::new();
    for i in 0..=200 * substeps {
        if i % substeps == 0 {
            let r = state.axes.map(|axis| axis.reference.position);
            let rate = state.axes.map(|axis| axis.reference.scaled_velocity / skill.phase().duration());
            let (r64, rate64) = (r.map(T::to_f64), rate.map(T::to_f64));
            let q = numbers(&chart.orientation(r));
            let w = angular_velocity(r, rate).map(T::to_f64);
            let row: Vec<f64> = [&r64[..], &rate64, &q, &w].concat();
            rows.push(row.try_into().unwrap());
        }
        skill.step(&mut state, [T::ZERO; 3], T::ONE, dt);
    }
    rows
}

/// The largest errors of coordinates, rates, quaternion and angular velocity.
fn movement_errors<T: Real>(substeps: u32) -> [f64; 4] {
    let rows = table(include_str!("data/pose/pose_movement.csv"));
    let found = move_along::<T>(substeps);
    assert_eq!(rows.len(), found.len());
    [0..3, 3..6, 6..10, 10..13].map(|columns| {
        let of = |(row, found): (&Vec<f64>, &[f64; 13])| {
            let expected = &row[columns.start + 1..columns.end + 1];
            // Either quaternion of a rotation will do.
            let other: Vec<f64> = expected.iter().map(|part| -part).collect();
            let error = gap(&found[columns.clone()], expected);
            if columns.len() == 4 { error.min(gap(&found[columns.clone()], &other)) } else { error }
        };
        rows.iter().zip(&found).map(of).fold(0.0, f64::max)
    })
}

#[test]
fn a_movement_on_the_chart_is_second_order() {
    let errors = [1, 2, 4].map(movement_errors::<f64>);
    println!("{errors:?}");
    for pair in errors.windows(2) {
        for (coarse, fine) in pair[0].iter().zip(pair[1]) {
            assert!((coarse / fine / 4.0 - 1.0).abs() < 0.05, "{errors:?}");
        }
    }
    assert!(errors[2][2] < 1e-5, "{errors:?}"); // the quaternion, at 2.5 ms
    let single = movement_errors::<f32>(4);
    assert!(single.iter().zip(errors[2]).all(|(single, double)| *single < double + 2e-5), "{single:?}");
}

#[test]
fn quaternions_written_one_after_the_other_do_not_jump() {
    let (chart, skill) = skill::<f64>();
    let mut state = skill.initial_state();
    let at = |state: &hpf_core::HybridState<f64, 3>| chart.orientation(state.axes.map(|axis| axis.reference.position));
    let mut last = at(&state);
    for _ in 0..2000 {
        skill.step(&mut state, [0.0; 3], 1.0, 1e-3);
        let next = at(&state).near(&last);
        let product: f64 = numbers(&next).iter().zip(numbers(&last)).map(|(a, b)| a * b).sum();
        assert!(product > 0.999);
        last = next;
    }
}

#[test]
fn a_new_goal_in_flight_jumps_neither_in_orientation_nor_in_velocity() {
    let (old, skill) = skill::<f64>();
    let mut state = skill.initial_state();
    for i in 1..2000 {
        skill.step(&mut state, [0.0; 3], 1.0, 1e-3);
        let r = state.axes.map(|axis| axis.reference.position);
        let rate = state.axes.map(|axis| axis.reference.scaled_velocity / 2.0);
        let goal = Quaternion::exp([0.3, -0.2 + 1e-3 * f64::from(i), 0.1]) * old.goal();
        let new = Chart::new(goal);
        let (moved, moved_rate) = old.rechart(&new, r, rate);
        assert!(old.orientation(r).distance(&new.orientation(moved)) < 1e-14);
        // The inverse Jacobian grows towards a whole turn; the short way stays below half of one.
        assert!(gap(&angular_velocity(moved, moved_rate), &angular_velocity(r, rate)) < 1e-13 * 10.0);
        assert!(length(moved) <= core::f64::consts::PI);
    }
}

fn torque(t: f64) -> [f64; 3] {
    [3.0 * (4.0 * t).sin(), 2.0 * (3.0 * t).cos(), 1.5 * (5.0 * t + 1.0).sin()]
}

/// Stiffness and damping of the reference at a time.
fn gains(t: f64) -> ([f64; 3], [f64; 3]) {
    let (start, end, d0) = ([20.0, 5.0, 10.0], [5.0, 30.0, 8.0], [2.0, 1.0, 1.5]);
    let k = core::array::from_fn(|i| start[i] + (end[i] - start[i]) * t / 2.0);
    (k, d0.map(|d| d * (1.0 + 0.5 * (3.0 * t).sin())))
}

/// How a run takes the Jacobian.
#[derive(Clone, Copy, PartialEq)]
enum Jacobian {
    Middle,
    Start,
}

/// The largest errors of offset, commanded quaternion, and angular velocity over the run.
fn compliance_errors<T: Real>(substeps: u32, jacobian: Jacobian) -> [f64; 3] {
    let (chart, _) = skill::<T>();
    let rows = table(include_str!("data/pose/rotational_admittance.csv"));
    let movement = table(include_str!("data/pose/pose_movement.csv"));
    let dt = 0.01 / f64::from(substeps);
    let mut offset = [T::ZERO; 3];
    let mut worst = [0.0_f64; 3];
    for i in 0..=200 * substeps {
        if i % substeps == 0 {
            let (row, reference) = (&rows[(i / substeps) as usize], &movement[(i / substeps) as usize]);
            let t = f64::from(i) * dt;
            let three = |from: usize| [reference[from], reference[from + 1], reference[from + 2]].map(T::of);
            let reference =
                Commanded { orientation: chart.orientation(three(1)), velocity: angular_velocity(three(1), three(4)) };
            let (k, d) = gains(t);
            let diagonal = |values: [f64; 3]| Symmetric::diagonal(values.map(T::of));
            let rate = offset_rate(offset, &diagonal(k), &diagonal(d), torque(t).map(T::of));
            let found = commanded(offset, rate, &reference);
            let q = numbers(&found.orientation);
            let other = q.map(|part| -part);
            let errors = [
                gap(&offset.map(T::to_f64), &row[1..4]),
                gap(&q, &row[4..8]).min(gap(&other, &row[4..8])),
                gap(&found.velocity.map(T::to_f64), &row[8..11]),
            ];
            worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
        }
        let t = (f64::from(i) + 0.5) * dt;
        let (k, d) = gains(t);
        let (k, d, torque, dt) = (k.map(T::of), d.map(T::of), torque(t).map(T::of), T::of(dt));
        offset = match jacobian {
            Jacobian::Middle => step_rotation(offset, k, d, torque, dt).offset,
            Jacobian::Start => {
                let force = transposed_times(&left_jacobian(offset), torque);
                core::array::from_fn(|i| hpf_core::admittance::step_offset(offset[i], k[i], d[i], force[i], dt))
            }
        };
    }
    worst
}

#[test]
fn compliance_is_second_order_with_the_jacobian_at_mid_step_and_first_order_without() {
    let errors = [1, 2, 4].map(|substeps| compliance_errors::<f64>(substeps, Jacobian::Middle));
    println!("{errors:?}");
    for pair in errors.windows(2) {
        for (coarse, fine) in pair[0].iter().zip(pair[1]) {
            assert!((coarse / fine / 4.0 - 1.0).abs() < 0.05, "{errors:?}");
        }
    }
    let first = [4, 8].map(|substeps| compliance_errors::<f64>(substeps, Jacobian::Start));
    assert!((first[0][0] / first[1][0] / 2.0 - 1.0).abs() < 0.1, "{first:?}");
    let single = compliance_errors::<f32>(4, Jacobian::Middle);
    assert!(single.iter().zip(errors[2]).all(|(single, double)| *single < double + 2e-5), "{single:?}");
}

/// The books of the run: the largest gap of a step on the chart [J], work, dissipated and stored at the end [J], and by how
/// much the work at the tool differs from that on the chart, step by step, in all [J].
fn books(substeps: u32) -> (f64, [f64; 3], f64) {
    let dt = 0.01 / f64::from(substeps);
    let (mut offset, mut worst) = ([0.0; 3], 0.0_f64);
    let (mut work, mut dissipated, mut apart) = (0.0, 0.0, 0.0);
    for i in 0..200 * substeps {
        let t = (f64::from(i) + 0.5) * dt;
        let ((k, d), torque) = (gains(t), torque(t));
        let OffsetStep { offset: next, force } = step_rotation(offset, k, d, torque, dt);
        let (mut done, mut burnt, mut stored) = (0.0, 0.0, 0.0);
        for j in 0..3 {
            let (e, change) = (offset[j], next[j] - offset[j]);
            done += force[j] * change;
            stored += 0.5 * k[j] * (next[j] * next[j] - e * e);
            // d int e'^2, in closed form: e = q + (e0 - q) exp(-k t/d).
            let target = force[j] / k[j];
            burnt += 0.5 * k[j] * (e - target).powi(2) * -(-2.0 * k[j] * dt / d[j]).exp_m1();
        }
        worst = worst.max((done - burnt - stored).abs());
        // At the tool the torque stands still while the offset goes from orientation to orientation.
        let turned = (Quaternion::exp(next) * Quaternion::exp(offset).conjugate()).log();
        apart += f64::abs(dot(torque, turned) - done);
        let counted = OffsetStep { offset: next, force }.work(offset, torque);
        assert!((counted.chart - done).abs() < 1e-15 && (counted.tool - dot(torque, turned)).abs() < 1e-15);
        assert!(counted.safe() <= done && counted.safe() <= dot(torque, turned));
        (work, dissipated) = (work + done, dissipated + burnt);
        offset = next;
    }
    let (k, _) = gains(2.0);
    let stored = (0..3).map(|j| 0.5 * k[j] * offset[j] * offset[j]).sum();
    (worst, [work, dissipated, stored], apart)
}

#[test]
fn work_on_the_chart_is_stored_or_dissipated_in_every_step() {
    let expected = table(include_str!("data/pose/rotational_admittance.csv"));
    let expected = &expected.last().unwrap()[11..14];
    let runs = [1, 2, 4].map(books);
    for (worst, ..) in &runs {
        assert!(*worst < 1e-10, "{worst:e} J in a step");
    }
    println!("{runs:?}");
    assert!(runs[2].2 < 1e-4, "{} J of 3 J, at 2.5 ms", runs[2].2);
    let errors = runs.map(|(_, found, _)| gap(&found, expected));
    let physical = runs.map(|(.., apart)| apart);
    for errors in [errors, physical] {
        for pair in errors.windows(2) {
            assert!((pair[0] / pair[1] / 4.0 - 1.0).abs() < 0.06, "{errors:?}");
        }
    }
    assert!(errors[2] < 1e-3, "{errors:?} J of 3 J, at 2.5 ms");
}

#[test]
fn the_power_of_a_torque_is_that_of_the_law_and_of_the_reference() {
    let (k, d) =
        (Symmetric::diagonal([20.0, 5.0, 10.0]), Symmetric { xy: 0.3, ..Symmetric::diagonal([2.0, 1.0, 1.5]) });
    for i in 0..100 {
        let t = f64::from(i) * 0.07;
        let (offset, torque) = ([0.8 * t.sin(), 1.2 * (2.0 * t).cos(), 0.5], torque(t));
        let reference =
            Commanded { orientation: Quaternion::exp([t, 0.3, -t]), velocity: [t.cos(), -0.4, (3.0 * t).sin()] };
        let rate = offset_rate(offset, &k, &d, torque);
        let found = commanded(offset, rate, &reference);
        let of_law = dot(transposed_times(&left_jacobian(offset), torque), rate);
        let total = dot(torque, found.velocity);
        assert!((total - of_law + reference_power(offset, torque, reference.velocity)).abs() < 1e-12);
        // The commanded velocity is what the commanded orientation does.
        let small = 1e-6;
        let ahead = |sign: f64| {
            let offset: [f64; 3] = core::array::from_fn(|i| offset[i] + sign * small * rate[i]);
            let turn = Quaternion::exp(reference.velocity.map(|part| sign * small * part));
            Quaternion::exp(offset) * (turn * reference.orientation)
        };
        let seen = (ahead(1.0) * ahead(-1.0).conjugate()).log().map(|part| part / (2.0 * small));
        assert!(gap(&seen, &found.velocity) < 1e-8, "{seen:?} {:?}", found.velocity);
    }
}

#[test]
fn a_tank_that_counts_the_smaller_work_keeps_its_promise_at_the_tool() {
    // Hostile torques, and a stiffness that is asked to be stiff along the offset or across it: 1e6 updates. The work at the
    // tool stays above what the tank may spend, less what the last step can owe.
    let tank = EnergyTank::new(0.3, 0.05, 0.9, 100.0).unwrap();
    let mut random = 0x2545_f491_4f6c_dd1d_u64;
    let mut draw = || {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    for run in 0..100 {
        let (mut energy, mut stiffness, mut offset) = (tank.full(), Symmetric::isotropic(10.0), [0.0; 3]);
        let damping = Symmetric::diagonal([2.0, 1.0, 1.5]);
        let dt = 1e-3 * f64::from(run % 10 + 1);
        let (mut work, mut torque, mut q) = (0.0, [0.0; 3], Quaternion::IDENTITY);
        let mut frame = PathFrame::new(1e-9).unwrap();
        for _ in 0..10_000 {
            if draw() > 0.9 {
                torque = [draw(), draw(), draw()].map(|part| 12.0 * part);
                q = Quaternion::exp([draw(), draw(), draw()].map(|part| 3.0 * part));
            }
            let hostile = draw() > 0.0;
            let frame = if hostile { frame.follow(offset) } else { q };
            let wanted = Symmetric::diagonal([40.0, 6.0, 6.0]).turned(&frame);
            stiffness = tank.stiffness_matrix(&mut energy, &stiffness, &wanted, offset, dt);
            let acting = if hostile { offset.map(|part| -20.0 * part) } else { torque };
            let step = step_rotation_coupled(offset, &stiffness, &damping, acting, dt);
            let done = step.work(offset, acting);
            let stored = 0.5 * (stiffness.quadratic(step.offset) - stiffness.quadratic(offset));
            tank.book(&mut energy, done.safe() - stored);
            work += done.tool;
            offset = step.offset;
            assert!(length(offset) < 3.0, "the torques are too large for the chart");
            assert!(work >= -(tank.capacity() - 0.05) - 1e-3, "{work} J at {dt} s");
        }
    }
}

#[test]
fn a_turned_world_gives_the_turned_offset() {
    let q = Quaternion::exp([0.5, 0.9, -1.4]);
    let (k, d) = (Symmetric::diagonal([20.0, 5.0, 10.0]), Symmetric::diagonal([2.0, 1.0, 1.5]));
    let (mut plain, mut turned) = ([0.0; 3], [0.0; 3]);
    for i in 0..200 {
        let torque = torque(f64::from(i) * 0.01);
        plain = step_rotation_coupled(plain, &k, &d, torque, 0.01).offset;
        turned = step_rotation_coupled(turned, &k.turned(&q), &d.turned(&q), q.turn(torque), 0.01).offset;
    }
    assert!(gap(&q.turn(plain), &turned) < 1e-13);
}

#[test]
fn a_cone_caps_the_angle_and_keeps_the_direction() {
    let capped = within_cone([0.3, -2.0, 1.5], 1.0);
    assert!((length(capped) - 1.0).abs() < 1e-15);
    assert!(gap(&capped.map(|part| part * length([0.3, -2.0, 1.5])), &[0.3, -2.0, 1.5]) < 1e-15);
    assert_eq!(within_cone([0.0; 3], 1.0), [0.0; 3]);
    assert_eq!(times(&left_jacobian([0.0; 3]), [1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
}
