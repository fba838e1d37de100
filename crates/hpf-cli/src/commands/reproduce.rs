//! `hpf reproduce`: the paper's figures, and its claims beside what comes out here.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::json;

use crate::cli::{Common, Reproduce};
use crate::outcome::Outcome;
use crate::render;
use crate::reproduce::{
    Claim, Study, Variant, claims, difference, json as claims_json, markdown, of_first_seed, over_seeds, placed,
    variants,
};
use crate::terminal::say;
use hpf::failure::Failure;
use hpf::figure::{self, Format};
use hpf::files::{self, in_file, make_folder, read_text};
use hpf::trial;

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
        // What cannot be written is told before minutes of learning, not after.
        None => {
            free(&folder, common.force)?;
            make_folder(&folder)?;
        }
    }
    let first = common.seed.unwrap_or(1);
    let seeds = (first..first.saturating_add(options.seeds.into())).collect();
    let Some(study) = Study::learn(seeds, common.quiet)? else { return Ok(Outcome::Interrupted) };
    let (claims, variants) = (claims(&study)?, variants(&study));
    let block = markdown(&study, &claims, &variants);

    if let Some((path, text)) = page {
        let wanted = placed(&text, &block).map_err(in_file(path))?;
        return judge(path, &text, &wanted, options.update.is_some());
    }
    let files = write(&study, &claims, &variants, &block, &folder)?;
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

/// Refuses a folder that holds something, where it is not to be replaced.
fn free(folder: &Path, force: bool) -> Result<(), Failure> {
    let is_empty = fs::read_dir(folder).map_or(!folder.exists(), |mut entries| entries.next().is_none());
    let refuse = |why: &str| Err(Failure::Input(format!("{} {why}", folder.display())));
    match (is_empty, force) {
        (true, _) => Ok(()),
        (false, true) if folder.join("claims.json").is_file() => Ok(()),
        (false, true) => refuse("is no reproduction: --force does not replace it, pass another --out"),
        (false, false) => {
            refuse("exists and is left as it is; pass --force to replace it, or --out to write elsewhere")
        }
    }
}

/// Writes everything, the tables before the figures that show them.
fn write(
    study: &Study,
    claims: &[Claim],
    variants: &[Claim],
    block: &str,
    folder: &Path,
) -> Result<Vec<String>, Failure> {
    let subject = format!("seed {}", study.seeds[0]);
    let mut names = Vec::new();
    let text = format!("# The paper, reproduced\n\n{block}");
    let json = format!("{:#}\n", claims_json(study, claims, variants));
    for (name, contents) in [("results.csv", study.csv()), ("claims.md", text), ("claims.json", json)] {
        files::write(&folder.join(name), contents)?;
        names.push(name.into());
    }
    names.extend(figure::draw(&of_first_seed(study), &subject, Format::Png, folder)?);
    names.extend(figure::draw(&over_seeds(study), "", Format::Png, folder)?);
    for variant in [Variant::ViaPoint, Variant::Cantilever] {
        let (prepared, trial) = study.first(variant);
        trial::save(trial, prepared, true, &folder.join(variant.name()))?;
        names.push(format!("{}/", variant.name()));
    }
    Ok(names)
}
