//! Numbers, skills and settings out of bytes: plain ones, those from the whole domain, and those that nobody means.

use hpf_core::conditioning::ForceConditioning;
use hpf_core::controller::{AxisSettings, Compliance, Settings, Timing};
use hpf_core::limits::Limits;
use hpf_core::passivity::{EnergyTank, Port};
use hpf_core::{AxisPrimitives, Basis, Damping, Gain, HybridPrimitive, Law, Movement, Phase, Real};
use libfuzzer_sys::arbitrary::{Arbitrary, Result, Unstructured};

/// Functions of a basis.
pub const N: usize = 4;

/// A scalar of any bits.
pub trait Scalar: Real + PartialOrd {
    const EPSILON: f64;
    fn of_bits(bits: u64) -> Self;
}

impl Scalar for f32 {
    const EPSILON: f64 = f32::EPSILON as f64;
    fn of_bits(bits: u64) -> Self {
        Self::from_bits(bits as u32)
    }
}

impl Scalar for f64 {
    const EPSILON: f64 = f64::EPSILON;
    fn of_bits(bits: u64) -> Self {
        Self::from_bits(bits)
    }
}

/// How far from what anybody would use.
#[derive(Clone, Copy, PartialEq)]
pub enum Taste {
    /// Plain numbers.
    Plain,
    /// Now and then a number from anywhere in the domain, 1e-9 to 1e9.
    Wide,
    /// Now and then any bits.
    Wild,
}

impl Taste {
    pub fn draw(input: &mut Unstructured<'_>) -> Result<Self> {
        Ok([Self::Plain, Self::Plain, Self::Wide, Self::Wild][usize::from(u8::arbitrary(input)? % 4)])
    }
}

/// A number of any bits, or one that breaks things elsewhere.
pub fn worst<T: Scalar>(input: &mut Unstructured<'_>) -> Result<T> {
    let named =
        [f64::NAN, f64::INFINITY, -f64::INFINITY, f64::MAX, f64::MIN, 5e-324, 1e-42, -0.0, -1.0, 1e9, -1e9, 1e-9];
    Ok(match usize::from(u8::arbitrary(input)? % 16) {
        choice if choice < named.len() => T::of(named[choice]),
        _ => T::of_bits(u64::arbitrary(input)?),
    })
}

/// A number, mostly of `lo..hi`.
pub fn number<T: Scalar>(input: &mut Unstructured<'_>, taste: Taste, lo: f64, hi: f64) -> Result<T> {
    if taste != Taste::Plain && u8::arbitrary(input)? % 8 == 0 {
        if taste == Taste::Wild {
            return worst(input);
        }
        let size = 10_f64.powf(f64::from(u16::arbitrary(input)?) / 65535.0 * 18.0 - 9.0);
        return Ok(T::of(if lo < 0.0 && bool::arbitrary(input)? { -size } else { size }));
    }
    Ok(T::of(lo + (hi - lo) * f64::from(u16::arbitrary(input)?) / 65535.0))
}

/// One number per axis.
pub fn each<T: Scalar, const D: usize>(input: &mut Unstructured<'_>, taste: Taste, lo: f64, hi: f64) -> Result<[T; D]> {
    let mut all = [T::ZERO; D];
    for value in &mut all {
        *value = number(input, taste, lo, hi)?;
    }
    Ok(all)
}

/// Bounds of a gain and weights between them.
fn gain<T: Scalar>(input: &mut Unstructured<'_>, taste: Taste, lo: f64, hi: f64) -> Result<Option<Gain<T, [T; N]>>> {
    let min: T = number(input, taste, lo, (lo * hi).sqrt())?;
    let max: T = number(input, taste, (lo * hi).sqrt(), hi)?;
    let mut weights = [min; N];
    for weight in &mut weights {
        let share = T::of(f64::from(u8::arbitrary(input)?) / 255.0);
        *weight = (min + share * (max - min)).max(min).min(max);
    }
    Ok(Gain::new(min, max, weights).ok())
}

/// A skill, where the numbers make one.
pub fn skill<T: Scalar, const D: usize>(
    input: &mut Unstructured<'_>,
    taste: Taste,
) -> Result<Option<HybridPrimitive<T, [T; N], D>>> {
    let decay = number(input, taste, 1.0, 6.0)?;
    let overlap = number(input, taste, 0.2, 0.9)?;
    let room = [T::ZERO; N];
    let basis = match bool::arbitrary(input)? {
        true => Basis::equally_spaced(decay, overlap, room, room),
        false => Basis::equally_spaced_in_time(decay, overlap, room, room),
    };
    let phase = Phase::new(number(input, taste, 0.05, 2.0)?, decay);
    let mut axes = [None; D];
    for axis in &mut axes {
        let movement = Movement::new(
            number(input, taste, -0.4, 0.4)?,
            number(input, taste, -0.4, 0.4)?,
            number(input, taste, 5.0, 40.0)?,
            number(input, taste, -1.0, 1.0)?,
            each(input, taste, -100.0, 100.0)?,
        );
        let (stiffness, damping) = (gain(input, taste, 10.0, 1000.0)?, gain(input, taste, 5.0, 200.0)?);
        let law = law(input, taste)?;
        *axis = movement.ok().zip(stiffness).zip(damping).zip(Some(law));
    }
    let (Ok(basis), Ok(phase)) = (basis, phase) else { return Ok(None) };
    if axes.iter().any(Option::is_none) {
        return Ok(None);
    }
    let axes = axes.map(|axis| {
        let Some((((movement, stiffness), damping), law)) = axis else { unreachable!() };
        AxisPrimitives { movement, stiffness, damping, law }
    });
    Ok(HybridPrimitive::new(phase, [basis; 3], axes).ok())
}

/// The law of an axis.
fn law<T: Scalar>(input: &mut Unstructured<'_>, taste: Taste) -> Result<Law<T>> {
    let damping = match u8::arbitrary(input)? % 4 {
        0 | 1 => return Ok(Law::FirstOrder),
        2 => Damping::Primitive,
        _ => Damping::Ratio { ratio: number(input, taste, 0.2, 2.0)?, floor: number(input, taste, 1.0, 20.0)? },
    };
    Ok(Law::SecondOrder { mass: number(input, taste, 0.1, 10.0)?, damping })
}

/// Settings, in order or not.
pub fn settings<T: Scalar, const D: usize>(input: &mut Unstructured<'_>, taste: Taste) -> Result<Settings<T, D>> {
    let plain =
        Limits { force: T::ONE, offset: T::ONE, velocity: T::ONE, acceleration: T::ONE, position: [T::ZERO; 2] };
    let mut settings = Settings::compliant([plain; D]);
    for axis in &mut settings.axes {
        let limits = Limits {
            force: number(input, taste, 20.0, 100.0)?,
            offset: number(input, taste, 0.02, 0.3)?,
            velocity: number(input, taste, 0.05, 2.0)?,
            acceleration: number(input, taste, 0.5, 50.0)?,
            position: [number(input, taste, -1.0, -0.4)?, number(input, taste, 0.4, 1.0)?],
        };
        let compliance = match u8::arbitrary(input)? % 4 {
            0 => Compliance::Rigid,
            1 => Compliance::Press(number(input, taste, -20.0, 20.0)?),
            _ => Compliance::Compliant,
        };
        let (trip_force, tracking) = (number(input, taste, 60.0, 150.0)?, number(input, taste, 0.02, 0.2)?);
        *axis = AxisSettings { compliance, limits, trip_force, tracking };
    }
    let flags = u8::arbitrary(input)?;
    settings.conditioning = ForceConditioning {
        tool_mass: number(input, taste, 0.0, 2.0)?,
        gravity: each(input, taste, -9.81, 0.0)?,
        cutoff: if flags & 1 != 0 { Some(number(input, taste, 2.0, 200.0)?) } else { None },
        dead_zone: each(input, taste, 0.0, 2.0)?,
    };
    if flags & 2 != 0 {
        let capacity: T = number(input, taste, 0.05, 3.0)?;
        let reserve = capacity * number(input, taste, 0.0, 1.0)?;
        settings.tank =
            EnergyTank::new(capacity, reserve, number(input, taste, 0.0, 1.0)?, number(input, taste, 1.0, 100.0)?).ok();
    }
    // Seldom, because it ties a command to a robot.
    if flags & 60 == 60 {
        let force_delay = u32::from(u8::arbitrary(input)? % 8);
        settings.port = Some(Port { force_delay, force_bias: each(input, taste, 0.0, 2.0)? });
    }
    settings.timing = Timing {
        longest_step: number(input, taste, 0.002, 0.02)?,
        ramp: number(input, taste, 0.01, 0.5)?,
        hold: number(input, taste, 0.0, 0.05)?,
        oldest_force: u32::from(flags >> 6) * 2,
    };
    Ok(settings)
}
