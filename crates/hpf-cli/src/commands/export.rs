//! `hpf export`: a policy for firmware, a run for ROS 2.

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::cli::{Common, Export};
use crate::deliver::deliver;
use crate::outcome::Outcome;
use crate::terminal::tell;
use hpf::export::{self, Form, Format, Precision};
use hpf::failure::Failure;
use hpf::files::{in_file, policy_path, read_policy};
use hpf::log;
use hpf::results::Run;

/// Runs `hpf export`.
pub fn export(options: &Export, common: &Common) -> Result<Outcome, Failure> {
    let format = options.format.map_or(Format::Ros2, |format| format.0);
    match format.firmware() {
        Some(form) => firmware(options, common, format, form),
        None => ros2(options, common),
    }
}

/// The policy alone, in a form and a scalar.
fn firmware(options: &Export, common: &Common, format: Format, form: Form) -> Result<Outcome, Failure> {
    let source = policy_path(&options.policy)?;
    let policy = read_policy(&source)?;
    let precision = options.scalar.map_or(Precision::F64, |scalar| scalar.0);
    let (name, scalar) = (format.name(), precision.name());
    let bytes = export::export(&policy, form, precision)
        .map_err(|error| in_file(&source)(format!("this makes no skill in {scalar}: {error}")))?;
    let default = source.with_extension(format.extension());
    refuse_source(common, &default, &source)?;
    deliver(common, Some(&default), &bytes, |file| {
        Some((
            format!("{}: {name}, {scalar}, {} bytes\n", file.display(), bytes.len()),
            json!({
                "format": "hpf-export", "version": 1, "task": policy.task, "form": name, "scalar": scalar,
                "file": file.display().to_string(), "bytes": bytes.len(),
            }),
        ))
    })
}

/// The motion of a run as a bag of ROS messages.
fn ros2(options: &Export, common: &Common) -> Result<Outcome, Failure> {
    if options.scalar.is_some() {
        return Err(Failure::Input("--scalar is for firmware: ROS messages have their own numbers".into()));
    }
    let source = run_of(&options.policy)?;
    let run = Run::load(&source)?;
    if let Some(note) = log::time_note(&run.task) {
        tell(&format!("note: {note}"));
    }
    let (bytes, messages) = log::bag(&run).map_err(|error| Failure::Work(format!("cannot make the bag: {error}")))?;
    let default = source.join("ros2.mcap");
    deliver(common, Some(&default), &bytes, |file| {
        Some((
            format!("{}: ros2, {messages} messages, {} bytes\n", file.display(), bytes.len()),
            json!({
                "format": "hpf-export", "version": 1, "task": run.task.name, "form": Format::Ros2.name(),
                "messages": messages, "file": file.display().to_string(), "bytes": bytes.len(),
            }),
        ))
    })
}

/// The run directory that is meant: the one named, or that of the policy named.
fn run_of(path: &Path) -> Result<PathBuf, Failure> {
    let folder = if path.is_dir() { path } else { path.parent().unwrap_or(Path::new("")) };
    if folder.join("trajectory.csv").is_file() {
        return Ok(folder.to_owned());
    }
    let why = "for ROS 2 a motion is wanted: name a run directory, such as `hpf run POLICY --out DIR` makes";
    Err(in_file(path)(why))
}

/// The policy is never replaced by what is made from it.
fn refuse_source(common: &Common, default: &Path, source: &Path) -> Result<(), Failure> {
    let target = common.out.as_deref().unwrap_or(default);
    let is_source =
        target.canonicalize().is_ok_and(|target| source.canonicalize().is_ok_and(|source| source == target));
    if is_source {
        return Err(in_file(target)("this is the policy itself: name another file with --out"));
    }
    Ok(())
}
