//! The arguments of `hpf report`.

use std::path::PathBuf;

use clap::Args;

/// What the help ends with.
pub const HELP: &str = "\
Examples:
  hpf report runs/cantilever                              # writes runs/cantilever/report.html
  hpf report runs/via_point runs/higher --out both.html   # side by side
  hpf report tasks/*.toml --out playground/index.html     # nothing learned yet: the page learns

One file that opens from disk, asks no network for anything and is below 3 MB. The tool can be pulled in it, against the
controller that a robot runs; start, goal, via points and the wall can be dragged, and `auto` learns the moved task in the page,
to the bytes of `hpf learn`.";

/// `hpf report`
#[derive(Args, Debug)]
pub struct Report {
    /// Run directories, or task files (TOML) that are not learned yet; at most 16
    #[arg(value_name = "RUN|TASK", required = true)]
    pub runs: Vec<PathBuf>,
}
