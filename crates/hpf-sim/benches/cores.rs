//! How far apart the cores are: what two threads of a run of learning hand each other goes from cache to cache.
//!
//! Beside it stands what the other benches say of two threads.

use core::hint::spin_loop;
use core::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

/// Times a line goes to the other core and back in one measurement.
const RETURNS: u32 = 10_000;

fn main() {
    if std::thread::available_parallelism().map_or(1, usize::from) < 2 {
        println!("there is one core alone");
        return;
    }
    let least = (0..200).map(|_| seconds()).fold(f64::INFINITY, f64::min);
    println!("a line of the cache goes to another core and back in {:.0} ns", 1e9 * least);
}

fn seconds() -> f64 {
    let turn = AtomicU32::new(0);
    // Whose turn it is passes to the other, from `first` on every second time.
    let play = |first: u32| {
        for own in (first..2 * RETURNS).step_by(2) {
            while turn.load(Ordering::Acquire) != own {
                spin_loop();
            }
            turn.store(own + 1, Ordering::Release);
        }
    };
    std::thread::scope(|scope| {
        let other = scope.spawn(|| play(1));
        // The thread is running when it has answered for the first time.
        turn.store(1, Ordering::Release);
        while turn.load(Ordering::Acquire) != 2 {
            spin_loop();
        }
        let begin = Instant::now();
        play(2);
        let seconds = begin.elapsed().as_secs_f64();
        other.join().expect("it only counts");
        seconds / f64::from(RETURNS - 1)
    })
}
