//! What may stand where hpf reads and writes: regular files are replaced and nothing else, and nothing is waited for.
//!
//! A device, a pipe or a link in the place of a result is refused, also by `--force`: renaming a file over it would take
//! it away from whoever put it there. An input that is a named pipe is refused, because opening it waits for a writer that
//! may never come; the pipes of a shell, such as `<(command)` and `/dev/stdin`, have one and are read.

use std::fs::{self, File, FileType};
use std::io::{self, Write as _};
use std::path::Path;

/// The kind of node, in words; `None` for a regular file.
fn strange(kind: FileType) -> Option<&'static str> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        let kinds = [
            (kind.is_fifo(), "a named pipe"),
            (kind.is_socket(), "a socket"),
            (kind.is_char_device() || kind.is_block_device(), "a device"),
        ];
        if let Some((_, words)) = kinds.into_iter().find(|(is_one, _)| *is_one) {
            return Some(words);
        }
    }
    match kind {
        kind if kind.is_symlink() => Some("a symbolic link"),
        kind if kind.is_dir() => Some("a directory"),
        kind if kind.is_file() => None,
        _ => Some("no regular file"),
    }
}

/// Refuses to replace what is at `path` unless it is a regular file or nothing.
///
/// # Errors
/// The kind of what is there.
pub fn replaceable(path: &Path) -> io::Result<()> {
    let Ok(metadata) = path.symlink_metadata() else { return Ok(()) };
    match strange(metadata.file_type()) {
        None => Ok(()),
        Some(words) => {
            Err(io::Error::other(format!("this is {words}, and only regular files are replaced: name another file")))
        }
    }
}

/// The kind of what is at `path`, in words, where it is neither a directory, nor a link to one, nor nothing.
pub fn in_the_place_of_a_folder(path: &Path) -> Option<&'static str> {
    let metadata = path.symlink_metadata().ok().filter(|_| !path.is_dir())?;
    Some(strange(metadata.file_type()).unwrap_or("a file"))
}

/// Opens a file to read it, without waiting for anybody.
///
/// # Errors
/// What the system says, and what is no file to read.
pub fn open(path: &Path) -> io::Result<File> {
    let kind = fs::metadata(path)?.file_type();
    let refuse = |what: &str| Err(io::Error::other(format!("this is {what}, a file is wanted")));
    match strange(kind) {
        Some("a named pipe") if has_writer(path) => {}
        // A device states no length: it is read up to a limit.
        None | Some("a device") => {}
        Some(words) => return refuse(words),
    }
    File::open(path)
}

/// Whether a pipe is one that a process has open, not a name that waits for one.
fn has_writer(path: &Path) -> bool {
    // The pipes of a shell have no name of their own: on Linux theirs leads nowhere.
    fs::canonicalize(path).map_or(true, |real| real.starts_with("/dev") || real.starts_with("/proc"))
}

/// Creates the file `path`, in the place of a regular file or of nothing; what had the old one open keeps it.
///
/// # Errors
/// What the system says, and that something there is no regular file.
pub fn create(path: &Path) -> io::Result<File> {
    replaceable(path)?;
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    File::create_new(path)
}

/// Gives the finished file `temporary` the name `path`.
///
/// # Errors
/// What the system says, and that something there is no regular file; `temporary` is removed then, as far as possible.
pub fn settle(temporary: &Path, path: &Path) -> io::Result<()> {
    replaceable(path).and_then(|()| fs::rename(temporary, path)).inspect_err(|_| {
        // The error to report is the first one.
        let _ = fs::remove_file(temporary);
    })
}

/// Writes `bytes` to `path` under a temporary name first: under its own name the file is whole or not there.
///
/// # Errors
/// As for [`create`] and [`settle`].
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replaceable(path)?;
    let temporary = path.with_added_extension("partial");
    let mut file = create(&temporary)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all()).inspect_err(|_| {
        let _ = fs::remove_file(&temporary);
    });
    written.and_then(|()| settle(&temporary, path))
}
