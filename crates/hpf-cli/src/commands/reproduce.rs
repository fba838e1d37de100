//! `hpf reproduce`: the paper's figures, and its claims beside what comes out here.

use std::path::{Path, PathBuf};
use std::time::Instant;

use hpf::failure::Failure;
use hpf::files::{self, in_file, make_folder, read_text};
use hpf_studies::reproduce::{
    Claim, Study, claims, difference, json as claims_json, markdown, placed, refuse_occupied, variants, write,
};
use serde_json::json;

use crate::cli::{Common, Reproduce};
use crate::outcome::Outcome;
use crate::progress::{OnTerminal, Tally};
use crate::render;
use crate::terminal::say;

/// Runs `hpf reproduce`.
pub fn reproduce(options: &Reproduce, common: &Common) -> Result<Outcome, Failure> {
    let started = Instant::now();
    if options.check.is_some() || options.update.is_some() {
        let meaningless = [("--out", common.out.is_some()), ("--force", common.force), ("--json", common.json)];
        if let Some((option, _)) = meaningless.into_iter().find(|(_, given)| *given) {
            return Err(Failure::Input(format!("{option} means nothing to --check and --update: leave it out")));
        }
    }
    let folder = common.out.clone().unwrap_or_else(|| PathBuf::from("runs/reproduction"));
    let page = options.check.as_ref().or(options.update.as_ref());
    let page = page.map(|path| Ok::<_, Failure>((path, read_text(path)?))).transpose()?;
    match &page {
        // A page without marks is refused before anything is learned.
        Some((path, text)) => drop(placed(text, "").map_err(in_file(path))?),
        // What cannot be written is reported before minutes of learning, not after.
        None => {
            refuse_occupied(&folder, common.force)?;
            make_folder(&folder)?;
        }
    }
    let first = common.seed.unwrap_or(1);
    let seeds = (first..first.saturating_add(options.seeds.into())).collect();
    let terminal = OnTerminal::<Tally>::new(common.quiet);
    let study = Study::learn(seeds, &terminal);
    terminal.finish();
    let Some(study) = study? else { return Ok(Outcome::Interrupted) };
    let (claims, variants) = (claims(&study)?, variants(&study));
    let block = markdown(&study, &claims, &variants);

    if let Some((path, text)) = page {
        let wanted = placed(&text, &block).map_err(in_file(path))?;
        return judge(path, &text, &wanted, options.update.is_some());
    }
    let files = write(&study, (&claims, &variants), &block, &folder, &terminal)?;
    if common.json {
        let mut object = claims_json(&study, &claims, &variants);
        object["directory"] = json!(folder);
        object["files"] = json!(files);
        say(&format!("{object:#}\n"))?;
    } else {
        let verdict = |claim: &Claim| {
            let word = if claim.holds == Some(true) { "holds" } else { "NOT" };
            format!("{word:<6} {}: {}\n       {}\n", claim.place, claim.says, claim.ours)
        };
        let verdicts: String = claims.iter().map(verdict).collect();
        let (seconds, place) = (started.elapsed().as_secs_f64(), folder.display());
        say(&format!("{verdicts}\n{seconds:.1} s; written to {place}:\n{}", render::wrapped(&files)))?;
    }
    Ok(if study.meets_targets() { Outcome::Done } else { Outcome::Missed })
}

/// Compares a page with what it should be, or makes it so.
fn judge(path: &Path, text: &str, wanted: &str, update: bool) -> Result<Outcome, Failure> {
    let place = path.display();
    match difference(text, wanted) {
        None => say(&format!("{place} is current\n"))?,
        Some((line, _, _)) if update => {
            files::write(path, wanted)?;
            say(&format!("{place} is now current, from line {line} on\n"))?;
        }
        Some((line, is, should)) => {
            return Err(Failure::Work(format!(
                "{place}:{line}: this is not what comes out now; `hpf reproduce --update {place}` writes it\n  is:        \
                 {is}\n  should be: {should}"
            )));
        }
    }
    Ok(Outcome::Done)
}
