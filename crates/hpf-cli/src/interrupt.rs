//! Ctrl-C, and the signals that ask a program to end (SIGTERM, SIGHUP): after the first, work ends as
//! soon as its results are complete; after the second, the program ends, and ends at once what must end before it.

use core::sync::atomic::{AtomicUsize, Ordering};

/// Signals received.
static ASKED: AtomicUsize = AtomicUsize::new(0);
/// How many parts of the program must end something before it may exit.
static HELD: AtomicUsize = AtomicUsize::new(0);
/// The exit code of a program that was asked to end.
const CODE: i32 = 130;

/// From now on a signal is only noted; the second time it ends the program, or has what holds it end at once; the third
/// time it ends the program in any case.
pub fn watch() {
    let handler = || {
        let before = ASKED.fetch_add(1, Ordering::SeqCst);
        let most = if HELD.load(Ordering::SeqCst) > 0 { 2 } else { 1 };
        if before >= most {
            std::process::exit(CODE);
        }
    };
    // Without a handler a signal still ends the program: nothing under a final name is half-written.
    let _ = ctrlc::set_handler(handler);
}

/// Whether the program was asked to end.
pub fn is_asked() -> bool {
    ASKED.load(Ordering::SeqCst) > 0
}

/// Whether it was asked again.
pub fn is_urgent() -> bool {
    ASKED.load(Ordering::SeqCst) > 1
}

/// Something must be ended before the program may end (`true`), or has been ended.
pub fn hold(is_held: bool) {
    if is_held {
        HELD.fetch_add(1, Ordering::SeqCst);
    } else if HELD.fetch_sub(1, Ordering::SeqCst) == 1 && is_urgent() {
        std::process::exit(CODE);
    }
}
