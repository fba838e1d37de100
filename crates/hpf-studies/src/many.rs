//! Many pieces of work at once, none waiting for another.

use core::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::interrupt;
use hpf::failure::Failure;

/// Calls `work` with 0 to `count - 1` until Ctrl-C, on the threads of the current pool.
///
/// Each worker has a pool of its own: pieces that share one would steal from each other, and none would end early.
///
/// # Errors
/// [`Failure::Work`] where no threads can be started.
pub fn side_by_side(count: usize, work: impl Fn(usize) + Sync) -> Result<(), Failure> {
    let threads = rayon::current_num_threads();
    let workers = threads.min(count).max(1);
    let pool = || rayon::ThreadPoolBuilder::new().num_threads(threads / workers).build();
    let pools = (0..workers).map(|_| pool()).collect::<Result<Vec<_>, _>>();
    let pools = pools.map_err(|error| Failure::Work(format!("cannot start threads: {error}")))?;
    let next = AtomicUsize::new(0);
    let piece = || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|index| *index < count && !interrupt::is_asked());
    interrupt::watch();
    thread::scope(|scope| {
        for pool in &pools {
            scope.spawn(|| {
                while let Some(index) = piece() {
                    pool.install(|| work(index));
                }
            });
        }
    });
    Ok(())
}
