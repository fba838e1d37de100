//! `hpf benchmark`: how many motions and seconds each method needs on every task.

use std::path::PathBuf;
use std::time::Instant;

use crate::benchmark::{Study, figures, json, markdown};
use crate::cli::{Benchmark, Common};
use crate::outcome::Outcome;
use crate::terminal::say;
use hpf::failure::Failure;
use hpf::figure::{self, Format};
use hpf::files::{self, make_folder};

/// Runs `hpf benchmark`.
pub fn benchmark(options: &Benchmark, common: &Common) -> Result<Outcome, Failure> {
    let started = Instant::now();
    let folder = common.out.clone().unwrap_or_else(|| PathBuf::from("runs/benchmark"));
    let page = folder.join("benchmarks.md");
    if page.exists() && !common.force {
        let place = page.display();
        return Err(Failure::Input(format!(
            "{place} exists and is left as it is; pass --force to replace it, or --out to write elsewhere"
        )));
    }
    // What cannot be written is told before minutes of learning, not after.
    make_folder(&folder)?;
    let first = common.seed.unwrap_or(1);
    let seeds = (first..first.saturating_add(options.seeds.into())).collect();
    let Some(study) = Study::learn(&options.task, seeds, options.motions, common.quiet)? else {
        return Ok(Outcome::Interrupted);
    };
    let seconds = started.elapsed().as_secs_f64();
    let object = json(&study, seconds);
    files::write(&folder.join("benchmarks.json"), format!("{object:#}\n"))?;
    let text = markdown(&study, seconds);
    files::write(&page, &text)?;
    figure::draw(&figures(&study), "", Format::Png, &folder.join("images/benchmarks"))?;
    if common.json {
        say(&format!("{object:#}\n"))?;
    } else {
        let tables = text.split_once("\n## ").map_or("", |(_, tables)| tables);
        let tables: String = tables.lines().filter(|line| !line.starts_with("![")).map(|l| format!("{l}\n")).collect();
        say(&format!("{tables}\n{seconds:.1} s; written to {}\n", page.display()))?;
    }
    Ok(Outcome::Done)
}
