//! `hpf report`: runs as one page that shows them and lets them be touched.

use std::path::{Path, PathBuf};

use hpf::failure::Failure;
use hpf::page::{self, Exhibit};
use hpf::words::typed;
use serde_json::json;

use super::plot::names;
use crate::cli::Common;
use crate::cli::report::Report;
use crate::deliver::deliver;
use crate::outcome::Outcome;

/// The page of a run, in its directory.
pub const NAME: &str = "report.html";

/// Runs `hpf report`.
pub fn report(options: &Report, common: &Common) -> Result<Outcome, Failure> {
    let default = match options.runs.as_slice() {
        [run] if run.is_dir() => Some(run.join(NAME)),
        _ if common.out.is_some() => None,
        [task] => Some(PathBuf::from(task.file_name().unwrap_or_default()).with_extension("html")),
        _ => {
            let message = "the page of several runs belongs to none of them: say where with --out FILE.html";
            return Err(Failure::Input(message.into()));
        }
    };
    let html = of(&options.runs)?;
    deliver(common, default.as_deref(), html.as_bytes(), |target| {
        let (path, bytes) = (target.display().to_string(), html.len());
        let object = json!({ "format": "hpf-report", "version": 1, "file": path, "bytes": bytes });
        Some((format!("{path}: {bytes} bytes; open it in a browser\n"), object))
    })
}

/// The page of `runs`.
///
/// # Errors
/// As [`Exhibit::load`] and [`page::html`].
pub fn of(runs: &[PathBuf]) -> Result<String, Failure> {
    let names = names(runs);
    if let Some((_, twice)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
        return Err(Failure::Input(format!("{twice} is named twice")));
    }
    let load = |(path, name): (&PathBuf, String)| Exhibit::load(path, name);
    let exhibits = runs.iter().zip(names).map(load).collect::<Result<Vec<_>, _>>()?;
    let words: Vec<String> = runs.iter().map(|path| shown(path)).collect();
    page::html(&exhibits, &format!("hpf report {}", words.join(" ")))
}

fn shown(path: &Path) -> String {
    typed(path.display())
}
