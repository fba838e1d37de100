//! The log and the figures only show a run: where one of them cannot be made, the run is kept and the failure is named.

use core::any::Any;
use core::panic::AssertUnwindSafe;
use std::panic::catch_unwind;
use std::path::Path;

use crate::failure::Failure;

/// Makes the file `path`. As a last resort a fault of the program itself, a panic, is a failure like any other.
///
/// # Errors
/// What `make` returns, or its panic.
pub fn guarded<T>(path: &Path, make: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    // Nothing that was at work when it broke off is used again.
    catch_unwind(AssertUnwindSafe(make)).unwrap_or_else(|panic| {
        Err(Failure::Work(format!("cannot write {}: a fault of hpf itself: {}", path.display(), reason(&*panic))))
    })
}

/// What a panic says.
pub fn reason(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no reason is known")
}

/// The failures of sinks as one, where there are any; the results themselves are in `place`.
///
/// # Errors
/// [`Failure::Work`] that names every file that could not be written.
pub fn combined(failures: &[Failure], place: &str) -> Result<(), Failure> {
    if failures.is_empty() {
        return Ok(());
    }
    let lines = failures.iter().map(|failure| failure.to_string().trim_start_matches("error: ").to_owned());
    Err(Failure::Work(format!("{}\nall other results are in {place}", lines.collect::<Vec<_>>().join("\nerror: "))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_in_a_sink_is_a_failure_that_names_its_file() {
        let failure = guarded::<()>(Path::new("plots/cost.png"), || panic!("index {} of 3", 7)).unwrap_err();
        assert_eq!(failure.to_string(), "error: cannot write plots/cost.png: a fault of hpf itself: index 7 of 3");
        assert!(matches!(failure, Failure::Work(_)));
    }
}
