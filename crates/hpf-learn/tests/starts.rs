//! Problems whose motions can fail or stop: starts that fail, and motions that can no longer be made.

use core::sync::atomic::{AtomicUsize, Ordering};

use hpf_learn::{
    AutoOptions, Block, CmaEsOptions, Cost, Draws, LearnError, LearningLoop, Method, Note, Parameters, Pi2Options,
    Problem, Record, Session,
};

/// The sum of squares of the distances to 3, of which the first `failing` motions fail and the last is `last`.
struct Bowl {
    blocks: Vec<Block>,
    made: AtomicUsize,
    failing: usize,
    last: usize,
}

impl Bowl {
    fn new(failing: usize, last: usize) -> Self {
        let (name, features, activations) = ("w".into(), vec![1.0, 1.0], vec![1.0, 1.0]);
        let block = Block { name, count: 2, features, activations, min: -10.0, max: 10.0, noise: 0.5 };
        Self { blocks: vec![block], made: AtomicUsize::new(0), failing, last }
    }
}

impl Problem for Bowl {
    type Workspace = ();

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn steps(&self) -> usize {
        1
    }

    fn terms(&self) -> &[&'static str] {
        &[]
    }

    fn workspace(&self) {}

    fn rollout(&self, _: Draws, parameters: Parameters<'_>, (): &mut (), cost: &mut Cost) {
        let made = self.made.fetch_add(1, Ordering::SeqCst) + 1;
        let height = parameters.at(0).iter().map(|w| (w - 3.0) * (w - 3.0)).sum::<f64>();
        let height = if made <= self.failing || made > self.last { f64::NAN } else { height };
        *cost = Cost { running: vec![height], terminal: 0.0, terms: Vec::new() };
    }

    fn is_stopped(&self) -> bool {
        self.made.load(Ordering::SeqCst) > self.last
    }

    fn may_start_fail(&self) -> bool {
        true
    }
}

fn methods() -> [Method; 3] {
    [
        Method::Pi2(Pi2Options { updates: 30, ..Pi2Options::default() }),
        Method::CmaEs(CmaEsOptions { rollouts: 10, updates: 30, seed: 1 }),
        Method::Auto(AutoOptions { rollouts: 4, updates: 30, seed: 1 }),
    ]
}

/// Learns on one thread, for motions count in their order; the session, its records, and why it ended early.
fn learn(bowl: &Bowl, method: &Method) -> (Session, Vec<Record>, Option<LearnError>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        let mut learning = LearningLoop::new(bowl, Session::begin(bowl, vec![0.0, 0.0], method, None).unwrap());
        let mut records = Vec::new();
        loop {
            match learning.step() {
                Ok(Some(told)) => records.push(told.record),
                Ok(None) => return (learning.session().clone(), records, None),
                Err(error) => return (learning.session().clone(), records, Some(error)),
            }
        }
    })
}

#[test]
fn a_start_that_fails_is_replaced_by_the_first_motion_near_it_that_does_not() {
    for method in methods() {
        for failing in [1, 2, 13] {
            let (session, records, ended) = learn(&Bowl::new(failing, usize::MAX), &method);
            assert_eq!(ended, None);
            let history = session.history();
            assert!(history.notes.iter().any(|note| matches!(note, Note::Sought(_))), "{method:?}");
            assert!(history.rejected >= failing, "{} of {failing}", history.rejected);
            // Near: each parameter off by some standard deviations of its noise.
            assert!(history.initial.weights.iter().all(|w| *w != 0.0 && w.abs() < 5.0 * 0.5));
            let height = |weights: &[f64]| weights.iter().map(|w| (w - 3.0) * (w - 3.0)).sum::<f64>();
            assert_eq!(history.initial.total, height(&history.initial.weights));
            assert!(history.best.total < 0.1 * history.initial.total, "{method:?}: {}", history.best.total);
            // TellOutcome the same again, another session is where this one is.
            let bowl = Bowl::new(0, 0);
            let mut again = Session::begin(&bowl, vec![0.0, 0.0], &method, None).unwrap();
            records.iter().for_each(|record| drop(again.replay(record).unwrap()));
            assert_eq!(again.history(), history);
        }
        let (_, _, ended) = learn(&Bowl::new(usize::MAX, usize::MAX), &method);
        assert_eq!(ended, Some(LearnError::NoStart { tried: 50 }));
    }
}

#[test]
fn motions_that_can_no_longer_be_made_tell_nothing() {
    for method in methods() {
        for last in [1, 7, 40] {
            let (session, records, ended) = learn(&Bowl::new(0, last), &method);
            assert_eq!(ended, Some(LearnError::Stopped));
            let bowl = Bowl::new(0, usize::MAX);
            let mut again = Session::begin(&bowl, vec![0.0, 0.0], &method, None).unwrap();
            records.iter().for_each(|record| drop(again.replay(record).unwrap()));
            assert_eq!(again.history(), session.history());
            assert_eq!(session.history().rejected, 0);
        }
    }
}
