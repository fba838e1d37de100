//! A packed skill read back, as text and as JSON.

use core::fmt::Write as _;

use hpf_core::packed::{Packed, PackedAxis, PackedGain};
use serde_json::{Value, json};

use crate::words::number;

/// Weights of a gain and their bounds.
struct Range {
    least: f64,
    most: f64,
    min: f64,
    max: f64,
}

impl Range {
    fn of(gain: &PackedGain<'_>) -> Self {
        let least = gain.weights().fold(f64::INFINITY, f64::min);
        let most = gain.weights().fold(f64::NEG_INFINITY, f64::max);
        Self { least, most, min: gain.min, max: gain.max }
    }

    fn to_json(&self) -> Value {
        json!({ "least": self.least, "most": self.most, "min": self.min, "max": self.max })
    }
}

fn unit(axis: &PackedAxis<'_>) -> &'static str {
    if axis.is_rotary { "rad" } else { "m" }
}

/// Stiffness and damping.
fn gains(axis: &PackedAxis<'_>) -> [Range; 2] {
    [&axis.stiffness, &axis.damping].map(Range::of)
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
    let duration = skill.duration();
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
    for (i, axis) in skill.axes().enumerate() {
        let _ = writeln!(text, "  axis        {i}: {} -> {} {}", axis.start, axis.goal, unit(&axis));
        for (name, Range { least, most, min, max }) in ["stiffness", "damping"].into_iter().zip(gains(&axis)) {
            let [least, most, min, max] = [least, most, min, max].map(number);
            let _ = writeln!(text, "    {name:<9} {least} .. {most}, bounds {min} .. {max}");
        }
        let _ = writeln!(text, "    law       {}", law_text(axis.law));
    }
    text
}

/// The same for programs.
pub fn to_json(skill: &Packed<'_>) -> Value {
    let axes = skill.axes().map(|axis| {
        let [stiffness, damping] = gains(&axis).map(|gain| gain.to_json());
        json!({
            "unit": unit(&axis), "start": axis.start, "goal": axis.goal, "stiffness": stiffness, "damping": damping,
            "mass": axis.law[0], "damping_ratio": axis.law[1], "damping_floor": axis.law[2],
        })
    });
    let head = skill.head();
    json!({
        "format": "hpf-packed-info", "version": 1, "scalar": format!("f{}", 8 * head.scalar.width()),
        "bytes": head.length(), "functions": head.functions, "in_time": head.in_time,
        "duration_s": skill.duration(),
        "axes": axes.collect::<Vec<_>>(),
    })
}
