//! Sizes: what is too large is refused by name, and the memory of what is allowed is bounded.

use hpf_learn::Problem as _;
use hpf_sim::task::{MAX_MEMORY, MAX_NUMBERS};
use hpf_sim::{Policy, Simulation, Task};

/// A task of one axis with these keys.
fn text(rate: f64, basis: usize, learning: &str, more: &str) -> String {
    let gain =
        |name: &str, initial: f64| format!("[{name}]\nbasis = {basis}\ninitial = {initial}\nmin = 1\nmax = 1000\n");
    let method = if learning.contains("method") { "" } else { "method = \"pi2\"\n" };
    format!(
        "name = \"large\"\nduration = 1.0\nrate = {rate:?}\n[[axis]]\nname = \"x\"\nstart = 0\ngoal = 1\n\
         [movement]\nbasis = {basis}\n{}{}[cost]\ngoal = 1.0\nacceleration = 1e-6\n[learning]\nupdates = 1\n{method}{learning}\n{more}",
        gain("stiffness", 100.0),
        gain("damping", 20.0),
    )
}

#[test]
fn what_is_too_large_is_refused_by_the_name_of_its_key() {
    let via = |count: usize| "[[via_point]]\ntime = 0.5\nposition = [0.5]\n".repeat(count);
    let push =
        |count: usize| "[[disturbance]]\nkind = \"step\"\naxis = \"x\"\namplitude = 1\nstart = 0\n".repeat(count);
    let axes = |count: usize| -> String {
        (0..count).map(|i| format!("[[axis]]\nname = \"x{i}\"\nstart = 0\ngoal = 1\n")).collect()
    };
    let updates: Vec<usize> = (0..101).collect();
    let keeps = format!("[output]\nsnapshots = {updates:?}");
    for (text, words) in [
        (text(1e6 + 1.0, 2, "rollouts = 2", ""), "1000001 steps"),
        (text(100.0, 1001, "rollouts = 2", ""), "`basis` is out of range: 1001"),
        (text(100.0, usize::MAX, "rollouts = 2", ""), "`basis` is out of range: 18446744073709551615"),
        (text(100.0, 20, "rollouts = 18446744073709551615", ""), "`rollouts` is out of range: 18446744073709551615"),
        (text(100.0, 20, "rollouts = 100001", ""), "`rollouts` is out of range: 100001"),
        (
            text(100.0, 20, "updates = 1000001", "").replacen("updates = 1\n", "", 1),
            "`updates` is out of range: 1000001",
        ),
        (text(100.0, 20, "", &via(101)), "`via_point` has 101 entries"),
        (text(100.0, 20, "", &push(101)), "`disturbance` has 101 entries"),
        (text(100.0, 20, "", &axes(7)), "`axis` has 8 entries"),
        (text(100.0, 20, "updates = 200", &keeps).replacen("updates = 1\n", "", 1), "`snapshots` has 101 entries"),
        (text(1e5, 200, "", ""), "parameters at every step are 60000000 numbers"),
        (text(1e5, 2, "rollouts = 1000", ""), "costs of every rollout and step are 100000000 numbers"),
        (text(10.0, 1000, "rollouts = 100000", ""), "samples of every rollout and parameter are 300000000 numbers"),
        (text(1e4, 20, "exploration = \"step\"\nrollouts = 100", ""), "samples of every rollout, step and parameter"),
        (text(1e4, 20, "exploration = \"basis\"\nrollouts = 100", ""), "samples of every rollout, step and parameter"),
        (text(1e4, 20, "preset = \"paper\"\nrollouts = 100", ""), "samples of every rollout, step and parameter"),
        (text(2e4, 800, "method = \"auto\"\nrollouts = 1000", ""), "parameters at every step are 48000000 numbers"),
        (text(5e4, 330, "method = \"auto\"\nrollouts = 900", ""), "parameters at every step are 49500000 numbers"),
    ] {
        let found = Task::parse(&text).expect_err(words);
        assert!(found.iter().any(|diagnostic| diagnostic.message.contains(words)), "{words}: {found:?}");
    }
}

#[test]
fn the_largest_tasks_allowed_need_no_more_memory_than_is_stated() {
    let mut most: f64 = 0.0;
    for rate in [1e2, 1e4, 1e5, 1e6] {
        for basis in [2, 20, 100, 500, 1000] {
            for rollouts in [2, 20, 200, 2000, 20_000] {
                for method in ["pi2", "gauss-newton"] {
                    for exploration in ["rollout", "step"] {
                        let learning =
                            format!("method = \"{method}\"\nrollouts = {rollouts}\nexploration = \"{exploration}\"");
                        if let Ok(task) = Task::parse(&text(rate, basis, &learning, "")) {
                            most = most.max(task.memory(1));
                            let steps = task.steps();
                            assert!(steps * 3 * basis <= MAX_NUMBERS && steps * rollouts <= MAX_NUMBERS);
                        }
                    }
                }
            }
        }
    }
    assert!((0.5 * MAX_MEMORY..=MAX_MEMORY).contains(&most), "{most}");
}

#[test]
fn a_via_point_without_a_time_is_measured_at_every_sample() {
    let plain = text(1000.0, 20, "method = \"auto\"", "");
    let free = plain.replace("acceleration = 1e-6\n", "acceleration = 1e-6\nvia_distance = 1.0\n");
    let tasks = [plain, free + "[[via_point]]\nposition = [0.5]\n"].map(|text| Task::parse(&text).unwrap());
    let [before, after] = tasks.map(|task| {
        let simulation = Simulation::new(&task, &Policy::initial(&task).unwrap()).unwrap();
        (simulation.signals().unwrap().groups[0].signals.len() as f64, task.memory(1))
    });
    // The response to 60 parameters, at work three times.
    let more = 60.0 * (after.0 - before.0) * 3.0 * 8.0;
    assert!(more > 1e6 && after.1 - before.1 >= more, "{before:?} {after:?}");
}
