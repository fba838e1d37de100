//! Tasks that a learner may stall on, each learned by `auto` without a key set: costs that an independent optimizer found.

use hpf_learn::{History, Note, learn_with};
use hpf_sim::task::Method;
use hpf_sim::{Policy, Simulation, Task};

fn learned(text: &str, motions: usize) -> (History, f64) {
    let task = Task::parse(text).unwrap();
    assert_eq!(task.learning.method, Method::Auto);
    let policy = Policy::initial(&task).unwrap();
    let simulation = Simulation::new(&task, &policy).unwrap();
    let start = simulation.starting_weights(&policy).unwrap();
    let history = learn_with(&simulation, start, &task.learning.method(), Some(motions), |_| true).unwrap();
    let cost = simulation.evaluate(&history.best.weights).0.total();
    (history, cost)
}

#[test]
fn an_axis_that_feels_no_force_is_learned_beside_one_that_does() {
    let cost = learned(include_str!("data/learning/force_one_axis.toml"), 100).1;
    assert!(cost <= 1.01 * 0.0799, "{cost}");
}

#[test]
fn a_via_point_without_a_time_is_passed_whatever_sample_is_nearest_at_first() {
    let between = learned(include_str!("data/learning/via_between.toml"), 100).1;
    assert!(between <= 1.01 * 0.0436, "{between}");
    let behind = learned(include_str!("data/learning/via_behind_start.toml"), 100).1;
    assert!(behind <= 1.01 * 0.0393, "{behind}");
}

#[test]
fn a_hard_wall_is_pressed() {
    let cost = learned(include_str!("data/learning/wall_hard.toml"), 100).1;
    assert!(cost <= 1.01 * 1.057, "{cost}");
}

#[test]
fn a_budget_that_ends_before_the_first_update_is_said_to() {
    let (history, _) = learned(include_str!("data/learning/noise_small_budget.toml"), 100);
    assert_eq!(history.updates, 0);
    assert!(history.notes.contains(&Note::TooFew));
    assert!(Note::TooFew.to_string().contains("max_rollouts"));
}
