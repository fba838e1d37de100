//! A session told the same is in the same state, and counts every motion of every draw.

use core::sync::atomic::{AtomicUsize, Ordering};

use hpf_learn::{
    AutoOptions, Block, CmaEsOptions, Cost, Covariance, Draws, Exploration, GaussNewtonOptions, LearnError,
    LearningLoop, Method, Parameters, Pi2Options, Problem, Record, Session, ShapeError, SignalGroup, SignalModel,
    TellOutcome, TerminationReason, learn_with,
};

const STEPS: usize = 6;
const COUNT: usize = 3;

/// Signals that bend: `rho_t = a_t . w + (a_t . w)^3/10 - c_t`, and the cost of step t is `rho_t^2/2`. With several
/// draws the cost is the mean over as many shifts of c, others for every draw asked for.
struct Bent {
    blocks: Vec<Block>,
    model: Option<SignalModel>,
    draws: usize,
    made: AtomicUsize,
    runs_ahead: bool,
    together: usize,
    /// Whether three of five motions fail.
    fails: bool,
}

impl Bent {
    fn new(has_signals: bool, draws: usize) -> Self {
        let block = |min: f64, max: f64| Block {
            name: "w".into(),
            count: COUNT,
            features: vec![1.0 / COUNT as f64; STEPS * COUNT],
            activations: vec![1.0; STEPS * COUNT],
            min,
            max,
            noise: 0.2,
        };
        let model = SignalModel {
            groups: vec![SignalGroup { parameters: 0..2 * COUNT, signals: 0..STEPS }],
            price: vec![vec![]; 2],
            distances: vec![],
        };
        Self {
            blocks: vec![block(f64::NEG_INFINITY, f64::INFINITY), block(-0.5, 0.5)],
            model: has_signals.then_some(model),
            draws,
            made: AtomicUsize::new(0),
            runs_ahead: true,
            together: 4,
            fails: false,
        }
    }

    fn made(&self) -> usize {
        self.made.load(Ordering::SeqCst)
    }

    fn signals_at(&self, draws: Draws, w: &[f64], draw: usize) -> Vec<f64> {
        let shift = match draws {
            _ if self.draws == 1 => 0.0,
            Draws::Update(update) => 0.1 * ((update * 7 + draw) as f64).sin(),
            Draws::HeldOut => 0.1 * (100.0 + draw as f64).sin(),
        };
        let signal = |t: usize| {
            let a = w.iter().enumerate().map(|(j, w)| w * (1.3 * t as f64 + 2.1 * j as f64).sin()).sum::<f64>();
            a + 0.1 * a * a * a - (t as f64).cos() - shift
        };
        (0..STEPS).map(signal).collect()
    }
}

impl Problem for Bent {
    type Workspace = ();

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn steps(&self) -> usize {
        STEPS
    }

    fn terms(&self) -> &[&'static str] {
        &["all"]
    }

    fn workspace(&self) {}

    fn motions(&self) -> usize {
        self.draws
    }

    fn rollout(&self, draws: Draws, parameters: Parameters<'_>, (): &mut (), cost: &mut Cost) {
        self.made.fetch_add(self.draws, Ordering::SeqCst);
        cost.running = (0..STEPS)
            .map(|t| {
                let square = |draw| self.signals_at(draws, parameters.at(t), draw)[t].powi(2);
                0.5 * (0..self.draws).map(square).sum::<f64>() / self.draws as f64
            })
            .collect();
        // The start does not fail; now and then a whole batch does.
        let is_bad = [0, 1, 3].contains(&(parameters.at(0)[0].to_bits() % 5));
        cost.terminal = if self.fails && is_bad { f64::NAN } else { 0.0 };
        cost.terms = vec![cost.total()];
    }

    fn may_run_ahead(&self) -> bool {
        self.runs_ahead
    }

    fn batch_size(&self) -> usize {
        self.together.max(1)
    }

    fn signals(&self) -> Option<&SignalModel> {
        self.model.as_ref()
    }

    fn measure(&self, draws: Draws, parameters: Parameters<'_>, (): &mut (), cost: &mut Cost, signals: &mut Vec<f64>) {
        self.rollout(draws, parameters, &mut (), cost);
        *signals = self.signals_at(draws, parameters.at(0), 0);
    }
}

fn methods() -> Vec<(Method, bool)> {
    let pi2 = Pi2Options { rollouts: 5, updates: 12, ..Pi2Options::default() };
    let adapted = Covariance::Diagonal { floor: 0.1, ceiling: 2.0 };
    vec![
        (Method::Pi2(pi2), true),
        (Method::Pi2(Pi2Options { covariance: adapted, exploration: Exploration::Step, ..pi2 }), false),
        (Method::GaussNewton(GaussNewtonOptions { rollouts: 3, updates: 30, seed: 2 }), true),
        (Method::Auto(AutoOptions { rollouts: 4, updates: 40, seed: 3 }), true),
        // Settles on the roots of the costs, then on their squares, then PI2.
        (Method::Auto(AutoOptions { rollouts: 4, updates: 120, seed: 3 }), false),
        (Method::CmaEs(CmaEsOptions { rollouts: 6, updates: 25, seed: 4 }), false),
    ]
}

#[test]
fn replayed_to_any_point_a_session_goes_on_to_the_same_bits() {
    for draws in [1, 3] {
        for (method, has_signals) in methods() {
            let problem = Bent::new(has_signals, draws);
            let begin = || Session::begin(&problem, vec![0.1; 2 * COUNT], &method, Some(1500)).unwrap();
            let mut learning = LearningLoop::new(&problem, begin());
            let (mut records, mut seen) = (Vec::new(), Vec::new());
            while let Some(told) = learning.step().unwrap() {
                records.push(told.record);
                seen.push(told.progress);
            }
            let mut session = learning.session().clone();
            assert!(session.is_over() && session.ask().is_none());
            if let (Method::Auto(_), false) = (method, has_signals) {
                assert_eq!(session.history().notes.len(), 3, "all stages: {:?}", session.history().notes);
            }
            assert!(records.len() > 8, "{method:?}: {}", records.len());
            for point in 0..=records.len() {
                let mut again = begin();
                for (record, progress) in records[..point].iter().zip(&seen) {
                    assert_eq!(again.replay(record).unwrap(), *progress);
                }
                // Wherever it may stop, there is something to keep.
                assert!(!again.is_evaluated() || again.history().best.total.is_finite(), "{method:?} at {point}");
                let mut learning = LearningLoop::new(&problem, again);
                for (record, progress) in records[point..].iter().zip(&seen[point..]) {
                    let told = learning.step().unwrap().unwrap();
                    assert_eq!((&told.record, &told.progress), (record, progress), "{method:?} from {point}");
                }
                assert_eq!(learning.step(), Ok(None));
                assert_eq!(learning.session().history(), session.history());
            }
        }
    }
}

#[test]
fn every_motion_of_every_draw_counts_and_none_is_made_beyond_the_limit() {
    for draws in [1, 3] {
        for (method, has_signals) in methods() {
            for allowed in [40, 41, 77, 100] {
                let problem = Bent::new(has_signals, draws);
                let history = learn_with(&problem, vec![0.1; 2 * COUNT], &method, Some(allowed), |_| true).unwrap();
                let made = problem.made();
                assert_eq!(history.rollouts, made, "{method:?}, {draws} draws");
                assert!(
                    made <= allowed && (made > allowed / 3 || history.stop != TerminationReason::Rollouts),
                    "{made}/{allowed}"
                );
                assert!(history.best.rollouts <= made && history.best.total <= history.initial.total);
            }
        }
    }
}

#[test]
fn the_start_is_known_however_few_motions_are_allowed() {
    for (method, has_signals) in methods() {
        for allowed in [0, 1] {
            let problem = Bent::new(has_signals, 1);
            let history = learn_with(&problem, vec![0.1; 2 * COUNT], &method, Some(allowed), |_| true).unwrap();
            assert_eq!((history.rollouts, history.stop), (1, TerminationReason::Rollouts), "{method:?}");
            assert!(history.initial.total.is_finite() && history.best == history.initial);
        }
    }
}

/// All that is told, and how it ends, on so many threads; the motions made.
fn run(problem: &Bent, method: &Method, allowed: usize, threads: usize) -> (Vec<TellOutcome>, String, usize) {
    let session = Session::begin(problem, vec![0.1; 2 * COUNT], method, Some(allowed)).unwrap();
    let (mut learning, mut all) = (LearningLoop::new(problem, session), Vec::new());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let end = pool.install(|| {
        loop {
            match learning.step() {
                Ok(Some(told)) => all.push(told),
                Ok(None) => break format!("{:?}", learning.session().history()),
                Err(error) => break format!("{error:?}"),
            }
        }
    });
    (all, end, problem.made())
}

#[test]
fn a_batch_made_beside_the_evaluation_before_it_changes_nothing() {
    let (mut failed, mut unpriced) = (0, 0);
    for (draws, fails) in [(1, false), (3, false), (1, true), (3, true)] {
        for (method, has_signals) in methods() {
            let problem =
                |together| Bent { runs_ahead: together > 0, together, fails, ..Bent::new(has_signals, draws) };
            // The limit falls before, within and after an update.
            for allowed in [36, 37, 38, 40, 77, 1000] {
                let (told, end, made) = run(&problem(0), &method, allowed, 1);
                failed += usize::from(end.contains("AllRejected"));
                unpriced += told.iter().filter_map(|told| told.progress.as_ref()).filter(|p| p.total.is_nan()).count();
                for (threads, together) in [(1, 4), (2, 1), (2, 3), (7, 4), (7, 50)] {
                    // Not as numbers, for NaN is not itself.
                    let ahead = run(&problem(together), &method, allowed, threads);
                    assert_eq!((format!("{:?}", ahead.0), ahead.1, ahead.2), (format!("{told:?}"), end.clone(), made));
                }
            }
        }
    }
    assert!(failed > 0 && unpriced > 0, "batches and evaluations failed: {failed}, {unpriced}");
}

#[test]
fn motions_made_ahead_do_not_count_where_nobody_goes_on() {
    let method = methods()[0].0;
    for last in 0..7 {
        let learned = |threads, together| {
            let problem = Bent { runs_ahead: together > 0, together, ..Bent::new(false, 1) };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let learn = || learn_with(&problem, vec![0.1; 2 * COUNT], &method, None, |p| p.update < last);
            (pool.install(learn).unwrap(), problem.made())
        };
        let (history, made) = learned(1, 0);
        assert_eq!((history.rollouts, history.stop), (made, TerminationReason::Requested));
        for (threads, together) in [(1, 1), (1, 3), (1, 8), (2, 1), (3, 3)] {
            let (ahead, made_ahead) = learned(threads, together);
            assert_eq!(ahead, history);
            // Updates are batches of five and an evaluation; a batch follows beside the evaluation.
            let most = made + 5;
            assert!((made..=most).contains(&made_ahead), "{made_ahead} rather than {made}");
        }
    }
}

#[test]
fn a_batch_is_handed_out_before_it_is_evaluated_where_motions_are_dear() {
    let problem = Bent { runs_ahead: false, ..Bent::new(false, 1) };
    let session = Session::begin(&problem, vec![0.1; 2 * COUNT], &methods()[0].0, None).unwrap();
    let mut learning = LearningLoop::new(&problem, session);
    let mut made = Vec::new();
    for _ in 0..5 {
        learning.step().unwrap().unwrap();
        made.push(problem.made());
    }
    assert_eq!(made, [1, 6, 7, 12, 13]);
}

#[test]
fn with_draws_the_best_is_what_its_evaluation_on_those_held_out_says() {
    for (method, has_signals) in methods() {
        let problem = Bent::new(has_signals, 3);
        let history = learn_with(&problem, vec![0.1; 2 * COUNT], &method, Some(2000), |_| true).unwrap();
        for progress in [&history.initial, &history.best] {
            let mut cost = Cost::default();
            problem.rollout(Draws::HeldOut, Parameters::Constant(&progress.weights), &mut (), &mut cost);
            assert_eq!(cost.total(), progress.total, "{method:?}");
        }
        assert!(history.best.total < history.initial.total, "{method:?}");
    }
}

#[test]
fn a_record_of_something_else_is_refused() {
    let signals = Bent::new(true, 1);
    let method = |i: usize| methods()[i].0;
    let begin = |i| Session::begin(&signals, vec![0.1; 2 * COUNT], &method(i), None).unwrap();
    let none = Record::Signals { prices: vec![], signals: vec![] };
    let update = Record::Update {
        update: 1,
        weights: vec![1.0],
        spread: vec![1.0],
        exploration: 1.0,
        rejected: 0,
        cheapest: None,
    };
    for (i, record) in [(0, &none), (0, &update), (0, &Record::Costs(vec![])), (2, &none), (2, &update), (5, &none)] {
        assert_eq!(begin(i).replay(record), Err(LearnError::WrongRecord), "{i} {record:?}");
    }
}

#[test]
fn an_answer_of_another_size_is_refused_and_changes_nothing() {
    let problem = Bent::new(true, 1);
    let mut session = Session::begin(&problem, vec![0.1; 2 * COUNT], &methods()[2].0, None).unwrap();
    let before = session.clone().history();
    let asked = session.ask().unwrap().samples.len();
    let costs = vec![Cost::default(); asked + 1];
    let length = |what, found, expected| Err(LearnError::Shape(ShapeError::Length { what, found, expected }));
    assert_eq!(session.tell(&costs, &[]), length("costs".into(), asked + 1, asked));
    assert_eq!(session.tell(&costs[..asked], &[]), length("signals".into(), 0, asked));
    assert_eq!(session.history(), before);
}

#[test]
fn a_problem_that_does_not_fit_together_is_refused_by_name() {
    let refused = |change: &dyn Fn(&mut Block), count: usize| {
        let mut problem = Bent::new(false, 1);
        change(&mut problem.blocks[1]);
        Session::begin(&problem, vec![0.1; count], &methods()[0].0, None).unwrap_err().to_string()
    };
    let whole = 2 * COUNT;
    assert_eq!(refused(&|_| {}, whole + 1), format!("weights: {} numbers where {whole} belong", whole + 1));
    type Change = fn(&mut Block);
    let changes: [(Change, &str); 5] = [
        (|block| block.features.truncate(1), "features of block"),
        (|block| block.activations.truncate(1), "activations of block"),
        (|block| block.min = f64::NAN, "has no range"),
        (|block| (block.min, block.max) = (1.0, -1.0), "has no range"),
        (|block| block.noise = -1.0, "noise"),
    ];
    for (change, words) in changes {
        let message = refused(&change, whole);
        assert!(message.contains(words), "{message}");
    }
}
