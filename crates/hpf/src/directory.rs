//! The run directory: built under another name, and given its own when it is whole.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::files::{self, while_writing};
use crate::nodes;
use crate::words::typed;

/// The file that a run under way holds locked, inside its unfinished directory.
const LOCK: &str = ".lock";

/// The records of learning so far, in a run that can be resumed.
pub const CHECKPOINT: &str = "checkpoint";

/// The result of a run: written last, so that a directory without a checkpoint that has it is whole.
const SUMMARY: &str = "summary.json";

/// What is added to the name of a run directory that is not whole yet: before it can be resumed, and from then on.
const WORKING: [&str; 2] = ["beginning", "partial"];

/// Folders inside a run directory.
const FOLDERS: [&str; 2] = ["plots", "snapshots"];

/// A run directory being filled. Until [`Unfinished::finish`] its name ends in `.partial`.
pub struct Unfinished {
    target: PathBuf,
    /// Where it is now.
    partial: PathBuf,
    files: Vec<String>,
    /// Whether something was learned that a resumed run can go on from.
    is_resumable: bool,
    /// Held until the end: another run leaves this directory alone.
    _lock: File,
}

impl Unfinished {
    /// Begins a run directory `target`; until [`Unfinished::ready`] a kill leaves nothing that is in the way.
    ///
    /// # Errors
    /// [`Failure::Input`] where results are there and `force` is not given, where something is there that is no run
    /// directory, or where another run is at work there; [`Failure::Work`] where no directory can be made.
    pub fn begin(target: &Path, force: bool) -> Result<Self, Failure> {
        // A link leads to where the results go; it is not replaced.
        let target = fs::canonicalize(target).unwrap_or_else(|_| target.to_owned());
        if target.file_name().is_none() {
            return Err(Failure::Input(format!("{}: this cannot name a run directory", target.display())));
        }
        if let Some(ending) = target.extension().filter(|ending| WORKING.iter().any(|one| ending == one)) {
            return Err(Failure::Input(format!(
                "{}: names that end in .{} are those of runs under way; pass another --out",
                target.display(),
                ending.display()
            )));
        }
        if exists(&target) && !is_empty_directory(&target) {
            if !force {
                return Err(Failure::Input(format!(
                    "{} exists and is left as it is; pass --force to replace it, or --out to write elsewhere",
                    target.display()
                )));
            }
            if !is_run(&target) {
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
        let beginning = target.with_added_extension("beginning");
        if exists(&beginning) {
            // A run that was killed before it could be resumed has made nothing worth keeping.
            discard(&beginning, true)?;
        }
        let make = || -> io::Result<File> {
            fs::create_dir(&beginning)?;
            let lock = File::create(beginning.join(LOCK))?;
            lock.lock()?;
            FOLDERS.iter().try_for_each(|folder| fs::create_dir(beginning.join(folder)))?;
            Ok(lock)
        };
        let lock = make().map_err(while_writing(&beginning))?;
        Ok(Self { target, partial: beginning, files: Vec::new(), is_resumable: false, _lock: lock })
    }

    /// Gives a directory that has all a run needs to go on, or that needs none, the name under which it is looked for.
    ///
    /// # Errors
    /// [`Failure::Work`] where it cannot be renamed.
    pub fn ready(&mut self) -> Result<(), Failure> {
        let partial = self.target.with_added_extension("partial");
        fs::rename(&self.partial, &partial).map_err(while_writing(&partial))?;
        self.partial = partial;
        Ok(())
    }

    /// Takes up a run that was killed, or a run directory that Ctrl-C left, where it stands.
    ///
    /// # Errors
    /// [`Failure::Input`] where there is none, where it is finished, where it is going on, and where `force` is missing
    /// to replace what it would replace; [`Failure::Work`] where the directory cannot be changed.
    pub fn resume(run: &Path, force: bool) -> Result<Self, Failure> {
        let is_partial = run.extension().is_some_and(|extension| extension == "partial");
        let target = if is_partial { run.with_extension("") } else { run.to_owned() };
        let target = fs::canonicalize(&target).unwrap_or(target);
        let refuse = |path: &Path, why: &str| Err(Failure::Input(format!("{} {why}", path.display())));
        if target.file_name().is_none() {
            return refuse(&target, "cannot name a run directory");
        }
        let partial = target.with_added_extension("partial");
        if exists(&partial) {
            if !partial.join(CHECKPOINT).is_file() && !partial.join(SUMMARY).is_file() {
                return refuse(&partial, "has no checkpoint to go on from; learn the task again with --force");
            }
            if exists(&target) && !is_empty_directory(&target) && !force {
                return refuse(&target, "exists beside the run that was broken off; pass --force to replace it");
            }
        } else if target.join(CHECKPOINT).is_file() {
            fs::rename(&target, &partial).map_err(while_writing(&partial))?;
        } else if target.join(SUMMARY).is_file() {
            return refuse(
                &target,
                "is finished: there is nothing to go on with; hpf learn TASK --from RUN --out OTHER learns further",
            );
        } else {
            return refuse(&target, "is no run that was broken off: there is nothing to go on with");
        }
        let path = partial.join(LOCK);
        let lock = nodes::replaceable(&path)
            .and_then(|()| File::options().create(true).truncate(false).write(true).open(&path))
            .map_err(while_writing(&path))?;
        if lock.try_lock().is_err() {
            return refuse(&partial, "belongs to a run that is going on; wait for it");
        }
        for folder in FOLDERS.map(|folder| partial.join(folder)).iter().filter(|folder| !folder.is_dir()) {
            fs::create_dir(folder).map_err(while_writing(folder))?;
        }
        Ok(Self { target, partial, files: Vec::new(), is_resumable: true, _lock: lock })
    }

    /// Whether nothing is missing but its name: a kill came when all else was done.
    pub fn is_whole(&self) -> bool {
        !self.path(CHECKPOINT).is_file() && self.path(SUMMARY).is_file()
    }

    /// From now on a failure leaves the directory to a resumed run.
    pub fn keep_for_resume(&mut self) {
        self.is_resumable = true;
    }

    /// From now on a failure leaves nothing: to go on would end in the same failure.
    pub fn forget(&mut self) {
        self.is_resumable = false;
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

    /// Gives the directory its name, when it is what it is to be under it: without the lock and, unless `is_open`, without
    /// the checkpoint. What it replaces is removed last. A kill in between leaves a whole run, under its name or the one
    /// before it, and a power cut finds the files on the disk before the checkpoint goes.
    ///
    /// # Errors
    /// [`Failure::Work`] that says where the results are.
    pub fn finish(self, is_open: bool) -> Result<(), Failure> {
        let swap = || -> io::Result<()> {
            for folder in FOLDERS.map(|folder| self.partial.join(folder)).iter().chain([&self.partial]) {
                sync(folder);
            }
            let checkpoint = self.partial.join(CHECKPOINT);
            if !is_open && checkpoint.is_file() {
                fs::remove_file(checkpoint)?;
            }
            fs::remove_file(self.partial.join(LOCK))?;
            for folder in FOLDERS.map(|folder| self.partial.join(folder)) {
                if is_empty_directory(&folder) {
                    fs::remove_dir(folder)?;
                }
            }
            let old = free_name(&self.target);
            let replaces = is_run(&self.target);
            if replaces {
                fs::rename(&self.target, &old)?;
            }
            fs::rename(&self.partial, &self.target)?;
            if let Some(parent) = self.target.parent() {
                sync(parent);
            }
            if replaces { fs::remove_dir_all(&old) } else { Ok(()) }
        };
        swap().map_err(|error| {
            let (partial, target) = (self.partial.display(), self.target.display());
            Failure::Work(format!("cannot rename {partial} to {target}: {error}; the results are in {partial}"))
        })
    }

    /// Gives up: what a resumed run can go on from is kept, and a policy that is already whole with the whole files
    /// beside it; anything less is removed.
    pub fn abandon(self, failure: Failure) -> Failure {
        // The failure to report is the one that led here: what cannot be tidied up is left.
        let is_kept = self.is_resumable || self.files.iter().any(|name| name == "policy.json");
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
        let kept = failure.with(&format!("what was finished before is in {}", self.partial.display()));
        if !self.is_resumable {
            return kept;
        }
        kept.with(&format!("go on from there with: hpf learn --resume {}", typed(self.target.display())))
    }
}

/// Has what was made and named in a folder reach the disk, where the system can do that for folders.
fn sync(folder: &Path) {
    // Where it cannot, names reach the disk in an order of its own.
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

fn exists(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

fn is_empty_directory(path: &Path) -> bool {
    fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none())
}

/// Whether a directory is one that hpf made for a run, finished or broken off: only those are replaced.
fn is_run(directory: &Path) -> bool {
    let has = |name: &str| directory.join(name).is_file();
    has("task.toml") && [SUMMARY, "policy.json", CHECKPOINT].into_iter().any(has)
}

/// A name beside `target` that nothing has.
fn free_name(target: &Path) -> PathBuf {
    let names = (0_u32..).map(|number| target.with_added_extension(format!("replaced-{number}")));
    names.into_iter().find(|name| !exists(name)).expect("some number is free")
}

/// Removes what a broken-off run left, if it is that, nobody is at work there, and `force` is given.
fn discard(partial: &Path, force: bool) -> Result<(), Failure> {
    let refuse = |why: &str| Err(Failure::Input(format!("{} {why}", partial.display())));
    let lock = nodes::open(&partial.join(LOCK));
    if lock.as_ref().is_ok_and(|lock| lock.try_lock().is_err()) {
        return refuse("belongs to a run that is going on; wait for it, or pass another --out");
    }
    // What is whole and not locked is somebody's run, whatever it is called.
    if lock.is_err() && partial.join(SUMMARY).is_file() && !partial.join(CHECKPOINT).is_file() {
        return refuse("holds a finished run: move it, or pass another --out");
    }
    let is_ours = lock.is_ok() || partial.join("task.toml").is_file() || is_empty_directory(partial);
    if !is_ours {
        return refuse("is in the way and is no broken-off run; move it, or pass another --out");
    }
    if !force {
        return refuse("holds a run that was broken off; go on with it by --resume, or pass --force to discard it");
    }
    clear(partial).map_err(while_writing(partial))
}

/// Removes a broken-off run: first what would let it pass for a whole one, last what shows whose it is, so that a kill in
/// between leaves what can be removed again.
fn clear(partial: &Path) -> io::Result<()> {
    let marks = ["task.toml", LOCK];
    let remove = |name: &str| match fs::remove_file(partial.join(name)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    };
    remove(SUMMARY)?;
    for entry in fs::read_dir(partial)? {
        let entry = entry?;
        if marks.iter().any(|mark| entry.file_name() == *mark) {
            continue;
        }
        if entry.file_type()?.is_dir() { fs::remove_dir_all(entry.path())? } else { fs::remove_file(entry.path())? }
    }
    marks.into_iter().try_for_each(remove)?;
    fs::remove_dir(partial)
}
