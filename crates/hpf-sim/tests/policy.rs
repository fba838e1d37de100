//! The policy file: what it keeps to the bit, what it refuses, and that a control loop steps what the simulator rolls.

use hpf_sim::{Policy, PolicyError, Simulation, SimulationError, Task};

const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");
const BEAM: &str = include_str!("../../../tasks/cantilever.toml");
const REACH: &str = include_str!("../../../tasks/reach.toml");

fn policy(text: &str) -> Policy {
    crate::waves::policy(&Task::parse(text).unwrap())
}

fn bits(policy: &Policy) -> Vec<u64> {
    let axes = policy.axes.iter().flat_map(|axis| {
        let m = &axis.movement;
        let gains = [&axis.stiffness, &axis.damping].map(|g| [&g.centers, &g.widths].into_iter().flatten());
        let lists = m.centers.iter().chain(&m.widths).chain(gains.into_iter().flatten());
        let numbers = [axis.start, axis.goal, m.alpha, m.beta, m.forcing_scale, axis.stiffness.min, axis.damping.max];
        lists.copied().chain(numbers).collect::<Vec<_>>()
    });
    let numbers = [policy.duration_s, policy.phase.decay, policy.provenance.cost];
    policy.weights().into_iter().chain(axes).chain(numbers).map(f64::to_bits).collect()
}

#[test]
fn a_policy_reads_back_to_the_same_bits() {
    let mut policy = policy(VIA_POINT);
    let awkward = [
        0.1 + 0.2,
        5e-324,
        -2.2e-310,
        f64::MIN_POSITIVE,
        1e9,
        -999_999_999.999_999_9,
        1.0 + f64::EPSILON,
        -0.0,
        1e9 / 3.0,
        9_007_199.254_740_993,
        core::f64::consts::PI,
        1.0 / 3.0,
    ];
    policy.axes[0].movement.weights[..12].copy_from_slice(&awkward);
    policy.axes[1].start = 0.1 + 0.2;
    policy.provenance.cost = 0.1 + 0.7;
    policy.provenance.seed = u64::MAX;
    policy.provenance.task_sha256 = "a \"quoted\" \u{e9}\n".into();
    let text = policy.to_json();
    assert!(text.ends_with("}\n"));
    let again = Policy::parse(&text).unwrap();
    assert_eq!(again, policy);
    assert_eq!(bits(&again), bits(&policy));
    assert_eq!(again.to_json(), text);
}

#[test]
fn the_initial_policy_of_every_task_reads_back() {
    for text in [VIA_POINT, BEAM, REACH] {
        let policy = Policy::initial(&Task::parse(text).unwrap()).unwrap();
        assert_eq!(Policy::parse(&policy.to_json()).as_ref(), Ok(&policy));
        assert!(policy.axes.iter().all(|axis| axis.movement.weights.iter().all(|w| *w == 0.0)));
    }
}

#[test]
fn weights_go_out_and_come_in_in_one_order() {
    let policy = policy(VIA_POINT);
    let weights = policy.weights();
    assert_eq!(weights.len(), 120);
    assert_eq!(weights[..20], policy.axes[0].movement.weights);
    assert_eq!(weights[20..40], policy.axes[0].stiffness.weights);
    assert_eq!(weights[100..], policy.axes[1].damping.weights);
    let initial = Policy::initial(&Task::parse(VIA_POINT).unwrap()).unwrap();
    assert_eq!(initial.with_weights(&weights).unwrap(), policy);
}

#[track_caller]
fn refused(change: impl FnOnce(&mut Policy)) -> String {
    let mut policy = policy(VIA_POINT);
    change(&mut policy);
    Policy::parse(&policy.to_json()).unwrap_err().to_string()
}

#[track_caller]
fn refused_text(from: &str, to: &str) -> String {
    let text = policy(VIA_POINT).to_json();
    assert!(text.contains(from), "{from}");
    Policy::parse(&text.replacen(from, to, 1)).unwrap_err().to_string()
}

#[test]
fn another_format_or_version_is_refused_by_name_before_anything_else() {
    assert_eq!(
        refused(|policy| policy.format = "bvh".into()),
        "`format` is \"bvh\", this version reads \"hpf-policy\""
    );
    assert_eq!(refused(|policy| policy.version = 2), "`version` is 2, this version reads 1");
    assert_eq!(refused_text("\"version\": 1,", ""), "`version` is missing, this version reads 1");
    assert_eq!(Policy::parse("{}").unwrap_err().to_string(), "`format` is missing, this version reads \"hpf-policy\"");
    assert_eq!(Policy::parse("[1]").unwrap_err().to_string(), "`format` is missing, this version reads \"hpf-policy\"");
    let future = "{ \"format\": \"hpf-policy\", \"version\": 7, \"engine\": {} }";
    assert_eq!(Policy::parse(future).unwrap_err().to_string(), "`version` is 7, this version reads 1");
    assert!(matches!(Policy::parse(future), Err(PolicyError::Format { field: "version", .. })));
}

#[test]
fn unknown_and_missing_fields_are_refused_by_name_and_place() {
    let unknown = refused_text("\"duration_s\"", "\"duration\"");
    assert!(unknown.starts_with("line 5, column 12: unknown field `duration`"), "{unknown}");
    let missing = refused_text("\"alpha\": 25.0,", "");
    assert!(missing.ends_with("missing field `alpha`") && missing.starts_with("line "), "{missing}");
    let twice = refused_text("\"alpha\": 25.0,", "\"alpha\": 25.0, \"alpha\": 25.0,");
    assert!(twice.ends_with("duplicate field `alpha`"), "{twice}");
    let deep = refused_text("\"decay\"", "\"dekay\"");
    assert!(deep.contains("unknown field `dekay`, expected `decay`"), "{deep}");
    let kind = refused_text("\"alpha\": 25.0", "\"alpha\": \"25\"");
    assert!(kind.contains("invalid type: string \"25\", expected f64"), "{kind}");
}

#[test]
fn a_file_that_ends_early_is_refused_wherever_it_ends() {
    let text = policy(REACH).to_json();
    for end in (0..text.trim_end().len()).step_by(7) {
        let error = Policy::parse(&text[..end]).unwrap_err();
        assert!(matches!(error, PolicyError::Json { .. }), "{end}: {error}");
        assert!(error.to_string().contains("EOF while parsing"), "{end}: {error}");
    }
    assert!(Policy::parse(&(text + "{}")).unwrap_err().to_string().contains("trailing characters"));
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    // JSON has no such numbers: NaN is written as null, and a text with NaN in it is no JSON.
    let null = refused(|policy| policy.axes[0].movement.weights[3] = f64::NAN);
    assert!(null.contains("invalid type: null, expected f64"), "{null}");
    for bad in ["NaN", "Infinity", "1e999", "-1e999"] {
        let text = refused_text("\"alpha\": 25.0", &format!("\"alpha\": {bad}"));
        assert!(text.starts_with("line "), "{text}");
    }
    assert!(refused_text("\"alpha\": 25.0", "\"alpha\": 1e999").contains("number out of range"));
}

#[test]
fn lists_that_differ_in_length_are_refused() {
    let fewer = refused(|policy| policy.axes[1].stiffness.weights.truncate(19));
    assert_eq!(fewer, "axes[1].stiffness.weights: 19 weights for 20 centers");
    let more = refused(|policy| policy.axes[0].movement.weights.push(1.0));
    assert_eq!(more, "axes[0].movement.weights: 21 weights for 20 centers");
    let widths = refused(|policy| policy.axes[0].damping.widths.truncate(19));
    assert_eq!(widths, "axes[0].damping: widths has 19 entries, 20 are needed");
}

#[test]
fn a_weight_outside_its_bounds_is_refused() {
    let above = refused(|policy| policy.axes[0].stiffness.weights[3] = 400.5);
    assert_eq!(above, "axes[0].stiffness.weights[3]: weights must lie in [30, 400], not 400.5");
    let below = refused(|policy| policy.axes[1].damping.weights[19] = -1.0);
    assert_eq!(below, "axes[1].damping.weights[19]: weights must lie in [10, 100], not -1");
}

#[test]
fn impossible_numbers_are_refused_by_place() {
    type Change = fn(&mut Policy);
    let changes: [(Change, &str); 10] = [
        (|p| p.axes[1].movement.beta = 6.0, "axes[1].movement.beta: must be alpha/4 = 6.25, not 6"),
        (
            |p| (p.axes[0].movement.alpha, p.axes[0].movement.beta) = (-4.0, -1.0),
            "axes[0]: alpha must be positive, not -4",
        ),
        (|p| p.axes[0].damping.min = 200.0, "axes[0].damping: gain has its lower bound 200 above its upper bound 100"),
        (|p| p.axes[0].damping.min = 0.0, "axes[0].damping: min must be positive, not 0"),
        (|p| p.duration_s = 0.0, "duration_s, phase.decay: duration must be positive, not 0"),
        (|p| p.phase.decay = -1.0, "duration_s, phase.decay: decay must be positive, not -1"),
        (|p| p.admittance.order = 3, "admittance.order: must be 1 or 2, not 3"),
        (|p| p.axes[0].movement.centers[3] = 0.9, "axes[0].movement: centers must fall from each entry to the next"),
        (|p| p.axes[0].movement.widths[3] = -0.9, "axes[0].movement: widths must be positive, not -0.9"),
        (
            |p| p.axes[1].stiffness.centers[3] += 1e-9,
            "axes[1].stiffness: family, centers or widths differ from those of axes[0]: axes share one basis per primitive",
        ),
    ];
    for (change, message) in changes {
        assert_eq!(refused(change), message);
    }
}

#[test]
fn counts_are_limited() {
    assert_eq!(refused(|policy| policy.axes.clear()), "axes: 1 to 7 are allowed, not 0");
    assert_eq!(refused(|policy| policy.axes = vec![policy.axes[0].clone(); 8]), "axes: 1 to 7 are allowed, not 8");
    let functions = |count: u32| {
        refused(|policy| {
            let movement = &mut policy.axes[0].movement;
            movement.centers = (0..count).map(|i| 1.0 - f64::from(i) / f64::from(count)).collect();
            movement.widths = vec![1e6; count as usize];
            movement.weights = vec![0.0; count as usize];
        })
    };
    assert_eq!(functions(1), "axes[0].movement: centers has 1 entries, at least 2 are needed");
    assert_eq!(functions(1001), "axes[0].movement: at most 1000 basis functions are allowed, not 1001");
    assert!(refused_text("\"order\": 1", "\"order\": 4294967297").contains("integer `4294967297`, expected u8"));
    assert!(refused_text("\"updates\": 0", "\"updates\": -1").contains("integer `-1`, expected usize"));
    assert!(Policy::parse(&"[".repeat(100_000)).unwrap_err().to_string().contains("recursion limit exceeded"));
}

#[test]
fn a_policy_becomes_a_skill_of_its_own_number_of_axes() {
    let policy = policy(VIA_POINT);
    assert!(policy.to_hybrid::<2>().is_ok());
    let refused = policy.to_hybrid::<3>().unwrap_err();
    assert_eq!(refused.to_string(), "axes has 2 entries, 3 are needed");
}

#[test]
fn a_policy_belongs_to_tasks_with_its_axes_and_duration() {
    let task = Task::parse(VIA_POINT).unwrap();
    let other = Task::parse(BEAM).unwrap();
    let wrong = Simulation::new(&other, &policy(VIA_POINT)).unwrap_err();
    assert_eq!(wrong, SimulationError::Axes { policy: "x, y".into(), task: "y".into() });
    assert_eq!(wrong.to_string(), "the policy moves the axes x, y, the task has y");
    let mut longer = policy(VIA_POINT);
    longer.duration_s = 6.0;
    let wrong = Simulation::new(&task, &longer).unwrap_err();
    assert_eq!(wrong, SimulationError::Duration { policy: 6.0, task: 5.0 });
}

#[test]
fn a_control_loop_without_force_follows_the_simulators_reference() {
    let policy = policy(VIA_POINT);
    for rate in [100.0, 250.0] {
        let mut task = Task::parse(VIA_POINT).unwrap();
        task.rate = rate;
        let trace = Simulation::new(&task, &policy).unwrap().rollout(&policy.weights());
        let skill = policy.to_hybrid::<2>().unwrap();
        let mut state = skill.initial_state();
        for i in 1..=trace.steps() {
            let commands = skill.step(&mut state, [0.0; 2], 1.0, 1.0 / rate);
            for (command, axis) in commands.iter().zip(&trace.axes) {
                // The loop multiplies its phase step by step, the simulator takes it from time: rounding of 1000 steps.
                assert!((command.position - axis.reference_position[i]).abs() < 1e-12, "{i}");
                assert!((command.velocity - axis.reference_velocity[i]).abs() < 1e-12, "{i}");
            }
            assert!((state.phase - trace.phase[i]).abs() < 1e-14);
        }
    }
}

#[test]
fn a_control_loop_under_a_held_force_gives_way_as_the_simulator_does() {
    // A force that is the same at both ends of a step is held; what is left is k and d at mid-step in the one, the
    // target's line from its start to its end in the other: second order, measured 1.0e-5 m at 100 Hz.
    let mut task = Task::parse(REACH).unwrap();
    let policy = policy(REACH);
    let gap = |rate: f64, task: &mut Task| {
        task.rate = rate;
        let trace = Simulation::new(task, &policy).unwrap().rollout(&policy.weights());
        let skill = policy.to_hybrid::<1>().unwrap();
        let mut state = skill.initial_state();
        let mut worst = 0.0_f64;
        for i in 1..=trace.steps() {
            let [command] = skill.step(&mut state, [trace.axes[0].force[i - 1]], 1.0, 1.0 / rate);
            worst = worst.max((command.position - trace.axes[0].position[i]).abs());
        }
        worst
    };
    let gaps = [100.0, 200.0, 400.0].map(|rate| gap(rate, &mut task));
    assert!(gaps[0] < 2e-5, "{gaps:?}");
    for pair in gaps.windows(2) {
        assert!((pair[0] / pair[1] / 4.0 - 1.0).abs() < 0.05, "{gaps:?}");
    }
}
