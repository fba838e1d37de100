//! The one place where text is printed. Control characters in it are escaped, so that the terminal obeys none of it
//! ([`hpf::escape`]).

use core::sync::atomic::{AtomicBool, Ordering};
use std::io::{self, Write as _, stderr};

use hpf::escape::{shown, styled};
use hpf::failure::Failure;

use crate::style::is_colored;

/// Whether stdout was closed when the program began: what is written to it now is lost without an error.
static IS_CLOSED: AtomicBool = AtomicBool::new(false);

/// Says whether stdout was closed when the program began.
pub fn begin(is_closed: bool) {
    IS_CLOSED.store(is_closed, Ordering::Relaxed);
}

/// Writes a line to stderr; where that is full or closed, work continues and the exit code remains.
pub fn tell(text: &str) {
    let _ = writeln!(stderr(), "{}", shown(text));
}

/// Says on stderr why a command failed.
pub fn complain(failure: &Failure) {
    let _ = match failure {
        Failure::Mistakes(mistakes) => writeln!(stderr(), "{}", styled(&mistakes.render(is_colored()))),
        other => writeln!(stderr(), "{}", shown(&other.to_string())),
    };
}

/// Prints a result on stdout. A reader that has seen enough, such as `head`, is no error.
///
/// # Errors
/// [`Failure::Work`] where stdout cannot be written otherwise.
pub fn say(text: &str) -> Result<(), Failure> {
    say_bytes(shown(text).as_bytes())
}

/// Prints a file on stdout, its bytes as they are.
///
/// # Errors
/// As for [`say`].
pub fn say_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    printed(stdout.write_all(bytes).and_then(|()| stdout.flush()))
}

/// The outcome of a print on stdout.
///
/// # Errors
/// As for [`say`].
pub fn printed(outcome: io::Result<()>) -> Result<(), Failure> {
    match outcome {
        Ok(()) if IS_CLOSED.load(Ordering::Relaxed) => {
            Err(Failure::Work("cannot write the result: stdout is closed".into()))
        }
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::Work(format!("cannot write the result: {error}")))
        }
        _ => Ok(()),
    }
}
