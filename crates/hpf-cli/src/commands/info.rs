//! `hpf info`: what is in this file, and how do these runs compare?

use std::io::Read as _;
use std::path::{Path, PathBuf};

use hpf_core::packed::{MAGIC, Packed};
use serde_json::{Value, json};

use crate::cli::{Check, Common, Info};
use crate::comparison::{Comparison, Side};
use crate::deliver::read_task;
use crate::outcome::Outcome;
use crate::render;
use crate::terminal::say;
use hpf::failure::Failure;
use hpf::files::{in_file, read_bytes, read_text, verify_run};
use hpf::log::{self, Ending};
use hpf::recordings::{Mapping, Saw};
use hpf::words::typed;
use hpf::{nodes, packed, recordings};

/// Runs `hpf info`.
pub fn info(options: &Info, common: &Common) -> Result<Outcome, Failure> {
    match options.files.as_slice() {
        [file] => one(file, common),
        runs => compare(runs, common),
    }
}

fn one(path: &Path, common: &Common) -> Result<Outcome, Failure> {
    // The folder of a bag is no run.
    let is_bag = path.join("metadata.yaml").is_file() && !path.join("summary.json").is_file();
    if is_bag {
        let (file, _) = recordings::bytes_of(path)?;
        return one(&file, common);
    }
    if let Some(file) = summary_of(path) {
        let summary = read_summary(&file)?;
        return answer(common, &summary, || render::summary(&summary));
    }
    if begins_with(path, &MAGIC) {
        let bytes = read_bytes(path)?;
        let skill = Packed::parse(&bytes).map_err(in_file(path))?;
        return answer(common, &packed::to_json(&skill), || packed::text(&skill));
    }
    if begins_with(path, log::MAGIC) || is_named_as_log(path) {
        let contents = log::summarize(path).map_err(in_file(path))?;
        let hint = match contents.ending {
            Ending::Complete => imitate_hint(path, &contents),
            _ => format!("\nnext: hpf recover {}\n", typed(path.display())),
        };
        return answer(common, &contents.to_json(), || format!("{contents}{hint}"));
    }
    if is_recording(path) {
        let (file, bytes) = recordings::bytes_of(path)?;
        let saw =
            recordings::inspect(&bytes, &Mapping::default()).map_err(|refusal| recordings::refused(&file, &refusal))?;
        return answer(common, &saw_in_json(&saw, path), || {
            let next = saw
                .command(&path.display().to_string())
                .map_or(String::new(), |command| format!("\nnext: {command}\n"));
            format!("{saw}{next}")
        });
    }
    super::check::check(&Check { file: path.to_owned(), ..Check::default() }, common)
}

/// Largest bag that is looked into for the command that may read it [bytes].
const MAX_INSPECTED: u64 = 256 << 20;

/// The command that may read a bag of others.
fn imitate_hint(path: &Path, contents: &log::Summary) -> String {
    let is_small = path.metadata().is_ok_and(|metadata| metadata.len() <= MAX_INSPECTED);
    if contents.metadata.contains_key("hpf.run") || !is_small {
        return String::new();
    }
    let saw = read_bytes(path).ok().and_then(|bytes| recordings::inspect(&bytes, &Mapping::default()).ok());
    let command = saw.and_then(|saw| saw.command(&path.display().to_string()));
    command.map_or(String::new(), |command| format!("\nnext: {command}\n"))
}

/// Whether the file is a recording: by its first bytes, or by an ending that tables have.
fn is_recording(path: &Path) -> bool {
    const TABLES: [&str; 6] = ["csv", "tsv", "txt", "dat", "asc", "bag"];
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let magics: [&[u8]; 5] = [b"\x93NUMPY", b"PK\x03\x04", b"SQLite format 3", b"\x89HDF", b"PAR1"];
    ending.is_some_and(|ending| TABLES.contains(&ending.as_str()))
        || magics.iter().any(|magic| begins_with(path, magic))
}

fn saw_in_json(saw: &Saw, path: &Path) -> Value {
    let number = |range: Option<(f64, f64)>| range.map_or(Value::Null, |(low, high)| json!([low, high]));
    let columns = saw
        .columns
        .iter()
        .map(|column| json!({ "name": column.name, "range": number(column.range), "role": column.role }));
    let topics = saw
        .topics
        .iter()
        .map(|topic| json!({ "name": topic.name, "type": topic.kind, "count": topic.count, "is_read": topic.is_read }));
    json!({
        "format": "hpf-recording-info",
        "version": 1,
        "kind": saw.kind,
        "rows": saw.rows,
        "columns": columns.collect::<Vec<_>>(),
        "topics": topics.collect::<Vec<_>>(),
        "command": saw.command(&path.display().to_string()),
    })
}

fn answer(common: &Common, object: &Value, text: impl FnOnce() -> String) -> Result<Outcome, Failure> {
    say(&if common.json { format!("{object:#}\n") } else { text() })?;
    Ok(Outcome::Done)
}

/// Several runs side by side.
fn compare(runs: &[PathBuf], common: &Common) -> Result<Outcome, Failure> {
    let sides = runs.iter().map(|path| {
        let Some(file) = summary_of(path) else {
            return Err(in_file(path)("this is no run; several files are compared only where each is a run directory"));
        };
        let task = read_task(&file.with_file_name("task.toml"), &[])?.task;
        let task = serde_json::to_value(&task).map_err(in_file(path))?;
        Ok(Side { name: path.display().to_string(), summary: read_summary(&file)?, task })
    });
    let comparison = Comparison::new(sides.collect::<Result<_, _>>()?);
    answer(common, &comparison.to_json(), || comparison.to_string())
}

/// The summary that is meant, where a run is: the one named, or that of the run directory named.
fn summary_of(path: &Path) -> Option<PathBuf> {
    let is_summary = path.file_name().is_some_and(|name| name == "summary.json");
    if path.is_dir() { Some(path.join("summary.json")) } else { is_summary.then(|| path.to_owned()) }
}

fn read_summary(file: &Path) -> Result<Value, Failure> {
    let summary: Value = serde_json::from_str(&read_text(file)?).map_err(in_file(file))?;
    if summary["format"] != json!("hpf-summary") || summary["version"] != json!(1) {
        return Err(in_file(file)("this is not a summary of version 1"));
    }
    verify_run(file)?;
    Ok(summary)
}

fn begins_with(path: &Path, magic: &[u8]) -> bool {
    let mut start = Vec::new();
    let read = nodes::open(path).and_then(|file| file.take(magic.len() as u64).read_to_end(&mut start));
    read.is_ok() && start == magic
}

fn is_named_as_log(path: &Path) -> bool {
    let name = path.to_string_lossy();
    name.ends_with(".mcap") || name.ends_with(".mcap.partial")
}
