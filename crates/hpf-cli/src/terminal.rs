//! What reaches the terminal: the one place where text is printed, and none of it is obeyed ([`hpf::escape`]).

use std::io::{self, Write as _, stderr};

use hpf::escape::{shown, styled};
use hpf::failure::Failure;

use crate::style::is_colored;

/// Writes a line to stderr; where that is full or closed, work goes on and the exit code tells.
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
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::Work(format!("cannot write the result: {error}")))
        }
        _ => Ok(()),
    }
}
