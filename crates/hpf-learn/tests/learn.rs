//! What a run of learning promises: the same bits on any number of threads, motions counted, the best kept.

use core::sync::atomic::{AtomicUsize, Ordering};

use crate::block::{FREE, block};
use hpf_learn::{
    Anneal, Block, Cost, Credit, Draws, Exploration, History, LearnError, Parameters, Pi2Error, Pi2Options, Problem,
    Temperature, TerminationReason, learn,
};

const STEPS: usize = 40;

/// A bowl: each step costs the squared distance of each block's mixture from that of a target.
struct Bowl {
    blocks: Vec<Block>,
    target: Vec<f64>,
    /// Rollouts made.
    made: AtomicUsize,
    /// The rollout from which on, counted from 1, the cost is NaN.
    broken_from: usize,
}

impl Bowl {
    fn new() -> Self {
        let blocks = vec![block("x", 6, STEPS, FREE, 1.0), block("k", 4, STEPS, (0.5, 2.0), 0.3)];
        Self {
            blocks,
            target: vec![1.0, -2.0, 0.5, 3.0, -1.0, 2.0, 1.0, 1.5, 0.8, 1.9],
            made: AtomicUsize::new(0),
            broken_from: usize::MAX,
        }
    }

    fn start() -> Vec<f64> {
        [[0.0; 6].as_slice(), &[1.0; 4]].concat()
    }

    fn made(&self) -> usize {
        self.made.load(Ordering::SeqCst)
    }
}

impl Problem for Bowl {
    type Workspace = ();

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn steps(&self) -> usize {
        STEPS
    }

    fn terms(&self) -> &[&'static str] {
        &["distance"]
    }

    fn workspace(&self) {}

    fn rollout(&self, _: Draws, parameters: Parameters<'_>, (): &mut (), cost: &mut Cost) {
        let number = self.made.fetch_add(1, Ordering::SeqCst) + 1;
        cost.running.clear();
        for t in 0..STEPS {
            let (mut start, mut sum) = (0, 0.0);
            for block in &self.blocks {
                let n = block.count;
                let phi = &block.features[t * n..(t + 1) * n];
                let row = &parameters.at(t)[start..start + n];
                let gap: f64 =
                    phi.iter().zip(row).zip(&self.target[start..]).map(|((phi, w), target)| phi * (w - target)).sum();
                sum += gap * gap;
                start += n;
            }
            cost.running.push(sum);
        }
        cost.terminal = if number >= self.broken_from { f64::NAN } else { 0.25 };
        cost.terms = vec![cost.total()];
    }
}

fn options(updates: usize) -> Pi2Options {
    Pi2Options { updates, anneal: Anneal::Geometric { last: 0.01 }, ..Pi2Options::default() }
}

#[test]
fn learning_finds_the_bottom_of_a_bowl() {
    let canonical = options(300);
    for (options, share) in [
        // The share of the excess cost that is left. Measured: 3.4e-4, 4.8e-4, 1.1e-3, 1.7e-2.
        (canonical, 1e-3),
        (Pi2Options { exploration: Exploration::Step, ..canonical }, 1e-3),
        (Pi2Options { temperature: Temperature::Lambda(0.1), ..canonical }, 3e-3),
        // A step that answers for the whole rollout hears more of what it did not do.
        (Pi2Options { credit: Credit::Total, ..canonical }, 3e-2),
    ] {
        let history = learn(&Bowl::new(), Bowl::start(), options, None, |_| true).unwrap();
        // 0.25 is what the end costs, whatever is done.
        let (first, last) = (history.initial.total - 0.25, history.best.total - 0.25);
        assert!(last >= 0.0 && last < share * first, "{options:?}: {first} -> {last}");
        assert!(history.best.weights[6..].iter().all(|w| (0.5..=2.0).contains(w)));
        assert_eq!((history.updates, history.rollouts, history.stop), (300, 1 + 300 * 21, TerminationReason::Updates));
    }
}

fn in_pool<R: Send>(threads: usize, run: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

#[test]
fn any_number_of_threads_learns_the_same_bits() {
    for exploration in [Exploration::Rollout, Exploration::Step] {
        let run = |threads: usize| {
            in_pool(threads, || {
                let mut seen: Vec<u64> = Vec::new();
                let history =
                    learn(&Bowl::new(), Bowl::start(), Pi2Options { exploration, ..options(15) }, None, |p| {
                        seen.push(p.total.to_bits());
                        seen.extend(p.weights.iter().map(|w| w.to_bits()));
                        true
                    });
                (seen, history.unwrap())
            })
        };
        let one = run(1);
        assert_eq!(one.0.len(), 16 * 11);
        assert_eq!(one, run(2));
        assert_eq!(one, run(7));
    }
}

#[test]
fn learning_never_makes_more_motions_than_allowed() {
    // A look, then 20 + 1 per update: 1, 22, 43, 64, ...
    for (allowed, made, updates) in [(1, 1, 0), (21, 1, 0), (22, 22, 1), (42, 22, 1), (43, 43, 2), (63, 43, 2)] {
        let bowl = Bowl::new();
        let mut observed = Vec::new();
        let history = learn(&bowl, Bowl::start(), options(10), Some(allowed), |p| {
            observed.push((p.update, p.rollouts));
            true
        })
        .unwrap();
        assert_eq!((bowl.made(), history.rollouts, history.updates), (made, made, updates), "{allowed} allowed");
        assert_eq!(history.stop, TerminationReason::Rollouts);
        let expected: Vec<_> = (0..=updates).map(|u| (u, 1 + 21 * u)).collect();
        assert_eq!(observed, expected);
    }
    let bowl = Bowl::new();
    let history = learn(&bowl, Bowl::start(), options(3), Some(64), |_| true).unwrap();
    assert_eq!((bowl.made(), history.rollouts, history.updates, history.stop), (64, 64, 3, TerminationReason::Updates));
}

#[test]
fn learning_stops_when_the_observer_asks() {
    for (last, made) in [(0, 1), (1, 22), (4, 85)] {
        let bowl = Bowl::new();
        let mut count = 0;
        let history = learn(&bowl, Bowl::start(), options(9), None, |progress| {
            count += 1;
            progress.update < last
        })
        .unwrap();
        assert_eq!(
            (history.stop, history.updates, bowl.made(), count),
            (TerminationReason::Requested, last, made, last + 1)
        );
    }
}

#[test]
fn the_best_is_the_cheapest_evaluation_seen() {
    // Noise this large makes some updates worse than the one before.
    let options = Pi2Options { rollouts: 3, anneal: Anneal::None, updates: 40, ..Pi2Options::default() };
    let bowl = Bowl::new();
    let mut seen = Vec::new();
    let history = learn(&bowl, Bowl::start(), options, None, |progress| {
        seen.push(progress.clone());
        true
    })
    .unwrap();
    assert_eq!(history.initial, seen[0]);
    let least = seen.iter().map(|p| p.total).fold(f64::INFINITY, f64::min);
    assert_eq!(history.best.total, least);
    assert!(seen.contains(&history.best));
    assert!(seen.windows(2).any(|pair| pair[1].total > pair[0].total), "some update made it worse");
    let mut again = Cost::default();
    bowl.rollout(Draws::HeldOut, Parameters::Constant(&history.best.weights), &mut (), &mut again);
    assert_eq!((again.total(), &again.terms), (history.best.total, &history.best.terms));
    assert!((history.best.terms[0] - history.best.total).abs() < 1e-15);
}

#[test]
fn progress_names_the_exploration_that_led_to_it() {
    let mut scales = Vec::new();
    let options = Pi2Options { updates: 3, anneal: Anneal::Linear { last: 0.1 }, ..Pi2Options::default() };
    learn(&Bowl::new(), Bowl::start(), options, None, |progress| {
        scales.push(progress.exploration);
        true
    })
    .unwrap();
    for (scale, expected) in scales.iter().zip([1.0, 1.0, 0.55, 0.1]) {
        assert!((scale - expected).abs() < 1e-15);
    }
}

#[test]
fn a_start_without_a_finite_cost_is_refused_after_one_motion() {
    let bowl = Bowl { broken_from: 1, ..Bowl::new() };
    let mut observed = 0;
    let refused = learn(&bowl, Bowl::start(), options(3), None, |_| {
        observed += 1;
        true
    });
    assert_eq!(refused, Err(LearnError::BadStart));
    assert_eq!((bowl.made(), observed), (1, 0));
    assert_eq!(LearnError::BadStart.to_string(), "the starting policy has no finite cost");
}

#[test]
fn what_was_learned_before_a_failure_is_kept() {
    // The first update and the look at it are motions 2 to 22; from motion 23 on nothing has a cost.
    let bowl = Bowl { broken_from: 23, ..Bowl::new() };
    let refused = in_pool(1, || learn(&bowl, Bowl::start(), options(5), None, |_| true));
    let Err(LearnError::Update { reason, history }) = refused else { panic!("not refused") };
    assert_eq!(reason, Pi2Error::AllRejected { update: 1, rollouts: 20 });
    let History { updates, rollouts, best, initial, .. } = *history;
    // The failed batch was made, too.
    assert_eq!((updates, rollouts), (1, 42));
    assert!(best.total <= initial.total);
}

#[test]
fn rejected_rollouts_are_counted_over_the_whole_run() {
    // Motion 1 is the look at the start, 2 to 21 the first batch, of which 7 fail; then the look at it, then all.
    let bowl = Bowl { broken_from: 15, ..Bowl::new() };
    let mut seen = Vec::new();
    let refused = in_pool(1, || {
        learn(&bowl, Bowl::start(), options(5), None, |progress| {
            seen.push(progress.total);
            true
        })
    });
    let Err(LearnError::Update { history, .. }) = refused else { panic!("not refused") };
    assert_eq!((history.rejected, history.updates), (7 + 20, 1));
    assert!(seen[1].is_nan(), "the evaluation after the update failed");
    assert_eq!(history.best, history.initial, "what has no cost is not the best");
}

#[test]
fn no_updates_leave_the_start() {
    let bowl = Bowl::new();
    let history = learn(&bowl, Bowl::start(), options(0), None, |_| true).unwrap();
    assert_eq!(
        (history.best.weights.as_slice(), history.stop, bowl.made()),
        (Bowl::start().as_slice(), TerminationReason::Updates, 1)
    );
}
