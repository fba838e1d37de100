//! A session told the same is in the same state, and counts every motion of every draw.

use core::sync::atomic::{AtomicUsize, Ordering};

use hpf_learn::{
    AutoOptions, Block, CmaEsOptions, Cost, Covariance, Draws, Driver, Exploration, GaussNewtonOptions, LearnError,
    Method, Parameters, Pi2Options, Problem, Record, Session, SignalGroup, SignalModel, Stop, Told, learn_with,
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
    /// Whether some motions fail, and all of the fifth batch.
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
        let is_bad = draws == Draws::Update(4) || parameters.at(0)[0].to_bits().is_multiple_of(5);
        cost.terminal = if self.fails && is_bad { f64::NAN } else { 0.0 };
        cost.terms = vec![cost.total()];
    }

    fn may_run_ahead(&self) -> bool {
        self.runs_ahead
    }

    fn together(&self) -> usize {
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
        (Method::Pi2(Pi2Options { elites: 3, ..pi2 }), false),
        // Settles on the roots of the costs, then on their squares, then PI2.
        (Method::Auto(AutoOptions { rollouts: 4, updates: 120, seed: 3 }), false),
        (Method::CmaEs(CmaEsOptions { rollouts: 6, updates: 25, seed: 4 }), false),
    ]
}

fn has_elites((method, _): &(Method, bool)) -> bool {
    matches!(method, Method::Pi2(options) if options.elites > 0)
}

#[test]
fn replayed_to_any_point_a_session_goes_on_to_the_same_bits() {
    for draws in [1, 3] {
        for (method, has_signals) in methods().into_iter().filter(|method| draws == 1 || !has_elites(method)) {
            let problem = Bent::new(has_signals, draws);
            let begin = || Session::begin(&problem, vec![0.1; 2 * COUNT], &method, Some(1500)).unwrap();
            let mut driver = Driver::new(&problem, begin());
            let (mut records, mut seen) = (Vec::new(), Vec::new());
            while let Some(told) = driver.step().unwrap() {
                records.push(told.record);
                seen.push(told.progress);
            }
            let mut session = driver.session().clone();
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
                let mut driver = Driver::new(&problem, again);
                for (record, progress) in records[point..].iter().zip(&seen[point..]) {
                    let told = driver.step().unwrap().unwrap();
                    assert_eq!((&told.record, &told.progress), (record, progress), "{method:?} from {point}");
                }
                assert_eq!(driver.step(), Ok(None));
                assert_eq!(driver.session().history(), session.history());
            }
        }
    }
}

#[test]
fn every_motion_of_every_draw_counts_and_none_is_made_beyond_the_limit() {
    for draws in [1, 3] {
        for (method, has_signals) in methods().into_iter().filter(|method| draws == 1 || !has_elites(method)) {
            for allowed in [40, 41, 77, 100] {
                let problem = Bent::new(has_signals, draws);
                let history = learn_with(&problem, vec![0.1; 2 * COUNT], &method, Some(allowed), |_| true).unwrap();
                let made = problem.made();
                assert_eq!(history.rollouts, made, "{method:?}, {draws} draws");
                assert!(made <= allowed && (made > allowed / 3 || history.stop != Stop::Rollouts), "{made}/{allowed}");
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
            assert_eq!((history.rollouts, history.stop), (1, Stop::Rollouts), "{method:?}");
            assert!(history.initial.total.is_finite() && history.best == history.initial);
        }
    }
}

/// All that is told, and how it ends, on so many threads; the motions made.
fn run(problem: &Bent, method: &Method, allowed: usize, threads: usize) -> (Vec<Told>, String, usize) {
    let session = Session::begin(problem, vec![0.1; 2 * COUNT], method, Some(allowed)).unwrap();
    let (mut driver, mut all) = (Driver::new(problem, session), Vec::new());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let end = pool.install(|| {
        loop {
            match driver.step() {
                Ok(Some(told)) => all.push(told),
                Ok(None) => break format!("{:?}", driver.session().history()),
                Err(error) => break format!("{error:?}"),
            }
        }
    });
    (all, end, problem.made())
}

#[test]
fn updates_made_before_the_evaluations_of_those_before_change_nothing() {
    let (mut failed, mut unpriced) = (0, 0);
    for (draws, fails) in [(1, false), (3, false), (1, true), (3, true)] {
        for (method, has_signals) in methods().into_iter().filter(|method| draws == 1 || !has_elites(method)) {
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
        assert_eq!((history.rollouts, history.stop), (made, Stop::Asked));
        for (threads, together) in [(1, 1), (1, 3), (1, 8), (2, 1), (3, 3)] {
            let (ahead, made_ahead) = learned(threads, together);
            assert_eq!(ahead, history);
            // Updates are batches of five and an evaluation; a batch follows beside the evaluations.
            let most = made + 6 * together * threads + 5;
            assert!((made..=most).contains(&made_ahead), "{made_ahead} rather than {made}");
        }
    }
}

#[test]
fn a_batch_is_handed_out_before_it_is_evaluated_where_motions_are_dear() {
    let problem = Bent { runs_ahead: false, ..Bent::new(false, 1) };
    let session = Session::begin(&problem, vec![0.1; 2 * COUNT], &methods()[0].0, None).unwrap();
    let mut driver = Driver::new(&problem, session);
    let mut made = Vec::new();
    for _ in 0..5 {
        driver.step().unwrap().unwrap();
        made.push(problem.made());
    }
    assert_eq!(made, [1, 6, 7, 12, 13]);
}

#[test]
fn with_draws_the_best_is_what_its_evaluation_on_those_held_out_says() {
    for (method, has_signals) in methods().into_iter().filter(|method| !has_elites(method)) {
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
fn elites_weigh_again_without_a_motion_and_are_refused_where_costs_are_random() {
    let learned = |elites, draws| {
        let method = Method::Pi2(Pi2Options { rollouts: 4, updates: 60, elites, ..Pi2Options::default() });
        learn_with(&Bent::new(false, draws), vec![0.1; 2 * COUNT], &method, None, |_| true)
    };
    let (without, with) = (learned(0, 1).unwrap(), learned(3, 1).unwrap());
    assert_eq!(with.rollouts, without.rollouts);
    assert_ne!(with.best.weights, without.best.weights);
    assert!(with.best.total < with.initial.total);
    assert_eq!(learned(3, 2), Err(LearnError::RandomElites));
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
        elites: vec![],
    };
    for (i, record) in [(0, &none), (0, &update), (0, &Record::Costs(vec![])), (2, &none), (2, &update), (6, &none)] {
        assert_eq!(begin(i).replay(record), Err(LearnError::WrongRecord), "{i} {record:?}");
    }
}

#[test]
#[should_panic(expected = "one cost for each sample asked for")]
fn telling_of_another_number_of_samples_is_a_mistake_of_the_program() {
    let problem = Bent::new(true, 1);
    let mut session = Session::begin(&problem, vec![0.1; 2 * COUNT], &methods()[0].0, None).unwrap();
    let _ = session.tell(&[Cost::default(), Cost::default()], &[]);
}
