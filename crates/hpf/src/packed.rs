//! A packed skill read back, as text and as JSON.

use core::fmt::Write as _;

use hpf_core::packed::Packed;
use serde_json::{Value, json};

use crate::words::number;

/// What a packed skill holds of one axis.
struct Axis {
    unit: &'static str,
    start: f64,
    goal: f64,
    /// Stiffness and damping.
    gains: [Range; 2],
    /// Virtual mass, damping ratio and least damping; all zero of a first-order axis.
    law: [f64; 3],
}

/// Weights of a gain and their bounds.
struct Range {
    least: f64,
    most: f64,
    min: f64,
    max: f64,
}

impl Range {
    /// The range of a gain as it is packed: its bounds, then its weights.
    fn of(numbers: &[f64]) -> Self {
        let weights = &numbers[2..];
        let least = weights.iter().copied().fold(f64::INFINITY, f64::min);
        let most = weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { least, most, min: numbers[0], max: numbers[1] }
    }

    fn to_json(&self) -> Value {
        json!({ "least": self.least, "most": self.most, "min": self.min, "max": self.max })
    }
}

/// The axes, which stand last in a packed skill.
fn axes_of(skill: &Packed<'_>) -> Vec<Axis> {
    let numbers: Vec<f64> = skill.values().collect();
    let [movement, stiffness, damping] = skill.head().functions.map(usize::from);
    let length = 4 + movement + 2 + stiffness + 2 + damping + skill.head().law_numbers();
    let axes = &numbers[numbers.len() - usize::from(skill.head().axes) * length..];
    let axis = |(i, axis): (usize, &[f64])| {
        let unit = if skill.head().rotary >> i & 1 == 1 { "rad" } else { "m" };
        let (stiffness, rest) = axis[4 + movement..].split_at(2 + stiffness);
        let (damping, law) = rest.split_at(2 + damping);
        let gains = [stiffness, damping].map(Range::of);
        Axis { unit, start: axis[0], goal: axis[1], gains, law: law.try_into().unwrap_or([0.0; 3]) }
    };
    axes.chunks_exact(length).enumerate().map(axis).collect()
}

/// The law of three numbers, in words.
fn law_text([mass, ratio, floor]: [f64; 3]) -> String {
    match (mass, ratio) {
        (0.0, _) => "first order".into(),
        (_, 0.0) => format!("second order, mass {}", number(mass)),
        _ => {
            format!("second order, mass {}, damping ratio {}, at least {}", number(mass), number(ratio), number(floor))
        }
    }
}

/// What a packed skill is.
pub fn text(skill: &Packed<'_>) -> String {
    let head = skill.head();
    let duration = skill.values::<f64>().next().unwrap_or_default();
    let [movement, stiffness, damping] = core::array::from_fn(|i| {
        let family = if head.in_time[i] { " in time" } else { "" };
        format!("{}{family}", head.functions[i])
    });
    let mut text = format!(
        "a packed skill, intact: {} axes in f{}, {duration} s, {} bytes\n",
        head.axes,
        8 * head.scalar.width(),
        head.length()
    );
    let _ = writeln!(text, "  basis       {movement} movement, {stiffness} stiffness, {damping} damping");
    for (i, axis) in axes_of(skill).into_iter().enumerate() {
        let _ = writeln!(text, "  axis        {i}: {} -> {} {}", axis.start, axis.goal, axis.unit);
        for (name, Range { least, most, min, max }) in ["stiffness", "damping"].into_iter().zip(axis.gains) {
            let [least, most, min, max] = [least, most, min, max].map(number);
            let _ = writeln!(text, "    {name:<9} {least} .. {most}, bounds {min} .. {max}");
        }
        let _ = writeln!(text, "    law       {}", law_text(axis.law));
    }
    text
}

/// The same for programs.
pub fn to_json(skill: &Packed<'_>) -> Value {
    let axes = axes_of(skill).into_iter().map(|axis| {
        let [stiffness, damping] = axis.gains.map(|gain| gain.to_json());
        json!({
            "unit": axis.unit, "start": axis.start, "goal": axis.goal, "stiffness": stiffness, "damping": damping,
            "mass": axis.law[0], "damping_ratio": axis.law[1], "damping_floor": axis.law[2],
        })
    });
    let head = skill.head();
    json!({
        "format": "hpf-packed-info", "version": 1, "scalar": format!("f{}", 8 * head.scalar.width()),
        "bytes": head.length(), "functions": head.functions, "in_time": head.in_time,
        "duration_s": skill.values::<f64>().next(),
        "axes": axes.collect::<Vec<_>>(),
    })
}
