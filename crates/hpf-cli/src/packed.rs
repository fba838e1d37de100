//! A packed skill read back, as text and as JSON.

use core::fmt::Write as _;

use hpf_core::packed::Packed;
use serde_json::{Value, json};

use crate::render::number;

/// What a packed skill holds, axis by axis: start and goal, ranges of stiffness and damping.
fn axes_of(skill: &Packed<'_>) -> Vec<(&'static str, [f64; 2], [[f64; 4]; 2])> {
    let numbers: Vec<f64> = skill.values().collect();
    let [movement, stiffness, damping] = skill.head().functions.map(usize::from);
    let axis_length = 4 + movement + 2 + stiffness + 2 + damping;
    let axes = &numbers[numbers.len() - usize::from(skill.head().axes) * axis_length..];
    let gain = |gain: &[f64]| {
        let range = gain[2..].iter().fold((f64::INFINITY, f64::NEG_INFINITY), |r, w| (r.0.min(*w), r.1.max(*w)));
        [range.0, range.1, gain[0], gain[1]]
    };
    let axis = |(i, axis): (usize, &[f64])| {
        let unit = if skill.head().rotary >> i & 1 == 1 { "rad" } else { "m" };
        let (stiff, damp) = axis[4 + movement..].split_at(2 + stiffness);
        (unit, [axis[0], axis[1]], [gain(stiff), gain(damp)])
    };
    axes.chunks_exact(axis_length).enumerate().map(axis).collect()
}

/// What a packed skill is.
pub fn text(skill: &Packed<'_>) -> String {
    let head = skill.head();
    let duration = skill.values::<f64>().next().unwrap_or_default();
    let [movement, stiffness, damping] = head.functions;
    let mut text = format!(
        "a packed skill, intact: {} axes in f{}, {duration} s, {} bytes\n",
        head.axes,
        8 * head.scalar.width(),
        head.length()
    );
    let _ = writeln!(text, "  basis       {movement} movement, {stiffness} stiffness, {damping} damping");
    for (i, (unit, [start, goal], gains)) in axes_of(skill).into_iter().enumerate() {
        let _ = writeln!(text, "  axis        {i}: {start} -> {goal} {unit}");
        for (name, range) in ["stiffness", "damping"].into_iter().zip(gains) {
            let [least, most, min, max] = range.map(number);
            let _ = writeln!(text, "    {name:<9} {least} .. {most}, bounds {min} .. {max}");
        }
    }
    text
}

/// The same for programs.
pub fn to_json(skill: &Packed<'_>) -> Value {
    let axes = axes_of(skill).into_iter().map(|(unit, [start, goal], gains)| {
        let [stiffness, damping] =
            gains.map(|[least, most, min, max]| json!({ "least": least, "most": most, "min": min, "max": max }));
        json!({ "unit": unit, "start": start, "goal": goal, "stiffness": stiffness, "damping": damping })
    });
    let head = skill.head();
    json!({
        "format": "hpf-packed-info", "version": 1, "scalar": format!("f{}", 8 * head.scalar.width()),
        "bytes": head.length(), "functions": head.functions, "duration_s": skill.values::<f64>().next(),
        "axes": axes.collect::<Vec<_>>(),
    })
}
