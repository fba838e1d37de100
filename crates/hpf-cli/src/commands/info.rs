//! `hpf info`: what is in this file?

use std::path::Path;

use serde_json::{Value, json};

use crate::cli::{Check, Common, Info};
use crate::failure::{Failure, Outcome};
use crate::files::{in_file, read_text, say};
use crate::{log, render};

/// Runs `hpf info`.
pub fn info(options: &Info, common: &Common) -> Result<Outcome, Failure> {
    let path = &options.file;
    let has_extension = |name: &str| path.extension().is_some_and(|extension| extension == name);
    if path.is_dir() {
        return summary(&path.join("summary.json"), common);
    }
    if path.file_name().is_some_and(|name| name == "summary.json") {
        return summary(path, common);
    }
    if has_extension("mcap") || path.to_string_lossy().ends_with(".mcap.partial") {
        let contents = log::summarize(path).map_err(in_file(path))?;
        say(&if common.json { format!("{:#}\n", contents.to_json()) } else { contents.to_string() })?;
        return Ok(Outcome::Done);
    }
    super::check::check(&Check { file: path.clone(), set: Vec::new(), rate: None, delay: None, load: None }, common)
}

fn summary(file: &Path, common: &Common) -> Result<Outcome, Failure> {
    let summary: Value = serde_json::from_str(&read_text(file)?).map_err(in_file(file))?;
    if summary["format"] != json!("hpf-summary") || summary["version"] != json!(1) {
        return Err(in_file(file)("this is not a summary of version 1"));
    }
    say(&if common.json { format!("{summary:#}\n") } else { render::summary(&summary) })?;
    Ok(Outcome::Done)
}
