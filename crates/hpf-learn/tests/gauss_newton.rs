//! Learning from signals, on problems whose optimum is known, and what a run of it promises.

use core::sync::atomic::{AtomicUsize, Ordering};

use hpf_learn::{
    AutoOptions, Block, Cost, Draws, Exhausted, GaussNewton, GaussNewtonOptions, History, LearnError, Method, Note,
    Parameters, Pi2Options, Problem, SignalGroup, SignalModel, TerminationReason, learn_with,
};

const COUNT: usize = 4;
const SIGNALS: usize = 12;

/// Two axes of two blocks each. The first block of an axis answers linearly, the second by its inverse, as a
/// position answers to a stiffness: signal i of an axis is `sum_j a_ij w_j + 3 sum_j b_ij / v_j - c_i`, plus
/// `coupling` times the other axis's first signal's movement part.
struct Toy {
    blocks: Vec<Block>,
    model: Option<SignalModel>,
    coupling: f64,
    /// Signals are NaN where a parameter of the second blocks is larger than this.
    broken_above: f64,
    /// Costs have this added to their first step.
    offset: f64,
    /// And up to twice this, another number in every rollout.
    noise: f64,
    made: AtomicUsize,
}

fn number(i: usize, j: usize) -> f64 {
    (1.0 + 1.7 * i as f64 + 5.3 * j as f64 + 0.9 * (i * j) as f64).sin()
}

impl Toy {
    fn new() -> Self {
        let block = |name: &str, min, max, noise| Block {
            name: name.into(),
            count: COUNT,
            features: vec![0.25; SIGNALS * COUNT],
            activations: vec![1.0; SIGNALS * COUNT],
            min,
            max,
            noise,
        };
        let free = (f64::NEG_INFINITY, f64::INFINITY);
        let blocks = ["x", "y"].into_iter().flat_map(|axis| {
            [block(&format!("{axis}.w"), free.0, free.1, 1.0), block(&format!("{axis}.v"), 0.5, 4.0, 0.3)]
        });
        let identity = |i: usize| if i.is_multiple_of(COUNT + 1) { 0.02 } else { 0.0 };
        let price: Vec<f64> = (0..COUNT * COUNT).map(identity).collect();
        let group = |a: usize| SignalGroup {
            parameters: 2 * COUNT * a..2 * COUNT * (a + 1),
            signals: SIGNALS * a..SIGNALS * (a + 1),
        };
        Self {
            blocks: blocks.collect(),
            model: Some(SignalModel {
                groups: vec![group(0), group(1)],
                price: vec![vec![], price.clone(), vec![], price],
                distances: vec![],
            }),
            coupling: 0.0,
            broken_above: f64::INFINITY,
            offset: 0.0,
            noise: 0.0,
            made: AtomicUsize::new(0),
        }
    }

    fn start() -> Vec<f64> {
        [[0.0; COUNT], [1.0; COUNT], [0.0; COUNT], [1.0; COUNT]].concat()
    }

    fn signals_at(&self, w: &[f64]) -> Vec<f64> {
        let linear =
            |a: usize, i: usize| -> f64 { (0..COUNT).map(|j| number(i + 3 * a, j) * w[2 * COUNT * a + j]).sum() };
        let mut rho = Vec::new();
        for a in 0..2 {
            let v = &w[2 * COUNT * a + COUNT..2 * COUNT * (a + 1)];
            for i in 0..SIGNALS {
                let inverse: f64 = (0..COUNT).map(|j| number(i, j + 7) / v[j]).sum();
                let broken = if v.iter().any(|v| *v > self.broken_above) { f64::NAN } else { 0.0 };
                let other = self.coupling * linear(1 - a, i);
                rho.push(linear(a, i) + other + 3.0 * inverse - 2.0 * number(i, 20 + a) + broken);
            }
        }
        rho
    }

    fn price_at(w: &[f64]) -> f64 {
        let gains = w[COUNT..2 * COUNT].iter().chain(&w[3 * COUNT..]);
        gains.map(|v| 0.5 * 0.02 * v * v).sum()
    }
}

impl Problem for Toy {
    type Workspace = ();

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn steps(&self) -> usize {
        SIGNALS
    }

    fn terms(&self) -> &[&'static str] {
        &["all"]
    }

    fn workspace(&self) {}

    fn rollout(&self, _: Draws, parameters: Parameters<'_>, (): &mut (), cost: &mut Cost) {
        let made = self.made.fetch_add(1, Ordering::SeqCst);
        let w = parameters.at(0);
        let rho = self.signals_at(w);
        cost.running = (0..SIGNALS).map(|i| 0.5 * (rho[i] * rho[i] + rho[SIGNALS + i] * rho[SIGNALS + i])).collect();
        cost.running[0] += self.offset + self.noise * (1.0 + number(made, 0));
        cost.terminal = Self::price_at(w);
        cost.terms = vec![cost.total()];
    }

    fn signals(&self) -> Option<&SignalModel> {
        self.model.as_ref()
    }

    fn measure(&self, draws: Draws, parameters: Parameters<'_>, (): &mut (), cost: &mut Cost, signals: &mut Vec<f64>) {
        self.rollout(draws, parameters, &mut (), cost);
        *signals = self.signals_at(parameters.at(0));
    }
}

fn options(rollouts: usize) -> GaussNewtonOptions {
    GaussNewtonOptions { rollouts, updates: 300, seed: 3 }
}

fn learned(toy: &Toy, options: GaussNewtonOptions) -> History {
    learn_with(toy, Toy::start(), &Method::GaussNewton(options), None, |_| true).unwrap()
}

/// Largest slope of the cost at `w`, of the coordinates that are free to follow it, by central differences.
fn steepest(toy: &Toy, w: &[f64]) -> f64 {
    let cost = |w: &[f64]| 0.5 * toy.signals_at(w).iter().map(|rho| rho * rho).sum::<f64>() + Toy::price_at(w);
    let mut steepest = 0.0_f64;
    for j in 0..w.len() {
        let (mut up, mut down) = (w.to_vec(), w.to_vec());
        up[j] += 1e-5;
        down[j] -= 1e-5;
        let slope = (cost(&up) - cost(&down)) / 2e-5;
        let bounds = &toy.blocks[j / COUNT];
        let is_held = (w[j] <= bounds.min && slope > 0.0) || (w[j] >= bounds.max && slope < 0.0);
        if !is_held {
            steepest = steepest.max(slope.abs());
        }
    }
    steepest
}

#[test]
fn learning_ends_where_the_cost_is_level_and_says_so() {
    let toy = Toy::new();
    let history = learned(&toy, options(7));
    assert_eq!(history.stop, TerminationReason::Exhausted(Exhausted::NothingImproves));
    assert!(history.notes.is_empty() && history.rejected == 0);
    // Of a slope of some tens at the start; the last rounds gain less than a thousandth of the cost.
    let (before, after) = (steepest(&toy, &Toy::start()), steepest(&toy, &history.best.weights));
    assert!(before > 10.0 && after < 0.05, "{before} {after}, {}", history.best.total);
    assert_eq!(history.rollouts, toy.made.load(Ordering::SeqCst), "every motion counts, and none is made twice");
}

#[test]
fn the_number_of_rollouts_at_a_time_changes_nothing() {
    let one = learned(&Toy::new(), options(1));
    for rollouts in [2, 5, 64] {
        assert_eq!(learned(&Toy::new(), options(rollouts)), one);
    }
}

#[test]
fn any_number_of_threads_learns_the_same_bits() {
    let methods = [
        Method::GaussNewton(options(8)),
        Method::Auto(AutoOptions { rollouts: 8, updates: 60, seed: 2 }),
        Method::Pi2(Pi2Options { updates: 5, ..Pi2Options::default() }),
    ];
    for method in methods {
        for model in [true, false] {
            let run = |threads: usize| {
                let mut toy = Toy::new();
                if !model && !matches!(method, Method::GaussNewton(_)) {
                    toy.model = None;
                }
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut seen = Vec::new();
                let history = pool.install(|| {
                    learn_with(&toy, Toy::start(), &method, Some(900), |progress| {
                        seen.extend(progress.weights.iter().map(|w| w.to_bits()));
                        true
                    })
                });
                (history.unwrap(), seen)
            };
            let one = run(1);
            assert_eq!(run(2), one);
            assert_eq!(run(7), one);
        }
    }
}

#[test]
fn samples_stay_within_their_bounds_and_perturbations_within_the_noise() {
    let toy = Toy::new();
    let mut learner = GaussNewton::new(&toy.blocks, toy.signals().unwrap(), Toy::start(), options(1));
    let mut made = 0;
    while learner.exhausted().is_none() {
        let sample = learner.ask()[0].clone();
        for (j, w) in sample.iter().enumerate() {
            let block = &toy.blocks[j / COUNT];
            assert!((block.min..=block.max).contains(w));
            // Looks, bends and columns come before the first step: 4 + 5 + 8 of them. 1e-12: rounding.
            if made < 17 {
                assert!((w - Toy::start()[j]).abs() <= block.noise + 1e-12);
            }
        }
        made += 1;
        learner.tell(&[toy.signals_at(&sample)]);
    }
    assert!(made > 17 && learner.ask().is_empty());
}

#[test]
fn groups_that_act_on_each_other_are_found_and_learned_together() {
    let toy = Toy { coupling: 0.3, ..Toy::new() };
    let history = learned(&toy, options(7));
    assert_eq!(history.notes, [Note::Coupled]);
    assert!(steepest(&toy, &history.best.weights) < 0.05);
}

#[test]
fn rollouts_without_finite_signals_are_rejected_and_perturbations_shrink() {
    // A whole perturbation of 0.3 from 1 breaks, a quarter of it does not.
    let toy = Toy { broken_above: 1.1, ..Toy::new() };
    let history = learned(&toy, options(7));
    assert!(history.rejected > 0);
    assert!(history.best.weights.iter().all(|w| w.is_finite()));
    assert!(history.best.total < 0.5 * history.initial.total, "{} {}", history.initial.total, history.best.total);
    // Broken at the very start, there is nothing to learn from.
    let toy = Toy { broken_above: 0.9, ..Toy::new() };
    let refused = learn_with(&toy, Toy::start(), &Method::GaussNewton(options(7)), None, |_| true);
    assert_eq!(refused, Err(LearnError::BadStart));
    // Broken but for the start itself: it ends, and says why.
    let toy = Toy { broken_above: 1.0, ..Toy::new() };
    let mut only = Toy { model: toy.model.clone(), ..toy };
    only.blocks.iter_mut().filter(|block| block.min > 0.0).for_each(|block| block.min = 1.0);
    let history = learned(&only, options(7));
    assert_eq!(history.stop, TerminationReason::Exhausted(Exhausted::NoSignals));
    assert_eq!(history.best, history.initial);
}

#[test]
fn parameters_without_noise_stay_where_they_are() {
    let mut toy = Toy::new();
    toy.blocks[1].noise = 0.0;
    toy.blocks[3].max = 1.0;
    toy.blocks[3].min = 1.0;
    let history = learned(&toy, options(7));
    assert_eq!(history.best.weights[COUNT..2 * COUNT], Toy::start()[COUNT..2 * COUNT]);
    assert_eq!(history.best.weights[3 * COUNT..], Toy::start()[3 * COUNT..]);
    assert!(history.best.total < history.initial.total);
}

#[test]
fn learning_stops_at_the_motions_allowed_and_when_asked() {
    for allowed in [1, 2, 5, 20, 33] {
        let toy = Toy::new();
        let method = Method::GaussNewton(options(7));
        let history = learn_with(&toy, Toy::start(), &method, Some(allowed), |_| true).unwrap();
        assert_eq!((history.rollouts, toy.made.load(Ordering::SeqCst)), (allowed, allowed));
        assert_eq!(history.stop, TerminationReason::Rollouts);
    }
    let mut seen = Vec::new();
    let method = Method::GaussNewton(options(7));
    let history = learn_with(&Toy::new(), Toy::start(), &method, None, |progress| {
        seen.push((progress.update, progress.rollouts));
        progress.update < 2
    })
    .unwrap();
    assert_eq!((history.stop, history.updates, seen[0]), (TerminationReason::Requested, 2, (0, 1)));
    // 4 looks, 5 bends, 8 columns; a round is 3 trials and 2 corrections.
    assert_eq!(seen[1..], [(1, 4 + 5 + 8 + 5), (2, 4 + 5 + 8 + 10)]);
}

#[test]
fn auto_takes_signals_where_there_are_any_and_costs_where_not() {
    let method = Method::Auto(AutoOptions { rollouts: 10, updates: 400, seed: 3 });
    let with = learn_with(&Toy::new(), Toy::start(), &method, None, |_| true).unwrap();
    assert!(with.best.total <= learned(&Toy::new(), options(10)).best.total, "after signals PI2 goes on");
    assert_eq!(with.notes, [Note::FellBack(Exhausted::NothingImproves)]);
    let blind = Toy { model: None, ..Toy::new() };
    let without = learn_with(&blind, Toy::start(), &method, None, |_| true).unwrap();
    let stalled = Exhausted::NothingImproves;
    assert_eq!(without.notes, [Note::NoSignals, Note::StepCosts(stalled), Note::FellBack(stalled)]);
    assert_eq!(without.stop, TerminationReason::Exhausted(Exhausted::NothingImproves));
    assert_eq!(without.rollouts, blind.made.load(Ordering::SeqCst));
    let gap = |history: &History| history.best.total / with.best.total;
    assert!(gap(&without) < 1.01, "{}", gap(&without));
}

fn from_costs(toy: &Toy, rollouts: usize, max_rollouts: usize) -> History {
    let method = Method::Auto(AutoOptions { rollouts, updates: 1000, seed: 3 });
    learn_with(toy, Toy::start(), &method, Some(max_rollouts), |_| true).unwrap()
}

#[test]
fn the_squares_of_costs_are_learned_alike_however_many_rollouts_are_made_at_a_time() {
    let blind = || Toy { model: None, ..Toy::new() };
    let history = from_costs(&blind(), 1, 600);
    assert_eq!(history.notes, [Note::NoSignals, Note::StepCosts(Exhausted::NothingImproves)]);
    for rollouts in [3, 50] {
        assert_eq!(from_costs(&blind(), rollouts, 600), history);
    }
}

#[test]
fn squares_of_costs_are_learned_until_every_perturbation_fails() {
    let toy = Toy { model: None, broken_above: 1.1, ..Toy::new() };
    let history = from_costs(&toy, 10, 1500);
    assert_eq!(history.notes, [Note::NoSignals, Note::StepCosts(Exhausted::NothingImproves)]);
    // It ends at the wall, where every perturbation of all parameters has one that breaks.
    assert_eq!(history.stop, TerminationReason::Exhausted(Exhausted::NoSignals));
    assert!(history.rejected > 0);
    assert!(history.best.total < 0.5 * history.initial.total, "{} {}", history.initial.total, history.best.total);
}

#[test]
fn costs_of_parameters_without_noise_end_where_they_began() {
    let mut toy = Toy { model: None, ..Toy::new() };
    toy.blocks.iter_mut().for_each(|block| block.noise = 0.0);
    let history = from_costs(&toy, 10, 1000);
    assert_eq!(history.best, history.initial);
    assert_eq!(history.stop, TerminationReason::Exhausted(Exhausted::NothingImproves));
}

#[test]
fn noisy_costs_are_left_to_pi2_after_their_roots() {
    let toy = Toy { model: None, noise: 1e-3, ..Toy::new() };
    let history = from_costs(&toy, 1, 3000);
    assert_eq!(history.notes[..], [Note::NoSignals, Note::FellBack(Exhausted::NothingImproves)]);
    assert!(history.best.total < 0.5 * history.initial.total, "{} {}", history.initial.total, history.best.total);
}

#[test]
fn costs_below_zero_are_learned_with_pi2() {
    let toy = Toy { model: None, offset: -1e3, ..Toy::new() };
    let method = Method::Auto(AutoOptions { rollouts: 10, updates: 150, seed: 3 });
    let history = learn_with(&toy, Toy::start(), &method, None, |_| true).unwrap();
    assert_eq!(history.notes, [Note::NoSignals, Note::NegativeCosts]);
    assert!(history.best.total + 1e3 < 0.3 * (history.initial.total + 1e3));
}

#[test]
fn a_problem_without_signals_is_refused_by_the_method_that_needs_them() {
    let toy = Toy { model: None, ..Toy::new() };
    let refused = learn_with(&toy, Toy::start(), &Method::GaussNewton(options(7)), None, |_| true);
    assert_eq!(refused, Err(LearnError::NoSignals));
    assert_eq!(toy.made.load(Ordering::SeqCst), 0);
}

#[test]
fn reasons_and_notes_read_as_sentences() {
    assert!(Exhausted::Noise.to_string().starts_with("nothing improves, and the noise"));
    let note = Note::FellBack(Exhausted::NothingImproves).to_string();
    assert_eq!(note, format!("pi2 goes on: {}", Exhausted::NothingImproves));
    assert!(Note::StepCosts(Exhausted::NothingImproves).to_string().ends_with("with the response freshly learned"));
    assert!(Note::Coupled.to_string().contains("together"));
}
