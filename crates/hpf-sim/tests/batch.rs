//! Rollouts together: the same bits as alone, in any instructions, on any number of threads, and nothing allocated.

use crate::stepped::{prepared, stepped};
use hpf_learn::{
    Batch, CmaEsOptions, Cost, Draws, Exploration, LearningLoop, Method, Parameters, Pi2, Pi2Options, Problem, Session,
    learn,
};
use hpf_sim::environment::disturbance::Side;
use hpf_sim::{Policy, Simulation, Task};

const SHIPPED: [&str; 4] = [
    include_str!("../../../tasks/cantilever.toml"),
    include_str!("../../../tasks/cantilever_moving_load.toml"),
    include_str!("../../../tasks/reach.toml"),
    include_str!("../../../tasks/via_point.toml"),
];

/// A tool that a force throws at a wall again and again; it meets and leaves it inside of steps.
const BOUNCING: &str = r#"
name = "bouncing"
duration = 1.0
rate = 50.0
axis = [{ name = "x", start = 0.0, goal = 0.1 }]
stiffness = { initial = 100.0, min = 30.0, max = 400.0 }
damping = { initial = 20.0, min = 5.0, max = 100.0 }
disturbance = [{ kind = "sine", axis = "x", amplitude = 30.0, period = 0.13 }]
contact = { kind = "wall", axis = "x", position = 0.05, stiffness = 5e3, force = 2.0 }
cost = { goal = 1e4, tracking = 1e6, contact_force = 0.1, acceleration = 1e-3, stiffness = 1e-5, damping = 1e-4 }
learning = { noise = { movement = 100.0 } }
"#;

/// As many samples as asked for, with the noise of the task.
fn samples(simulation: &Simulation, policy: &Policy, rollouts: usize, exploration: Exploration) -> Batch {
    let options = Pi2Options { rollouts, exploration, seed: 7, ..Pi2Options::default() };
    Pi2::new(simulation.blocks(), simulation.steps(), policy.weights(), options).unwrap().ask()
}

fn costs(simulation: &Simulation, parameters: &[Parameters<'_>]) -> Vec<Cost> {
    let mut costs = vec![Cost::default(); parameters.len()];
    simulation.rollouts(Draws::Update(0), parameters, &mut simulation.workspace(), &mut costs);
    costs
}

fn alone(simulation: &Simulation, parameters: Parameters<'_>) -> Cost {
    let mut cost = Cost::default();
    Problem::rollout(simulation, Draws::Update(0), parameters, &mut simulation.workspace(), &mut cost);
    cost
}

/// Every bit of a cost.
fn bits(cost: &Cost) -> Vec<u64> {
    cost.running.iter().chain(&cost.terms).chain([&cost.terminal]).map(|number| number.to_bits()).collect()
}

#[test]
fn a_rollout_costs_the_same_alone_in_a_batch_of_any_size_and_by_its_trace() {
    for text in SHIPPED.into_iter().chain([BOUNCING]) {
        let (task, policy, simulation) = prepared(text);
        let batch = samples(&simulation, &policy, 19, Exploration::Rollout);
        let parameters: Vec<_> = (0..batch.len()).map(|k| batch.sample(k)).collect();
        let expected: Vec<Cost> =
            parameters.iter().map(|parameters| simulation.cost(&simulation.rollout(parameters.at(0)))).collect();
        for (k, parameters) in parameters.iter().enumerate() {
            assert_eq!(bits(&alone(&simulation, *parameters)), bits(&expected[k]), "{}: {k} alone", task.name);
        }
        for count in 1..=parameters.len() {
            for (k, cost) in costs(&simulation, &parameters[..count]).iter().enumerate() {
                assert_eq!(bits(cost), bits(&expected[k]), "{}: {k} of {count}", task.name);
            }
        }
    }
}

#[test]
fn every_set_of_instructions_gives_the_same_bits() {
    for text in SHIPPED.into_iter().chain([BOUNCING]) {
        let (task, policy, simulation) = prepared(text);
        let batch = samples(&simulation, &policy, 11, Exploration::Rollout);
        let parameters: Vec<_> = (0..batch.len()).map(|k| batch.sample(k)).collect();
        let found = costs(&simulation, &parameters);
        let portable = costs(&simulation.clone().portable(), &parameters);
        assert!(found.iter().zip(&portable).all(|(a, b)| bits(a) == bits(b)), "{}", task.name);
    }
}

#[test]
fn the_bouncing_tool_meets_and_leaves_the_wall_in_some_lanes_only() {
    let (_, policy, simulation) = prepared(BOUNCING);
    let batch = samples(&simulation, &policy, 8, Exploration::Rollout);
    let crossings: Vec<Vec<usize>> = (0..batch.len())
        .map(|k| {
            let trace = simulation.rollout(batch.sample(k).at(0));
            let force = trace.contact.unwrap().force;
            (1..force.len()).filter(|&i| (force[i] > 0.0) != (force[i - 1] > 0.0)).collect()
        })
        .collect();
    assert!(crossings.iter().all(|crossings| crossings.len() >= 4), "{crossings:?}");
    assert!(crossings.iter().any(|other| *other != crossings[0]), "{crossings:?}");
}

#[test]
fn parameters_that_change_with_the_steps_cost_the_same_in_a_batch_as_alone() {
    for text in SHIPPED.into_iter().chain([BOUNCING]) {
        let (task, policy, simulation) = prepared(text);
        let constant = samples(&simulation, &policy, 3, Exploration::Rollout);
        let changing = samples(&simulation, &policy, 3, Exploration::Step);
        let mixed = [changing.sample(0), constant.sample(1), changing.sample(2)];
        let expected = mixed.map(|parameters| alone(&simulation, parameters));
        for (k, cost) in costs(&simulation, &mixed).iter().enumerate() {
            assert_eq!(bits(cost), bits(&expected[k]), "{}: {k}", task.name);
        }
        let mut trace = simulation.blank_trace();
        simulation.rollout_into(changing.sample(0), &mut trace);
        assert_eq!(bits(&simulation.cost(&trace)), bits(&expected[0]), "{}", task.name);
        // The same parameters at every step are constant parameters.
        let row = constant.sample(0).at(0);
        let rows = row.repeat(simulation.steps());
        let repeated = alone(&simulation, Parameters::PerStep { rows: &rows, count: row.len() });
        assert_eq!(bits(&repeated), bits(&alone(&simulation, constant.sample(0))), "{}", task.name);
    }
}

#[test]
fn a_task_is_learned_to_the_same_bits_by_any_number_of_threads_and_in_any_instructions() {
    for text in SHIPPED {
        let (task, policy, simulation) = prepared(text);
        for exploration in [Exploration::Rollout, Exploration::Step] {
            let rollouts = if exploration == Exploration::Step { 3 } else { 20 };
            let options = Pi2Options { rollouts, updates: 4, exploration, ..task.learning.pi2_options() };
            let weights = |threads: usize, simulation: &Simulation| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let history = pool.install(|| learn(simulation, policy.weights(), options, None, |_| true)).unwrap();
                history.best.weights.iter().map(|weight| weight.to_bits()).collect::<Vec<_>>()
            };
            let expected = weights(1, &simulation);
            for threads in [2, 3, 7] {
                assert_eq!(weights(threads, &simulation), expected, "{}, {threads} threads", task.name);
            }
            assert_eq!(weights(2, &simulation.clone().portable()), expected, "{}, portable", task.name);
        }
    }
}

#[test]
fn batches_made_ahead_are_those_asked_for_one_by_one() {
    for text in [SHIPPED[0], include_str!("../../../tasks/via_point_stochastic.toml")] {
        let (task, policy, simulation) = prepared(text);
        let pi2 = Method::Pi2(Pi2Options { rollouts: 12, updates: 4, ..task.learning.pi2_options() });
        let cma_es = Method::CmaEs(CmaEsOptions { rollouts: 12, updates: 4, seed: 5 });
        for method in [pi2, cma_es] {
            let begin = || Session::begin(&simulation, policy.weights(), &method, None).unwrap();
            let (mut session, mut records) = (begin(), Vec::new());
            while let Some(ask) = session.ask() {
                let mut costs = vec![Cost::default(); ask.samples.len()];
                simulation.rollouts(ask.draws, &ask.samples, &mut simulation.workspace(), &mut costs);
                records.push(session.tell(&costs, &[]).unwrap().record);
            }
            for threads in [1, 2, 7] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut learning = LearningLoop::new(&simulation, begin());
                let told = || pool.install(|| learning.step()).unwrap().map(|told| told.record);
                assert!(core::iter::from_fn(told).eq(records.iter().cloned()), "{}, {threads} threads", task.name);
                assert_eq!(learning.session().history(), session.history());
            }
        }
    }
}

#[test]
fn an_update_allocates_nothing_once_its_rooms_are_made() {
    for text in SHIPPED {
        let (task, policy, simulation) = prepared(text);
        for exploration in [Exploration::Rollout, Exploration::Basis, Exploration::Step] {
            let options = Pi2Options { rollouts: 11, exploration, ..task.learning.pi2_options() };
            let mut learner = Pi2::new(simulation.blocks(), simulation.steps(), policy.weights(), options).unwrap();
            let (mut batch, mut costs) = (Batch::default(), vec![Cost::default(); 11]);
            let mut workspace = simulation.workspace();
            let mut update = || {
                learner.ask_into(&mut batch);
                let parameters: [_; 11] = core::array::from_fn(|k| batch.sample(k));
                simulation.rollouts(Draws::Update(0), &parameters, &mut workspace, &mut costs);
                learner.tell(&batch, &costs).unwrap();
            };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            let allocations = pool.install(|| {
                update();
                allocation_counter::measure(|| (0..3).for_each(|_| update()))
            });
            assert_eq!(allocations.count_total, 0, "{}, {exploration:?}", task.name);
        }
    }
}

/// The controller holds force, stiffness and damping of mid-step over a step, a rollout lets them run on: a difference
/// of second order in the step, that falls fourfold where the step is halved. The reference is the same up to rounding.
#[test]
fn a_rollout_is_what_the_controller_of_a_robot_does() {
    let text = SHIPPED[3];
    let difference = |rate: f64| {
        let task = Task { rate, ..Task::parse(text).unwrap() };
        let policy = Policy::initial(&task).unwrap();
        let batch = {
            let simulation = Simulation::new(&task, &policy).unwrap();
            samples(&simulation, &policy, 1, Exploration::Rollout)
        };
        let policy = policy.with_weights(batch.sample(0).at(0)).unwrap();
        let trace = Simulation::new(&task, &policy).unwrap().rollout(batch.sample(0).at(0));
        let steps = task.steps();
        let middle = |i: usize| (i as f64 + 0.5) * task.duration / steps as f64;
        let forces: Vec<[f64; 2]> =
            (0..steps).map(|i| [0, 1].map(|axis| task.disturbance[axis].force(middle(i), Side::After))).collect();
        let commands = stepped(&policy, &forces);
        let far = |i: usize, axis: usize| (commands[i][axis] - trace.axes[axis].position[i + 1]).abs();
        (0..steps).flat_map(|i| [far(i, 0), far(i, 1)]).fold(0.0, f64::max)
    };
    let [coarse, fine] = [100.0, 200.0].map(difference);
    println!("{coarse:.2e} m at 100 Hz, {fine:.2e} m at 200 Hz");
    assert!(coarse < 5e-6 && (3.6..4.4).contains(&(coarse / fine)), "{coarse} m, {fine} m");
}
