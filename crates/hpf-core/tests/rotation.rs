//! Rotations against 40-digit numbers, and where quaternions usually go wrong.

use core::f64::consts::{PI, TAU};

use hpf_core::Real;
use hpf_core::rotation::{Matrix, Quaternion, Wxyz, left_jacobian, left_jacobian_inverse, length, times};

struct Row {
    angle: f64,
    r: [f64; 3],
    q: [f64; 4],
    jacobian: Matrix<f64>,
}

fn rows() -> impl Iterator<Item = Row> {
    include_str!("data/pose/rotations.csv").lines().skip(1).map(|line| {
        let row: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        let three = |from: usize| [row[from], row[from + 1], row[from + 2]];
        let q = [row[4], row[5], row[6], row[7]];
        Row { angle: row[0], r: three(1), q, jacobian: [three(8), three(11), three(14)] }
    })
}

fn numbers<T: Real>(q: &Quaternion<T>) -> [f64; 4] {
    let Wxyz { w, x, y, z } = q.numbers();
    [w, x, y, z].map(T::to_f64)
}

fn gap(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The largest error of quaternion, Jacobian and inverse over all rows, of numbers that are at most 1 (of the inverse:
/// relative to its largest).
fn worst<T: Real>() -> [f64; 3] {
    let mut worst = [0.0_f64; 3];
    for row in rows() {
        let r = row.r.map(T::of);
        let jacobian = left_jacobian(r).map(|line| line.map(T::to_f64));
        let inverse = left_jacobian_inverse(r).map(|line| line.map(T::to_f64));
        // The reference's own J_l times this inverse is the identity, to the inverse's largest number.
        let product = core::array::from_fn::<_, 3, _>(|i| {
            core::array::from_fn::<_, 3, _>(|j| (0..3).map(|k| row.jacobian[i][k] * inverse[k][j]).sum::<f64>())
        });
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let size = inverse.as_flattened().iter().fold(1.0_f64, |size, part| size.max(part.abs()));
        let errors = [
            gap(&numbers(&Quaternion::exp(r)), &row.q),
            gap(jacobian.as_flattened(), row.jacobian.as_flattened()),
            gap(product.as_flattened(), identity.as_flattened()) / size,
        ];
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
    }
    worst
}

#[test]
fn exp_and_the_jacobians_are_those_of_forty_digits() {
    let (double, single) = (worst::<f64>(), worst::<f32>());
    println!("f64 {double:?} f32 {single:?}");
    assert!(double.iter().all(|&error| error < 1e-14), "{double:?}");
    // At 6.2 rad the quaternion of a rounded vector differs by 4e-7 already.
    assert!(single.iter().all(|&error| error < 1e-6), "{single:?}");
}

#[test]
fn small_rotations_keep_their_digits() {
    for row in rows().filter(|row| row.angle > 0.0 && row.angle < 1e-3) {
        let q = Quaternion::exp(row.r);
        let [_, vector @ ..] = numbers(&q);
        let [_, expected @ ..] = row.q;
        assert!(gap(&vector, &expected) < 1e-15 * row.angle, "{:e}", row.angle);
        assert!(gap(&q.log(), &row.r) < 1e-15 * row.angle, "{:e}", row.angle);
    }
}

#[test]
fn log_takes_back_exp_below_a_half_turn() {
    for row in rows().filter(|row| row.angle < PI) {
        let found = Quaternion::exp(row.r).log();
        assert!(gap(&found, &row.r) < 1e-14, "{}: {found:?}", row.angle);
        let single = Quaternion::exp(row.r.map(|part| part as f32)).log().map(f64::from);
        // Next to a half turn rounding may choose the other way round.
        if row.angle < 3.1 {
            assert!(gap(&single, &row.r) < 1e-6 * row.angle.max(1.0), "{}: {single:?}", row.angle);
        }
    }
}

#[test]
fn the_short_way_and_the_long_way_are_a_whole_turn_apart() {
    for row in rows().filter(|row| row.angle > 1e-6) {
        let q = Quaternion::exp(row.r);
        let (short, long) = (q.log(), q.log_long());
        assert!(length(short) <= PI + 1e-15 && length(long) >= PI - 1e-15);
        assert!((length(short) + length(long) - TAU).abs() < 1e-14);
        assert!(q.distance(&Quaternion::exp(long)) < 1e-14);
        let along = if row.angle < PI { short } else { long };
        if !q.is_half_turn() {
            assert!(gap(&along, &row.r) < 1e-14, "{}: {along:?}", row.angle);
        }
    }
    assert_eq!(Quaternion::<f64>::IDENTITY.log_long(), [0.0; 3]);
}

#[test]
fn a_half_turn_is_found_and_its_log_is_finite_and_right() {
    for axis in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, 0.8], [-1.0, 0.0, 0.0]] {
        let exact = Quaternion::new(Wxyz { w: 0.0, x: axis[0], y: axis[1], z: axis[2] }).unwrap();
        assert!(exact.is_half_turn());
        assert!(gap(&exact.log(), &axis.map(|part| part * PI)) < 1e-15);
        for (off, close) in [(0.9e-6, true), (1.1e-6, false), (-0.9e-6, true), (-1.1e-6, false)] {
            let q = Quaternion::exp(axis.map(|part| part * (PI + off)));
            assert_eq!(q.is_half_turn(), close, "{off}");
            assert!((length(q.log()) - (PI - f64::abs(off))).abs() < 1e-14);
        }
    }
    let single = Quaternion::exp([core::f32::consts::PI, 0.0, 0.0]);
    assert!(single.is_half_turn() && (length(single.log()) - core::f32::consts::PI).abs() < 1e-6);
}

#[test]
fn a_quaternion_and_its_negative_are_one_rotation() {
    for row in rows() {
        let q = Quaternion::exp(row.r);
        let Wxyz { w, x, y, z } = q.numbers();
        let negative = Quaternion::new(Wxyz { w: -w, x: -x, y: -y, z: -z }).unwrap();
        assert!(q.distance(&negative) < 1e-15);
        assert!(gap(&numbers(&negative.near(&q)), &numbers(&q)) < 1e-15);
        assert!(gap(&negative.turn([1.0, 2.0, 3.0]), &q.turn([1.0, 2.0, 3.0])) < 1e-14);
        if !q.is_half_turn() {
            assert!(gap(&negative.log(), &q.log()) < 1e-15);
        }
    }
    // Along a path through several turns, each quaternion near the one before: no jump.
    let mut last = Quaternion::<f64>::IDENTITY;
    for i in 0..4000 {
        let next = Quaternion::exp([0.0, f64::from(i) * 0.005, 0.0]).near(&last);
        assert!(gap(&numbers(&next), &numbers(&last)) < 0.003);
        last = next;
    }
}

#[test]
fn single_precision_knows_angles_that_acos_does_not() {
    let at = Quaternion::exp([0.7_f32, -0.2, 1.1]);
    for angle in [1e-6_f32, 1e-5, 1e-4, 1e-3, 0.1, 1.0, 3.0, 3.12, 3.135] {
        let distance = at.distance(&(at * Quaternion::exp([0.0, angle, 0.0])));
        // Rounding of two quaternions: 1e-7 each.
        assert!((distance - angle).abs() < 5e-7, "{angle}: {distance}");
    }
    let dot: f32 = numbers(&Quaternion::exp([1e-4_f32, 0.0, 0.0]))[0] as f32;
    assert_eq!(dot, 1.0, "the trap is there: the acos of this would be 0");
}

fn norm_after_a_million_turns<T: Real>() -> f64 {
    let step = Quaternion::exp([0.011, -0.007, 0.003].map(T::of));
    let mut q = Quaternion::exp([0.3, 0.4, -0.5].map(T::of));
    for _ in 0..1_000_000 {
        q = step * q;
    }
    numbers(&q).iter().map(|part| part * part).sum::<f64>().sqrt()
}

#[test]
fn the_norm_stays_one_over_a_million_products() {
    let double = (norm_after_a_million_turns::<f64>() - 1.0).abs();
    assert!(double < 1e-12, "{double:e}");
    let single = (norm_after_a_million_turns::<f32>() - 1.0).abs();
    assert!(single < 1e-6, "{single:e}");
}

#[test]
fn turning_and_the_matrix_agree_and_products_turn_by_the_second_first() {
    let (a, b) = (Quaternion::exp([0.4, 1.9, -0.3]), Quaternion::exp([-2.0, 0.2, 0.9]));
    let vector = [1.0, -2.0, 0.5];
    assert!(gap(&times(&a.matrix(), vector), &a.turn(vector)) < 1e-15);
    assert!(gap(&(a * b).turn(vector), &a.turn(b.turn(vector))) < 1e-14);
    assert!(gap(&a.turn_back(a.turn(vector)), &vector) < 1e-14);
    let about = Quaternion::about([0.0, 0.0, -5.0], 0.3).unwrap();
    assert!(gap(&about.log(), &[0.0, 0.0, -0.3]) < 1e-15);
}

#[test]
fn roll_pitch_and_yaw_are_about_fixed_axes() {
    let (roll, pitch, yaw) = (0.3_f64, -0.8, 2.1);
    let found = Quaternion::rpy([roll, pitch, yaw]).unwrap().matrix();
    // R = Rz Ry Rx, written out.
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    let expected = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ];
    assert!(gap(found.as_flattened(), expected.as_flattened()) < 1e-15);
}

#[test]
fn angular_velocity_is_what_the_orientation_does() {
    // A path of rotation vectors through a half turn; its angular velocity by a small difference of orientations.
    let path = |t: f64| [2.0 * t, 1.0 + t * t, -0.5 + 1.5 * t];
    let rate = |t: f64| [2.0, 2.0 * t, 1.5];
    for i in 0..15 {
        let t = f64::from(i) * 0.1;
        let small = 1e-4;
        let (before, after) = (Quaternion::exp(path(t - small)), Quaternion::exp(path(t + small)));
        let seen = (after * before.conjugate()).log().map(|part| part / (2.0 * small));
        let found = times(&left_jacobian(path(t)), rate(t));
        assert!(gap(&seen, &found) < 1e-7, "{t}: {seen:?} {found:?}"); // small^2, times third derivatives
        assert!(gap(&times(&left_jacobian_inverse(path(t)), found), &rate(t)) < 1e-13);
    }
}

#[test]
fn sine_and_cosine_in_single_precision_are_right_to_two_units() {
    let mut worst = 0.0_f64;
    for i in -300_000..300_000 {
        let angle = i as f32 * 1e-4;
        let (sine, cosine) = Real::sin_cos(angle);
        let (s, c) = f64::from(angle).sin_cos();
        worst = worst.max((f64::from(sine) - s).abs()).max((f64::from(cosine) - c).abs());
    }
    assert!(worst < 1.2e-7, "{worst:e}");
    for angle in [2999.0_f32, -2500.0, 1e5, 3.0e9] {
        let (sine, cosine) = Real::sin_cos(angle);
        let (s, c) = f64::from(angle).sin_cos();
        assert!((f64::from(sine) - s).abs() < 1e-5 && (f64::from(cosine) - c).abs() < 1e-5, "{angle}: {sine} {cosine}");
    }
    assert!(Real::sin_cos(f32::NAN).0.is_nan() && Real::sin_cos(f32::INFINITY).1.is_nan());
}

#[test]
fn what_is_no_rotation_is_refused_by_name() {
    let named = |w, x| Quaternion::new(Wxyz { w, x, y: 0.0, z: 0.0 }).unwrap_err().to_string();
    assert_eq!(named(0.9989, 0.0), "norm of the quaternion must lie in [0.999, 1.001], not 0.9989");
    assert_eq!(named(f64::NAN, 0.0), "quaternion is not a finite number");
    assert_eq!(Quaternion::about([0.0; 3], 1.0).unwrap_err().to_string(), "length of the axis must be positive, not 0");
    assert_eq!(Quaternion::rpy([0.0, f64::INFINITY, 0.0]).unwrap_err().to_string(), "pitch is not a finite number");
}
