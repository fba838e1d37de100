//! Many runs learned at once, each as it would be learned alone.

use core::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use hpf::failure::Failure;
use hpf::trial::{self, Broken, Prepared, Trial};
use hpf::{Nobody, Watch};

/// Who looks on while a study learns its runs.
///
/// Of each run it hears the notes, and is asked whether to end; it hears of no single evaluation.
pub trait StudyWatch: Watch {
    /// The study `name` has `all` runs, of which `done` are there already.
    fn planned(&self, name: &str, all: usize, done: usize) {
        let _ = (name, all, done);
    }

    /// The run `name` has ended; `failure` says why it has no result, where it has none.
    fn run_ended(&self, name: &str, failure: Option<&str>) {
        let _ = (name, failure);
    }
}

impl StudyWatch for Nobody {}

/// What the watch of a study hears of one run.
pub struct OneOfMany<'w>(pub &'w dyn StudyWatch);

impl Watch for OneOfMany<'_> {
    fn note(&self, sentence: &str) {
        self.0.note(sentence);
    }

    fn is_asked(&self) -> bool {
        self.0.is_asked()
    }

    fn is_urgent(&self) -> bool {
        self.0.is_urgent()
    }

    fn hold(&self, is_held: bool) {
        self.0.hold(is_held);
    }
}

/// Learns every one of `jobs` for the study `name`; returns what came of each, in their order. Where `watch` asks to end,
/// those that were not begun are interrupted.
///
/// # Errors
/// As [`side_by_side`].
pub fn learn_each(
    name: &str,
    jobs: &[Prepared],
    watch: &dyn StudyWatch,
) -> Result<Vec<Result<Trial, Broken>>, Failure> {
    let results: Vec<Mutex<Result<Trial, Broken>>> =
        jobs.iter().map(|_| Mutex::new(Err(Broken::Interrupted))).collect();
    watch.planned(name, jobs.len(), 0);
    side_by_side(jobs.len(), watch, |index| {
        let loaded = &jobs[index].loaded;
        let result = trial::learn(loaded, &OneOfMany(watch));
        watch.run_ended(&loaded.task.name, None);
        *results[index].lock().unwrap_or_else(PoisonError::into_inner) = result;
    })?;
    Ok(results.into_iter().map(|result| result.into_inner().unwrap_or_else(PoisonError::into_inner)).collect())
}

/// Calls `work` with 0 to `count - 1` until `watch` asks to end, on the threads of the current pool.
///
/// Each worker has a pool of its own: pieces that share one would steal from each other, and none would end early.
///
/// # Errors
/// [`Failure::Work`] where no threads can be started.
pub fn side_by_side(count: usize, watch: &dyn StudyWatch, work: impl Fn(usize) + Sync) -> Result<(), Failure> {
    let threads = rayon::current_num_threads();
    let workers = threads.min(count).max(1);
    let pool = || rayon::ThreadPoolBuilder::new().num_threads(threads / workers).build();
    let pools = (0..workers).map(|_| pool()).collect::<Result<Vec<_>, _>>();
    let pools = pools.map_err(|error| Failure::Work(format!("cannot start threads: {error}")))?;
    let next = AtomicUsize::new(0);
    let piece = || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|index| *index < count && !watch.is_asked());
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts runs, and asks to end after some.
    struct Counting {
        ended: AtomicUsize,
        most: usize,
    }

    impl Watch for Counting {
        fn is_asked(&self) -> bool {
            self.ended.load(Ordering::SeqCst) >= self.most
        }
    }

    impl StudyWatch for Counting {
        fn run_ended(&self, _: &str, _: Option<&str>) {
            self.ended.fetch_add(1, Ordering::SeqCst);
        }
    }

    #[test]
    fn work_ends_where_the_watch_asks_for_it_and_is_all_done_otherwise() {
        let made_of = |most: usize| {
            let (watch, made) = (Counting { ended: AtomicUsize::new(0), most }, AtomicUsize::new(0));
            let work = |_| {
                made.fetch_add(1, Ordering::SeqCst);
                watch.run_ended("", None);
            };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            pool.install(|| side_by_side(5, &watch, work)).unwrap();
            made.into_inner()
        };
        assert_eq!((made_of(3), made_of(usize::MAX)), (3, 5));
    }
}
