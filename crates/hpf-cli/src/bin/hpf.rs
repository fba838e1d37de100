//! `hpf`: all of it is in the library, so that its readers can be tested and fuzzed.

use std::process::ExitCode;

fn main() -> ExitCode {
    hpf_cli::main(stdout::was_closed())
}

/// Whether stdout was closed when the program began.
///
/// Before `main` the runtime puts /dev/null in the place of what is closed, and every write to it succeeds: so this looks
/// earlier, among the functions that the loader calls first.
#[cfg(target_os = "linux")]
mod stdout {
    use core::sync::atomic::{AtomicBool, Ordering};

    static WAS_CLOSED: AtomicBool = AtomicBool::new(false);

    extern "C" fn look() {
        WAS_CLOSED.store(rustix::io::fcntl_getfd(rustix::stdio::stdout()).is_err(), Ordering::Relaxed);
    }

    #[used]
    #[allow(unsafe_code, reason = "a section of the program is named; the function only asks the system")]
    #[unsafe(link_section = ".init_array")]
    static BEFORE_MAIN: extern "C" fn() = look;

    pub fn was_closed() -> bool {
        WAS_CLOSED.load(Ordering::Relaxed)
    }
}

/// Elsewhere nothing can be said about it.
#[cfg(not(target_os = "linux"))]
mod stdout {
    pub fn was_closed() -> bool {
        false
    }
}
