//! The time family in task files and policies.

use hpf_learn::learn_with;
use hpf_sim::{Conditions, Family, Policy, Simulation, Task};

const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");

fn time_family() -> Task {
    let text = VIA_POINT.replacen("basis = 20 ", "basis = { family = \"time\" } ", 1);
    let text = text.replacen("basis = 20\n", "basis = { family = \"time\", count = 15 }\n", 2);
    let task = Task::parse(&text).unwrap_or_else(|found| panic!("{found:?}"));
    assert_eq!(
        [task.movement.basis, task.stiffness.basis, task.damping.basis].map(|basis| basis.count()),
        [20, 15, 15]
    );
    task
}

#[test]
fn a_task_in_the_time_family_learns_and_its_policy_reads_back() {
    let mut task = time_family();
    task.learning.method = hpf_sim::task::Method::Auto;
    let policy = Policy::initial(&task).unwrap();
    assert_eq!(policy.axes[0].movement.family, Family::Time { overlap: 0.6 });
    let simulation = Simulation::new(&task, &policy).unwrap();
    let start = simulation.starting_weights(&policy).unwrap();
    let history = learn_with(&simulation, start, &task.learning.method(), Some(400), |_| true).unwrap();
    let (_, metrics) = simulation.evaluate(&history.best.weights);
    assert!(metrics.iter().all(|metric| metric.pass() != Some(false)), "{metrics:?}");
    let policy = policy.with_weights(&history.best.weights).unwrap();
    let read = Policy::parse(&policy.to_json()).unwrap();
    assert_eq!(read, policy);
    read.certify(&Conditions::new(1000.0, 0.001, 10.0)).unwrap();
    // The control loop steps the same gains as the simulator.
    let (trace, skill) = (simulation.rollout(&policy.weights()), policy.to_hybrid::<2>().unwrap());
    for (i, phase) in trace.phase.iter().enumerate() {
        let profile = skill.at(*phase);
        for (axis, profile) in trace.axes.iter().zip(profile) {
            assert!((axis.stiffness[i] / profile.stiffness - 1.0).abs() < 1e-12);
            assert!((axis.damping[i] / profile.damping - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn a_policy_in_the_phase_family_says_nothing_of_families() {
    let text = Policy::initial(&Task::parse(VIA_POINT).unwrap()).unwrap().to_json();
    assert!(!text.contains("family") && !text.contains("mass"));
}

#[test]
fn lists_that_are_not_those_of_the_family_are_refused() {
    let policy = Policy::initial(&time_family()).unwrap();
    let refused = |change: &dyn Fn(&mut Policy)| {
        let mut policy = policy.clone();
        change(&mut policy);
        Policy::parse(&policy.to_json()).unwrap_err().to_string()
    };
    let overlap = refused(&|policy| policy.axes[1].movement.family = Family::Time { overlap: 0.7 });
    assert!(overlap.starts_with("axes[1].movement: falls"), "{overlap}");
    let center = refused(&|policy| policy.axes[0].damping.centers[3] *= 1.0 + 1e-12);
    assert!(center.starts_with("axes[0].damping: centers"), "{center}");
    let phase = refused(&|policy| policy.axes.iter_mut().for_each(|axis| axis.stiffness.family = Family::Phase));
    assert!(phase.starts_with("axes[0].stiffness: "), "{phase}");
    let text = policy.to_json().replace("\"time\"", "\"tide\"");
    let unknown = Policy::parse(&text).unwrap_err().to_string();
    assert!(unknown.contains("unknown variant `tide`"), "{unknown}");
}

#[test]
fn mistakes_in_a_basis_are_answered() {
    for (basis, words) in [
        ("{ family = \"tyme\" }", "unknown value `tyme`, did you mean `time`?"),
        ("{ count = 1 }", "`count` is out of range: 1"),
        ("{ cuont = 5 }", "unknown key `cuont`, did you mean `count`?"),
        ("1", "`basis` is out of range: 1"),
        ("20.5", "`basis` cannot have a decimal point"),
        ("\"time\"", "`basis` cannot be a text"),
    ] {
        let found = Task::parse(&VIA_POINT.replacen("basis = 20 ", &format!("basis = {basis} "), 1)).unwrap_err();
        assert!(found.iter().any(|found| found.message.contains(words)), "{basis}: {found:?}");
    }
}

#[test]
fn a_law_of_second_order_has_a_mass_and_one_of_first_order_none() {
    for (keys, words) in [
        ("order = 2", "a law of order 2 has a mass, and none is given"),
        ("mass = 2.0", "a law of order 1 has no mass"),
        ("order = 3\nmass = 2.0", "`order` is out of range: 3"),
        ("order = 2\nmass = 0.0", "`mass` is out of range: 0"),
        ("order = 2\nmass = [1.0]", "1 value for 2 axes"),
    ] {
        let found = Task::parse(&format!("{VIA_POINT}\n[admittance]\n{keys}\n")).unwrap_err();
        assert!(found.iter().any(|found| found.message.contains(words)), "{keys}: {found:?}");
    }
    let task = Task::parse(&format!("{VIA_POINT}\n[admittance]\norder = 2\nmass = [1.0, 2.0]\n")).unwrap();
    let policy = Policy::initial(&task).unwrap();
    assert_eq!(policy.admittance.mass, Some(vec![1.0, 2.0]));
    assert_eq!(policy.axis(1).admittance.mass, Some(vec![2.0]));
    assert_eq!(Policy::parse(&policy.to_json()).as_ref(), Ok(&policy));
    let refused = |mass: Option<Vec<f64>>| {
        let mut policy = policy.clone();
        policy.admittance.mass = mass;
        Policy::parse(&policy.to_json()).unwrap_err().to_string()
    };
    assert_eq!(refused(None), "admittance.mass: missing: a law of order 2 has one");
    assert_eq!(refused(Some(vec![1.0])), "admittance.mass: 1 numbers for 2 axes");
    assert_eq!(refused(Some(vec![1.0, -2.0])), "admittance.mass: must be above 0 and finite, not -2");
}

#[test]
fn a_task_of_second_order_is_learned() {
    let text = VIA_POINT.replace("method = \"pi2\"", "method = \"auto\"") + "\n[admittance]\norder = 2\nmass = 2.0\n";
    let task = Task::parse(&text).unwrap();
    let policy = Policy::initial(&task).unwrap();
    let simulation = Simulation::new(&task, &policy).unwrap();
    let start = simulation.starting_weights(&policy).unwrap();
    let history = learn_with(&simulation, start, &task.learning.method(), Some(1000), |_| true).unwrap();
    let (_, metrics) = simulation.evaluate(&history.best.weights);
    assert!(metrics.iter().all(|metric| metric.pass() != Some(false)), "{metrics:?}");
}
