//! The folder of a reproduction: tables, figures, and the runs of the first seed.

use std::fs;
use std::path::Path;

use hpf::failure::Failure;
use hpf::figure::{self, Format};
use hpf::files;
use hpf::{Watch, trial};

use super::claims::Claim;
use super::figures::{of_first_seed, over_seeds};
use super::page::json;
use super::study::{Study, Variant};

/// Refuses a folder that holds something, where it is not to be replaced (`force`).
///
/// # Errors
/// [`Failure::Input`] that says what to pass.
pub fn refuse_occupied(folder: &Path, force: bool) -> Result<(), Failure> {
    let is_empty = fs::read_dir(folder).map_or(!folder.exists(), |mut entries| entries.next().is_none());
    let refuse = |why: &str| Err(Failure::Input(format!("{} {why}", folder.display())));
    match (is_empty, force) {
        (true, _) => Ok(()),
        (false, true) if folder.join("claims.json").is_file() => Ok(()),
        (false, true) => refuse("is no reproduction: --force does not replace it, pass another --out"),
        (false, false) => {
            refuse("exists and is left as it is; pass --force to replace it, or --out to write elsewhere")
        }
    }
}

/// Writes everything into `folder`, the tables before the figures that show them; returns the names of the files. `block`
/// is what [`markdown`](super::markdown) makes of the study.
///
/// # Errors
/// [`Failure`] that names what cannot be written.
pub fn write(
    study: &Study,
    (claims, variants): (&[Claim], &[Claim]),
    block: &str,
    folder: &Path,
    watch: &dyn Watch,
) -> Result<Vec<String>, Failure> {
    let subject = format!("seed {}", study.seeds[0]);
    let mut names = Vec::new();
    let text = format!("# The paper, reproduced\n\n{block}");
    let object = format!("{:#}\n", json(study, claims, variants));
    for (name, contents) in [("results.csv", study.csv()), ("claims.md", text), ("claims.json", object)] {
        files::write(&folder.join(name), contents)?;
        names.push(name.into());
    }
    names.extend(figure::draw(&of_first_seed(study), &subject, Format::Png, folder)?);
    names.extend(figure::draw(&over_seeds(study), "", Format::Png, folder)?);
    for variant in [Variant::ViaPoint, Variant::Cantilever] {
        let (prepared, trial) = study.first(variant);
        trial::save(trial, prepared, true, &folder.join(variant.name()), watch)?;
        names.push(format!("{}/", variant.name()));
    }
    Ok(names)
}
