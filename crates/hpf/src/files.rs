//! Reading tasks and policies, writing results: every message names the file.

use core::fmt::Display;
use std::fs;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf, is_separator};

use hpf_sim::environment::Disturbance;
use hpf_sim::environment::disturbance::Samples;
use hpf_sim::task::{Environment, MAX_TASK_BYTES, Process, Task};
use hpf_sim::{Policy, TableEnd};
use serde_json::Value;
use sha2::{Digest as _, Sha256};

use crate::failure::{Failure, in_text};
use crate::{nodes, overrides};

/// Largest data file read [bytes]: the longest trajectory of the most axes, in full digits.
const MAX_BYTES: u64 = 2 << 30;

/// Most that is read of a device or a pipe [bytes]: it states no length, and may never end.
const MAX_STREAM_BYTES: u64 = 64 << 20;

/// The policy of a run.
const POLICY: &str = "policy.json";
/// The result of a run.
const SUMMARY: &str = "summary.json";

/// A task as it will run.
pub struct LoadedTask {
    /// The task, tables read.
    pub task: Task,
    /// The text it comes from, overrides applied.
    pub text: String,
    /// What was mended in what it reads.
    pub notes: Vec<String>,
}

impl LoadedTask {
    /// SHA-256 of what decides the results: the text, of a task that a process runs without the keys that say how its
    /// rollouts are made ([`Process::HOW`]).
    pub fn sha256(&self) -> String {
        match &self.task.environment {
            None => sha256(&self.text),
            Some(_) => {
                let text = overrides::without(&self.text, "environment", &Process::HOW);
                sha256(&text.expect("what was read as TOML is TOML"))
            }
        }
    }
}

/// Puts the name of a file before an error of the data in it.
pub fn in_file<E: Display>(path: &Path) -> impl FnOnce(E) -> Failure {
    move |error| Failure::Input(format!("{}: {error}", path.display()))
}

/// Puts what could not be written before an error of the system.
pub fn while_writing<E: Display>(path: &Path) -> impl FnOnce(E) -> Failure {
    move |error| Failure::Work(format!("cannot write {}: {error}", path.display()))
}

/// Reads a text file.
///
/// # Errors
/// [`Failure::Input`] for a file that is missing, a directory, too large, or not text.
pub fn read_text(path: &Path) -> Result<String, Failure> {
    read_limited(path, MAX_BYTES)
}

/// Reads a file that is no text.
///
/// # Errors
/// [`Failure::Input`] for a file that is missing, a directory, or too large.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    read_bytes_limited(path, MAX_BYTES)
}

fn read_bytes_limited(path: &Path, limit: u64) -> Result<Vec<u8>, Failure> {
    let say = |what: String| Failure::Input(format!("{}: {what}", path.display()));
    let file = nodes::open(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => say("there is no such file".into()),
        _ => say(error.to_string()),
    })?;
    let metadata = file.metadata().map_err(|error| say(error.to_string()))?;
    let is_stream = !metadata.is_file() && limit > MAX_STREAM_BYTES;
    let (limit, of) = if is_stream { (MAX_STREAM_BYTES, " of a device or a pipe") } else { (limit, "") };
    let refuse = || Err(say(format!("more than {limit} bytes, which is the most that is read{of}")));
    if metadata.len() > limit {
        return refuse();
    }
    // Files of the system say that they are empty, and some grow: what is read is what counts.
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|error| say(error.to_string()))?;
    if bytes.len() as u64 > limit { refuse() } else { Ok(bytes) }
}

/// The text of a file of at most `limit` bytes.
pub fn read_limited(path: &Path, limit: u64) -> Result<String, Failure> {
    let bytes = read_bytes_limited(path, limit)?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = valid.iter().filter(|byte| **byte == b'\n').count() + 1;
        let column = valid.iter().rev().take_while(|byte| **byte != b'\n').count() + 1;
        Failure::Input(format!("{}:{line}:{column}: this is not text (UTF-8)", path.display()))
    })
}

/// Reads and checks a task file, applies `overrides` (each `key.path=value`), and reads its tables.
///
/// # Errors
/// [`Failure`] with every mistake of the file and its place.
pub fn read_task(path: &Path, overrides: &[String]) -> Result<LoadedTask, Failure> {
    let text = read_limited(path, MAX_TASK_BYTES as u64)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parse_task(text, &path.display().to_string(), folder, overrides)
}

/// [`read_task`] of a text that is called `name`; the files it names lie in `folder`.
///
/// # Errors
/// As for [`read_task`].
pub fn parse_task(mut text: String, name: &str, folder: &Path, overrides: &[String]) -> Result<LoadedTask, Failure> {
    let parse = |text: &str, name: &str| Task::parse(text).map_err(in_text(name));
    let mut task = parse(&text, name)?;
    if !overrides.is_empty() {
        text = overrides::apply(&text, overrides)?;
        task = parse(&text, &format!("{name} (with --set {})", overrides.join(" --set ")))?;
    }
    let mut notes = Vec::new();
    for disturbance in &mut task.disturbance {
        if let Disturbance::Table(table) = disturbance {
            table.samples = read_table(&folder.join(&table.file), &mut notes)?;
        }
    }
    if let Some(Environment::Process(process)) = &mut task.environment {
        let place = folder.join(process.folder.as_deref().unwrap_or_default());
        // Where the working folder is not known, the path stays what it is, and the program says what is missing.
        let place = if place.as_os_str().is_empty() { PathBuf::from(".") } else { place };
        process.folder = Some(std::path::absolute(&place).unwrap_or(place).display().to_string());
    }
    Ok(LoadedTask { task, text, notes })
}

/// Reads a force table: CSV with the header `time_s,force_n`.
fn read_table(path: &Path, notes: &mut Vec<String>) -> Result<Samples, Failure> {
    let text = read_text(path)?;
    notes.extend(open_end(path, &text));
    parse_table(&text).map_err(|(line, column, what)| {
        Failure::Input(format!(
            "{}:{line}:{column}: {what}; rows are a time [s] and a force [N], such as 0.5,10",
            path.display()
        ))
    })
}

/// What is to be said of the table `text` of the file `path` that ends without a line break and may be whole.
pub fn open_end(path: &Path, text: &str) -> Option<String> {
    match TableEnd::of(text) {
        TableEnd::Open { number } => {
            let path = path.display();
            Some(format!("{path}: no line break follows the last number, {number}, which is taken as it stands"))
        }
        TableEnd::Whole | TableEnd::Cut { .. } => None,
    }
}

/// The force table in `text`.
///
/// # Errors
/// Line and column, from 1, and what is wrong there.
pub fn parse_table(text: &str) -> Result<Samples, (u64, usize, String)> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| (1, 1, error.to_string()))?;
    if !header.iter().eq(["time_s", "force_n"]) {
        return Err((1, 1, "the header must be time_s,force_n".into()));
    }
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|error| {
            (error.position().map_or(1, csv::Position::line), 1, "the row does not have two numbers".into())
        })?;
        let line = record.position().map_or(1, csv::Position::line);
        let number = |field: usize| {
            let column = 1 + record.iter().take(field).map(|text| text.len() + 1).sum::<usize>();
            record[field].parse::<f64>().map_err(|_| (line, column, format!("`{}` is not a number", &record[field])))
        };
        rows.push((number(0)?, number(1)?));
        lines.push(line);
    }
    if let TableEnd::Cut { line, column, number } = TableEnd::of(text) {
        let what = format!(
            "the last number, {number}, is shorter than the others and no line break follows: the file may be cut; where \
             it is whole, end it with a line break"
        );
        return Err((line, column, what));
    }
    Samples::new(&rows).map_err(|error| {
        let line = error.row().and_then(|row| lines.get(row)).copied().unwrap_or(1);
        (line, 1, error.to_string())
    })
}

/// Reads and checks a policy file.
///
/// # Errors
/// [`Failure::Input`] that says which of its numbers cannot be.
pub fn read_policy(path: &Path) -> Result<Policy, Failure> {
    let text = read_limited(path, hpf_sim::MAX_POLICY_BYTES as u64)?;
    let policy = Policy::parse(&text).map_err(in_file(path))?;
    refuse_foreign(path, &text)?;
    Ok(policy)
}

/// Refuses a policy that is not the one its run was finished with: costs and measures beside it are of another.
fn refuse_foreign(path: &Path, text: &str) -> Result<(), Failure> {
    let summary = path.with_file_name(SUMMARY);
    if path.file_name().is_none_or(|name| name != POLICY) || summary.symlink_metadata().is_err() {
        return Ok(());
    }
    const REMEDY: &str = "copy the policy out of the run directory to use it as it is";
    let said: Value = serde_json::from_str(&read_text(&summary)?).map_err(|error| {
        in_file(&summary)(format!("damaged, so that its policy cannot be verified: {error}; {REMEDY}"))
    })?;
    match said["policy_sha256"].as_str() {
        Some(said) if said == sha256(text) => Ok(()),
        Some(said) => Err(in_file(path)(format!(
            "this is not the policy that the run was finished with: {SUMMARY} says policy_sha256 {said}; {REMEDY}"
        ))),
        None => Err(in_file(&summary)(format!("no policy_sha256, so that its policy cannot be verified; {REMEDY}"))),
    }
}

/// Refuses the run of `summary`, the file, whose policy is another one than it says.
///
/// # Errors
/// [`Failure::Input`] that names the policy.
pub fn verify_run(summary: &Path) -> Result<(), Failure> {
    let policy = summary.with_file_name(POLICY);
    if !policy.is_file() {
        // A summary that was copied elsewhere is read alone; a run is not whole without its policy.
        let is_alone = !summary.with_file_name("task.toml").is_file();
        return if is_alone {
            Ok(())
        } else {
            Err(in_file(&policy)("it is missing, so that the run cannot be verified"))
        };
    }
    refuse_foreign(&policy, &read_limited(&policy, hpf_sim::MAX_POLICY_BYTES as u64)?)
}

/// The policy file that is meant: the one named, or that of the run directory named.
///
/// # Errors
/// [`Failure::Input`] for a directory without a policy.
pub fn policy_path(path: &Path) -> Result<PathBuf, Failure> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let policy = path.join("policy.json");
    if policy.is_file() {
        return Ok(policy);
    }
    Err(Failure::Input(format!("{}: this is a directory without policy.json, no run", path.display())))
}

/// SHA-256 of a text, in hexadecimal.
pub fn sha256(text: &str) -> String {
    sha256_of_bytes(text.as_bytes())
}

/// SHA-256 of bytes, in hexadecimal.
pub fn sha256_of_bytes(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Writes a file under a temporary name and renames it: under its own name it is whole or not there.
///
/// # Errors
/// [`Failure::Work`] that names the file.
pub fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    nodes::write(path, bytes.as_ref()).map_err(while_writing(path))
}

/// Refuses a target that is no file, or exists and may not be replaced.
///
/// # Errors
/// [`Failure::Input`] that says what to pass.
pub fn refuse_occupied(target: &Path, force: bool) -> Result<(), Failure> {
    let refuse = |why: &str| Err(Failure::Input(format!("{}: {why}", target.display())));
    let ends_as_directory =
        target.as_os_str().as_encoded_bytes().last().is_some_and(|last| is_separator((*last).into()));
    if target.is_dir() || target.file_name().is_none() || ends_as_directory {
        return refuse("this is a directory: name a file with --out");
    }
    if target.symlink_metadata().is_ok() && !force {
        return refuse("it exists and is left as it is; pass --force to replace it, or --out to write elsewhere");
    }
    nodes::replaceable(target).map_err(in_file(target))
}

/// Makes the folder `path` for results, and those above it.
///
/// # Errors
/// [`Failure::Input`] where something else is there; [`Failure::Work`] from the system.
pub fn make_folder(path: &Path) -> Result<(), Failure> {
    if let Some(words) = nodes::in_the_place_of_a_folder(path) {
        return Err(in_file(path)(format!("this is {words}, and results go into a directory: pass another --out")));
    }
    fs::create_dir_all(path).map_err(while_writing(path))
}

/// Writes the file `target` and the folders above it, where nothing is or it may be replaced.
///
/// # Errors
/// As [`refuse_occupied`] and [`write`].
pub fn place(target: &Path, bytes: &[u8], force: bool) -> Result<(), Failure> {
    refuse_occupied(target, force)?;
    if let Some(folder) = target.parent() {
        make_folder(folder)?;
    }
    write(target, bytes)
}
