//! `hpf manual`: a manual page per command.

use std::path::Path;

use clap::CommandFactory as _;
use clap_mangen::Man;
use serde_json::json;

use crate::cli::{Arguments, Common};
use crate::outcome::Outcome;
use crate::render;
use crate::terminal::say;
use hpf::failure::Failure;
use hpf::files::{make_folder, refuse_occupied, while_writing, write};

/// Runs `hpf manual`.
pub fn manual(common: &Common) -> Result<Outcome, Failure> {
    let folder = common.out.as_deref().unwrap_or(Path::new("man"));
    let mut pages = Vec::new();
    let mut hpf = Arguments::command().name("hpf").disable_help_subcommand(true);
    // Building gives every command its options of the whole program.
    hpf.build();
    let commands: Vec<_> =
        hpf.get_subcommands().map(|command| (format!("hpf-{}", command.get_name()), command)).collect();
    for (name, command) in [("hpf".to_owned(), &hpf)].into_iter().chain(commands) {
        let mut page = Vec::new();
        let title = name.to_uppercase();
        let man = Man::new(command.clone().display_name(&name))
            .title(title)
            .manual("HPF")
            .source(concat!("hpf ", env!("CARGO_PKG_VERSION")));
        man.render(&mut page).map_err(while_writing(folder))?;
        pages.push((format!("{name}.1"), page));
    }
    for (name, _) in &pages {
        refuse_occupied(&folder.join(name), common.force)?;
    }
    make_folder(folder)?;
    for (name, page) in &pages {
        write(&folder.join(name), page)?;
    }
    let files: Vec<String> = pages.into_iter().map(|(name, _)| name).collect();
    if common.json {
        let object = json!({ "format": "hpf-manual", "version": 1, "directory": folder, "files": files });
        say(&format!("{object:#}\n"))?;
    } else {
        say(&format!("written to {}:\n{}", folder.display(), render::wrapped(&files)))?;
    }
    Ok(Outcome::Done)
}
