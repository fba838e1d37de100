//! The run directory: built under another name, and given its own when it is whole.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::files::{self, while_writing};

/// The file that a run under way holds locked, inside its unfinished directory.
const LOCK: &str = ".lock";

/// Folders inside a run directory.
const FOLDERS: [&str; 2] = ["plots", "snapshots"];

/// A run directory being filled. Until [`Unfinished::finish`] its name ends in `.partial`.
pub struct Unfinished {
    target: PathBuf,
    partial: PathBuf,
    files: Vec<String>,
    /// Held until the end: another run leaves this directory alone.
    _lock: File,
}

impl Unfinished {
    /// Begins a run directory `target`.
    ///
    /// # Errors
    /// [`Failure::Input`] where results stand there and `force` is not given, where something that is no run directory
    /// stands there, or where another run is going on there; [`Failure::Work`] where no directory can be made.
    pub fn begin(target: &Path, force: bool) -> Result<Self, Failure> {
        // A link leads to where the results go; it is not replaced.
        let target = fs::canonicalize(target).unwrap_or_else(|_| target.to_owned());
        if target.file_name().is_none() {
            return Err(Failure::Input(format!("{}: this cannot name a run directory", target.display())));
        }
        if exists(&target) && !is_empty_directory(&target) {
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
            discard(&partial, force)?;
        }
        if let Some(parent) = partial.parent() {
            fs::create_dir_all(parent).map_err(while_writing(parent))?;
        }
        let make = || -> io::Result<File> {
            fs::create_dir(&partial)?;
            let lock = File::create(partial.join(LOCK))?;
            lock.lock()?;
            FOLDERS.iter().try_for_each(|folder| fs::create_dir(partial.join(folder)))?;
            Ok(lock)
        };
        let lock = make().map_err(while_writing(&partial))?;
        Ok(Self { target, partial, files: Vec::new(), _lock: lock })
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
        let swap = || -> io::Result<()> {
            fs::remove_file(self.partial.join(LOCK))?;
            for folder in FOLDERS.map(|folder| self.partial.join(folder)) {
                if is_empty_directory(&folder) {
                    fs::remove_dir(folder)?;
                }
            }
            let old = free_name(&self.target);
            let replaces = self.target.join("task.toml").is_file();
            if replaces {
                fs::rename(&self.target, &old)?;
            }
            fs::rename(&self.partial, &self.target)?;
            if replaces { fs::remove_dir_all(&old) } else { Ok(()) }
        };
        swap().map_err(|error| {
            let (partial, target) = (self.partial.display(), self.target.display());
            Failure::Work(format!("cannot rename {partial} to {target}: {error}; the results are in {partial}"))
        })
    }

    /// Gives up: a policy that is already whole is kept, with the whole files beside it; anything less is removed.
    pub fn abandon(self, failure: Failure) -> Failure {
        // The failure to report is the one that led here: what cannot be tidied up is left.
        let is_kept = self.files.iter().any(|name| name == "policy.json");
        if !is_kept {
            let _ = fs::remove_dir_all(&self.partial);
            return failure;
        }
        let _ = fs::remove_file(self.partial.join(LOCK));
        let folders = FOLDERS.map(|folder| self.partial.join(folder)).into_iter().chain([self.partial.clone()]);
        for entry in folders.flat_map(|folder| fs::read_dir(folder).into_iter().flatten().flatten()) {
            if entry.file_name().to_string_lossy().contains(".partial") {
                let _ = fs::remove_file(entry.path());
            }
        }
        failure.with(&format!("what was finished before is in {}", self.partial.display()))
    }
}

fn exists(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

fn is_empty_directory(path: &Path) -> bool {
    fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none())
}

/// A name beside `target` that nothing has.
fn free_name(target: &Path) -> PathBuf {
    let names = (0_u32..).map(|number| target.with_added_extension(format!("replaced-{number}")));
    names.into_iter().find(|name| !exists(name)).expect("some number is free")
}

/// Removes what a broken-off run left, if it is that, nobody is at work there, and `force` is given.
fn discard(partial: &Path, force: bool) -> Result<(), Failure> {
    let refuse = |why: &str| Err(Failure::Input(format!("{} {why}", partial.display())));
    let lock = File::open(partial.join(LOCK));
    if lock.as_ref().is_ok_and(|lock| lock.try_lock().is_err()) {
        return refuse("belongs to a run that is going on; wait for it, or pass another --out");
    }
    let is_ours = lock.is_ok() || partial.join("task.toml").is_file() || is_empty_directory(partial);
    if !is_ours {
        return refuse("is in the way and is no broken-off run; move it, or pass another --out");
    }
    if !force {
        return refuse("holds a run that was broken off; pass --force to discard it");
    }
    fs::remove_dir_all(partial).map_err(while_writing(partial))
}
