//! What must hold between the keys of a task file, each rule with a file that breaks it.

use super::*;

#[test]
fn duration_and_rate_make_a_whole_number_of_steps() {
    let whole =
        "duration times rate is the number of steps and must be a whole number: the nearest rates are 100 and 100.2";
    let rate = "rate = 100.0";
    one(VIA_POINT, (rate, "rate = 100.1"), "100.1", "5 s at 100.1 Hz make 500.5 steps", whole);
    let few = "duration times rate is the number of steps, at least 2";
    one(VIA_POINT, (rate, "rate = 0.2"), "0.2", "5 s at 0.2 Hz make only 1 step", few);
    let many = "duration times rate is the number of steps, at most 1000000";
    one(VIA_POINT, (rate, "rate = 1e9"), "1e9", "5 s at 1000000000 Hz make 5000000000 steps", many);
}

#[test]
fn names_are_checked_and_one_mistake_in_them_is_told_once() {
    let file = "1 to 100 letters, digits, `_`, `-` or `.`, the first not a dot: it names the run directory";
    for name in ["via/point", "..", "", "a b"] {
        let to = format!("name = \"{name}\"");
        let place = format!("\"{name}\"");
        one(VIA_POINT, ("name = \"via_point\"", &to), &place, &format!("`{name}` cannot name a task"), file);
    }
    // The second disturbance now names no axis, which is the same mistake.
    let own = "give each axis a name of its own";
    one(VIA_POINT, ("name = \"y\"", "name = \"x\""), "\"x\"", "two axes are called `x`", own);
    let message = "columns of `x_reference` would be called like some of axis `x`";
    let rename = "tables have columns of the reference of every axis: rename one of the two";
    one(VIA_POINT, ("name = \"y\"", "name = \"x_reference\""), "\"x_reference\"", message, rename);
    let axis = "a letter, then up to 31 letters, digits or `_`";
    one(VIA_POINT, ("name = \"y\"", "name = \"1y\""), "\"1y\"", "`1y` cannot name an axis", axis);
}

#[test]
fn bounds_hold_between_each_other() {
    let help = "stiffness.min must not be above stiffness.max";
    let message = "`min` is above `max` on axis `x`: 500 > 400";
    one(VIA_POINT, ("min = 30.0", "min = 500"), "500", message, help);
    let message = "`min` is above `max` on axis `y`: 500 > 400";
    one(VIA_POINT, ("min = 30.0", "min = [30, 500]"), "500", message, help);
    let help = "`initial` must lie between min = 30 and max = 400";
    let message = "`initial` is outside its bounds on axis `x`: 10";
    one(VIA_POINT, ("initial = 100.0", "initial = 10.0"), "10.0", message, help);
}

#[test]
fn goal_scaling_needs_a_goal_away_from_the_start() {
    let message = "goal scaling needs a goal away from the start, axis `x` goes from 0 to 0";
    let help = "move them at least 1e-6 apart, or set scaling = \"unit\" under [movement]";
    one(VIA_POINT, ("goal = 1.0", "goal = 0.0"), "0.0", message, help);
    let text = VIA_POINT.replacen("goal = 1.0", "goal = 0.0", 1);
    for scaling in ["\"unit\"", "{ amplitude = 0.5 }"] {
        assert!(Task::parse(&text.replace("scaling = \"goal\"", &format!("scaling = {scaling}"))).is_ok());
    }
    let no_scale = "a forcing scale of 0 leaves nothing to learn";
    let help = "`amplitude` must be a number other than 0";
    one(VIA_POINT, ("scaling = \"goal\"", "scaling = { amplitude = [1, 0] }"), "0", no_scale, help);
}

#[test]
fn arrays_have_one_number_per_axis() {
    let help = "write one number for all axes, or an array with one per axis";
    for (from, to, place, message) in [
        ("alpha = 25.0", "alpha = [25]", "[25]", "1 value for 2 axes"),
        ("goal = 1e4", "goal = [1, 2, 3]", "[1, 2, 3]", "3 values for 2 axes"),
        ("initial = 100.0", "initial = []", "[]", "0 values for 2 axes"),
        ("movement = 10.0", "movement = [1.0]", "[1.0]", "1 value for 2 axes"),
        ("scaling = \"goal\"", "scaling = { amplitude = [1, 2, 3] }", "[1, 2, 3]", "3 values for 2 axes"),
    ] {
        one(VIA_POINT, (from, to), place, message, help);
    }
    let message = "a position with 1 number for 2 axes";
    let help = "write one number per axis, in axis order";
    one(VIA_POINT, ("position = [0.6, 0.8]", "position = [0.6]"), "[0.6]", message, help);
}

#[test]
fn forces_and_contacts_name_an_axis_that_is_there() {
    one(VIA_POINT, ("axis = \"x\"", "axis = \"z\""), "\"z\"", "there is no axis `z`", "the axes are: x, y");
    one(BEAM, ("axis = \"y\"", "axis = \"x\""), "\"x\"", "there is no axis `x`", "the axes are: y");
}

#[test]
fn a_via_point_has_a_time_or_a_radius_and_a_weight_that_measures_it() {
    let radius = "position = [3.0, 3.0]\nradius = 0.1";
    let both = "time = 0.4\nposition = [3.0, 3.0]\nradius = 0.1";
    let found = mistakes(&DMPBBO.replace(radius, both));
    let told: Vec<&str> = found.iter().map(|diagnostic| diagnostic.message.as_str()).collect();
    assert_eq!(told, ["a `radius` beside a `time`", "`cost.via_distance` has nothing to measure"]);
    assert_eq!(found[1].help, "add a [[via_point]] without a `time`, or leave it out");
    let timed = mistakes(&DMPBBO.replace("via_distance = 1.0", "via_point = 1.0"));
    assert_eq!(timed[0].message, "`cost.via_point` has nothing to measure");
    assert_eq!(timed[0].help, "add a [[via_point]] with a `time`, or leave it out");
    assert!(mistakes(&DMPBBO.replace("radius = 0.1", "radius = -0.1"))[0].message.contains("out of range"));
}

#[test]
fn a_via_point_lies_within_the_movement() {
    let message = "the via point at 5.5 s lies outside the movement";
    let help = "`time` must lie after 0 s and no later than duration = 5 s";
    one(VIA_POINT, ("time = 2.5", "time = 5.5"), "5.5", message, help);
    assert!(Task::parse(&VIA_POINT.replace("time = 2.5", "time = 5.0")).is_ok());
}

#[test]
fn costs_and_targets_need_something_to_measure() {
    for (from, to, place, key, what) in [
        ("acceleration = 1e-3", "tracking = 1.0", "1.0", "cost.tracking", "[contact]"),
        ("acceleration = 1e-3", "contact_force = 1.0", "1.0", "cost.contact_force", "[contact]"),
        ("acceleration = 1e-3", "via_point = 1.0", "1.0", "cost.via_point", "[[via_point]] with a `time`"),
        ("acceleration = 1e-3", "via_distance = 1.0", "1.0", "cost.via_distance", "[[via_point]] without a `time`"),
        ("max_goal_error = 5e-3", "max_deviation = 5e-3", "5e-3", "accept.max_deviation", "[contact]"),
        ("max_goal_error = 5e-3", "max_force_error = 5e-3", "5e-3", "accept.max_force_error", "[contact]"),
        ("max_goal_error = 5e-3", "max_contact_loss = 0.0", "0.0", "accept.max_contact_loss", "[contact]"),
        ("max_goal_error = 5e-3", "max_via_error = 5e-3", "5e-3", "accept.max_via_error", "[[via_point]]"),
    ] {
        let message = format!("`{key}` has nothing to measure");
        one(REACH, (from, to), place, &message, &format!("add a {what}, or leave it out"));
    }
    let (_, cost) = REACH.split_once("[cost]").unwrap();
    let weights = cost[cost.find("goal").unwrap()..].split_once("\n\n").unwrap().0;
    let message = "no cost term has a weight: there is nothing to learn";
    let help = "give at least one term of [cost] a weight above 0";
    one_elsewhere(REACH, (weights, ""), "[cost]", message, help);
    one_elsewhere(REACH, (weights, "goal = -1.0\n"), "-1.0", "`goal` is out of range: -1", "`goal` must be at least 0");
}

#[test]
fn learning_has_room_for_an_update_and_keeps_each_once() {
    let message = "`max_rollouts` leaves no room for a single update";
    let help = "at least 20: one motion before learning, 18 of the first update, one after it";
    one(VIA_POINT, ("max_rollouts = 12000", "max_rollouts = 19"), "19", message, help);
    let twice = ("snapshots = [0, 100", "snapshots = [0, 100, 1_00");
    one(VIA_POINT, twice, "1_00", "update 100 is kept twice", "name each update once");
}

#[test]
fn a_setting_of_pi2_needs_the_method_named() {
    let text = REACH.replace("updates = 100", "updates = 100\npreset = \"paper\"");
    let [found] = &mistakes(&text)[..] else { panic!("one mistake") };
    assert_eq!(&text[found.span.clone()], "\"paper\"");
    assert!(found.message.contains("`preset` is a setting of pi2") && found.help.contains("method = \"pi2\""));
    Task::parse(&text.replace("preset =", "method = \"pi2\"\npreset =")).unwrap();
}
