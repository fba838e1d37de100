//! `hpf init`: a commented task file to start from.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde_json::json;

use crate::cli::{Common, Init};
use crate::failure::{Failure, Outcome};
use crate::files::deliver;

/// The kinds of task to start from: the shipped ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Kind {
    /// The smallest: reach a goal against a steady force
    Reach,
    /// Reach a goal through a via point, pushed and pulled (Task 1 of the paper)
    ViaPoint,
    /// Slide along a bending beam with a constant force (Task 2 of the paper)
    Cantilever,
    /// The same on the curve of a beam loaded where the tool is
    CantileverMovingLoad,
    /// Come to rest against a wall and press it
    Wall,
    /// Turn a rotary joint through a via point against a pulse
    Joint,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Reach => "reach",
            Self::ViaPoint => "via_point",
            Self::Cantilever => "cantilever",
            Self::CantileverMovingLoad => "cantilever_moving_load",
            Self::Wall => "wall",
            Self::Joint => "joint",
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Reach => include_str!("../../../../tasks/reach.toml"),
            Self::ViaPoint => include_str!("../../../../tasks/via_point.toml"),
            Self::Cantilever => include_str!("../../../../tasks/cantilever.toml"),
            Self::CantileverMovingLoad => include_str!("../../../../tasks/cantilever_moving_load.toml"),
            Self::Wall => include_str!("../../../../tasks/wall.toml"),
            Self::Joint => include_str!("../../../../tasks/joint.toml"),
        }
    }
}

/// Runs `hpf init`.
pub fn init(options: &Init, common: &Common) -> Result<Outcome, Failure> {
    let kind = options.kind;
    let default = PathBuf::from(kind.name()).with_added_extension("toml");
    let text = named_after(common.out.as_deref().unwrap_or(&default), kind);
    deliver(common, Some(&default), text.as_bytes(), |file| {
        Some((
            format!("{}: a task of kind {}\n\nnext: hpf learn {0}\n", file.display(), kind.name()),
            json!({ "format": "hpf-init", "version": 1, "kind": kind.name(), "file": file.display().to_string() }),
        ))
    })
}

/// The text of `kind`, its task named after the file `target`, so that its runs do not stand in the way of others.
fn named_after(target: &Path, kind: Kind) -> String {
    let name = target.file_stem().and_then(|stem| stem.to_str()).filter(|name| is_plain(name)).unwrap_or(kind.name());
    let place = if target == Path::new("-") { PathBuf::from("TASK") } else { target.to_owned() };
    kind.text()
        .replace(&format!("\nname = \"{}\"", kind.name()), &format!("\nname = \"{name}\""))
        .replace(&format!("hpf learn tasks/{}.toml", kind.name()), &format!("hpf learn {}", place.display()))
}

/// Whether a task may have this name and needs no quotes anywhere.
fn is_plain(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphanumeric())
        && name.chars().all(|letter| letter.is_ascii_alphanumeric() || "_-".contains(letter))
}
