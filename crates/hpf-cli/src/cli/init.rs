//! The arguments of `hpf init`.

use clap::{Args, ValueEnum};

/// `hpf init`
#[derive(Args, Debug)]
pub struct Init {
    /// Kind of task
    #[arg(value_enum, value_name = "KIND")]
    pub kind: Kind,
}

/// The kinds of task to start from: the shipped ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Kind {
    /// The smallest: reach a goal against a steady force
    Reach,
    /// Reach a goal through a via point, pushed and pulled (Task 1 of the paper)
    ViaPoint,
    /// Slide along a bending beam with a constant force (Task 2 of the paper)
    Cantilever,
    /// The same on the curve of a beam loaded where the tool is
    CantileverMovingLoad,
    /// Stop at a wall and press it
    Wall,
    /// Turn a rotary joint through a via point against a pulse
    Joint,
    /// Reach a goal through a via point under a push that nobody knows: drawn motions, measured on others held out
    Stochastic,
    /// A simulator or a robot of your own: a task, and the program that makes its rollouts
    Process,
}
