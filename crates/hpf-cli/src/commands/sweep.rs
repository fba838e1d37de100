//! `hpf sweep`: a task learned with several seeds and settings; a table, a summary and figures of all.

use std::path::PathBuf;
use std::time::Instant;

use hpf::failure::Failure;
use hpf::sinks::combined;
use hpf_studies::sweep::{self, Plan, Request, SweptShard};
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
        variants: options.variant.clone(),
        set: options.set.clone(),
    };
    let plan = Plan::new(&request, &terminal)?;
    let folder = common.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(format!("{}-sweep", plan.task)));
    let place = folder.display().to_string();
    if let Some(shard) = options.shard {
        let swept = sweep::sweep_shard(&plan, shard, &folder, options.full, common.force, &terminal);
        terminal.finish();
        return of_a_shard(&swept?, &place, common.json);
    }
    let swept = sweep::sweep(&plan, &folder, options.full, common.force, &terminal);
    terminal.finish();
    let swept = swept?;

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
    if !swept.failed.is_empty() {
        return Err(of_failed(&swept.failed, plan.jobs.len()));
    }
    Ok(if swept.missed == 0 { Outcome::Done } else { Outcome::Missed })
}

/// What became of a shard.
fn of_a_shard(swept: &SweptShard, place: &str, is_json: bool) -> Result<Outcome, Failure> {
    if is_json {
        let failed: Vec<&str> = swept.failed.iter().map(|(run, _)| run.as_str()).collect();
        let object = json!({ "directory": place, "runs": swept.runs, "kept": swept.kept, "failed": failed });
        say(&format!("{object:#}\n"))?;
    } else {
        let kept = if swept.kept > 0 { format!(", {} of them before", swept.kept) } else { String::new() };
        let learned = swept.runs - swept.failed.len();
        let sentence = if swept.interrupted {
            format!("ended before all {} runs of the shard were learned\n", swept.runs)
        } else {
            format!("learned {learned} of {} runs of the shard{kept}\n", swept.runs)
        };
        say(&format!("{sentence}next: the same command without --shard, once all shards are in {}\n", place))?;
    }
    match () {
        () if swept.interrupted => Ok(Outcome::Interrupted),
        () if !swept.failed.is_empty() => Err(of_failed(&swept.failed, swept.runs)),
        () => Ok(Outcome::Done),
    }
}

fn of_failed(failed: &[(String, String)], runs: usize) -> Failure {
    let shown: Vec<String> = failed.iter().take(MOST_SHOWN).map(|(run, why)| format!("{run}: {why}")).collect();
    Failure::Work(format!("{} of {runs} runs failed\n{}", failed.len(), shown.join("\n")))
}
