//! `hpf benchmark`: how many motions and seconds each method needs on every task.

use std::path::PathBuf;
use std::time::Instant;

use hpf::failure::Failure;
use hpf::figure::{self, Format};
use hpf::files::{self, make_folder};
use hpf_studies::benchmark::{History, Study, figures, json, markdown};

use crate::cli::{Benchmark, Common};
use crate::outcome::Outcome;
use crate::progress::{OnTerminal, Tally};
use crate::terminal::say;

/// The version whose results a history gets.
const VERSION: &str = env!("CARGO_PKG_VERSION");

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
    // What cannot be read or written is reported before minutes of learning, not after.
    let history = options.history.as_deref().map(|path| Ok::<_, Failure>((path, History::read(path)?))).transpose()?;
    make_folder(&folder)?;
    let first = common.seed.unwrap_or(1);
    let seeds = (first..first.saturating_add(options.seeds.into())).collect();
    let terminal = OnTerminal::<Tally>::new(common.quiet);
    let study = Study::learn(&options.task, seeds, options.motions, &terminal);
    terminal.finish();
    let Some(study) = study? else { return Ok(Outcome::Interrupted) };
    let seconds = started.elapsed().as_secs_f64();
    let object = json(&study, seconds);
    files::write(&folder.join("benchmarks.json"), format!("{object:#}\n"))?;
    let text = markdown(&study, seconds);
    files::write(&page, &text)?;
    figure::draw(&figures(&study), "", Format::Png, &folder.join("images/benchmarks"))?;
    if let Some((path, mut history)) = history {
        history.add(&study, VERSION);
        history.write(path)?;
    }
    if common.json {
        say(&format!("{object:#}\n"))?;
    } else {
        let tables = text.split_once("\n## ").map_or("", |(_, tables)| tables);
        let tables: String = tables.lines().filter(|line| !line.starts_with("![")).map(|l| format!("{l}\n")).collect();
        say(&format!("{tables}\n{seconds:.1} s; written to {}\n", page.display()))?;
    }
    Ok(Outcome::Done)
}
