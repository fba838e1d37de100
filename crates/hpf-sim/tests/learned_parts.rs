//! What is learned and what is not: goals, single primitives, single axes.

use hpf_learn::{Problem, learn_with};
use hpf_sim::task::{CostWeights, Method, PerAxis};
use hpf_sim::{Policy, Simulation, Task};

const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");
const REACH: &str = include_str!("../../../tasks/reach.toml");

fn with_learning(text: &str, keys: &str) -> Result<Task, hpf_sim::Mistakes> {
    let task = Task::parse(&text.replace("[learning]\n", &format!("[learning]\n{keys}\n")))?;
    let cost = CostWeights { rest: PerAxis::All(0.0), ..task.cost };
    Ok(Task { cost, ..task })
}

/// The policies before and after learning.
fn learned(task: &Task, most: usize) -> (Policy, Policy) {
    let policy = Policy::initial(task).unwrap();
    let simulation = Simulation::new(task, &policy).unwrap();
    let start = simulation.starting_weights(&policy).unwrap();
    assert_eq!(start.len(), simulation.blocks().iter().map(|block| block.count).sum::<usize>());
    let history = learn_with(&simulation, start, &task.learning.method(), Some(most), |_| true).unwrap();
    assert!(history.best.total < history.initial.total);
    let best = policy.clone().with_weights(&history.best.weights).unwrap();
    assert_eq!(simulation.parameters(&best), history.best.weights);
    (policy, best)
}

#[test]
fn what_is_not_learned_stays_as_it_was() {
    for method in [Method::Pi2, Method::GaussNewton, Method::Auto] {
        let mut task = with_learning(VIA_POINT, "learn = [\"x.movement\", \"stiffness\"]").unwrap();
        task.learning.method = method;
        let (before, after) = learned(&task, 200);
        let [x, y] = [0, 1].map(|a| (&before.axes[a], &after.axes[a]));
        assert_ne!(x.0.movement, x.1.movement, "{method:?}");
        assert_ne!(x.0.stiffness, x.1.stiffness);
        assert_ne!(y.0.stiffness, y.1.stiffness);
        assert_eq!(y.0.movement, y.1.movement);
        assert_eq!((&x.0.damping, &y.0.damping), (&x.1.damping, &y.1.damping));
        assert_eq!([x.0.goal, y.0.goal], [x.1.goal, y.1.goal]);
    }
}

#[test]
fn cma_es_moves_nothing_that_is_frozen_and_no_number_is_lost() {
    let stiffness = with_learning(VIA_POINT, "learn = [\"stiffness\"]").unwrap();
    let mut silent = Task::parse(VIA_POINT).unwrap();
    silent.learning.noise.movement = PerAxis::Each(vec![0.0, 10.0]);
    for (mut task, moves_y) in [(stiffness, false), (silent, true)] {
        task.learning.method = Method::CmaEs;
        let (before, after) = learned(&task, 1000);
        let [x, y] = [0, 1].map(|a| (&before.axes[a], &after.axes[a]));
        assert_eq!(x.0.movement, x.1.movement);
        assert_eq!(y.0.movement != y.1.movement, moves_y);
        assert_eq!(x.0.damping != x.1.damping, moves_y);
        assert_ne!(x.0.stiffness, x.1.stiffness);
        assert!(after.weights().iter().all(|weight| weight.is_finite()));
    }
}

#[test]
fn no_motion_is_spent_on_what_is_not_learned() {
    let mut task = with_learning(VIA_POINT, "learn = [\"damping\"]").unwrap();
    task.learning.method = Method::GaussNewton;
    let policy = Policy::initial(&task).unwrap();
    let simulation = Simulation::new(&task, &policy).unwrap();
    let mut first = None;
    let observe = |progress: &hpf_learn::Progress| {
        first = first.or((progress.update == 1).then_some(progress.rollouts));
        progress.update == 0
    };
    learn_with(&simulation, policy.weights(), &task.learning.method(), None, observe).unwrap();
    // Twice the start and each axis alone, 2 for the bends of one block, 20 of 60 columns, three trials; no correction
    // promises anything.
    assert_eq!(first, Some(4 + 2 + 20 + 3));
}

#[test]
fn a_goal_is_learned_and_the_policy_keeps_it() {
    // A steady push of -2 N at the end: a goal beyond the target makes up for it without any stiffness.
    for method in [Method::Pi2, Method::Auto] {
        let mut task = with_learning(REACH, "learn = [\"goal\"]\nnoise = { goal = 0.05 }").unwrap();
        task.learning.method = method;
        let (before, after) = learned(&task, 1500);
        assert_eq!(before.axes[0].goal, 0.3);
        assert_eq!(
            (&before.axes[0].movement, &before.axes[0].stiffness),
            (&after.axes[0].movement, &after.axes[0].stiffness)
        );
        let read = Policy::parse(&after.to_json()).unwrap();
        assert_eq!(read, after);
        // Between 0.3 m and the 0.32 m that 2 N at 100 N/m ask for at rest: half a second is not long enough for rest.
        assert!((0.302..0.32).contains(&after.axes[0].goal), "{method:?}: {}", after.axes[0].goal);
        let simulation = Simulation::new(&task, &read).unwrap();
        let trace = simulation.rollout(&simulation.parameters(&read));
        let miss = trace.axes[0].position[trace.steps()] - 0.3;
        assert!(miss.abs() < 0.5e-3, "{method:?}: {miss}");
    }
}

#[test]
fn goals_and_weights_are_learned_together() {
    let learn = "learn = [\"movement\", \"stiffness\", \"damping\", \"goal\"]\nmethod = \"auto\"";
    let text = VIA_POINT.replace("method = \"pi2\"\n", "");
    let task = with_learning(&text, learn).unwrap();
    let (_, after) = learned(&task, 400);
    assert!(after.axes.iter().all(|axis| axis.goal != 1.0));
    // Rolled out together or alone, the same bits.
    let simulation = Simulation::new(&task, &after).unwrap();
    let parameters = simulation.parameters(&after);
    let mut cost = hpf_learn::Cost::default();
    let constant = hpf_learn::Parameters::Constant(&parameters);
    Problem::rollout(&simulation, hpf_learn::Draws::HeldOut, constant, &mut simulation.workspace(), &mut cost);
    assert_eq!(cost, simulation.cost(&simulation.rollout(&parameters)));
}

#[test]
fn parts_that_are_not_there_are_refused_by_name() {
    for (keys, words) in [
        ("learn = [\"z.movement\"]", "there is no axis `z`"),
        ("learn = [\"stifness\"]", "unknown part `stifness`, did you mean `stiffness`?"),
        ("learn = [\"x.speed\"]", "unknown part `speed`"),
        ("learn = [\"goal\", \"goal\"]", "`goal` is named twice"),
        ("learn = []", "`learn` has 0 entries"),
        ("learn = \"goal\"", "`learn` cannot be a text"),
    ] {
        let found = with_learning(VIA_POINT, keys).unwrap_err();
        assert!(found.iter().any(|found| found.message.contains(words)), "{keys}: {found:?}");
        assert!(found.iter().all(|found| !found.span.is_empty()), "{keys}: {found:?}");
    }
}
