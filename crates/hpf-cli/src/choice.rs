//! Enumerations of the library as values of arguments.

use clap::ValueEnum;
use clap::builder::PossibleValue;
use hpf::export::{self, Precision};
use hpf::figure;

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice<T>(pub T);

/// All there are, and how help names them.
pub trait Choices: Clone + 'static {
    /// In the order of the help.
    const ALL: &'static [Choice<Self>];

    /// Name and help.
    fn value(&self) -> PossibleValue;
}

impl<T: Choices> ValueEnum for Choice<T> {
    fn value_variants<'a>() -> &'a [Self] {
        T::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(self.0.value())
    }
}

impl Choices for figure::Format {
    const ALL: &'static [Choice<Self>] = &[Choice(Self::Png), Choice(Self::Svg)];

    fn value(&self) -> PossibleValue {
        PossibleValue::new(self.extension()).help(match self {
            Self::Png => "Pixels, at twice the size of the figure",
            Self::Svg => "Lines and outlines of letters; needs no font",
        })
    }
}

impl Choices for export::Format {
    const ALL: &'static [Choice<Self>] =
        &[Choice(Self::Rust), Choice(Self::C), Choice(Self::Binary), Choice(Self::Ros2)];

    fn value(&self) -> PossibleValue {
        let value = PossibleValue::new(self.name());
        match self {
            Self::Rust => {
                value.help("A Rust module for no_std firmware: constant arrays, and a function that builds the skill")
            }
            Self::C => value.help("A C header: the same numbers as constant arrays"),
            Self::Binary => value.help("A few bytes with a checksum, read by hpf_core::packed").alias("postcard"),
            Self::Ros2 => value.help("A log of ROS 2 messages (MCAP, CDR) of the motion of a run"),
        }
    }
}

impl Choices for Precision {
    const ALL: &'static [Choice<Self>] = &[Choice(Self::F32), Choice(Self::F64)];

    fn value(&self) -> PossibleValue {
        PossibleValue::new(self.name()).help(match self {
            Self::F32 => "Single precision, for a microcontroller",
            Self::F64 => "Double precision, the policy's own numbers",
        })
    }
}
