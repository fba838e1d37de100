//! `hpf export`: a policy for firmware.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;

use crate::cli::{Common, Export};
use crate::export::export as form;
use crate::failure::{Failure, Outcome};
use crate::files::{in_file, policy_path, read_policy, say, say_bytes, while_writing, write};

/// Runs `hpf export`.
pub fn export(options: &Export, common: &Common) -> Result<Outcome, Failure> {
    let source = policy_path(&options.policy)?;
    let policy = read_policy(&source)?;
    let bytes = form(&policy, options.format, options.scalar).map_err(|error| {
        let scalar = options.scalar.name();
        in_file(&source)(format!("this makes no skill in {scalar}: {error}"))
    })?;
    if common.out.as_deref() == Some(Path::new("-")) {
        if common.json {
            return Err(Failure::Input("--out - and --json both want stdout: name a file".into()));
        }
        say_bytes(&bytes)?;
        return Ok(Outcome::Done);
    }
    let target = target(&source, options, common)?;
    if let Some(folder) = target.parent() {
        fs::create_dir_all(folder).map_err(while_writing(folder))?;
    }
    write(&target, &bytes)?;
    let (format, scalar) = (options.format.name(), options.scalar.name());
    if common.json {
        let object = json!({
            "format": "hpf-export", "version": 1, "task": policy.task, "form": format, "scalar": scalar,
            "file": target.display().to_string(), "bytes": bytes.len(),
        });
        say(&format!("{object:#}\n"))?;
    } else {
        say(&format!("{}: {format}, {scalar}, {} bytes\n", target.display(), bytes.len()))?;
    }
    Ok(Outcome::Done)
}

/// The file to write: the one asked for, or one beside the policy.
fn target(source: &Path, options: &Export, common: &Common) -> Result<PathBuf, Failure> {
    let target = common.out.clone().unwrap_or_else(|| source.with_extension(options.format.extension()));
    let refuse = |why: &str| Err(Failure::Input(format!("{}: {why}", target.display())));
    if target.is_dir() || target.file_name().is_none() {
        return refuse("this is a directory: name a file with --out");
    }
    if target.symlink_metadata().is_ok() {
        if target.canonicalize().ok() == source.canonicalize().ok() {
            return refuse("this is the policy itself: name another file with --out");
        }
        if !common.force {
            return refuse("it exists and is left as it is; pass --force to replace it, or --out to write elsewhere");
        }
    }
    Ok(target)
}
