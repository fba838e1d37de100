//! The command line: what can be asked, with its defaults and units.

pub mod imitate;
pub mod init;
pub mod numbers;
pub mod report;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;

use crate::choice::Choice;
use crate::style::ColorChoice;
use hpf::export::{Format, Precision};
use hpf::figure;
use hpf_studies::sweep::Shard;
use numbers::{number, whole};

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
  hpf init reach --out my_task.toml                  # a task to start from
  hpf check my_task.toml                             # is it right, and what does it hold?
  hpf learn tasks/cantilever.toml                    # learn a task, keep all in runs/cantilever
  hpf learn tasks/cantilever.toml --seed 2 --out out # another seed, another place
  hpf info runs/cantilever out                       # both side by side
  hpf run runs/cantilever --rate 1000                # run what was learned, at 1000 Hz
  hpf imitate tasks/demonstrations/wipe.csv          # a policy from a recorded motion
  hpf export runs/cantilever --format rust           # what was learned, for firmware

Exit codes: 0 done, 1 failed, 2 bad arguments or invalid task, 3 a target of [accept] was missed, 130 Ctrl-C.";

const PLOT_EXAMPLES: &str = "\
Examples:
  hpf plot runs/cantilever --force
  hpf plot runs/cantilever --only stiffness,deviation --format svg --out figures
  hpf learn tasks/cantilever.toml --seed 2 --out runs/second
  hpf plot runs/cantilever runs/second --out compared

Figures of one run go into its plots/, unless --out says where; those of several runs need --out. Several runs are drawn in \
the same figures, a colour each: at most 16, with axes of the same names and units.";

const SWEEP_EXAMPLES: &str = "\
Examples:
  hpf sweep tasks/via_point.toml --seeds 20
  hpf sweep tasks/via_point.toml --seeds 10 --vary learning.noise.movement=3,10,30
  hpf sweep tasks/cantilever.toml --vary learning.method=pi2,auto --vary 'contact.curve=\"tip_load\",\"moving_load\"'
  hpf sweep tasks/via_point_stochastic.toml --variant 'movement: learning.learn=[\"movement\"]' --variant all:
  hpf sweep tasks/via_point.toml --seeds 20 --shard 3/16   # on the third of 16 machines

Results go to runs/NAME-sweep, or --out: results.csv, summary.json, plots/, and a directory per run in runs/. The same \
command goes on where it was broken off: finished runs are kept, failed ones are tried again. Seeds count up from --seed. \
--force learns all runs again. Shards may write to one folder at once; with disks of their own, put their runs/ into one. \
The same command without --shard then keeps all runs and writes the tables. Exit code 1 where a run failed, else 3 where \
one missed a target.";

const REPRODUCE_EXAMPLES: &str = "\
Examples:
  hpf reproduce
  hpf reproduce --seeds 3 --out paper
  hpf reproduce --check docs/reproduction.md

Writes to runs/reproduction, or --out: figure_02_... to figure_12_..., claims.md and claims.json, results.csv with every \
seed, and the runs of the first seed. Seeds count up from --seed [default: 1]. --check and --update compare or replace what \
stands in a page between its two marks, and write nothing else. Exit code 1 where the page is not current.";

const BENCHMARK_EXAMPLES: &str = "\
Examples:
  hpf benchmark
  hpf benchmark --task dmpbbo_via_point,wall --seeds 20 --out runs/compared
  hpf benchmark --task reach --motions 400 --seeds 2 --json --out runs/quick
  hpf benchmark --history docs/benchmark-history.csv   # before a release: a row per task and method

Writes to runs/benchmark, or --out: benchmarks.md and benchmarks.json with the motions and seconds to stated costs, median and \
worst over the seeds, and a figure per task in images/benchmarks/. Seeds count up from --seed [default: 1].";

/// Options accepted before and after the command.
#[derive(Args, Debug)]
#[command(next_help_heading = "Common options")]
pub struct Common {
    /// Seed of all random numbers [default: the task's]
    #[arg(long, global = true, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = whole(0..=i64::MAX as u64))]
    pub seed: Option<u64>,
    /// Threads for rollouts; the results are the same for any number [default: one per core]
    #[arg(long, global = true, value_name = "N", value_parser = whole(1..=1024_u16))]
    pub threads: Option<u16>,
    /// Where results go: a directory for learn, run, plot, manual [default: runs/NAME, none, RUN/plots, man]; a file for
    /// export, report, init, schema, completions, recover [default: see their help], or - for stdout
    #[arg(long, global = true, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// Replace existing results
    #[arg(long, global = true)]
    pub force: bool,
    /// Print the result as one JSON object with `format` and `version`
    #[arg(long, global = true)]
    pub json: bool,
    /// Print no progress
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

A run that was killed or stopped by Ctrl-C goes on with --resume RUN: hpf learn --resume runs/cantilever")]
    Learn(Learn),
    /// Simulate a learned policy, also at another rate or in another environment
    #[command(after_help = "\
Examples:
  hpf run runs/cantilever
  hpf run runs/cantilever --rate 1000 --set contact.force=12  # misses its targets: exit code 3
  hpf run policy.json --task tasks/cantilever.toml --out runs/again
  hpf run runs/elsewhere --controller --rate 1000             # as a robot runs it")]
    Run(Simulate),
    /// Make a policy of demonstrations (CSV), kept as a run
    #[command(after_help = imitate::HELP)]
    Imitate(Box<imitate::Options>),
    /// Draw the figures of a run again, or of several together
    #[command(after_help = PLOT_EXAMPLES)]
    Plot(Plot),
    /// Write a page that shows runs and lets them be pushed and learned again
    #[command(after_help = report::HELP)]
    Report(report::Report),
    /// Check a task or policy and show what it holds; a policy with its certificates
    #[command(after_help = "\
Examples:
  hpf check tasks/cantilever.toml --set rate=1000
  hpf check runs/cantilever --rate 1000 --delay 0.004 --load 20
  hpf check runs/cantilever --rate 1000 --tool-mass 0.5 --cutoff 10 --lag 0.005 --contact-mass 0.05

Certificates of a policy, by axis: whether its gains are passive from rest (first order), the energy that rising stiffness can
put in under any force within --load, the heaviest tool behind the sensor and the stiffest contact that the loop through the
measured force can stand, the fastest reference.")]
    Check(Check),
    /// Write a policy for firmware (Rust, C, binary), or a run for ROS 2
    #[command(after_help = "\
Examples:
  hpf export runs/cantilever --format rust --scalar f32
  hpf export runs/cantilever/policy.json --format c --out firmware/cantilever.h
  hpf export runs/cantilever --format binary --out - | sha256sum
  hpf export runs/cantilever --ros2 --out cantilever_ros2.mcap   # then: ros2 bag play cantilever_ros2.mcap

Without --out: policy.rs, policy.h, policy.bin or ros2.mcap beside the policy.")]
    Export(Export),
    /// Learn a task with several seeds and settings, and compare
    #[command(after_help = SWEEP_EXAMPLES)]
    Sweep(Sweep),
    /// Draw every figure of the paper, and check its claims
    #[command(after_help = REPRODUCE_EXAMPLES)]
    Reproduce(Reproduce),
    /// Compare the learning methods on every shipped task
    #[command(after_help = BENCHMARK_EXAMPLES)]
    Benchmark(Benchmark),
    /// Say what is in a run, task, policy or MCAP log; several runs side by side
    #[command(after_help = "\
Examples:
  hpf info runs/cantilever
  hpf info runs/cantilever runs/elsewhere    # side by side, with the keys in which their tasks differ
  hpf info runs/cantilever/log.mcap --json
  hpf info tasks/cantilever.toml")]
    Info(Info),
    /// Rescue what is whole in a truncated or damaged MCAP log
    #[command(after_help = "\
Examples:
  hpf recover runs/cantilever/log.mcap --out rescued.mcap
  hpf recover runs/cantilever/log.mcap       # writes runs/cantilever/log.recovered.mcap

Kept: every message of every whole chunk, of a cut one as far as it goes, metadata and attachments. Left out: chunks whose
checksum is wrong. The file that is read is never written.")]
    Recover(Recover),
    /// Write a commented task file to start from
    #[command(after_help = "\
Examples:
  hpf init reach                             # writes reach.toml
  hpf init wall --out press.toml             # a task named press
  hpf init process --out arm.toml            # and arm.py, the program that makes the rollouts
  hpf init via_point --out - | head")]
    Init(init::Init),
    /// Write the JSON schema of the task file, for editors
    #[command(after_help = "\
Examples:
  hpf schema --out task.schema.json
  hpf schema | head

An editor with Taplo (VS Code: Even Better TOML) checks and completes a task file whose first line is
  #:schema ./task.schema.json")]
    Schema,
    /// Write the completions of a shell
    #[command(after_help = "\
Examples:
  hpf completions bash --out completions/hpf # for one user: ~/.local/share/bash-completion/completions/hpf
  hpf completions zsh --out completions/_hpf # anywhere in fpath
  hpf completions fish --out completions/hpf.fish
  hpf completions powershell | head          # or: hpf completions powershell >> $PROFILE

Without --out they go to stdout.")]
    Completions(Completions),
    /// Write the manual pages, one per command
    #[command(after_help = "\
Examples:
  hpf manual --out man/man1                  # then: man -M man hpf-learn
  hpf manual --out man/man1 --force          # again, after an update")]
    Manual,
}

/// `hpf learn`
#[derive(Args, Debug)]
pub struct Learn {
    /// Task file (TOML)
    #[arg(value_name = "TASK", required_unless_present = "resume")]
    pub task: Option<PathBuf>,
    /// Policy to start from, such as an imitated one; of the task's axes and bases [default: the bare pull to the goal]
    #[arg(long, value_name = "POLICY|RUN", conflicts_with = "resume")]
    pub from: Option<PathBuf>,
    /// Override a key of the task, typed as in TOML; lists by position, from 0
    #[arg(long, value_name = "KEY.PATH=VALUE", conflicts_with = "resume")]
    pub set: Vec<String>,
    /// Go on with a run that was killed or interrupted, to the same results as if it had not been
    #[arg(long, value_name = "RUN", conflicts_with = "task")]
    pub resume: Option<PathBuf>,
    /// Write report.html with the run: a page to look at and touch, see `hpf report`
    #[arg(long)]
    pub report: bool,
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
    #[arg(long, value_name = "HZ", allow_hyphen_values = true, value_parser = number)]
    pub rate: Option<f64>,
    /// Override a key of the environment: disturbance, contact, sensor, actuator, via_point, cost, accept, rate
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub set: Vec<String>,
    /// Run the controller that a robot runs, in the environment of the task
    #[arg(long)]
    pub controller: bool,
    /// Settings of the controller (TOML): limits, trips, tank, requests and so on [default: no limits, no tank]
    #[arg(long, value_name = "FILE", requires = "controller")]
    pub settings: Option<PathBuf>,
}

/// `hpf plot`
#[derive(Args, Debug)]
pub struct Plot {
    /// Run directories
    #[arg(value_name = "RUN", required = true)]
    pub runs: Vec<PathBuf>,
    /// Form of the figures
    #[arg(long, value_enum, value_name = "FORM", default_value = "png")]
    pub format: Choice<figure::Format>,
    /// Only these figures, such as stiffness,cost [default: all that the runs have in common]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub only: Vec<String>,
}

/// `hpf check`
#[derive(Args, Debug, Default)]
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
    /// Age of the measured force [s] [default: sensor.delay of that task, else one sample]
    #[arg(long, value_name = "S")]
    pub delay: Option<f64>,
    /// Time constant with which the robot follows its command [s] [default: actuator.lag of that task, else 0]
    #[arg(long, value_name = "S")]
    pub lag: Option<f64>,
    /// Cut-off of the force filter of the controller [Hz] [default: no filter]
    #[arg(long, value_name = "HZ")]
    pub cutoff: Option<f64>,
    /// Mass of the tool behind the force sensor [kg or kg m^2] [default: 0]
    #[arg(long, value_name = "KG")]
    pub tool_mass: Option<f64>,
    /// Mass of what the tool touches [kg or kg m^2] [default: 0]
    #[arg(long, value_name = "KG")]
    pub contact_mass: Option<f64>,
    /// Damping of what the tool touches [N s/m or N m s/rad] [default: 0]
    #[arg(long, value_name = "N_S_PER_M")]
    pub contact_damping: Option<f64>,
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
    #[arg(long, value_enum, value_name = "FORM", required_unless_present = "ros2")]
    pub format: Option<Choice<Format>>,
    /// The same as --format ros2
    #[arg(long, conflicts_with = "format")]
    pub ros2: bool,
    /// Scalar of a form for firmware [default: f64]
    #[arg(long, value_enum, value_name = "SCALAR")]
    pub scalar: Option<Choice<Precision>>,
}

/// `hpf sweep`
#[derive(Args, Debug)]
pub struct Sweep {
    /// Task file (TOML)
    #[arg(value_name = "TASK")]
    pub task: PathBuf,
    /// Runs of every setting, each with a seed of its own
    #[arg(long, value_name = "COUNT", default_value_t = 10, value_parser = whole(1..=1000_u32))]
    pub seeds: u32,
    /// Vary a key of the task over these values; several make a grid
    #[arg(long, value_name = "KEY.PATH=VALUE,VALUE...")]
    pub vary: Vec<String>,
    /// Set variants of the task beside each other, each with changes of its own, or none
    #[arg(long, value_name = "NAME: KEY.PATH=VALUE; ...")]
    pub variant: Vec<String>,
    /// Override a key of the task in every run, typed as in TOML; lists by position, from 0
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub set: Vec<String>,
    /// Keep snapshots, log and plots of every run too
    #[arg(long)]
    pub full: bool,
    /// Learn only every N-th run, from the I-th on, and leave the tables to the sweep without this option
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
}

/// `hpf reproduce`
#[derive(Args, Debug)]
pub struct Reproduce {
    /// Runs of every task, each with a seed of its own
    #[arg(long, value_name = "COUNT", default_value_t = 10, value_parser = whole(1..=1000_u32))]
    pub seeds: u32,
    /// Fail where what stands between the marks of this page is not what comes out
    #[arg(long, value_name = "FILE", conflicts_with = "update")]
    pub check: Option<PathBuf>,
    /// Write what comes out between the marks of this page
    #[arg(long, value_name = "FILE")]
    pub update: Option<PathBuf>,
}

/// `hpf benchmark`
#[derive(Args, Debug)]
pub struct Benchmark {
    /// Runs of every method on every task, each with a seed of its own
    #[arg(long, value_name = "COUNT", default_value_t = 10, value_parser = whole(1..=1000_u32))]
    pub seeds: u32,
    /// Most motions of a run, evaluations included
    #[arg(long, value_name = "COUNT", default_value_t = 4000, value_parser = whole(100..=10_000_000_usize))]
    pub motions: usize,
    /// Only these tasks, such as via_point,wall [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub task: Vec<String>,
    /// Add the results to this table of all versions; rows of this version that measure the same are replaced
    #[arg(long, value_name = "FILE")]
    pub history: Option<PathBuf>,
}

/// `hpf info`
#[derive(Args, Debug)]
pub struct Info {
    /// Run directory or summary.json, task (TOML), policy (JSON or binary), log (MCAP) or recording; several must be runs
    #[arg(value_name = "RUN|FILE", required = true)]
    pub files: Vec<PathBuf>,
}

/// `hpf recover`
#[derive(Args, Debug)]
pub struct Recover {
    /// Truncated or damaged log (.mcap, .mcap.partial)
    #[arg(value_name = "LOG")]
    pub log: PathBuf,
}

/// `hpf completions`
#[derive(Args, Debug)]
pub struct Completions {
    /// Shell
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: Shell,
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use clap::error::ErrorKind;

    use super::*;

    /// Words of a shell line, quotes taken off.
    fn words(line: &str) -> Vec<String> {
        let mut words = vec![String::new()];
        let mut is_quoted = false;
        for letter in line.chars() {
            match letter {
                '\'' => is_quoted = !is_quoted,
                ' ' | '\n' if !is_quoted => words.push(String::new()),
                letter => words.last_mut().expect("there is always a word").push(letter),
            }
        }
        words.retain(|word| !word.is_empty());
        words
    }

    #[test]
    fn every_command_that_the_text_of_the_documentation_names_exists_with_its_options() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut pages = vec![root.join("README.md")];
        pages.extend(fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path()));
        let mut count = 0;
        for page in pages.iter().filter(|page| page.extension().is_some_and(|extension| extension == "md")) {
            let text = fs::read_to_string(page).unwrap();
            let spans = text.split('`').skip(1).step_by(2).filter(|span| span.starts_with("hpf "));
            // A form with alternatives or options in brackets is no line to type.
            for span in spans.filter(|span| !["|", " [", "COMMAND"].iter().any(|part| span.contains(part))) {
                count += 1;
                let Err(error) = Arguments::try_parse_from(words(span)) else { continue };
                // A command is often named without its file, and `KIND` takes its place.
                let is_short = matches!(error.kind(), ErrorKind::MissingRequiredArgument | ErrorKind::DisplayHelp)
                    || (error.kind() == ErrorKind::InvalidValue && span.ends_with(|last: char| last.is_uppercase()));
                assert!(is_short, "{}: `{span}`: {error}", page.display());
            }
        }
        assert!(count > 20, "only {count} commands are named");
    }
}
