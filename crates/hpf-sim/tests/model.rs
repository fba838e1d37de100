//! Learning from a model of the environment: a few motions, none of them random, from what was recorded alone.

use hpf_learn::{Cost, Draws, Parameters, Problem, Wants, learn_with};
use hpf_sim::task::Method;
use hpf_sim::{Policy, Simulation, Task};

const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");
const CANTILEVER: &str = include_str!("../../../tasks/cantilever.toml");
const WALL: &str = include_str!("../../../tasks/wall.toml");

/// The task without a cost of the rest time, which the figures known of it leave out.
fn without_rest(text: &str) -> String {
    text.lines().filter(|line| !line.starts_with("rest = ")).map(|line| format!("{line}\n")).collect()
}

fn task(text: &str) -> Task {
    let mut task = Task::parse(text).unwrap();
    task.learning.method = Method::Model;
    task
}

fn simulation(task: &Task) -> (Simulation, Vec<f64>) {
    let policy = Policy::initial(task).unwrap();
    let simulation = Simulation::new(task, &policy).unwrap();
    let start = simulation.starting_weights(&policy).unwrap();
    (simulation, start)
}

/// What the cheapest recorded of the first `motions` motions costs without noise.
fn cost_after(task: &Task, motions: usize) -> f64 {
    let (simulation, start) = simulation(task);
    let history = learn_with(&simulation, start, &task.learning.method(), Some(motions), |_| true).unwrap();
    assert!(history.rollouts <= motions);
    simulation.evaluate(&history.best.weights).0.total()
}

fn recorded(text: &str, position: f64, force: f64, seed: u64) -> Task {
    let mut task = task(&format!("{text}\n[recording]\nposition_noise = {position}\nforce_noise = {force}\n"));
    task.learning.seed = seed;
    task
}

#[test]
fn the_via_point_is_learned_in_five_motions() {
    assert!(cost_after(&task(&without_rest(VIA_POINT)), 3) <= 0.12);
    assert!(cost_after(&task(&without_rest(VIA_POINT)), 5) <= 0.10);
}

#[test]
fn the_via_point_is_learned_in_five_motions_from_noisy_records() {
    let noisy = recorded(&without_rest(VIA_POINT), 0.2e-3, 0.2, 3);
    assert!(cost_after(&noisy, 3) <= 0.12);
    assert!(cost_after(&noisy, 5) <= 0.10);
}

#[test]
fn the_beam_is_learned_in_six_motions() {
    let beam = task(&CANTILEVER.replace("contact_force = 0.1", "contact_force = 0.0"));
    assert!(cost_after(&beam, 6) <= 0.05);
}

#[test]
fn the_wall_is_learned_in_six_motions() {
    // The best known costs 2.178.
    assert!(cost_after(&task(&without_rest(WALL)), 6) <= 1.03 * 2.178);
}

/// The motion of `weights`, as recorded.
fn shown(simulation: &Simulation, weights: &[f64]) -> Vec<f64> {
    let (mut cost, mut motion) = (Cost::default(), Vec::new());
    let parameters = Parameters::Constant(weights);
    simulation.observe(
        (Draws::Update(0), 0),
        parameters,
        Wants::Motion,
        &mut simulation.workspace(),
        &mut cost,
        &mut motion,
    );
    motion
}

#[test]
fn a_model_knows_nothing_of_the_environment_but_what_was_recorded() {
    let (pushed, start) = simulation(&task(VIA_POINT));
    let (calm, _) = simulation(&task(&VIA_POINT.replace("amplitude = 10.0", "amplitude = 0.1")));
    let motion = shown(&pushed, &start);
    let proposals = [&pushed, &calm].map(|simulation| {
        let mut model = simulation.model().unwrap();
        assert_eq!(model.shown(), motion.len());
        assert!(model.learn(&start, &motion));
        model.propose(&start, 128.0).unwrap()
    });
    assert_eq!(proposals[0], proposals[1]);
    assert_ne!(shown(&calm, &start), motion);
}

#[test]
fn a_proposal_lies_within_the_radius_and_the_bounds() {
    let (simulation, start) = simulation(&task(VIA_POINT));
    let motion = shown(&simulation, &start);
    for radius in [0.5, 4.0, 1e6] {
        let mut model = simulation.model().unwrap();
        model.learn(&start, &motion);
        let proposal = model.propose(&start, radius).unwrap();
        assert!(proposal.length <= radius * (1.0 + 1e-9));
        assert!(proposal.expected < proposal.before);
        let mut weights = proposal.weights.iter();
        for block in simulation.blocks() {
            for weight in weights.by_ref().take(block.count) {
                assert!((block.min..=block.max).contains(weight));
            }
        }
    }
}

#[test]
fn records_differ_by_their_noise_alone_and_policies_are_measured_without_it() {
    let clean = task(VIA_POINT);
    let noisy = recorded(VIA_POINT, 1e-3, 0.5, 1);
    let ((simulation, start), (other, _)) = (simulation(&clean), simulation(&noisy));
    assert_eq!(simulation.evaluate(&start), other.evaluate(&start));
    let (motion, record) = (shown(&simulation, &start), shown(&other, &start));
    let samples = motion.len() / 4;
    for (signal, sigma) in [(0, 1e-3), (1, 0.5), (2, 1e-3), (3, 0.5)] {
        let range = signal * samples..(signal + 1) * samples;
        let squares = motion[range.clone()].iter().zip(&record[range]).map(|(a, b)| (a - b) * (a - b));
        let deviation = (squares.sum::<f64>() / samples as f64).sqrt();
        // 501 numbers tell a standard deviation to 3 %; five times that.
        assert!((deviation / sigma - 1.0).abs() < 0.16, "{signal}: {deviation}");
    }
    assert_eq!(record, shown(&other, &start), "the same rollout leaves the same record");
}

fn with_safety(limits: &str) -> Result<Task, hpf_sim::Mistakes> {
    let text = VIA_POINT.replace("method = \"pi2\"", "method = \"model\"");
    let inertial = text.replace("[cost]", "[admittance]\norder = 2\nmass = 1.0\n\n[cost]");
    let drawn = text.replacen("amplitude = 10.0", "amplitude = { uniform = [5.0, 10.0] }", 1);
    for (changed, wanted) in [(inertial, "a law of order 1"), (drawn, "a task without anything drawn at random")] {
        let found = Task::parse(&changed).unwrap_err();
        assert!(found.iter().any(|one| one.message == format!("`model` learns {wanted} only")), "{found:?}");
    }
    Task::parse(&format!("{text}\n[learning.safety]\n{limits}\n"))
}

/// The fastest that any motion is, the furthest it goes on y, and the cost of the best.
fn extremes(task: &Task) -> ([f64; 2], f64) {
    let (simulation, start) = simulation(task);
    let mut extremes = [0.0_f64; 2];
    let history = learn_with(&simulation, start, &task.learning.method(), Some(8), |progress| {
        let trace = simulation.rollout(&progress.weights);
        for axis in &trace.axes {
            axis.velocity.iter().for_each(|v| extremes[0] = extremes[0].max(v.abs()));
        }
        trace.axes[1].position.iter().for_each(|y| extremes[1] = extremes[1].max(*y));
        true
    })
    .unwrap();
    (extremes, history.best.total)
}

#[test]
fn planned_motions_stay_within_the_limits_of_safety() {
    let ([fastest, furthest], least) = extremes(&with_safety("max_force = 20.0").unwrap());
    let (_, start) = simulation(&task(VIA_POINT));
    let first = simulation(&task(VIA_POINT)).0.rollout(&start);
    let of_first = first.axes.iter().flat_map(|axis| &axis.velocity).fold(0.0, |most: f64, v| most.max(v.abs()));
    // Limits between what the start does and what is planned without them.
    let limit = 0.5 * (of_first + fastest);
    if of_first < limit {
        let (limited, cost) = extremes(&with_safety(&format!("max_velocity = {limit}")).unwrap());
        assert!(limited[0] <= limit, "{limited:?} {limit}");
        assert!(cost >= least);
    }
    let of_first = first.axes[1].position.iter().fold(0.0, |most: f64, y| most.max(*y));
    let limit = 0.5 * (of_first + furthest);
    let workspace = format!("workspace = [[-9.0, 9.0], [-9.0, {}]]", limit.max(1.0));
    let (limited, _) = extremes(&with_safety(&workspace).unwrap());
    assert!(limited[1] <= limit.max(of_first).max(1.0), "{limited:?} {limit}");
}

#[test]
fn limits_of_safety_need_planned_motions_and_a_place_for_start_and_goal() {
    let refused = |text: Result<Task, hpf_sim::Mistakes>, words: &str| {
        let found = text.unwrap_err();
        assert!(found.iter().any(|diagnostic| diagnostic.message.contains(words)), "{found:?}");
    };
    refused(Task::parse(&format!("{VIA_POINT}\n[learning.safety]\nmax_force = 9.0\n")), "no model predicts");
    refused(with_safety("workspace = [[0.0, 2.0]]"), "1 range for 2 axes");
    refused(with_safety("workspace = [[0.0, 2.0], [0.0, 0.5]]"), "the goal of axis `y` lies outside");
    refused(with_safety("max_velocity = 0.0"), "`max_velocity` is out of range");
}
