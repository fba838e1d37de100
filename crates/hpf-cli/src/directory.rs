//! The run directory: built under another name, and given its own when it is whole.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::files::{self, while_writing};

/// A run directory being filled. Until [`Unfinished::finish`] its name ends in `.partial`.
pub struct Unfinished {
    target: PathBuf,
    partial: PathBuf,
    files: Vec<String>,
}

impl Unfinished {
    /// Begins a run directory `target`.
    ///
    /// # Errors
    /// [`Failure::Input`] where results stand there and `force` is not given, or where something that is no run
    /// directory stands there; [`Failure::Work`] where no directory can be made.
    pub fn begin(target: &Path, force: bool) -> Result<Self, Failure> {
        if target.file_name().is_none() {
            return Err(Failure::Input(format!("{}: this cannot name a run directory", target.display())));
        }
        let exists = |path: &Path| path.symlink_metadata().is_ok();
        if exists(target) && !is_empty_directory(target) {
            if !force {
                return Err(Failure::Input(format!(
                    "{} exists and is left as it is; pass --force to replace it, or --out to write elsewhere",
                    target.display()
                )));
            }
            if !target.join("task.toml").is_file() {
                return Err(Failure::Input(format!(
                    "{} is no run directory: --force does not replace it, pass another --out",
                    target.display()
                )));
            }
        }
        let partial = target.with_added_extension("partial");
        if exists(&partial) {
            if !force {
                return Err(Failure::Input(format!(
                    "{} holds a run that is going on or was broken off; pass --force to discard it",
                    partial.display()
                )));
            }
            fs::remove_dir_all(&partial).map_err(while_writing(&partial))?;
        }
        if let Some(parent) = partial.parent() {
            fs::create_dir_all(parent).map_err(while_writing(parent))?;
        }
        fs::create_dir(&partial).map_err(while_writing(&partial))?;
        Ok(Self { target: target.to_owned(), partial, files: Vec::new() })
    }

    /// Where the file `name` is while the directory is filled.
    pub fn path(&self, name: &str) -> PathBuf {
        self.partial.join(name)
    }

    /// Writes the file `name`.
    ///
    /// # Errors
    /// [`Failure::Work`] that names the file.
    pub fn write(&mut self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
        files::write(&self.path(name), bytes)?;
        self.written(name);
        Ok(())
    }

    /// Counts a file that somebody else wrote.
    pub fn written(&mut self, name: &str) {
        self.files.push(name.to_owned());
    }

    /// The files written, in their order.
    pub fn files(&self) -> &[String] {
        &self.files
    }

    /// Gives the directory its name; what it replaces is removed last.
    ///
    /// # Errors
    /// [`Failure::Work`] that says where the results are.
    pub fn finish(self) -> Result<(), Failure> {
        let old = self.target.with_added_extension("replaced");
        let swap = || -> io::Result<()> {
            if self.target.join("task.toml").is_file() {
                if old.exists() {
                    fs::remove_dir_all(&old)?;
                }
                fs::rename(&self.target, &old)?;
            }
            fs::rename(&self.partial, &self.target)?;
            if old.exists() { fs::remove_dir_all(&old) } else { Ok(()) }
        };
        swap().map_err(|error| {
            let (partial, target) = (self.partial.display(), self.target.display());
            Failure::Work(format!("cannot rename {partial} to {target}: {error}; the results are in {partial}"))
        })
    }

    /// Gives up: a policy that is already whole is kept and said where, anything less is removed.
    pub fn abandon(self, failure: Failure) -> Failure {
        if self.files.iter().any(|name| name == "policy.json") {
            return Failure::Work(format!("{failure}\nwhat was finished before is in {}", self.partial.display()));
        }
        // The failure to report is the one that led here.
        let _ = fs::remove_dir_all(&self.partial);
        failure
    }
}

fn is_empty_directory(path: &Path) -> bool {
    fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none())
}
