//! A Rust module that needs nothing but `hpf-core`.

use core::fmt::Write as _;

use hpf_sim::Policy;

use super::{MASS, PER_AXIS, Precision, WEIGHTS, bases, lines, masses, preamble};
use crate::files::sha256;

/// A learned number may be near a constant that clippy knows, or long.
const HEAD: &str = "
#![allow(clippy::approx_constant, clippy::unreadable_literal)]

use hpf_core::{AxisPrimitives, Basis, ConfigError, NAMES_HEREGain, HybridPrimitive, Law, Movement, Phase};
";

const BUILD: &str = "
/// The skill; its lists stay where they lie.
pub type Skill = HybridPrimitive<Scalar, &'static [Scalar], AXES>;

/// Builds the skill. The numbers were accepted when they were exported, and are again.
///
/// # Errors
/// `ConfigError` if somebody has changed them since.
pub fn skill() -> Result<Skill, ConfigError> {
    let bases = [
BASES_HERE    ];
    let axes = [
AXES_HERE    ];
    HybridPrimitive::new(Phase::new(DURATION, DECAY)?, bases, axes)
}
";

/// One axis; constant places in the lists are checked when the module is compiled.
const AXIS: &str = "        AxisPrimitives {
            movement: Movement::new(START[I], GOAL[I], ALPHA[I], FORCING_SCALE[I], &MOVEMENT_WEIGHTS[I][..])?,
            stiffness: Gain::new(STIFFNESS_MIN[I], STIFFNESS_MAX[I], &STIFFNESS_WEIGHTS[I][..])?,
            damping: Gain::new(DAMPING_MIN[I], DAMPING_MAX[I], &DAMPING_WEIGHTS[I][..])?,
            law: LAW_HERE,
        },
";

/// The module's text.
pub fn module(policy: &Policy, precision: Precision) -> String {
    let mut text = String::new();
    for line in preamble(policy, &sha256(&policy.to_json())) {
        text += format!("//! {line}").trim_end();
        text.push('\n');
    }
    // Only what is used is imported and written: the module compiles without a warning.
    let (damping, law) = match &policy.admittance.mass {
        None => ("", "Law::FirstOrder"),
        Some(_) => ("Damping, ", "Law::SecondOrder { mass: MASS[I], damping: Damping::Primitive }"),
    };
    text += &HEAD.replace("NAMES_HERE", damping);
    let axes = policy.axes.len();
    let digits = |number: &f64| precision.digits(*number);
    let list = |numbers: &[f64]| lines(numbers.iter().map(digits), 4);
    let _ = writeln!(text, "\n/// The scalar of the skill.\npub type Scalar = {};", precision.name());
    let _ = writeln!(text, "/// Number of axes.\npub const AXES: usize = {axes};");
    let _ = writeln!(
        text,
        "/// Duration of the movement [s].\npub const DURATION: Scalar = {};",
        digits(&policy.duration_s)
    );
    let _ = writeln!(
        text,
        "/// Decay alpha_s of the phase over the duration.\npub const DECAY: Scalar = {};",
        digits(&policy.phase.decay)
    );
    for (name, what, of) in PER_AXIS {
        let values: Vec<f64> = policy.axes.iter().map(of).collect();
        let _ = writeln!(text, "\n/// {}, by axis.", what);
        let _ = writeln!(text, "pub static {}: [Scalar; AXES] = [{}\n];", name.to_uppercase(), list(&values));
    }
    let _ = writeln!(text, "\n/// {MASS}, by axis.");
    let _ = writeln!(text, "pub static MASS: [Scalar; AXES] = [{}\n];", list(&masses(policy)));
    let bases = bases(policy, precision);
    for basis in &bases {
        let (name, (shape, what)) = (basis.name, basis.shape_name());
        let (upper, count) = (name.to_uppercase(), basis.count());
        let _ = writeln!(text, "\n/// Centers of the basis of {name}, oldest phase first.");
        let _ = writeln!(text, "pub static {upper}_CENTERS: [Scalar; {count}] = [{}\n];", list(&basis.centers));
        let _ = writeln!(text, "\n/// {what} of the basis of {name}.");
        let shape = shape.to_uppercase();
        let _ = writeln!(text, "pub static {upper}_{shape}: [Scalar; {count}] = [{}\n];", list(&basis.shape));
        if let Some(overlap) = &basis.overlap {
            let _ = writeln!(text, "\n/// Overlap of neighbours in the basis of {name}.");
            let _ = writeln!(text, "pub const {upper}_OVERLAP: Scalar = {};", digits(overlap));
        }
    }
    for ((name, unit, of), count) in WEIGHTS.into_iter().zip(bases.each_ref().map(super::ExportedBasis::count)) {
        let _ = writeln!(text, "\n/// Weights of {name} [{unit}], by axis.");
        let _ = writeln!(text, "pub static {}_WEIGHTS: [[Scalar; {count}]; AXES] = [", name.to_uppercase());
        for axis in &policy.axes {
            let _ = writeln!(text, "    [{}\n    ],", lines(of(axis).iter().map(digits), 8));
        }
        text += "];\n";
    }
    let axis = AXIS.replace("LAW_HERE", law);
    let built: String = (0..axes).map(|i| axis.replace("[I]", &format!("[{i}]"))).collect();
    let made = bases.iter().map(|basis| {
        let upper = basis.name.to_uppercase();
        match basis.overlap {
            None => format!("        Basis::new(&{upper}_CENTERS[..], &{upper}_WIDTHS[..])?,\n"),
            Some(_) => format!(
                "        Basis::stored_in_time(DECAY, {upper}_OVERLAP, &{upper}_CENTERS[..], &{upper}_FALLS[..])?,\n"
            ),
        }
    });
    text + &BUILD.replace("BASES_HERE", &made.collect::<String>()).replace("AXES_HERE", &built)
}
