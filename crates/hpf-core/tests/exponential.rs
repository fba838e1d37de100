//! The exponentials of `f32` against double precision, over every magnitude.

use hpf_core::Real;

/// Every so many of the 2^32 patterns of bits, a prime, so that mantissas of all kinds turn up.
const STRIDE: usize = 1009;

/// Distance of `found` from `exact` in units in the last place of `exact` as an `f32`.
fn units(found: f32, exact: f64) -> f64 {
    let nearest = exact as f32;
    let magnitude = nearest.abs().max(f32::MIN_POSITIVE);
    let unit = f64::from(magnitude) - f64::from(magnitude.next_down());
    (f64::from(found) - exact).abs() / unit
}

/// All that are sampled, finite or not.
fn samples() -> impl Iterator<Item = f32> {
    (0..=u32::MAX).step_by(STRIDE).map(f32::from_bits)
}

#[test]
fn exponential_is_within_two_units_in_the_last_place() {
    let mut worst = (0.0, 0.0);
    for x in samples().filter(|x| (-87.0..=88.72).contains(x)) {
        let off = units(Real::exp(x), libm::exp(f64::from(x)));
        if off > worst.0 {
            worst = (off, x);
        }
    }
    assert!(worst.0 <= 2.0, "{} units at {}", worst.0, worst.1);
    assert!(worst.0 > 0.5, "no sample was rounded: the test looks at nothing");
}

#[test]
fn exponential_less_one_is_within_two_units_in_the_last_place() {
    let mut worst = (0.0, 0.0);
    for x in samples().filter(|x| *x <= 88.72 && x.abs() >= f32::MIN_POSITIVE) {
        let off = units(Real::exp_m1(x), libm::expm1(f64::from(x)));
        if off > worst.0 {
            worst = (off, x);
        }
    }
    assert!(worst.0 <= 2.0, "{} units at {}", worst.0, worst.1);
    assert!(worst.0 > 0.5, "no sample was rounded: the test looks at nothing");
}

#[test]
fn extreme_arguments_have_the_values_they_tend_to() {
    for x in [-87.1, -104.0, -1e9, f32::MIN, f32::NEG_INFINITY] {
        assert_eq!(Real::exp(x), 0.0);
        assert_eq!(Real::exp_m1(x), -1.0);
    }
    for x in [89.0, 1e9, f32::MAX, f32::INFINITY] {
        assert_eq!(Real::exp(x), f32::INFINITY);
        assert_eq!(Real::exp_m1(x), f32::INFINITY);
    }
    assert!(Real::exp(f32::NAN).is_nan() && Real::exp_m1(f32::NAN).is_nan());
    assert_eq!(Real::exp(0.0_f32), 1.0);
    assert_eq!(Real::exp_m1(0.0_f32), 0.0);
}
