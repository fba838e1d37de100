//! The command line: what can be asked, with its defaults and units.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::export::{Format, Precision};
use crate::style::ColorChoice;

/// Learn, run and inspect compliant robot skills: motion, stiffness and damping in one.
#[derive(Debug, Parser)]
#[command(name = "hpf", version, arg_required_else_help = true, after_help = EXAMPLES)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

const EXAMPLES: &str = "\
Examples:
  hpf learn tasks/cantilever.toml                    learn a task, keep everything in runs/cantilever
  hpf learn tasks/via_point.toml --seed 2 --out out  another seed, another place
  hpf run runs/cantilever --rate 1000                run what was learned, at 1000 Hz
  hpf check tasks/reach.toml                         is this task file right?
  hpf export runs/cantilever --format rust           what was learned, for firmware

Exit codes: 0 done, 1 failed, 2 bad arguments or invalid task, 3 a target of [accept] was missed, 130 Ctrl-C.";

/// Options accepted before and after the command.
#[derive(Args, Debug)]
pub struct Common {
    /// Seed of all random numbers [default: the task's]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    pub seed: Option<u64>,
    /// Threads for rollouts; the results are the same for any number [default: one per core]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Where results go: a directory; for export a file, or - for stdout
    #[arg(long, global = true, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// Replace existing results
    #[arg(long, global = true)]
    pub force: bool,
    /// Print the result as one JSON object
    #[arg(long, global = true)]
    pub json: bool,
    /// No progress on stderr
    #[arg(long, global = true)]
    pub quiet: bool,
    /// When to colour messages
    #[arg(long, global = true, value_enum, default_value_t, value_name = "WHEN")]
    pub color: ColorChoice,
}

/// What `hpf` can do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Learn a task; keep policy, tables, log and plots in runs/NAME or --out
    #[command(after_help = "\
Examples:
  hpf learn tasks/cantilever.toml
  hpf learn tasks/via_point.toml --set 'via_point.0.position=[0.5,0.9]' --out runs/elsewhere
  hpf learn tasks/reach.toml --set learning.updates=300 --json
  hpf learn --resume runs/cantilever")]
    Learn(Learn),
    /// Simulate a learned policy, also at another rate or in another environment
    #[command(after_help = "\
Examples:
  hpf run runs/cantilever
  hpf run runs/cantilever --rate 1000 --set contact.force=12
  hpf run policy.json --task tasks/cantilever.toml --out runs/again")]
    Run(Simulate),
    /// Draw the plots of a run again, from its tables
    #[command(after_help = "Example:\n  hpf plot runs/cantilever --out figures")]
    Plot(Plot),
    /// Check a task or policy and say what it comes to; a policy with its certificates
    #[command(after_help = "\
Examples:
  hpf check tasks/cantilever.toml --set rate=1000
  hpf check runs/cantilever --rate 1000 --delay 0.004 --load 20

Certificates of a policy, by axis: whether its gains are passive from rest (first order), the energy that rising stiffness can
put in under any force within --load, the stiffest contact for a force --delay late, the fastest reference.")]
    Check(Check),
    /// Write a policy for firmware: Rust, C or binary
    #[command(after_help = "\
Examples:
  hpf export runs/cantilever --format rust --scalar f32
  hpf export runs/cantilever/policy.json --format c --out firmware/cantilever.h
  hpf export runs/cantilever --format binary --out - | sha256sum")]
    Export(Export),
    /// Say what is in a task, policy, run directory or MCAP log
    #[command(after_help = "Examples:\n  hpf info runs/cantilever\n  hpf info runs/cantilever/log.mcap")]
    Info(Info),
}

/// `hpf learn`
#[derive(Args, Debug)]
pub struct Learn {
    /// Task file (TOML)
    #[arg(value_name = "TASK", required_unless_present = "resume")]
    pub task: Option<PathBuf>,
    /// Override a key of the task, typed as in TOML; lists by position, from 0
    #[arg(long, value_name = "KEY.PATH=VALUE", conflicts_with = "resume")]
    pub set: Vec<String>,
    /// Go on with a run that was killed or interrupted, to the same results as if it had not been
    #[arg(long, value_name = "RUN", conflicts_with = "task")]
    pub resume: Option<PathBuf>,
}

/// `hpf run`
#[derive(Args, Debug)]
pub struct Simulate {
    /// Run directory, or policy file (JSON)
    #[arg(value_name = "POLICY|RUN")]
    pub policy: PathBuf,
    /// Task file for a policy file [default: task.toml beside it]
    #[arg(long, value_name = "TASK")]
    pub task: Option<PathBuf>,
    /// Control rate [Hz] [default: the task's]
    #[arg(long, value_name = "HZ", allow_hyphen_values = true)]
    pub rate: Option<f64>,
    /// Override a key of the environment: disturbance, contact, via_point, cost, accept, rate
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub set: Vec<String>,
}

/// `hpf plot`
#[derive(Args, Debug)]
pub struct Plot {
    /// Run directory
    #[arg(value_name = "RUN")]
    pub run: PathBuf,
}

/// `hpf check`
#[derive(Args, Debug)]
pub struct Check {
    /// Task file (TOML), policy file (JSON) or run directory
    #[arg(value_name = "TASK|POLICY|RUN")]
    pub file: PathBuf,
    /// Override a key of the task, typed as in TOML; lists by position, from 0
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub set: Vec<String>,
    /// Control rate of a policy [Hz] [default: that of task.toml beside it, else 1000]
    #[arg(long, value_name = "HZ")]
    pub rate: Option<f64>,
    /// Age of the measured force [s] [default: one sample]
    #[arg(long, value_name = "S")]
    pub delay: Option<f64>,
    /// Largest force of the environment [N or N m] [default: 10]
    #[arg(long, value_name = "N")]
    pub load: Option<f64>,
}

/// `hpf export`
#[derive(Args, Debug)]
pub struct Export {
    /// Policy file (JSON) or run directory
    #[arg(value_name = "POLICY|RUN")]
    pub policy: PathBuf,
    /// Form [postcard: the same as binary]
    #[arg(long, value_enum, value_name = "FORM")]
    pub format: Format,
    /// Scalar
    #[arg(long, value_enum, value_name = "SCALAR", default_value = "f64")]
    pub scalar: Precision,
}

/// `hpf info`
#[derive(Args, Debug)]
pub struct Info {
    /// Task, policy, run directory or MCAP log
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
}
