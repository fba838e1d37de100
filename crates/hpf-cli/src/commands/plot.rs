//! `hpf plot`: the figures of a run, or of several runs together, from their tables.

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::cli::{Common, Plot};
use crate::outcome::Outcome;
use crate::render;
use crate::terminal::say;
use hpf::failure::Failure;
use hpf::figure::{self, Drawing, MOST_SERIES, Named};
use hpf::results::Run;

/// The least likeness of two names at which one is suggested for the other (0 to 1).
const LEAST_LIKENESS: f64 = 0.75;

/// Runs `hpf plot`.
pub fn plot(options: &Plot, common: &Common) -> Result<Outcome, Failure> {
    let folder = folder(&options.runs, common)?;
    let runs = options.runs.iter().map(|path| Run::load(path)).collect::<Result<Vec<_>, _>>()?;
    let names = names(&options.runs);
    let named: Vec<_> = names.into_iter().zip(&runs).map(|(name, run)| Named { name, run }).collect();
    comparable(&named)?;
    let (figures, subject) = match runs.as_slice() {
        [run] => (figure::figures(run), run.task.name.clone()),
        _ => (figure::overlaid(&named), format!("{} runs", runs.len())),
    };
    let figures = chosen(figures, &options.only)?;
    let standing: Vec<String> = figures
        .iter()
        .map(|drawing| format!("{}.{}", drawing.name, options.format.0.extension()))
        .filter(|name| folder.join(name).exists())
        .collect();
    if !standing.is_empty() && !common.force {
        return Err(Failure::Input(format!(
            "{} holds {} already and is left as it is; pass --force to replace them, or --out to write elsewhere",
            folder.display(),
            standing.join(", ")
        )));
    }
    let files = figure::draw(&figures, &subject, options.format.0, &folder)?;
    if common.json {
        let object = json!({ "format": "hpf-plots", "version": 1, "directory": folder, "files": files });
        say(&format!("{object:#}\n"))?;
    } else {
        say(&format!("written to {}:\n{}", folder.display(), render::wrapped(&files)))?;
    }
    Ok(Outcome::Done)
}

/// Where the figures go: to the one run, where `--out` says nothing else.
fn folder(runs: &[PathBuf], common: &Common) -> Result<PathBuf, Failure> {
    match (&common.out, runs) {
        (Some(out), _) => Ok(out.clone()),
        (None, [run]) => Ok(run.join("plots")),
        (None, _) => {
            Err(Failure::Input("figures of several runs belong to none of them: say where with --out DIR".into()))
        }
    }
}

/// What each run is called in figures: the last parts of its path that distinguish it from the others.
pub(super) fn names(paths: &[PathBuf]) -> Vec<String> {
    let ending = |path: &Path, parts: usize| {
        let all: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
        all[all.len().saturating_sub(parts)..].join("/")
    };
    let longest = paths.iter().map(|path| path.components().count()).max().unwrap_or(1);
    let differ = |parts: &usize| {
        let mut names: Vec<_> = paths.iter().map(|path| ending(path, *parts)).collect();
        names.sort();
        names.windows(2).all(|pair| pair[0] != pair[1])
    };
    let parts = (1..=longest).find(differ).unwrap_or(longest);
    paths.iter().map(|path| ending(path, parts)).collect()
}

/// Refuses runs that cannot be in one figure.
fn comparable(runs: &[Named<'_>]) -> Result<(), Failure> {
    if runs.len() > MOST_SERIES {
        let message = format!("{} runs: at most {MOST_SERIES} can be distinguished in one figure", runs.len());
        return Err(Failure::Input(message));
    }
    let axes = |named: &Named<'_>| {
        let axes = named.run.task.axis.iter().map(|axis| format!("{} [{}]", axis.name, axis.unit.symbol()));
        axes.collect::<Vec<_>>().join(", ")
    };
    if let Some(twice) = runs.iter().enumerate().find(|(i, named)| runs[..*i].iter().any(|one| one.name == named.name))
    {
        return Err(Failure::Input(format!("{} is named twice", twice.1.name)));
    }
    match runs.iter().find(|named| axes(named) != axes(&runs[0])) {
        None => Ok(()),
        Some(other) => Err(Failure::Input(format!(
            "runs of different axes have no figure in common: {} has {}, {} has {}",
            runs[0].name,
            axes(&runs[0]),
            other.name,
            axes(other)
        ))),
    }
}

/// The figures named in `only`, in the order of `figures`; all, where it names none.
fn chosen<'r>(figures: Vec<Drawing<'r>>, only: &[String]) -> Result<Vec<Drawing<'r>>, Failure> {
    let known: Vec<&str> = figures.iter().map(|drawing| drawing.name.as_str()).collect();
    if let Some(name) = only.iter().find(|name| !known.contains(&name.as_str())) {
        let likeness = |known: &&str| strsim::jaro_winkler(name, known);
        let nearest = known.iter().copied().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        let hint = nearest.filter(|near| likeness(near) >= LEAST_LIKENESS);
        let hint = hint.map(|near| format!(", did you mean `{near}`?")).unwrap_or_else(|| ";".into());
        return Err(Failure::Input(format!(
            "--only: there is no figure `{name}`{hint} there are {}",
            known.join(", ")
        )));
    }
    let is_chosen = |drawing: &Drawing<'_>| only.is_empty() || only.contains(&drawing.name);
    Ok(figures.into_iter().filter(is_chosen).collect())
}
