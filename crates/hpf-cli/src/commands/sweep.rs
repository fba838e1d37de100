//! `hpf sweep`: a task learned with several seeds and settings; a table, a summary and figures of all.

use std::path::PathBuf;
use std::time::Instant;

use hpf::failure::Failure;
use hpf::sinks::combined;
use hpf_studies::sweep::{self, Plan, Request};
use serde_json::json;

use crate::cli::{Common, Sweep};
use crate::outcome::Outcome;
use crate::progress::{OnTerminal, Tally};
use crate::sweep_table;
use crate::terminal::say;

/// More failures than this are counted, not shown; the table has all.
const MOST_SHOWN: usize = 10;

/// Runs `hpf sweep`.
pub fn sweep(options: &Sweep, common: &Common) -> Result<Outcome, Failure> {
    let started = Instant::now();
    let terminal = OnTerminal::<Tally>::new(common.quiet);
    let request = Request {
        task: options.task.clone(),
        seeds: options.seeds,
        first_seed: common.seed,
        vary: options.vary.clone(),
        set: options.set.clone(),
    };
    let plan = Plan::new(&request, &terminal)?;
    let folder = common.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(format!("{}-sweep", plan.task)));
    let swept = sweep::sweep(&plan, &folder, options.full, common.force, &terminal);
    terminal.finish();
    let swept = swept?;

    let place = folder.display().to_string();
    if common.json {
        let mut object = swept.summary;
        object["directory"] = json!(folder);
        object["files"] = json!(swept.files);
        say(&format!("{object:#}\n"))?;
    } else {
        let seconds = started.elapsed().as_secs_f64();
        say(&sweep_table::render(&swept.summary, swept.kept, seconds, &place, &swept.files))?;
    }
    if swept.interrupted {
        return Ok(Outcome::Interrupted);
    }
    combined(&swept.failures, &place)?;
    let failed: Vec<String> = swept.failed.iter().map(|(run, why)| format!("{run}: {why}")).collect();
    let shown = failed.iter().take(MOST_SHOWN).cloned().collect::<Vec<_>>().join("\n");
    match (failed.is_empty(), swept.missed) {
        (false, _) => Err(Failure::Work(format!("{} of {} runs failed\n{}", failed.len(), plan.jobs.len(), shown))),
        (true, 0) => Ok(Outcome::Done),
        (true, _) => Ok(Outcome::Missed),
    }
}
