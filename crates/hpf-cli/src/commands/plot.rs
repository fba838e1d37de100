//! `hpf plot`: the pictures of a run, from its tables.

use serde_json::json;

use crate::cli::{Common, Plot};
use crate::failure::{Failure, Outcome};
use crate::files::say;
use crate::results::Run;
use crate::{figure, render};

/// Runs `hpf plot`.
pub fn plot(options: &Plot, common: &Common) -> Result<Outcome, Failure> {
    let run = Run::load(&options.run)?;
    let folder = common.out.clone().unwrap_or_else(|| options.run.join("plots"));
    let names = figure::names(&run);
    let standing: Vec<&str> = names.iter().copied().filter(|name| folder.join(name).exists()).collect();
    if !standing.is_empty() && !common.force {
        return Err(Failure::Input(format!(
            "{} holds {} already and is left as it is; pass --force to replace them, or --out to write elsewhere",
            folder.display(),
            standing.join(", ")
        )));
    }
    let files = figure::draw(&run, &folder)?;
    if common.json {
        let object = json!({ "format": "hpf-plots", "version": 1, "directory": folder, "files": files });
        say(&format!("{object:#}\n"))?;
    } else {
        say(&format!("written to {}:\n{}", folder.display(), render::wrapped(&files)))?;
    }
    Ok(Outcome::Done)
}
