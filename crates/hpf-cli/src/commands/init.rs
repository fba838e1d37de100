//! `hpf init`: a commented task file to start from.

use std::path::{Path, PathBuf};

use serde_json::json;
use toml_edit::Value;

use crate::cli::Common;
use crate::cli::init::{Init, Kind};
use crate::deliver::deliver;
use crate::outcome::Outcome;
use hpf::escape::line;
use hpf::failure::Failure;
use hpf::files::{place, refuse_occupied};
use hpf::words::typed;

/// The program that makes the rollouts of the shipped task of kind process.
const PROGRAM: &str = include_str!("../../shipped/examples/process/point_mass.py");

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Reach => "reach",
            Self::ViaPoint => "via_point",
            Self::Cantilever => "cantilever",
            Self::CantileverMovingLoad => "cantilever_moving_load",
            Self::Wall => "wall",
            Self::Joint => "joint",
            Self::Stochastic => "stochastic",
            Self::Process => "process",
        }
    }

    /// The shipped task of this kind: its folder, its name and its text.
    fn shipped(self) -> (&'static str, &'static str, &'static str) {
        macro_rules! shipped {
            ($folder:literal, $name:literal) => {
                ($folder, $name, include_str!(concat!("../../shipped/", $folder, "/", $name, ".toml")))
            };
        }
        match self {
            Self::Reach => shipped!("tasks", "reach"),
            Self::ViaPoint => shipped!("tasks", "via_point"),
            Self::Cantilever => shipped!("tasks", "cantilever"),
            Self::CantileverMovingLoad => shipped!("tasks", "cantilever_moving_load"),
            Self::Wall => shipped!("tasks", "wall"),
            Self::Joint => shipped!("tasks", "joint"),
            Self::Stochastic => shipped!("tasks", "via_point_stochastic"),
            Self::Process => shipped!("examples/process", "point_mass"),
        }
    }
}

/// Runs `hpf init`.
pub fn init(options: &Init, common: &Common) -> Result<Outcome, Failure> {
    let kind = options.kind;
    let default = PathBuf::from(kind.name()).with_added_extension("toml");
    let target = common.out.as_deref().unwrap_or(&default);
    let mut text = named_after(target, kind);
    let program = match kind {
        Kind::Process => Some(program_beside(target, common.force)?),
        _ => None,
    };
    if let Some(program) = &program {
        let name = program.file_name().unwrap_or_default().to_string_lossy();
        // The program lies beside the task, where relative paths are looked for.
        let command = Value::from(&*name).to_string();
        text = text.replace(" point_mass.py", &format!(" {name}")).replace("\"point_mass.py\"", &command);
    }
    deliver(common, Some(&default), text.as_bytes(), |file| {
        let file = file.display().to_string();
        let mut object = json!({ "format": "hpf-init", "version": 1, "kind": kind.name(), "file": &file });
        let mut made = format!("{file}: a task of kind {}\n", kind.name());
        if let Some(program) = program {
            object["program"] = json!(program);
            made += &format!("{}: the program that makes its rollouts\n", program.display());
        }
        Some((format!("{made}\nnext: hpf learn {}\n", typed(file)), object))
    })
}

/// Writes the program of the task `target` beside it, where both may be written.
fn program_beside(target: &Path, force: bool) -> Result<PathBuf, Failure> {
    let program = target.with_extension("py");
    if target == Path::new("-") || program == target {
        let what = "a task of kind process is two files: name NAME.toml with --out, and NAME.py is written beside it";
        return Err(Failure::Input(what.into()));
    }
    refuse_occupied(target, force)?;
    place(&program, PROGRAM.as_bytes(), force)?;
    Ok(program)
}

/// The text of `kind`, its task named after the file `target`, so that its runs have a directory of their own.
fn named_after(target: &Path, kind: Kind) -> String {
    let (folder, shipped, text) = kind.shipped();
    let name = target.file_stem().and_then(|stem| stem.to_str()).filter(|name| is_plain(name)).unwrap_or(kind.name());
    let place = if target == Path::new("-") { "TASK".into() } else { typed(target.display()) };
    text.replace(&format!("\nname = \"{shipped}\""), &format!("\nname = \"{name}\""))
        .replace(&format!("hpf learn {folder}/{shipped}.toml"), &format!("hpf learn {}", line(&place)))
}

/// Whether a task may have this name and needs no quotes anywhere.
fn is_plain(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphanumeric())
        && name.chars().all(|letter| letter.is_ascii_alphanumeric() || "_-".contains(letter))
}
