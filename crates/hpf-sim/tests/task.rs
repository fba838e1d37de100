//! The task file: what ships is accepted, and each mistake is told once, where it is, in words that help.

mod rules;

use hpf_sim::environment::{Contact, Disturbance};
use hpf_sim::task::{PerAxis, TemperatureKind};
use hpf_sim::{Diagnostic, Policy, Simulation, Task};

const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");
const DMPBBO: &str = include_str!("../../../tasks/dmpbbo_via_point.toml");
const BEAM: &str = include_str!("../../../tasks/cantilever.toml");
const MOVING_LOAD: &str = include_str!("../../../tasks/cantilever_moving_load.toml");
const ROBOT_BEAM: &str = include_str!("../../../tasks/cantilever_robot.toml");
const REACH: &str = include_str!("../../../tasks/reach.toml");

#[test]
fn every_shipped_task_is_accepted_and_can_be_simulated() {
    for (text, name, axes, steps) in [
        (VIA_POINT, "via_point", 2, 500),
        (DMPBBO, "dmpbbo_via_point", 2, 75),
        (BEAM, "cantilever", 1, 500),
        (MOVING_LOAD, "cantilever_moving_load", 1, 500),
        (ROBOT_BEAM, "cantilever_robot", 1, 5000),
        (REACH, "reach", 1, 100),
    ] {
        let task = Task::parse(text).unwrap();
        assert_eq!((task.name.as_str(), task.axis.len(), task.steps()), (name, axes, steps));
        let policy = Policy::initial(&task).unwrap();
        let simulation = Simulation::new(&task, &policy).unwrap();
        assert!(simulation.cost(&simulation.rollout(&policy.weights())).total().is_finite());
    }
}

#[test]
fn what_is_left_out_has_the_papers_value() {
    let task = Task::parse(REACH).unwrap();
    assert_eq!((task.movement.basis.count(), task.stiffness.basis.count(), task.admittance.order), (20, 20, 1));
    assert_eq!(task.movement.alpha, PerAxis::All(25.0));
    assert!((task.phase.decay - 100.0_f64.ln()).abs() < 1e-15);
    assert!(task.contact.is_none() && task.via_point.is_empty());
    let Contact::Cantilever(beam) = Task::parse(&BEAM.replace("contact_stiffness = 1e6", "")).unwrap().contact.unwrap()
    else {
        panic!("not a beam")
    };
    assert_eq!(beam.contact_stiffness, 1e6);
}

#[test]
fn numbers_may_be_written_in_every_way_toml_knows() {
    for (seed, value) in
        [("0xff", 255), ("0b101", 5), ("0o17", 15), ("1_000", 1000), ("9223372036854775807", i64::MAX as u64)]
    {
        assert_eq!(Task::parse(&REACH.replace("seed = 1", &format!("seed = {seed}"))).unwrap().learning.seed, value);
    }
    let whole = Task::parse(&REACH.replace("rate = 100.0", "rate = 1_00")).unwrap();
    assert_eq!(whole.rate, 100.0);
}

#[test]
fn values_per_axis_and_named_kinds_are_read() {
    let text = VIA_POINT
        .replace("goal = 1e4", "goal = [1e4, 2e4]")
        .replace("scaling = \"goal\"", "scaling = { amplitude = [1, 2.5] }")
        .replace("seed = 1", "seed = 1\ntemperature = { lambda = 2.0 }\ncredit = \"to-go\"")
        .replacen("kind = \"sine\"\naxis", "kind = \"sine\"\nphase = 0.5\naxis", 1);
    let task = Task::parse(&text).unwrap();
    assert_eq!((task.cost.goal.of(0), task.cost.goal.of(1)), (1e4, 2e4));
    assert_eq!(task.learning.temperature, Some(TemperatureKind::Lambda(2.0)));
    assert_eq!(task.axis_index("y"), Some(1));
    assert!(task.disturbance.iter().all(|d| matches!(d, Disturbance::Sine(_))));
}

#[track_caller]
fn mistakes(text: &str) -> Vec<Diagnostic> {
    Task::parse(text).unwrap_err().into_iter().collect()
}

/// The first `from` in `text` becomes `to`; the one diagnostic points at `place` within `to`, with that message and
/// help.
#[track_caller]
fn one(text: &str, (from, to): (&str, &str), place: &str, message: &str, help: &str) {
    assert!(text.contains(from), "the task has no {from}");
    let start = text.find(from).unwrap() + to.find(place).unwrap();
    let found = mistakes(&text.replacen(from, to, 1));
    let expected = Diagnostic { span: start..start + place.len(), message: message.into(), help: help.into() };
    assert_eq!(found, [expected]);
}

/// The same, the one diagnostic pointing at `elsewhere`, outside what changed.
#[track_caller]
fn one_elsewhere(text: &str, (from, to): (&str, &str), elsewhere: &str, message: &str, help: &str) {
    assert!(text.contains(from), "the task has no {from}");
    let text = text.replacen(from, to, 1);
    let start = text.find(elsewhere).unwrap();
    let expected = Diagnostic { span: start..start + elsewhere.len(), message: message.into(), help: help.into() };
    assert_eq!(mistakes(&text), [expected]);
}

#[test]
fn an_unknown_key_names_the_nearest_one() {
    let keys = "the task takes: name, duration, rate, axis, phase, movement, stiffness, damping, admittance, \
                environment, disturbance, contact, sensor, actuator, recording, via_point, cost, learning, output, accept";
    let near = "unknown key `duratoin`, did you mean `duration`?";
    one(VIA_POINT, ("duration = 5.0", "duratoin = 5.0"), "duratoin", near, keys);
    one(VIA_POINT, ("[phase]", "[phases]"), "phases", "unknown key `phases`, did you mean `phase`?", keys);
    one(REACH, ("[[axis]]", "[[axes]]"), "axes", "unknown key `axes`, did you mean `axis`?", keys);
    one(BEAM, ("[contact]", "[contct]"), "contct", "unknown key `contct`, did you mean `contact`?", keys);
    let gain = "stiffness takes: basis, overlap, initial, min, max";
    one(VIA_POINT, ("initial = 100", "intial = 100"), "intial", "unknown key `intial`, did you mean `initial`?", gain);
    let cost = "cost takes: goal, end_velocity, rest, via_point, via_distance, tracking, contact_force, acceleration, \
                stiffness, damping";
    one(VIA_POINT, ("acceleration = 1e-2", "jerk = 1.0"), "jerk", "unknown key `jerk`", cost);
    let scaling = ("scaling = \"goal\"", "scaling = { amplitde = 1 }");
    let near = "unknown key `amplitde`, did you mean `amplitude`?";
    one(VIA_POINT, scaling, "amplitde", near, "scaling takes: amplitude");
}

#[test]
fn a_value_of_the_wrong_type_says_what_it_is_and_what_it_must_be() {
    let number = "`duration` must be a number from 1e-9 to 1e9";
    one(VIA_POINT, ("duration = 5.0", "duration = \"5 s\""), "\"5 s\"", "`duration` cannot be a text", number);
    one(VIA_POINT, ("duration = 5.0", "duration = [5.0]"), "[5.0]", "`duration` cannot be an array", number);
    one(VIA_POINT, ("duration = 5.0", "duration = true"), "true", "`duration` cannot be true or false", number);
    one(VIA_POINT, ("duration = 5.0", "duration = 05:00:00"), "05:00:00", "`duration` cannot be a date", number);
    let family = "{ family = \"phase\" or \"time\", count = ... }";
    let whole = &format!("`basis` must be a whole number from 2 to 1000 or a table {family}");
    one(VIA_POINT, ("basis = 20", "basis = \"time\""), "\"time\"", "`basis` cannot be a text", whole);
    one(VIA_POINT, ("basis = 20", "basis = 20.0"), "20.0", "`basis` cannot have a decimal point", whole);
    let per_axis = "`alpha` must be a number or an array of numbers";
    one(VIA_POINT, ("alpha = 25.0", "alpha = \"25\""), "\"25\"", "`alpha` cannot be a text", per_axis);
    one(VIA_POINT, ("alpha = 25.0", "alpha = { x = 1 }"), "{ x = 1 }", "`alpha` cannot be a table", per_axis);
    one(
        VIA_POINT,
        ("alpha = 25.0", "alpha = [25.0, \"x\"]"),
        "\"x\"",
        "`alpha` cannot be a text",
        "`alpha` must be a number",
    );
    let scaling = "`scaling` must be \"goal\" or \"unit\" or a table { amplitude = ... }";
    one(VIA_POINT, ("scaling = \"goal\"", "scaling = 1.0"), "1.0", "`scaling` cannot be a number", scaling);
    let axes = "`axis` must be an array of tables, each under [[axis]]";
    one(REACH, ("[[axis]]", "[axis]"), "[axis]", "`axis` cannot be a table", axes);
    let position = "`position` must be an array of numbers";
    one(VIA_POINT, ("position = [0.6, 0.8]", "position = 0.6"), "0.6", "`position` cannot be a number", position);
    one(
        VIA_POINT,
        ("method = \"pi2\"", "method = 2"),
        "2",
        "`method` cannot be a number",
        "`method` must be \"pi2\" or \"gauss-newton\" or \"model\" or \"auto\" or \"cma-es\"",
    );
}

#[test]
fn a_number_out_of_range_says_its_range() {
    for (text, from, to, place, range) in [
        (VIA_POINT, "duration = 5.0", "duration = 0", "0", "`duration` must be a number from 1e-9 to 1e9"),
        (VIA_POINT, "rate = 100.0", "rate = 0.0", "0.0", "`rate` must be a number above 0"),
        (VIA_POINT, "rate = 100.0", "rate = -1e2", "-1e2", "`rate` must be a number above 0"),
        (VIA_POINT, "decay = 4.605170185988091", "decay = 200", "200", "`decay` must be a number from 0.001 to 100"),
        (VIA_POINT, "basis = 20", "basis = 0", "0", "`basis` must be a whole number from 2 to 1000"),
        (VIA_POINT, "basis = 20", "basis = 1", "1", "`basis` must be a whole number from 2 to 1000"),
        (VIA_POINT, "basis = 20", "basis = 1001", "1001", "`basis` must be a whole number from 2 to 1000"),
        (VIA_POINT, "basis = 20", "overlap = 1.0", "1.0", "`overlap` must be a number above 0 and below 1"),
        (BEAM, "width = 0.05", "width = -0.05", "-0.05", "`width` must be a number above 0"),
        (VIA_POINT, "time = 2.5", "time = 0.0", "0.0", "`time` must be a number above 0"),
        (VIA_POINT, "updates = 600", "updates = 0", "0", "`updates` must be a whole number from 1 to 1000000"),
        (VIA_POINT, "rollouts = 18", "rollouts = 1", "1", "`rollouts` must be a whole number from 2 to 100000"),
        (VIA_POINT, "seed = 1", "seed = -1", "-1", "`seed` must be a whole number from 0 to 9223372036854775807"),
        (
            VIA_POINT,
            "seed = 1",
            "seed = 99999999999999999999",
            "99999999999999999999",
            "`seed` must be a whole number from 0 to 9223372036854775807, 64 bits with a sign",
        ),
        (
            VIA_POINT,
            "snapshots = [0, 100",
            "snapshots = [0, -1",
            "-1",
            "`snapshots` must be a whole number of at least 0",
        ),
        (VIA_POINT, "max_cost = 1.1", "max_cost = -0.7", "-0.7", "`max_cost` must be a number of at least 0"),
        // What differs by axis is checked with the axes.
        (VIA_POINT, "alpha = 25.0", "alpha = [25.0, -1]", "-1", "`alpha` must be above 0"),
        (VIA_POINT, "min = 30.0", "min = 0", "0", "`min` must be above 0"),
        (VIA_POINT, "max = 400.0", "max = 0", "0", "`max` must be above 0"),
        (VIA_POINT, "initial = 100.0", "initial = -100", "-100", "`initial` must be above 0"),
        (VIA_POINT, "via_point = 1e4", "via_point = [1, -2]", "-2", "`via_point` must be at least 0"),
        (VIA_POINT, "movement = 10.0", "movement = -10", "-10", "`movement` must be at least 0"),
    ] {
        let key = range.split('`').nth(1).unwrap();
        one(text, (from, to), place, &format!("`{key}` is out of range: {place}"), range);
    }
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    for bad in ["nan", "inf", "-inf", "1e400"] {
        let message = "`duration` is not a finite number";
        let to = format!("duration = {bad}");
        one(VIA_POINT, ("duration = 5.0", &to), bad, message, "`duration` must be a number from 1e-9 to 1e9");
        let to = format!("position = [0.6, {bad}]");
        let message = "`position` is not a finite number";
        one(VIA_POINT, ("position = [0.6, 0.8]", &to), bad, message, "`position` must be a number");
    }
}

#[test]
fn a_missing_key_is_asked_for_where_it_belongs() {
    let goal = "add `goal`, a number";
    one_elsewhere(REACH, ("goal = 0.3", ""), "[[axis]]", "axis has no `goal`", goal);
    let initial = "add `initial`, a number or an array of numbers";
    one_elsewhere(REACH, ("initial = 100.0", ""), "[stiffness]", "stiffness has no `initial`", initial);
    one_elsewhere(BEAM, ("width = 0.05", ""), "[contact]", "contact has no `width`", "add `width`, a number above 0");
    let kinds = "kind is one of: cantilever, wall";
    one_elsewhere(BEAM, ("kind = \"cantilever\"", ""), "[contact]", "contact has no `kind`", kinds);
}

#[test]
fn an_empty_file_is_told_once_and_one_without_keys_is_asked_for_all_that_it_needs() {
    let help = "a task needs at least name, duration, rate, one [[axis]], [stiffness] and [damping]";
    for text in ["", " \n\t\n"] {
        assert_eq!(mistakes(text), [Diagnostic { span: 0..0, message: "the file is empty".into(), help: help.into() }]);
    }
    for text in ["\n# nothing yet\n", "\u{feff}"] {
        let found: Vec<String> =
            mistakes(text).into_iter().map(|found| format!("{}; {}", found.message, found.help)).collect();
        let expected = [
            "the task has no `name`; add `name`, a text in quotes",
            "the task has no `duration`; add `duration`, a number from 1e-9 to 1e9",
            "the task has no `rate`; add `rate`, a number above 0",
            "the task has no `axis`; add `axis`, an array of tables, each under [[axis]]",
            "the task has no `stiffness`; add `stiffness`, a table { initial = ..., min = ..., max = ... }",
            "the task has no `damping`; add `damping`, a table { initial = ..., min = ..., max = ... }",
        ];
        assert_eq!(found, expected);
        assert!(mistakes(text).iter().all(|found| found.span == (0..0)));
    }
}

#[test]
fn kinds_and_names_are_listed() {
    let forces = "kind is one of: sine, step, pulse, ramp, table";
    let near = "unknown kind `sin`, did you mean `sine`?";
    one(VIA_POINT, ("kind = \"sine\"", "kind = \"sin\""), "\"sin\"", near, forces);
    let strange = "unknown kind `earthquake`";
    one(VIA_POINT, ("kind = \"sine\"", "kind = \"earthquake\""), "\"earthquake\"", strange, forces);
    one(VIA_POINT, ("kind = \"sine\"", "kind = 3"), "3", "`kind` cannot be a number", forces);
    one(VIA_POINT, ("kind = \"sine\"", "knid = \"sine\""), "knid", "unknown key `knid`, did you mean `kind`?", forces);
    let contacts = "kind is one of: cantilever, wall";
    one(BEAM, ("\"cantilever\"\naxis", "\"beam\"\naxis"), "\"beam\"", "unknown kind `beam`", contacts);
    let curve = ("curve = \"tip_load\"", "curve = \"tip-load\"");
    let near = "unknown value `tip-load`, did you mean `tip_load`?";
    one(BEAM, curve, "\"tip-load\"", near, "`curve` is one of: tip_load, moving_load");
}

#[test]
fn a_table_with_one_key_of_several_says_which() {
    let help = "temperature takes one of: range, lambda, effective_size";
    for (table, place, message) in [
        (
            "{ range = 10.0, lambda = 1.0 }",
            "{ range = 10.0, lambda = 1.0 }",
            "temperature has both `range` and `lambda`",
        ),
        ("{ rnge = 10.0 }", "rnge", "unknown key `rnge`, did you mean `range`?"),
        ("{}", "{}", "temperature is empty"),
    ] {
        // A task that names the method, so that nothing else is wrong.
        let named = REACH.replace("updates = 100", "method = \"pi2\"\nupdates = 100");
        one(&named, ("seed = 1", &format!("temperature = {table}")), place, message, help);
    }
    let both = "`temperature` must be \"rank\" or a table { range = ... } or a table { lambda = ... } or a table { effective_size = ... }";
    one(REACH, ("seed = 1", "temperature = 10.0"), "10.0", "`temperature` cannot be a number", both);
}

#[test]
fn all_mistakes_are_told_in_the_order_of_the_text() {
    let keys = VIA_POINT
        .replace("rate = 100.0", "rate = 0.0")
        .replace("alpha = 25.0", "alpha = \"25\"")
        .replace("period = 5.0", "perod = 5.0")
        .replace("seed = 1", "sead = 1");
    let messages = |text: &str| -> Vec<String> { mistakes(text).into_iter().map(|found| found.message).collect() };
    let expected = [
        "`rate` is out of range: 0.0",
        "`alpha` cannot be a text",
        "unknown key `perod`, did you mean `period`?",
        "unknown key `perod`, did you mean `period`?",
        "unknown key `sead`, did you mean `seed`?",
    ];
    assert_eq!(messages(&keys), expected);

    let rules = VIA_POINT
        .replace("max_rollouts = 12000", "max_rollouts = 3")
        .replace("min = 30.0", "min = 500.0")
        .replace("time = 2.5", "time = 7.0")
        .replace("axis = \"x\"", "axis = \"q\"");
    let expected = [
        "`min` is above `max` on axis `x`: 500 > 400",
        "there is no axis `q`",
        "the via point at 7 s lies outside the movement",
        "`max_rollouts` leaves no room for a single update",
    ];
    assert_eq!(messages(&rules), expected);
    for text in [keys, rules] {
        assert!(mistakes(&text).is_sorted_by_key(|found| found.span.start));
    }
}

/// Whatever is wrong with a table, its axis is looked for; what hangs on a stand-in is not told.
#[test]
fn a_table_with_a_mistake_is_still_held_against_the_rest() {
    let told = |table: &str| -> Vec<String> {
        let text = format!("disturbance = [{table}]\n{}", REACH.replace("[[disturbance]]", "[other]"));
        let found = mistakes(&text).into_iter().filter(|found| !found.message.contains("other"));
        found.map(|found| found.message).filter(|message| !message.contains("cost.")).collect()
    };
    let no_axis = "there is no axis `q`";
    let lacks = |key: &str| format!("disturbance has no `{key}`");
    for (table, mistakes) in [
        ("{ kind = 'step', axis = 'q', amplitude = 1.0 }", vec![lacks("start"), no_axis.into()]),
        (
            "{ kind = 'step', axis = 'q', force = 'much', amplitude = 1.0 }",
            vec![lacks("start"), no_axis.into(), "unknown key `force`".into()],
        ),
        (
            "{ kind = 'step', axis = 'q', amplitude = 'much', start = 0.1 }",
            vec![no_axis.into(), "`amplitude` cannot be a text".into()],
        ),
        (
            "{ kind = 'sinus', axis = 'q', period = 'long' }",
            vec!["unknown kind `sinus`, did you mean `sine`?".into(), no_axis.into()],
        ),
        ("{ axis = 'q', amplitude = 1.0 }", vec![lacks("kind"), no_axis.into()]),
        ("{ knd = 'step', axis = 'q' }", vec!["unknown key `knd`, did you mean `kind`?".into(), no_axis.into()]),
        ("{ kind = 'step', axis = 3, amplitude = 1.0, start = 0.1 }", vec!["`axis` cannot be a number".into()]),
        ("{ kind = 'step', amplitude = 1.0, start = 0.1 }", vec![lacks("axis")]),
        ("{ kind = 'sinus', axis = 3 }", vec!["unknown kind `sinus`, did you mean `sine`?".into()]),
        (
            "{ kind = 'sine', axis = 'q', amplitude = 1.0, period = { uniform = [-1.0, 1.0], normal = [1.0, 1.0] } }",
            vec![no_axis.into(), "period has both `uniform` and `normal`".into()],
        ),
        (
            "{ kind = 'sine', axis = 'q', amplitude = {}, period = 1 }",
            vec![no_axis.into(), "amplitude is empty".into()],
        ),
    ] {
        assert_eq!(told(table), mistakes, "{table}");
    }
    let told = |from: &str, to: &str| -> Vec<String> {
        let via_point = "\n[[via_point]]\ntime = 99.0\nposition = [0.1]\n";
        let text = REACH.replacen(from, to, 1).replace("axis = \"x\"", "axis = \"q\"") + via_point;
        mistakes(&text).into_iter().map(|found| found.message).filter(|message| !message.contains("cost.")).collect()
    };
    let outside = "the via point at 99 s lies outside the movement";
    assert_eq!(told("rate = 100.0", ""), ["the task has no `rate`", no_axis, outside]);
    assert_eq!(told("initial = 100.0\n", ""), ["stiffness has no `initial`", no_axis, outside]);
    assert_eq!(told("goal = 0.3 ", ""), ["axis has no `goal`", no_axis, outside]);
    assert_eq!(told("duration = 1.0", ""), ["the task has no `duration`", no_axis]);
}

#[test]
fn what_is_not_toml_is_told_where_it_stops_being_toml() {
    let help = "the file must be valid TOML: lines of `key = value`, `[table]` or `# comment`, texts in quotes";
    for (text, places) in [
        ("name = \"a\nrate = \nx", [9, 17, 19].as_slice()),
        ("duration 5.0", &[9]),
        ("name = \"a\"\r\n[[axis]\r\n", &[19]),
        ("name = pi2", &[7]),
    ] {
        let found = mistakes(text);
        assert_eq!(found.iter().map(|found| found.span.start).collect::<Vec<_>>(), places, "{text}");
        assert!(found.iter().all(|found| found.help == help && found.span.end <= text.len()));
    }
    let twice = "keep one of them; several of a kind, such as axes, stand under double brackets each: [[axis]]";
    let again = ("duration = 5.0", "duration = 5.0\nduration");
    let text = VIA_POINT.replacen(again.0, "duration = 5.0\nduration = 6.0", 1);
    let start = text.find("duration = 6.0").unwrap();
    let expected =
        Diagnostic { span: start..start + 8, message: "`duration` is given twice".into(), help: twice.into() };
    assert_eq!(mistakes(&text), [expected]);
}

#[test]
fn every_diagnostic_points_into_the_text_and_says_something() {
    // Every line of a task, left out or spoilt: never a panic, never an empty word.
    for text in [VIA_POINT, BEAM, REACH] {
        for (number, line) in text.lines().enumerate() {
            for change in ["", "= 1", "x = ", "[[a", "axis = 3", &line.replace("= ", "= -"), &line.replace('"', "")] {
                let mut lines: Vec<&str> = text.lines().collect();
                lines[number] = change;
                let text = lines.join("\n");
                for found in Task::parse(&text).err().into_iter().flatten() {
                    assert!(text.get(found.span.clone()).is_some(), "{found:?}");
                    assert!(!found.message.is_empty() && !found.help.is_empty() && !found.message.ends_with('.'));
                    assert!(!found.message.contains('\n') && !found.message.contains("``"), "{found:?}");
                }
            }
        }
    }
}
