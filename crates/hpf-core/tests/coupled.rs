//! Stiffness and damping with directions, against 40-digit numbers and what they must keep.

use hpf_core::admittance::{
    CoupledInertia, CoupledMotion, Inertial, OffsetMotion, coupled_velocity, step_coupled, step_offset,
};
use hpf_core::rotation::Quaternion;
use hpf_core::{Real, Symmetric};
use serde_json::Value;

fn table(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect()
}

fn gap(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn size(vector: &[f64]) -> f64 {
    vector.iter().fold(0.0, |size, part| size.max(part.abs()))
}

/// Matrix, matrix, offset and force from the columns that `from` is the first of.
fn three(row: &[f64], from: usize) -> [f64; 3] {
    [row[from], row[from + 1], row[from + 2]]
}

fn matrix(row: &[f64], from: usize) -> Symmetric<f64> {
    Symmetric::of(core::array::from_fn(|i| row[from + i]))
}

fn single(matrix: &Symmetric<f64>) -> Symmetric<f32> {
    Symmetric::of(matrix.numbers().map(|number| number as f32))
}

#[test]
fn one_step_is_exact_from_a_nanosecond_to_a_thousand_seconds() {
    // Of the numbers as they are printed: `coupled_step.py` has them to 60 digits.
    let exact = table(include_str!("data/pose/coupled_step_exact.csv"));
    let published = table(include_str!("data/pose/coupled_step.csv"));
    let mut worst = [0.0_f64; 3];
    for (i, (row, exact)) in published.iter().zip(&exact).enumerate() {
        let (stiffness, damping, offset, force) = (matrix(row, 1), matrix(row, 7), three(row, 13), three(row, 16));
        let found = step_coupled(offset, &stiffness, &damping, force, row[0]);
        let error = gap(&found, exact) / size(exact);
        let published = gap(&found, &row[19..]) / size(exact);
        println!("dt {:e} K {}: {error:e}, of the published numbers {published:e}", row[0], i % 3);
        assert!(error < 1e-12, "{error:e} at {:e} s", row[0]);
        // The third stiffness has eigenvalues 0.001, 400 and 400. The published offsets of it are not those of the matrix
        // as printed: two ways of 60 and 50 digits, the pencil and the exponential of a matrix, agree that they are
        // 1.9e-11 off at 0.1 s, and 2.5e-12 at 1000 s.
        assert!(published < if i % 3 == 2 { 2e-11 } else { 1e-12 }, "{published:e} at {:e} s", row[0]);
        let narrow = step_coupled(
            offset.map(|part| part as f32),
            &single(&stiffness),
            &single(&damping),
            force.map(|part| part as f32),
            row[0] as f32,
        );
        worst[i % 3] = worst[i % 3].max(gap(&narrow.map(f64::from), exact) / size(exact));
    }
    println!("f32 {worst:?}");
    assert!(worst[0] < 1e-5 && worst[1] < 1e-5, "{worst:?}");
    // Rounding to single precision moves an eigenvalue of 0.001 among 400s by a hundredth.
    assert!(worst[2] < 0.05, "{worst:?}");
}

#[test]
fn diagonal_matrices_are_three_scalar_axes() {
    let (k, d, e, f) = ([100.0, 30.0, 400.0], [50.0, 10.0, 80.0], [0.01, -0.02, 0.03], [5.0, -7.0, 2.0]);
    for dt in [1e-6, 1e-3, 0.1, 10.0] {
        let found = step_coupled(e, &Symmetric::diagonal(k), &Symmetric::diagonal(d), f, dt);
        let expected: [f64; 3] = core::array::from_fn(|i| step_offset(e[i], k[i], d[i], f[i], dt));
        assert!(gap(&found, &expected) < 1e-16 + 1e-15 * size(&expected), "{found:?} {expected:?}");
    }
}

#[test]
fn a_turned_law_gives_the_turned_offset() {
    let row = &table(include_str!("data/pose/coupled_step.csv"))[12];
    let (stiffness, damping, offset, force) = (matrix(row, 1), matrix(row, 7), three(row, 13), three(row, 16));
    let q = Quaternion::exp([0.3, -1.0, 2.2]);
    let found = step_coupled(q.turn(offset), &stiffness.turned(&q), &damping.turned(&q), q.turn(force), 0.01);
    let expected = q.turn(step_coupled(offset, &stiffness, &damping, force, 0.01));
    assert!(gap(&found, &expected) < 1e-15, "{found:?} {expected:?}");
}

#[test]
fn without_stiffness_the_tool_drifts() {
    let row = &table(include_str!("data/pose/coupled_step.csv"))[0];
    let (damping, force) = (matrix(row, 7), three(row, 16));
    let found = step_coupled([0.0; 3], &Symmetric::isotropic(0.0), &damping, force, 2.0);
    assert!(gap(&damping.times(found).map(|part| part / 2.0), &force) < 1e-13, "D e = f dt: {found:?}");
}

/// Offsets every 10 ms of the run with a stiffness that varies with time, gains and force taken at mid-step.
fn walk<T: Real>(substeps: u32) -> Vec<[f64; 3]> {
    let reference: Value = serde_json::from_str(include_str!("data/pose/reference.json")).unwrap();
    let entries = |value: &Value| {
        let rows: Vec<Vec<f64>> = serde_json::from_value(value.clone()).unwrap();
        let rows: [[f64; 3]; 3] = core::array::from_fn(|i| core::array::from_fn(|j| rows[i][j]));
        Symmetric::of_rows("K", &rows).unwrap()
    };
    let coupled = &reference["coupled"];
    let [k0, k1, k2] = [0, 1, 2].map(|i| entries(&coupled["K"][i]).numbers());
    let damping = Symmetric::of(entries(&coupled["D"]).numbers().map(T::of));
    let dt = 0.01 / f64::from(substeps);
    let mut offset = [T::ZERO; 3];
    let mut offsets = vec![[0.0; 3]];
    for i in 0..200 * substeps {
        let t = (f64::from(i) + 0.5) * dt;
        let a = t / 2.0;
        let mixed =
            core::array::from_fn(|j| T::of((1.0 - a).powi(2) * k0[j] + 2.0 * a * (1.0 - a) * k1[j] + a * a * k2[j]));
        let force = [10.0 * (3.0 * t).sin(), 8.0 * (2.0 * t).cos(), 6.0 * (5.0 * t).sin()].map(T::of);
        offset = step_coupled(offset, &Symmetric::of(mixed), &damping, force, T::of(dt));
        if (i + 1) % substeps == 0 {
            offsets.push(offset.map(T::to_f64));
        }
    }
    offsets
}

fn off<T: Real>(substeps: u32) -> f64 {
    let rows = table(include_str!("data/pose/coupled_admittance.csv"));
    rows.iter().zip(walk::<T>(substeps)).map(|(row, found)| gap(&found, &row[1..])).fold(0.0, f64::max)
}

#[test]
fn a_stiffness_that_varies_is_second_order() {
    let errors = [1, 2, 4, 8].map(off::<f64>);
    println!("{errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] / 4.0 - 1.0).abs() < 0.05, "{errors:?}");
    }
    assert!(errors[3] < 1e-6, "{errors:?}"); // of 0.1 m, at 1.25 ms
    assert!(off::<f32>(8) < 2e-6);
}

#[test]
fn work_is_stored_or_dissipated_step_by_step() {
    let (k, d) = (matrix(&table(include_str!("data/pose/coupled_step.csv"))[0], 1), [60.0, 40.0, 50.0]);
    let damping = Symmetric { xy: 10.0, xz: -15.0, ..Symmetric::diagonal(d) };
    let mut offset = [0.01, -0.02, 0.03];
    let dt = 1e-4;
    for i in 0..20_000 {
        let t = f64::from(i) * dt;
        let force = [10.0 * (3.0 * t).sin(), 8.0 * (20.0 * t).cos(), 6.0];
        let next = step_coupled(offset, &k, &damping, force, dt);
        let moved: [f64; 3] = core::array::from_fn(|i| next[i] - offset[i]);
        let work: f64 = (0..3).map(|i| force[i] * moved[i]).sum();
        let stored = 0.5 * (k.quadratic(next) - k.quadratic(offset));
        // e'^T D e' over the step, by Simpson's rule at both ends and the middle.
        let middle = step_coupled(offset, &k, &damping, force, 0.5 * dt);
        let power = |at: [f64; 3]| damping.quadratic(coupled_velocity(at, &k, &damping, force));
        let dissipated = dt / 6.0 * (power(offset) + 4.0 * power(middle) + power(next));
        assert!((work - stored - dissipated).abs() < 1e-10 * 1e-3, "{work} {stored} {dissipated}");
        offset = next;
    }
}

#[test]
fn with_inertia_each_principal_direction_is_a_scalar_axis() {
    let (mass, ratio, floor, dt) = (2.0, 0.7, 12.0, 1e-3);
    let law = CoupledInertia::new(mass, ratio, floor, 400.0, dt).unwrap();
    let values = [400.0, 90.0, 15.0];
    let q = Quaternion::exp([0.4, 1.0, -0.7]);
    let stiffness = Symmetric::diagonal(values).turned(&q);
    let mut motion = CoupledMotion { offset: q.turn([0.01, 0.02, -0.03]), velocity: q.turn([0.1, -0.2, 0.3]) };
    let mut expected =
        [0, 1, 2].map(|i| OffsetMotion { offset: [0.01, 0.02, -0.03][i], velocity: [0.1, -0.2, 0.3][i] });
    for i in 0..2000 {
        let force = [3.0, (0.01 * f64::from(i)).sin(), -2.0];
        law.step(&mut motion, &stiffness, q.turn(force), dt);
        for ((motion, k), force) in expected.iter_mut().zip(values).zip(force) {
            let d = (2.0 * ratio * f64::sqrt(mass * k)).max(floor);
            Inertial::new(mass, 400.0, 60.0, dt).unwrap().step(motion, k, d, force, dt);
        }
    }
    assert!(gap(&q.turn_back(motion.offset), &expected.map(|axis| axis.offset)) < 1e-12);
    assert!(gap(&q.turn_back(motion.velocity), &expected.map(|axis| axis.velocity)) < 1e-11);
    let refused = CoupledInertia::new(1.0, 0.0, 1.0, 400.0, dt).unwrap_err();
    assert_eq!(refused.to_string(), "damping.ratio must be positive, not 0");
}

#[test]
fn eigenvalues_and_vectors_make_the_matrix_again() {
    let q = Quaternion::exp([1.0, 0.3, -0.8]);
    for values in [[400.0, 30.0, 100.0], [400.0, 400.0, 0.001], [7.0; 3], [0.0; 3], [1e9, 1.0, 1e-9], [-5.0, 3.0, 0.0]]
    {
        let matrix = Symmetric::diagonal(values).turned(&q);
        let eigen = matrix.eigen();
        let again = eigen.map(|value| value);
        let largest = size(&values);
        assert!(gap(&again.numbers(), &matrix.numbers()) <= 4e-15 * largest, "{values:?}");
        for (value, vector) in eigen.values.iter().zip(eigen.vectors) {
            let stretched = vector.map(|part| part * value);
            assert!(gap(&matrix.times(vector), &stretched) <= 4e-15 * largest, "{values:?}");
        }
        let (mut found, mut sorted) = (eigen.values, values);
        found.sort_by(f64::total_cmp);
        sorted.sort_by(f64::total_cmp);
        assert!(gap(&found, &sorted) <= 4e-15 * largest, "{values:?}: {found:?}");
    }
}

/// The largest part of `K v - k v` in the largest eigenvalue, over random matrices, many of them nearly degenerate.
fn worst_eigenvector<T: Real>() -> f64 {
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    let mut draw = || {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut worst = 0.0_f64;
    for _ in 0..100_000 {
        let first = 400.0 * draw();
        let second = first * (1.0 - 10.0_f64.powf(-12.0 * draw()));
        let values = [first, second, 400.0 * 10.0_f64.powf(-6.0 * draw())];
        let q = Quaternion::exp([6.0 * draw() - 3.0, 6.0 * draw() - 3.0, 6.0 * draw() - 3.0]);
        let matrix = Symmetric::of(Symmetric::diagonal(values).turned(&q).numbers().map(T::of));
        let eigen = matrix.eigen();
        let largest = size(&eigen.values.map(T::to_f64));
        for (value, vector) in eigen.values.into_iter().zip(eigen.vectors) {
            let stretched = vector.map(|part| (part * value).to_f64());
            worst = worst.max(gap(&matrix.times(vector).map(T::to_f64), &stretched) / largest);
        }
    }
    worst
}

#[test]
fn the_sweeps_suffice_for_every_matrix() {
    let (double, single) = (worst_eigenvector::<f64>(), worst_eigenvector::<f32>());
    println!("{double:e} {single:e}");
    // A dozen rotations round by a unit in the last place each.
    assert!(double < 4e-15 && single < 2e-6, "{double:e} {single:e}");
}

#[test]
fn clamping_brings_eigenvalues_within_and_leaves_those_that_are() {
    let q = Quaternion::exp([0.2, -0.5, 1.7]);
    let matrix = Symmetric::diagonal([5.0, 100.0, 900.0]).turned(&q);
    let expected = Symmetric::diagonal([30.0, 100.0, 400.0]).turned(&q);
    assert!(gap(&matrix.clamped(30.0, 400.0).numbers(), &expected.numbers()) < 1e-12);
    assert!(gap(&expected.clamped(30.0, 400.0).numbers(), &expected.numbers()) < 1e-12);
}

#[test]
fn what_is_not_symmetric_is_refused_by_name() {
    let refused = Symmetric::of_rows("K", &[[1.0, 2.0, 0.0], [3.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).unwrap_err();
    assert_eq!(refused.to_string(), "K must lie in [-0.000003, 0.000003], not -1");
}
