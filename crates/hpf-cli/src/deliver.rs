//! Delivers one result where the user wants it, and reads a task with its notes printed.

use std::path::Path;

use hpf::failure::Failure;
use hpf::files::{self, LoadedTask, place};
use serde_json::Value;

use crate::cli::Common;
use crate::outcome::Outcome;
use crate::terminal::{say, say_bytes, tell};

/// Reads a task as [`files::read_task`], and prints its notes.
///
/// # Errors
/// As there.
pub fn read_task(path: &Path, overrides: &[String]) -> Result<LoadedTask, Failure> {
    let loaded = files::read_task(path, overrides)?;
    loaded.notes.iter().for_each(|note| tell(&format!("note: {note}")));
    Ok(loaded)
}

/// Puts one result where the user wants it: into the file `--out` or `default`, on stdout for `-` and where there is no
/// default. `report` describes the file written, as text and as JSON; without a description its name and size are printed.
///
/// # Errors
/// [`Failure::Input`] where something is there or stdout is wanted twice; [`Failure::Work`] from the system.
pub fn deliver(
    common: &Common,
    default: Option<&Path>,
    bytes: &[u8],
    report: impl FnOnce(&Path) -> Option<(String, Value)>,
) -> Result<Outcome, Failure> {
    let target = match common.out.as_deref().or(default) {
        Some(target) if target != Path::new("-") => target,
        target => {
            if target.is_some() && common.json {
                return Err(Failure::Input("--out - and --json both want stdout: name a file".into()));
            }
            say_bytes(bytes)?;
            return Ok(Outcome::Done);
        }
    };
    place(target, bytes, common.force)?;
    match report(target) {
        Some((_, object)) if common.json => say(&format!("{object:#}\n"))?,
        Some((text, _)) => say(&text)?,
        None => say(&format!("{}: {} bytes\n", target.display(), bytes.len()))?,
    }
    Ok(Outcome::Done)
}
