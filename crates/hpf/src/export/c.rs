//! A C header (C89 and C++): constant arrays, and a macro that fills the policy of `hpf.h` with them.

use core::fmt::Write as _;

use hpf_sim::Policy;

use super::{MASS, PER_AXIS, Precision, WEIGHTS, bases, lines, masses, preamble};
use crate::files::sha256;

/// The header's text.
pub fn header(policy: &Policy, precision: Precision) -> String {
    let prefix = format!("hpf_{}", identifier(&policy.task));
    let upper = prefix.to_uppercase();
    let (kind, suffix) = match precision {
        Precision::F32 => ("float", "f"),
        Precision::F64 => ("double", ""),
    };
    let digits = |number: &f64| precision.digits(*number) + suffix;
    let axes = policy.axes.len();

    let mut text = String::from("/*\n");
    for line in preamble(policy, &sha256(&policy.to_json())) {
        text += format!(" * {line}").trim_end();
        text.push('\n');
    }
    let _ = writeln!(text, " */\n#ifndef {upper}_H\n#define {upper}_H\n");
    let _ = writeln!(text, "/* Number of axes. */\n#define {upper}_AXES {axes}");
    let bases = bases(policy, precision);
    for basis in &bases {
        let (name, count) = (basis.name, basis.count());
        let _ = writeln!(
            text,
            "/* Functions in the basis of {name}. */\n#define {upper}_{}_BASIS {count}",
            name.to_uppercase()
        );
    }
    let names: Vec<_> = policy.axes.iter().map(|axis| literal(&axis.name)).collect();
    let _ = writeln!(text, "\n/* Names of the axes. */");
    let _ = writeln!(
        text,
        "static const char *const {prefix}_names[{upper}_AXES] = {{{}\n}};",
        lines(names.into_iter(), 4)
    );
    let _ = writeln!(text, "\n/* Duration of the movement [s]. */");
    let _ = writeln!(text, "static const {kind} {prefix}_duration = {};", digits(&policy.duration_s));
    let _ = writeln!(text, "/* Decay alpha_s of the phase over the duration. */");
    let _ = writeln!(text, "static const {kind} {prefix}_decay = {};", digits(&policy.phase.decay));
    for (name, what, of) in PER_AXIS {
        let values = lines(policy.axes.iter().map(|axis| digits(&of(axis))), 4);
        let _ = writeln!(text, "\n/* {what}, by axis. */");
        let _ = writeln!(text, "static const {kind} {prefix}_{name}[{upper}_AXES] = {{{values}\n}};");
    }
    let values = lines(masses(policy).iter().map(digits), 4);
    let _ = writeln!(text, "\n/* {MASS}, by axis. */");
    let _ = writeln!(text, "static const {kind} {prefix}_mass[{upper}_AXES] = {{{values}\n}};");
    for basis in &bases {
        let (name, (shape, what)) = (basis.name, basis.shape_name());
        let count = format!("{upper}_{}_BASIS", name.to_uppercase());
        let list = |numbers: &[f64]| lines(numbers.iter().map(digits), 4);
        let _ = writeln!(text, "\n/* Centers of the basis of {name}, oldest phase first. */");
        let _ =
            writeln!(text, "static const {kind} {prefix}_{name}_centers[{count}] = {{{}\n}};", list(&basis.centers));
        let _ = writeln!(text, "/* {what} of the basis of {name}. */");
        let _ = writeln!(text, "static const {kind} {prefix}_{name}_{shape}[{count}] = {{{}\n}};", list(&basis.shape));
        if let Some(overlap) = &basis.overlap {
            let _ = writeln!(text, "/* Overlap of neighbours in the basis of {name}. */");
            let _ = writeln!(text, "static const {kind} {prefix}_{name}_overlap = {};", digits(overlap));
        }
    }
    for (name, unit, of) in WEIGHTS {
        let _ = writeln!(text, "\n/* Weights of {name} [{unit}], by axis. */");
        let shape = format!("[{upper}_AXES][{upper}_{}_BASIS]", name.to_uppercase());
        let _ = writeln!(text, "static const {kind} {prefix}_{name}_weights{shape} = {{");
        for axis in &policy.axes {
            let _ = writeln!(text, "    {{{}\n    }},", lines(of(axis).iter().map(digits), 8));
        }
        text += "};\n";
    }
    text + &filler(policy, precision, &prefix, &upper) + "\n#endif\n"
}

/// The macro that fills a policy of `hpf.h`: C that has not included it pays nothing for it.
fn filler(policy: &Policy, precision: Precision, prefix: &str, upper: &str) -> String {
    let bases = bases(policy, precision);
    let numbers: usize = bases.iter().map(|basis| 2 * basis.count()).sum();
    let scalar = precision.name();
    let mut text = format!(
        "\n/* Numbers of HPF_{}_BYTES for this skill, its lists used where they are. */\n\
         #define {upper}_NUMBERS {numbers}\n\
         /* Fills a hpf_{scalar}_policy_t of hpf.h, to be included before: {upper}_POLICY(policy); */\n\
         #define {upper}_POLICY(policy) \\\n  do {{ \\\n    HPF_PREPARE(policy); \\\n",
        scalar.to_uppercase()
    );
    let mut set = |field: &str, value: &str| {
        let _ = writeln!(text, "    (policy).{field} = {value}; \\");
    };
    set("axes", &format!("{upper}_AXES"));
    set("lists", "HPF_LISTS_BORROWED");
    set("duration", &format!("{prefix}_duration"));
    set("decay", &format!("{prefix}_decay"));
    for basis in &bases {
        let name = basis.name;
        set(&format!("{name}_basis.count"), &format!("{upper}_{}_BASIS", name.to_uppercase()));
        if basis.overlap.is_some() {
            set(&format!("{name}_basis.family"), "HPF_BASIS_TIME");
            set(&format!("{name}_basis.overlap"), &format!("{prefix}_{name}_overlap"));
        } else {
            set(&format!("{name}_basis.family"), "HPF_BASIS_STORED");
            set(&format!("{name}_basis.centers"), &format!("{prefix}_{name}_centers"));
            set(&format!("{name}_basis.widths"), &format!("{prefix}_{name}_widths"));
        }
    }
    for axis in 0..policy.axes.len() {
        for (name, ..) in PER_AXIS {
            set(&format!("axis[{axis}].{name}"), &format!("{prefix}_{name}[{axis}]"));
        }
        set(&format!("axis[{axis}].mass"), &format!("{prefix}_mass[{axis}]"));
        for (name, ..) in WEIGHTS {
            set(&format!("axis[{axis}].{name}_weights"), &format!("{prefix}_{name}_weights[{axis}]"));
        }
    }
    text + "  } while (0)\n"
}

/// A name as part of an identifier of C.
fn identifier(name: &str) -> String {
    name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { '_' }).collect()
}

/// A text as a string of C: what is not plain ASCII goes byte by byte, a question mark too (trigraphs).
fn literal(text: &str) -> String {
    let byte = |byte: u8| match byte {
        b' ' | b'!' | b'#'..=b'>' | b'@'..=b'[' | b']'..=b'~' => char::from(byte).to_string(),
        other => format!("\\{other:03o}"),
    };
    format!("\"{}\"", text.bytes().map(byte).collect::<String>())
}
