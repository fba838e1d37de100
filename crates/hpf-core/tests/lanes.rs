//! Lanes: the kernels run over them, each lane as if it were alone, and their exponentials are as good as they say.

use hpf_core::admittance::relax;
use hpf_core::{Lanes, Real};

/// A number as the sum of two, the second below half a unit in the last place of the first: some 106 bits.
#[derive(Clone, Copy)]
struct Double(f64, f64);

impl Double {
    fn sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        let b_part = sum - a;
        Self(sum, (a - (sum - b_part)) + (b - b_part))
    }

    fn plus(self, other: Self) -> Self {
        let Self(high, low) = Self::sum(self.0, other.0);
        Self::sum(high, low + (self.1 + other.1))
    }

    fn times(self, other: Self) -> Self {
        let product = self.0 * other.0;
        let rest = self.0.mul_add(other.0, -product) + (self.0 * other.1 + self.1 * other.0);
        Self::sum(product, rest)
    }

    fn scaled(self, power_of_two: f64) -> Self {
        Self(self.0 * power_of_two, self.1 * power_of_two)
    }
}

/// ln 2 to 106 bits (its digits are in any table: 0.69314718055994530941723212145817656807...).
const LN_2: Double = Double(core::f64::consts::LN_2, 2.319_046_813_846_3e-17);

/// `e^x = value * 2^k` and `e^x - 1 = value * 2^k - 1`, to some 100 bits.
fn reference(x: f64) -> (Double, i32) {
    let k = (x / LN_2.0).round();
    let r = Double(x, 0.0).plus(LN_2.times(Double(-k, 0.0))).scaled(1.0 / 256.0);
    // e^r - 1 by its series, then eight times (1 + p)^2 - 1 = p (2 + p).
    let mut series = Double(0.0, 0.0);
    for n in (1..=14).rev() {
        let share = 1.0 / f64::from(n);
        let inverse = Double(share, (-share).mul_add(f64::from(n), 1.0) / f64::from(n));
        series = r.times(inverse).times(series.plus(Double(1.0, 0.0)));
    }
    for _ in 0..8 {
        series = series.times(series.plus(Double(2.0, 0.0)));
    }
    (series.plus(Double(1.0, 0.0)), k as i32)
}

/// How far `found` is from `expected`, in units of the last place of the latter.
fn units(found: f64, expected: Double) -> f64 {
    let unit = expected.0.abs().next_up() - expected.0.abs();
    ((found - expected.0) - expected.1).abs() / unit
}

/// Numbers all over the range of the exponentials, dense where they are used.
fn arguments() -> impl Iterator<Item = f64> {
    let wide = (0..400_000).map(|i| -745.0 + 1454.7 * f64::from(i) / 400_000.0);
    let near = (0..400_000).map(|i| -3.0 + 6.0 * f64::from(i) / 400_000.0);
    let tiny = (0..3000).flat_map(|i| [1.0, -1.0].map(|sign| sign * 10.0_f64.powf(-f64::from(i) / 10.0)));
    wide.chain(near).chain(tiny)
}

#[test]
fn exponentials_are_within_two_units_in_the_last_place() {
    let (mut worst, mut worst_m1) = (0.0_f64, 0.0_f64);
    for x in arguments() {
        let Lanes([exp, exp_m1]) = Lanes([Lanes([x]).exp().0[0], Lanes([x]).exp_m1().0[0]]);
        let (value, k) = reference(x);
        if x > -708.0 {
            // Halves, because 2^1024 is too large a number.
            let scale = 2.0_f64.powi(k - 1);
            worst = worst.max(units(0.5 * exp, value.scaled(scale)));
        } else {
            assert!((exp - libm::exp(x)).abs() <= f64::from_bits(1), "{x}: {exp:e}");
        }
        if x.abs() < 700.0 {
            let expected =
                if x.abs() < 1e-5 { small_m1(x) } else { value.scaled(2.0_f64.powi(k)).plus(Double(-1.0, 0.0)) };
            worst_m1 = worst_m1.max(units(exp_m1, expected));
        }
    }
    println!("e^x: {worst:.2}, e^x - 1: {worst_m1:.2} units in the last place");
    assert!(worst <= 2.0 && worst_m1 <= 2.0, "{worst}, {worst_m1}");
}

/// `e^x - 1` of a small x by its series: the reference loses digits there.
fn small_m1(x: f64) -> Double {
    let x = Double(x, 0.0);
    let third = Double(1.0 / 3.0, 1.850_371_707_708_594e-17);
    let cubic = x.times(x).times(x).scaled(0.5).times(third);
    let quartic = Double(x.0 * x.0 * x.0 * x.0 / 24.0, 0.0);
    x.plus(x.times(x).scaled(0.5)).plus(cubic).plus(quartic)
}

#[test]
fn exponentials_end_where_numbers_end() {
    let inputs = [f64::NEG_INFINITY, -1e300, -746.0, 709.782_712_893_384, 709.79, 1e300, f64::INFINITY, -0.0];
    let exp = Lanes(inputs).exp().0;
    assert_eq!(exp[..3], [0.0; 3]);
    assert!(exp[3] > 1.797e308 && exp[3].is_finite(), "{}", exp[3]);
    assert_eq!(exp[4..], [f64::INFINITY, f64::INFINITY, f64::INFINITY, 1.0]);
    let exp_m1 = Lanes(inputs).exp_m1().0;
    assert_eq!(exp_m1[..3], [-1.0; 3]);
    assert!(exp_m1[3] > 1.797e308 && exp_m1[3].is_finite(), "{}", exp_m1[3]);
    assert_eq!(exp_m1[4..], [f64::INFINITY, f64::INFINITY, f64::INFINITY, 0.0]);
    assert!(Lanes([f64::NAN]).exp().0[0].is_nan() && Lanes([f64::NAN]).exp_m1().0[0].is_nan());
    let smallest = Lanes([f64::from_bits(1)]).exp_m1().0[0];
    assert!((0.0..=f64::from_bits(2)).contains(&smallest), "one step at most: {smallest:e}");
}

#[test]
fn every_lane_has_the_bits_it_has_alone() {
    let [y, from, to, x] = [0.3, -1.7, 2.0, 0.0].map(|start| {
        let mut lanes = [0.0; 8];
        (0..8).for_each(|i| lanes[i] = start + 0.37 * i as f64 * i as f64);
        Lanes(lanes)
    });
    let together = relax(y, from, to, x).0;
    for (i, together) in together.into_iter().enumerate() {
        let [y, from, to, x] = [y, from, to, x].map(|lanes| lanes.0[i]);
        let [alone] = relax(Lanes([y]), Lanes([from]), Lanes([to]), Lanes([x])).0;
        assert_eq!(together.to_bits(), alone.to_bits());
        let scalar = relax(y, from, to, x);
        assert!((alone - scalar).abs() <= 4.0 * f64::EPSILON * scalar.abs().max(1.0), "near that of f64");
    }
}

#[test]
fn choices_are_made_lane_by_lane_and_nan_is_not_below() {
    let values = Lanes([1.0, 3.0, f64::NAN, -2.0]);
    let chosen = values.select_below(Lanes::of(2.0), Lanes::of(10.0), Lanes::of(20.0));
    assert_eq!(chosen.0, [10.0, 20.0, 20.0, 10.0]);
    assert_eq!(values.max(Lanes::ZERO).0, [1.0, 3.0, 0.0, 0.0]);
    assert_eq!(values.min(Lanes::ZERO).0, [0.0, 0.0, 0.0, -2.0]);
    assert!(!values.is_finite() && Lanes([1.0, 2.0]).is_finite());
    assert_eq!((-values).0[3], 2.0);
    assert_eq!(Lanes([4.0, 9.0]).sqrt().0, [2.0, 3.0]);
    assert_eq!((Lanes([7.9, 1.0]).to_index(), Lanes([7.5, 1.0]).floor().0), (7, [7.0, 1.0]));
}
