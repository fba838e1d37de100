//! Random valid tasks, learned for a few updates: nothing panics, every number stays finite, every gain within bounds.
//!
//! 200 tasks; `HPF_RANDOM_TASKS=10000 cargo test --release -p hpf-sim --test random_tasks` learns more,
//! `HPF_RANDOM_TASK=17` the one alone and prints it.

use hpf_sim::{Conditions, Policy, Simulation, Task, Trace};
use rayon::prelude::*;

/// Tasks learned where nobody asks for more.
const TASKS: u64 = 200;

/// A gain mixes weights within its bounds, by shares whose sum is 1 but for rounding.
const ROUNDING: f64 = 1e-12;

fn asked(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name} must be a whole number")))
}

#[test]
fn random_tasks_are_learned_with_finite_numbers_within_their_bounds() {
    if let Some(seed) = asked("HPF_RANDOM_TASK") {
        println!("{}", crate::generator::task(seed));
        return learn(seed).unwrap_or_else(|wrong| panic!("{wrong}"));
    }
    let seeds = 0..asked("HPF_RANDOM_TASKS").unwrap_or(TASKS);
    let count = seeds.end;
    let wrong: Vec<String> = seeds
        .into_par_iter()
        .filter_map(|seed| {
            let learned = std::panic::catch_unwind(|| learn(seed)).unwrap_or_else(|_| Err("it panics".into()));
            learned.err().map(|wrong| format!("HPF_RANDOM_TASK={seed}: {wrong}"))
        })
        .collect();
    let (shown, total) = (wrong.iter().take(20).cloned().collect::<Vec<_>>().join("\n"), wrong.len());
    assert!(wrong.is_empty(), "{total} of {count} tasks went wrong:\n{shown}");
}

/// Learns task `seed`, and says what went wrong.
fn learn(seed: u64) -> Result<(), String> {
    let text = crate::generator::task(seed);
    let task = Task::parse(&text).map_err(|found| format!("refused: {}; {}", found[0].message, found[0].help))?;
    let again = toml::to_string(&task).map_err(|error| format!("cannot be written: {error}"))?;
    if Task::parse(&again).as_ref() != Ok(&task) {
        return Err(format!("written and read it is another task:\n{again}"));
    }
    let start = Policy::initial(&task).map_err(|error| error.to_string())?;
    let simulation = Simulation::new(&task, &start).map_err(|error| error.to_string())?;
    let weights = simulation.starting_weights(&start).map_err(|error| error.to_string())?;
    let mut wrong = None;
    let history =
        hpf_learn::learn_with(&simulation, weights, &task.learning.method(), task.learning.max_rollouts, |progress| {
            let numbers = progress.terms.iter().chain(&progress.weights).chain([&progress.total]);
            if wrong.is_none() && !numbers.chain([&progress.exploration]).all(|number| number.is_finite()) {
                wrong = Some(format!("update {} has a number that is not finite", progress.update));
            }
            true
        })
        .map_err(|error| error.to_string())?;
    if let Some(wrong) = wrong {
        return Err(wrong);
    }
    if task.learning.max_rollouts.is_some_and(|most| history.rollouts > most) {
        return Err(format!("{} motions were made", history.rollouts));
    }
    let policy = start.with_weights(&history.best.weights).unwrap();
    check_policy(&policy, task.rate)?;
    let trace = simulation.rollout(&history.best.weights);
    check_trace(&task, &trace)?;
    if simulation.parameters(&policy) != history.best.weights {
        return Err("the policy has other parameters than were learned".into());
    }
    match simulation.evaluate(&history.best.weights).1.iter().find(|metric| !metric.value.is_finite()) {
        Some(metric) => Err(format!("{} is {}", metric.name, metric.value)),
        None => Ok(()),
    }
}

/// The policy comes back from its file to the bit, and its certificates are numbers.
fn check_policy(policy: &Policy, rate: f64) -> Result<(), String> {
    let again = Policy::parse(&policy.to_json()).map_err(|error| format!("the policy is refused: {error}"))?;
    let bits = |policy: &Policy| policy.weights().iter().map(|weight| weight.to_bits()).collect::<Vec<_>>();
    if again != *policy || bits(&again) != bits(policy) {
        return Err("the policy is another one after reading".into());
    }
    let conditions = Conditions::new(rate, rate.recip(), 10.0);
    let certificates = policy.certify(&conditions).map_err(|error| format!("no certificate: {error}"))?;
    let finite = certificates.iter().all(|certificate| {
        let numbers = [certificate.largest_offset, certificate.switched_energy, certificate.peak_velocity];
        numbers.iter().all(|number| number.is_finite())
    });
    if finite { Ok(()) } else { Err("a certificate is not finite".into()) }
}

fn check_trace(task: &Task, trace: &Trace) -> Result<(), String> {
    let finite = |name: &str, signal: &[f64]| match signal.iter().position(|number| !number.is_finite()) {
        Some(row) => Err(format!("{name} is {} in row {row}", signal[row])),
        None => Ok(()),
    };
    for (i, axis) in trace.axes.iter().enumerate() {
        for (name, signal) in [
            ("reference_position", &axis.reference_position),
            ("reference_velocity", &axis.reference_velocity),
            ("position", &axis.position),
            ("velocity", &axis.velocity),
            ("force", &axis.force),
            ("stiffness", &axis.stiffness),
            ("damping", &axis.damping),
        ] {
            finite(name, signal)?;
        }
        for (name, gain, signal) in
            [("stiffness", &task.stiffness, &axis.stiffness), ("damping", &task.damping, &axis.damping)]
        {
            let (min, max) = (gain.min.of(i) * (1.0 - ROUNDING), gain.max.of(i) * (1.0 + ROUNDING));
            if let Some(value) = signal.iter().find(|value| !(min..=max).contains(*value)) {
                return Err(format!("{name} of axis {i} is {value}, outside {min} to {max}"));
            }
        }
    }
    if let Some(contact) = &trace.contact {
        finite("deviation", &contact.deviation)?;
        finite("deflection", &contact.deflection)?;
        finite("contact force", &contact.force)?;
    }
    Ok(())
}
