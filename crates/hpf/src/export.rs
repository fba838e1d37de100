//! A policy in the forms that firmware takes: each is a function of the policy and of the scalar. The form for ROS is a
//! log: `log::bag`.

mod binary;
mod c;
mod rust;

use hpf_core::{ConfigError, Real};
use hpf_sim::task::Unit;
use hpf_sim::{AxisPolicy, Family, Policy};

/// The forms of an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A Rust module for no_std firmware: constant arrays, and a function that builds the skill
    Rust,
    /// A C header: the same numbers as constant arrays
    C,
    /// A few bytes with a checksum, read by hpf_core::packed
    Binary,
    /// A log of ROS 2 messages (MCAP, CDR) of the motion of a run
    #[cfg(feature = "logs")]
    Ros2,
}

impl Format {
    /// The name of the form.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rust => "rust",
            Self::C => "c",
            Self::Binary => "binary",
            #[cfg(feature = "logs")]
            Self::Ros2 => "ros2",
        }
    }

    /// The form, if it is one for firmware.
    pub fn firmware(self) -> Option<Form> {
        match self {
            Self::Rust => Some(|policy, precision| rust::module(policy, precision).into_bytes()),
            Self::C => Some(|policy, precision| c::header(policy, precision).into_bytes()),
            Self::Binary => Some(binary::bytes),
            #[cfg(feature = "logs")]
            Self::Ros2 => None,
        }
    }

    /// What the name of its file ends in.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Rust => "rs",
            Self::C => "h",
            Self::Binary => "bin",
            #[cfg(feature = "logs")]
            Self::Ros2 => "mcap",
        }
    }
}

/// The scalars of an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Single precision, for a microcontroller
    F32,
    /// Double precision, the policy's own numbers
    F64,
}

impl Precision {
    /// The name of the scalar in Rust.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// The shortest digits that read back to the same number of this scalar.
    fn digits(self, number: f64) -> String {
        match self {
            Self::F32 => format!("{:?}", number as f32),
            Self::F64 => format!("{number:?}"),
        }
    }
}

/// A form for firmware: the bytes of a policy in a scalar.
pub type Form = fn(&Policy, Precision) -> Vec<u8>;

/// The policy in the form and scalar asked for.
///
/// # Errors
/// [`ConfigError`] where the policy makes no skill in this scalar: centers that become one, numbers beyond its range.
pub fn export(policy: &Policy, form: Form, precision: Precision) -> Result<Vec<u8>, ConfigError> {
    match precision {
        Precision::F32 => check::<f32>(policy)?,
        Precision::F64 => check::<f64>(policy)?,
    }
    Ok(form(policy, precision))
}

fn check<T: Real>(policy: &Policy) -> Result<(), ConfigError> {
    (0..policy.axes.len()).try_for_each(|axis| policy.axis(axis).to_hybrid_of::<T, 1>().map(drop))
}

/// One basis of an export, its numbers those of the scalar asked for.
struct ExportedBasis {
    name: &'static str,
    /// Overlap of neighbours, where it is of the time family.
    overlap: Option<f64>,
    centers: Vec<f64>,
    /// Widths; of the time family, what a function has fallen to j spacings from its center.
    shape: Vec<f64>,
}

impl ExportedBasis {
    fn count(&self) -> usize {
        self.centers.len()
    }

    /// What its second list is called, and is.
    fn shape_name(&self) -> (&'static str, &'static str) {
        match self.overlap {
            None => ("widths", "Widths"),
            Some(_) => ("falls", "What a function has fallen to 0, 1, 2 ... spacings from its center, time family,"),
        }
    }
}

/// The bases of movement, stiffness and damping.
fn bases(policy: &Policy, precision: Precision) -> [ExportedBasis; 3] {
    match precision {
        Precision::F32 => bases_of::<f32>(policy),
        Precision::F64 => bases_of::<f64>(policy),
    }
}

fn bases_of<T: Real>(policy: &Policy) -> [ExportedBasis; 3] {
    let [movement, stiffness, damping] = policy.bases::<T>().expect("a policy that makes a skill has its bases");
    let exported = |name, basis: hpf_core::Basis<T, Vec<T>>| {
        let list = |numbers: &[T]| numbers.iter().map(|number| number.to_f64()).collect();
        let overlap = basis.overlap().map(T::to_f64);
        ExportedBasis { name, overlap, centers: list(basis.centers()), shape: list(basis.widths()) }
    };
    [exported("movement", movement), exported("stiffness", stiffness), exported("damping", damping)]
}

/// The law in a sentence.
fn law(policy: &Policy) -> String {
    match &policy.admittance.mass {
        None => "Admittance: first order, d e' + k e = f.".into(),
        Some(_) => {
            "Admittance: second order, m e'' + d e' + k e = f, masses m as below, damping d its primitive.".into()
        }
    }
}

/// Virtual mass of each axis; 0 of a first-order one.
fn masses(policy: &Policy) -> Vec<f64> {
    policy.admittance.mass.clone().unwrap_or_else(|| vec![0.0; policy.axes.len()])
}

/// What [`masses`] are.
const MASS: &str = "Virtual mass of the admittance of second order [kg or kg m^2], 0: first order";

/// One number per axis: its name, what it is with its unit, and where it stands.
type PerAxis = (&'static str, &'static str, fn(&AxisPolicy) -> f64);

const PER_AXIS: [PerAxis; 8] = [
    ("start", "Where the movement starts [m or rad]", |axis| axis.start),
    ("goal", "Where it ends [m or rad]", |axis| axis.goal),
    ("alpha", "Spring factor alpha of the movement; beta = alpha/4", |axis| axis.movement.alpha),
    ("forcing_scale", "Scale A of the forcing term [m or rad]", |axis| axis.movement.forcing_scale),
    ("stiffness_min", "Least stiffness [N/m or N m/rad]", |axis| axis.stiffness.min),
    ("stiffness_max", "Largest stiffness [N/m or N m/rad]", |axis| axis.stiffness.max),
    ("damping_min", "Least damping [N s/m or N m s/rad]", |axis| axis.damping.min),
    ("damping_max", "Largest damping [N s/m or N m s/rad]", |axis| axis.damping.max),
];

/// One list of weights per axis: the primitive's name, its unit, and where the list stands.
type WeightsPerAxis = (&'static str, &'static str, fn(&AxisPolicy) -> &[f64]);

const WEIGHTS: [WeightsPerAxis; 3] = [
    ("movement", "1", |axis| &axis.movement.weights),
    ("stiffness", "N/m or N m/rad", |axis| &axis.stiffness.weights),
    ("damping", "N s/m or N m s/rad", |axis| &axis.damping.weights),
];

/// What a text export says at its top, each line without its comment sign.
fn preamble(policy: &Policy, sha256: &str) -> Vec<String> {
    let from = &policy.provenance;
    let first = &policy.axes[0];
    let families = [first.movement.family, first.stiffness.family, first.damping.family];
    let functions = match families.iter().filter(|family| **family == Family::Phase).count() {
        3 => {
            "Basis functions psi_i(s) = exp(-h_i (s - c_i)^2) of the phase s = exp(-decay t/duration), centers c_i, widths h_i."
        }
        0 => "Basis functions psi_i = overlap^((u - i)^2), time family, u = (n - 1) t/duration, centers c_i in phase.",
        _ => {
            "Basis functions with widths h_i are psi_i(s) = exp(-h_i (s - c_i)^2), s = exp(-decay t/duration); those with falls overlap^((u - i)^2), u = (n - 1) t/duration."
        }
    };
    let mut lines = vec![
        format!(
            "Skill `{}`, made by `hpf export` {}: not edited by hand.",
            printable(&policy.task),
            env!("CARGO_PKG_VERSION")
        ),
        String::new(),
    ];
    lines.extend(policy.axes.iter().enumerate().map(|(i, axis)| {
        let unit = if axis.unit == Unit::M { "m, N, N/m, N s/m" } else { "rad, N m, N m/rad, N m s/rad" };
        format!("Axis {i}: `{}`, in {unit}.", printable(&axis.name))
    }));
    lines.extend([
        functions.into(),
        law(policy),
        format!("Policy: SHA-256 {sha256}."),
        format!(
            "Learned: hpf {}, seed {}, {} updates, cost {:?}.",
            printable(&from.hpf),
            from.seed,
            from.updates,
            from.cost
        ),
    ]);
    lines
}

/// A text that ends neither a line nor a comment.
fn printable(text: &str) -> String {
    text.escape_default().to_string().replace("*/", "* /").replace("/*", "/ *").replace('`', "'")
}

/// A list of numbers over as many lines as it takes, each indented by `indent`.
fn lines(numbers: impl Iterator<Item = String>, indent: usize) -> String {
    let mut text = String::new();
    let mut width = usize::MAX;
    for number in numbers {
        if width.saturating_add(number.len() + 2) > 110 {
            text += &format!("\n{:indent$}", "");
            width = indent;
        } else {
            text.push(' ');
        }
        width += number.len() + 2;
        text += &number;
        text.push(',');
    }
    text
}
