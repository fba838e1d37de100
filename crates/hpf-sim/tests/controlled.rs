//! The real controller in the simulator's environment: the same motion as the simulation of the same loop, to rounding;
//! and what limits, faults, the tank and requests make of it.

use hpf_core::controller::Mode;
use hpf_sim::robot::{Limits, Settings};
use hpf_sim::task::PerAxis;
use hpf_sim::{Policy, Simulation, Task, Trace};

const REACH: &str = include_str!("../../../tasks/reach.toml");
const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");
const STOCHASTIC: &str = include_str!("../../../tasks/via_point_stochastic.toml");
const WALL: &str = include_str!("../../../tasks/wall.toml");
const JOINT: &str = include_str!("../../../tasks/joint.toml");
const BEAM: &str = include_str!("../../../tasks/cantilever.toml");

/// A task with `more` at its end, at `rate`, and a policy for it that bends: weights that differ from each other.
fn task(text: &str, rate: f64, more: &str) -> (Task, Policy) {
    let text: Vec<String> = text
        .lines()
        .map(|line| if line.starts_with("rate = ") { format!("rate = {rate:?}") } else { line.to_owned() })
        .collect();
    let text = text.join("\n") + "\n" + more;
    let task = Task::parse(&text).unwrap_or_else(|found| panic!("{found:?}"));
    let policy = Policy::initial(&task).unwrap();
    let weights: Vec<f64> = policy.weights();
    let bent = weights.iter().enumerate().map(|(i, weight)| match *weight {
        0.0 => 20.0 * (0.7 * i as f64).sin(),
        gain => gain * (1.0 + 0.3 * (0.9 * i as f64).cos()),
    });
    let bent: Vec<f64> = bent.collect();
    (task, policy.with_weights(&bent).unwrap())
}

fn simulated(task: &Task, policy: &Policy) -> Trace {
    let simulation = Simulation::new(task, policy).unwrap();
    simulation.rollout(&simulation.parameters(policy))
}

fn gap(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn controller_and_simulation_of_the_same_loop_agree() {
    let second = "[admittance]\norder = 2\nmass = 2.0\n";
    let soft = BEAM.replace("contact_stiffness = 1e6", "contact_stiffness = 5e3");
    let away = soft.replace("travel = ", "from = 0.2\ntravel = ").replace("start = 0.0 ", "start = 0.00275 ");
    let sensors = [
        "[sensor]\n",
        "[sensor]\ndelay = 0.0025\nbias = 0.5\nnoise = 0.3\nquantisation = 0.1\ndropout = 0.1\n",
        "[sensor]\n[actuator]\nlag = 0.01\n",
    ];
    for (name, text) in
        [("reach", REACH), ("via point", VIA_POINT), ("stochastic", STOCHASTIC), ("wall", WALL), ("joint", JOINT)]
            .into_iter()
            .chain([("beam", soft.as_str()), ("beam away", &away)])
    {
        let inertia = if text.contains("[admittance]") { "" } else { second };
        for sensor in sensors {
            if text.contains("[sensor]") && sensor != sensors[0] {
                continue;
            }
            let sensor = if text.contains("[sensor]") { "" } else { sensor };
            for law in ["", inertia] {
                let (task, policy) = task(text, 1000.0, &format!("{sensor}{law}"));
                let plain = simulated(&task, &policy);
                let simulation = Simulation::new(&task, &policy).unwrap();
                let (trace, conduct) = simulation.controlled(&policy, &Settings::default()).unwrap();
                let tally = conduct.tally();
                assert_eq!((tally.hits, tally.faults, tally.trips, tally.refused), ([0; 5], 0, 0, 0), "{name}");
                for (found, expected) in trace.axes.iter().zip(&plain.axes) {
                    for (signal, found, expected) in [
                        ("position", &found.position, &expected.position),
                        ("reference", &found.reference_position, &expected.reference_position),
                        ("force", &found.force, &expected.force),
                    ] {
                        let most = expected.iter().fold(1.0_f64, |most, value| most.max(value.abs()));
                        let gap = gap(found, expected) / most;
                        assert!(gap < 1e-9, "{name} {signal}, {sensor}{law}: {gap:e}");
                    }
                }
                if let (Some(found), Some(expected)) = (&trace.contact, &plain.contact) {
                    let most = expected.force.iter().fold(1.0_f64, |most, value| most.max(*value));
                    assert!(gap(&found.force, &expected.force) / most < 1e-9, "{name} {sensor}{law}");
                }
            }
        }
    }
}

#[test]
fn against_the_continuous_simulation_the_difference_falls_with_the_step() {
    // A held force is half a step late, first order; one that lasts is never late, and the rest is of second order.
    for (text, fall) in [(VIA_POINT, 2.0), (WALL, 2.0), (REACH, 4.0)] {
        let gaps = [1000.0, 2000.0, 4000.0].map(|rate| {
            let (task, policy) = task(text, rate, "");
            let simulation = Simulation::new(&task, &policy).unwrap();
            let (trace, _) = simulation.controlled(&policy, &Settings::default()).unwrap();
            let plain = simulated(&task, &policy);
            let each = trace.axes.iter().zip(&plain.axes).map(|(a, b)| gap(&a.position, &b.position));
            each.fold(0.0, f64::max)
        });
        for pair in gaps.windows(2) {
            assert!((pair[0] / pair[1] - fall).abs() < 0.1 * fall, "{gaps:?}");
        }
        assert!(gaps[0] < 1e-3, "{gaps:?}");
    }
}

fn controlled(settings: &str) -> (Trace, hpf_sim::robot::Conduct) {
    let (task, policy) = task(REACH, 1000.0, "");
    let settings = Settings::parse(settings, &task.axis).unwrap_or_else(|found| panic!("{found:?}"));
    Simulation::new(&task, &policy).unwrap().controlled(&policy, &settings).unwrap()
}

fn modes(conduct: &hpf_sim::robot::Conduct) -> Vec<(usize, Mode)> {
    conduct.changes()
}

#[test]
fn requests_come_when_they_are_asked_for() {
    let ask = |kind: &str, time: f64, more: &str| format!("[[request]]\nkind = \"{kind}\"\ntime = {time}\n{more}");
    let (trace, conduct) = controlled(
        &[ask("start", 0.1, ""), ask("hold", 0.4, ""), ask("resume", 0.7, ""), ask("goal", 0.8, "position = 0.2\n")]
            .concat(),
    );
    let expected = [(0, Mode::Idle), (100, Mode::Run), (400, Mode::Hold), (700, Mode::Run)];
    assert_eq!(modes(&conduct), expected);
    assert!(conduct.rate[..100].iter().all(|rate| *rate == 0.0) && conduct.rate[100] == 1.0);
    assert_eq!(trace.axes[0].reference_position[100], trace.axes[0].reference_position[0]);
    assert_eq!(conduct.counters.refused, 0);
    let (_, conduct) = controlled(&[ask("stop", 0.3, ""), ask("resume", 0.5, "")].concat());
    assert_eq!(modes(&conduct), [(0, Mode::Run), (300, Mode::Stop)]);
    assert_eq!((conduct.tally().refused, conduct.tally().stopped), (1, 1));
    let (_, conduct) = controlled(&ask("rate", 0.0, "rate = 0.5\n"));
    assert!(conduct.rate.iter().skip(1).all(|rate| *rate >= 0.5), "at first the start is asked for");
}

#[test]
fn limits_trips_and_the_tank_are_kept_and_told() {
    let (trace, conduct) = controlled("[limits]\nvelocity = 0.1\nacceleration = 2.0\n");
    let tally = conduct.tally();
    assert!(tally.hits[3] > 0, "{tally:?}");
    let fastest = trace.axes[0].velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    assert!(fastest <= 0.1 + 1e-9, "{fastest}");
    let (_, conduct) = controlled("[trips]\nforce = 1.0\n");
    assert_eq!(modes(&conduct).last().unwrap().1, Mode::Stop);
    assert!(conduct.tally().trips > 0);
    let (_, conduct) = controlled("[tank]\ncapacity = 1e-3\nrefill = 0.5\n");
    let tally = conduct.tally();
    assert!(tally.short > 0 && tally.least_energy < 1e-3, "{tally:?}");
}

#[test]
fn settings_say_where_they_are_wrong_and_what_is_near() {
    let (task, policy) = task(REACH, 1000.0, "");
    let wrong = |text: &str, axes: usize| {
        let found = Settings::parse(text, &vec![task.axis[0].clone(); axes]).unwrap_err();
        let one = &found[0];
        (text[one.span.clone()].to_owned(), one.message.clone(), one.help.clone())
    };
    let (place, message, help) = wrong("[limits]\nvelocty = 1.0\n", 1);
    assert_eq!(place, "velocty");
    assert!(message.contains("did you mean `velocity`") || help.contains("velocity"), "{message} {help}");
    let (place, message, _) = wrong("[limits]\nforce = [1.0, 2.0]\n", 3);
    assert_eq!((place.as_str(), message.as_str()), ("[1.0, 2.0]", "2 entries for 3 axes"));
    let (_, message, _) = wrong("[tank]\ncapacity = -1\n", 1);
    assert!(message.contains("`capacity` is out of range"), "{message}");
    let (_, message, help) = wrong("[[request]]\nkind = \"pause\"\ntime = 1\n", 1);
    assert!(message.contains("pause") && help.contains("hold"), "{message} {help}");
    let (_, message, _) = wrong("speed = 3\n", 1);
    assert!(message.contains("speed"), "{message}");
    for (text, place, message) in [
        ("position_max = 0.1", "0.1", "axis `x` ends at 0.3 m, outside its workspace"),
        ("position_min = 0.01", "0.01", "axis `x` starts at 0 m, outside its workspace"),
        ("position_min = 0.2\nposition_max = [0.2]", "[0.2]", "the workspace of axis `x` has no width: 0.2 to 0.2 m"),
        ("position_max = 1e300", "1e300", "`position_max` is out of range: 1e300"),
    ] {
        let found = wrong(&format!("[limits]\n{text}\n"), 1);
        assert_eq!((&*found.0, &*found.1), (place, message));
    }
    let (place, message, _) = wrong("press = -6.0\n[limits]\nforce = 5.0\n", 1);
    assert_eq!((&*place, &*message), ("-6.0", "`press` of axis `x` is -6, above its largest force, 5"));
    // What the controller alone can refuse comes with its reason.
    let limits = Limits { position_max: Some(PerAxis::All(0.1)), ..Limits::default() };
    let settings = Settings { limits, ..Settings::default() };
    let refused = Simulation::new(&task, &policy).unwrap().controlled(&policy, &settings).unwrap_err().to_string();
    assert!(refused.starts_with("the controller refuses: goal must lie in"), "{refused}");
}

#[test]
fn every_mistake_of_settings_is_found_at_once_also_beside_a_list_of_the_wrong_length() {
    let (task, _) = task(REACH, 1000.0, "");
    let text = "press = [1.0, 2.0]\n[limits]\nforce = 0.5\nvelocity = [-1.0]\n[readings]\ntool_mass = 1e10\n\
                dead_zone = -1.0\ngravity = [1e10]\n[tank]\ncapacity = 1e-10\nreserve = 1e10\npower = 1e300\n\
                [port]\nforce_bias = -2\n[timing]\noldest_force = 4294967296\n";
    let found = Settings::parse(text, &task.axis).unwrap_err();
    let all: Vec<(&str, &str)> = found.iter().map(|one| (&text[one.span.clone()], &*one.message)).collect();
    let expected = [
        ("[1.0, 2.0]", "2 entries for 1 axis"),
        ("[1.0, 2.0]", "`press` of axis `x` is 1, above its largest force, 0.5"),
        ("-1.0", "`velocity` is out of range: -1"),
        ("1e10", "`tool_mass` is out of range: 1e10"),
        ("-1.0", "`dead_zone` is out of range: -1"),
        ("1e10", "`gravity` is out of range: 10000000000"),
        ("1e-10", "`capacity` is out of range: 1e-10"),
        ("1e10", "`reserve` is out of range: 1e10"),
        ("1e300", "`power` is out of range: 1e300"),
        ("-2", "`force_bias` is out of range: -2"),
        ("4294967296", "`oldest_force` is out of range: 4294967296"),
    ];
    assert_eq!(all, expected);
    let helps = found.iter().map(|one| one.help.as_str()).collect::<Vec<_>>();
    assert_eq!(helps[10], "`oldest_force` must be a whole number from 0 to 4294967295");
    assert_eq!(helps[8], "`power` must be a number from 1e-9 to 1e9");
}

#[test]
fn settings_that_are_read_are_settings_that_a_controller_takes() {
    let (task, policy) = task(REACH, 1000.0, "");
    let simulation = Simulation::new(&task, &policy).unwrap();
    let keys = [
        ("limits", "force"),
        ("limits", "offset"),
        ("limits", "velocity"),
        ("limits", "acceleration"),
        ("limits", "position_min"),
        ("limits", "position_max"),
        ("trips", "force"),
        ("trips", "tracking"),
        ("readings", "tool_mass"),
        ("readings", "gravity"),
        ("readings", "cutoff"),
        ("readings", "dead_zone"),
        ("tank", "capacity"),
        ("tank", "reserve"),
        ("tank", "refill"),
        ("tank", "power"),
        ("port", "force_delay"),
        ("port", "force_bias"),
        ("timing", "ramp"),
        ("timing", "hold"),
        ("timing", "oldest_force"),
    ];
    let sizes =
        ["0", "1", "6", "7", "1e-10", "1e-9", "0.5", "10.0", "1e9", "1.1e9", "1e300", "4294967295", "4294967296"];
    let (mut taken, mut refused) = (0, 0);
    for (table, key) in keys {
        for number in sizes.iter().flat_map(|size| [(*size).to_owned(), format!("-{size}")]) {
            let capacity = if key == "capacity" { "" } else { "capacity = 1e9\n" };
            let tank = if matches!(table, "tank" | "port") { format!("[tank]\n{capacity}") } else { String::new() };
            let head = if table == "tank" { String::new() } else { format!("[{table}]\n") };
            match Settings::parse(&format!("{tank}{head}{key} = {number}\n"), &task.axis) {
                Ok(settings) => {
                    taken += 1;
                    if let Err(error) = simulation.controlled(&policy, &settings) {
                        panic!("{table}.{key} = {number} is read, and refused later: {error}");
                    }
                }
                Err(_) => refused += 1,
            }
        }
    }
    assert!(taken > 100 && refused > 100, "{taken} {refused}");
}

#[test]
fn one_press_for_all_axes_is_for_those_with_something_to_press_on() {
    let text = "name = \"two\"\nduration = 1.0\nrate = 1000.0\n[[axis]]\nname = \"x\"\nstart = 0.0\ngoal = 0.1\n\
                [[axis]]\nname = \"y\"\nstart = 0.0\ngoal = 0.2\n[movement]\nbasis = 10\n\
                [stiffness]\nbasis = 10\ninitial = 100.0\nmin = 30.0\nmax = 400.0\n\
                [damping]\nbasis = 10\ninitial = 50.0\nmin = 10.0\nmax = 100.0\n\
                [contact]\nkind = \"wall\"\naxis = \"x\"\nposition = 0.1\nstiffness = 1000.0\nforce = 5.0\n\
                [cost]\ngoal = 1.0\n";
    let task = Task::parse(text).unwrap();
    let policy = Policy::initial(&task).unwrap();
    let simulation = Simulation::new(&task, &policy).unwrap();
    let motion = |settings: &str| {
        let settings = Settings::parse(settings, &task.axis).unwrap();
        simulation
            .controlled(&policy, &settings)
            .unwrap()
            .0
            .axes
            .into_iter()
            .map(|axis| axis.position)
            .collect::<Vec<_>>()
    };
    let named = motion("compliance = [\"press\", \"compliant\"]\npress = [5.0, 0.0]\n");
    assert_eq!(motion("press = 5.0\n"), named);
    assert_eq!(motion("press = [5.0, 0.0]\n"), named);
    assert_ne!(motion("compliance = \"press\"\npress = 5.0\n"), named);
}
