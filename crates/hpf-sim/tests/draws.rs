//! Tasks in which something is drawn: who meets which draws, and what that costs.

use hpf_learn::{AutoOptions, CmaEsOptions, Cost, Draws, Method, Parameters, Problem, learn_with};
use hpf_sim::{Policy, Simulation, Task};

const STOCHASTIC: &str = include_str!("../../../tasks/via_point_stochastic.toml");

fn task(changes: &[(&str, &str)]) -> Task {
    let mut text = STOCHASTIC.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    Task::parse(&text).unwrap_or_else(|found| panic!("{found:?}"))
}

fn simulation(task: &Task) -> (Simulation, Vec<f64>) {
    let policy = Policy::initial(task).unwrap();
    let simulation = Simulation::new(task, &policy).unwrap();
    (simulation, policy.weights())
}

fn cost(simulation: &Simulation, draws: Draws, weights: &[f64]) -> Cost {
    let mut cost = Cost::default();
    Problem::rollout(simulation, draws, Parameters::Constant(weights), &mut simulation.workspace(), &mut cost);
    cost
}

#[test]
fn rollouts_of_an_update_meet_the_same_draws_and_no_others_do() {
    let (simulation, weights) = simulation(&task(&[]));
    let sets = [Draws::Update(0), Draws::Update(1), Draws::Update(2), Draws::HeldOut];
    let totals = sets.map(|draws| cost(&simulation, draws, &weights).total());
    for (i, draws) in sets.into_iter().enumerate() {
        assert_eq!(cost(&simulation, draws, &weights).total(), totals[i], "the same set, the same draws");
        assert!(totals[..i].iter().all(|other| *other != totals[i]), "{totals:?}");
    }
    let (same, _) = self::simulation(&task(&[]));
    assert_eq!(cost(&same, Draws::Update(7), &weights), cost(&simulation, Draws::Update(7), &weights));
    let (other, _) = self::simulation(&task(&[("seed = 1", "seed = 2")]));
    assert_ne!(cost(&other, Draws::Update(7), &weights), cost(&simulation, Draws::Update(7), &weights));
}

#[test]
fn a_workspace_may_go_from_one_set_of_draws_to_another() {
    let (simulation, weights) = simulation(&task(&[]));
    let (mut workspace, mut found) = (simulation.workspace(), Cost::default());
    for draws in [Draws::Update(3), Draws::HeldOut, Draws::Update(3), Draws::Update(4)] {
        Problem::rollout(&simulation, draws, Parameters::Constant(&weights), &mut workspace, &mut found);
        assert_eq!(found, cost(&simulation, draws, &weights));
    }
}

#[test]
fn a_rollout_costs_the_mean_of_its_motions_and_takes_as_many() {
    // Of a choice of two, mirrored draws are one of each: the mean is that of two tasks without draws.
    let drawn = task(&[("uniform = [-10.0, 10.0]", "choice = [-10.0, 5.0]"), ("draws = 4", "draws = 2")]);
    let amplitudes = |x: f64, y: f64| {
        let mut task = drawn.clone();
        for (disturbance, amplitude) in task.disturbance.iter_mut().zip([x, y]) {
            *disturbance = disturbance.drawn(&mut |_| amplitude);
        }
        let (simulation, weights) = simulation(&task);
        assert_eq!(simulation.motions(), 1);
        cost(&simulation, Draws::HeldOut, &weights).total()
    };
    // Axes do not touch each other: which amplitude of x goes with which of y does not matter.
    let expected = 0.5 * (amplitudes(-10.0, -10.0) + amplitudes(5.0, 5.0));
    let (simulation, weights) = simulation(&drawn);
    assert_eq!(simulation.motions(), 2);
    for draws in [Draws::Update(0), Draws::Update(5), Draws::HeldOut] {
        let found = cost(&simulation, draws, &weights).total();
        assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
    }
}

#[test]
fn signals_of_all_draws_are_the_cost_and_together_is_as_alone() {
    let sensor = "\n[sensor]\nnoise = 0.3\nbias = { normal = [0.0, 0.5] }\ndelay = 0.015\ndropout = 0.1\nquantisation = 0.05\n[actuator]\nlag = 0.02\n";
    for text in [STOCHASTIC.to_owned(), STOCHASTIC.to_owned() + sensor] {
        let task = Task::parse(&text).unwrap();
        let (simulation, weights) = simulation(&task);
        let model = simulation.signals().unwrap();
        let (mut measured, mut signals) = (Cost::default(), Vec::new());
        let parameters = Parameters::Constant(&weights);
        let mut workspace = simulation.workspace();
        simulation.measure(Draws::Update(2), parameters, &mut workspace, &mut measured, &mut signals);
        assert_eq!(measured, cost(&simulation, Draws::Update(2), &weights));
        assert_eq!(signals.len(), model.groups.last().unwrap().signals.end);
        let mut total = 0.5 * signals.iter().map(|rho| rho * rho).sum::<f64>();
        let mut start = 0;
        for (block, price) in simulation.blocks().iter().zip(&model.price) {
            let own = &weights[start..start + block.count];
            for (row, weight) in price.chunks_exact(block.count).zip(own) {
                total += 0.5 * weight * row.iter().zip(own).map(|(q, w)| q * w).sum::<f64>();
            }
            start += block.count;
        }
        assert!((total - measured.total()).abs() < 1e-12 * total, "{total} {}", measured.total());
        // Each axis' signals stand together: moving one axis' weights leaves those of the other alone.
        let (mut moved, mut others) = (weights.clone(), Vec::new());
        moved[model.groups[1].parameters.clone()].iter_mut().for_each(|w| *w += 1.0);
        let parameters = Parameters::Constant(&moved);
        simulation.measure(Draws::Update(2), parameters, &mut workspace, &mut measured, &mut others);
        let [x, y] = [0, 1].map(|axis| model.groups[axis].signals.clone());
        assert_eq!(signals[x.clone()], others[x]);
        assert_ne!(signals[y.clone()], others[y]);
    }
}

#[test]
fn what_is_said_of_a_policy_is_from_draws_held_out_even_where_there_is_one() {
    let task = task(&[("draws = 4", "draws = 1"), ("max_rollouts = 4000", "max_rollouts = 200")]);
    let (simulation, weights) = simulation(&task);
    assert!(simulation.motions() == 1 && simulation.is_random());
    let (rollouts, updates, seed) = (20, 100, 1);
    for method in
        [Method::Auto(AutoOptions { rollouts, updates, seed }), Method::CmaEs(CmaEsOptions { rollouts, updates, seed })]
    {
        let best = learn_with(&simulation, weights.clone(), &method, Some(200), |_| true).unwrap().best;
        assert!(best.update > 0, "{method:?}");
        assert_eq!(best.total, cost(&simulation, Draws::HeldOut, &best.weights).total(), "{method:?}");
    }
}

#[test]
fn measures_are_taken_over_the_evaluation_draws() {
    let find = |metrics: &[hpf_sim::Metric], name: &str| metrics.iter().find(|m| m.name == name).unwrap().value;
    let one = task(&[("evaluation_draws = 100", "evaluation_draws = 1")]);
    let (single, weights) = simulation(&one);
    let (_, metrics) = single.evaluate(&weights);
    assert_eq!(metrics, single.metrics(&single.rollout(&weights)), "a trace shows the first of them");
    let (many, _) = simulation(&task(&[]));
    let (cost, metrics) = many.evaluate(&weights);
    assert!((cost.total() / find(&metrics, "max_cost") - 1.0).abs() < 1e-12, "the mean of the totals");
    let (worst, rms) = (find(&metrics, "max_via_error"), find(&metrics, "rms_via_error"));
    assert!(rms < worst, "{rms} {worst}");
    // The offset is linear in the amplitudes: known at one amplitude, it is known at all. Mean square of an even spread
    // over [-10, 10]: a third of the square of 10.
    let at = |x: f64, y: f64| {
        let mut task = task(&[]);
        for (disturbance, amplitude) in task.disturbance.iter_mut().zip([x, y]) {
            *disturbance = disturbance.drawn(&mut |_| amplitude);
        }
        let (simulation, weights) = simulation(&task);
        let trace = simulation.rollout(&weights);
        [0, 1].map(|axis| trace.sample(&trace.axes[axis].position, 2.5) - [0.6, 0.8][axis])
    };
    let (still, pushed) = (at(0.0, 0.0), at(10.0, 10.0));
    let square: f64 = (0..2).map(|a| still[a].powi(2) + (pushed[a] - still[a]).powi(2) / 3.0).sum();
    // A hundred spread draws: the mean square of each is within half a stratum of the integral.
    assert!((rms / square.sqrt() - 1.0).abs() < 1e-3, "{rms} {}", square.sqrt());
}

#[test]
fn drawn_onsets_and_bounded_keys_are_checked() {
    let step = "kind = \"step\"\naxis = \"x\"\namplitude = 3.0\nstart = START";
    let parse = |start: &str| {
        let (before, after) = STOCHASTIC.split_once("[[disturbance]]").unwrap();
        let text = format!("{before}[[disturbance]]\n{}\n\n[[disturbance]]{after}", step.replace("START", start));
        Task::parse(&text)
    };
    assert!(parse("{ uniform = [0.5, 1.5] }").unwrap().is_random());
    let found = Task::parse(&STOCHASTIC.replace("draws = 4 ", "draws = 10000 ").replace("rate = 100.0", "rate = 1e3"));
    assert!(found.unwrap_err()[0].message.contains("what all draws meet are 652480000 numbers"));
    let found = Task::parse(&STOCHASTIC.replace("draws = 4 ", "elites = 1\ndraws = 4 ")).unwrap_err();
    assert!(found[0].message.starts_with("`learning.elites` was taken out"), "{}", found[0].message);
    for (start, words) in [
        ("{ uniform = [-0.5, 1.5] }", "`start` is out of range: -0.5"),
        ("{ uniform = [1.5, 0.5] }", "`start` is drawn from an empty range: 1.5 to 0.5"),
        ("{ normal = [1.0, 0.1] }", "a normal distribution has no bounds"),
        ("{ choice = [1.0, -1.0] }", "`start` is out of range: -1"),
        ("{ choice = [] }", "`choice` has 0 entries"),
        ("{ uniform = [1.0] }", "`uniform` has 1 entries"),
        ("{ unifrom = [0.0, 1.0] }", "unknown key `unifrom`, did you mean `uniform`?"),
        ("{ uniform = [0.0, 1.0], normal = [0.0, 1.0] }", "start has both `uniform` and `normal`"),
        ("\"later\"", "`start` cannot be a text"),
        ("-1.0", "`start` is out of range: -1"),
    ] {
        let found = parse(start).unwrap_err();
        assert!(found.iter().any(|found| found.message.contains(words)), "{start}: {found:?}");
    }
}
