//! `hpf check POLICY`: what is certified, against closed forms and simulations of this file's own.

use std::fs;
use std::path::Path;

use crate::support::{expect, folder, read, task};

/// A policy of the via point task with these gains over time, on all axes, as policy.json.
fn write_policy(folder: &Path, stiffness: impl Fn(usize) -> f64, damping: f64) {
    let task = hpf_sim::Task::parse(&read(task("via_point.toml"))).unwrap();
    let mut policy = hpf_sim::Policy::initial(&task).unwrap();
    for axis in &mut policy.axes {
        axis.stiffness.weights.iter_mut().enumerate().for_each(|(i, weight)| *weight = stiffness(i));
        axis.damping.weights.fill(damping);
    }
    fs::write(folder.join("policy.json"), policy.to_json()).unwrap();
}

/// The certificates that `hpf check` gives.
fn certificates(folder: &Path, more: &[&str]) -> serde_json::Value {
    let (stdout, _) = expect(0, folder, &[&["check", "policy.json", "--json"], more].concat());
    serde_json::from_str::<serde_json::Value>(&stdout).unwrap()["certificates"].take()
}

#[test]
fn constant_gains_are_certified_passive_with_the_numbers_of_the_closed_form() {
    let folder = folder();
    write_policy(folder.path(), |_| 100.0, 50.0);
    let found = certificates(folder.path(), &["--load", "20"]);
    let number = |key: &str| found["axes"][1][key].as_f64().unwrap();
    assert_eq!((found["rate_hz"].as_f64(), found["delay_s"].as_f64()), (Some(1000.0), Some(0.001)));
    assert_eq!(found["axes"][1]["passive"], true);
    // Rounding of a mixture of equal weights is all that rises.
    assert!(number("switched_energy_j") < 1e-9, "{found:#}");
    assert!((number("largest_offset") - 0.2).abs() < 1e-8); // f/k after 20 time constants
    // One sample late: z^2 - exp(-k h/d) z + K (1 - exp(-k h/d))/k has a root on the circle.
    let limit = 100.0 / (1.0 - (-0.002_f64).exp());
    assert!((number("contact_stiffness_limit") / limit - 1.0).abs() < 1e-6, "{found:#}");
    assert_eq!(found["axes"][1]["contact_limited_by"], "carried");
    // No filter: d h/2 at any delay.
    assert!((number("safe_tool_mass") - 0.025).abs() < 1e-9, "{found:#}");
    // Without forcing x'' = alpha beta (g - x)/tau^2 at the start, and x' is largest at 2 tau/alpha: alpha/(2 e tau).
    assert!((number("peak_acceleration") - 25.0 * 6.25 / 25.0).abs() < 1e-9);
    assert!((number("peak_velocity") - 25.0 / (2.0 * 1.0_f64.exp() * 5.0)).abs() < 1e-6);
}

#[test]
fn a_policy_that_stiffens_quickly_is_said_to_be_not_passive_and_from_when() {
    let folder = folder();
    write_policy(folder.path(), |i| if i < 10 { 30.0 } else { 400.0 }, 10.0);
    let found = certificates(folder.path(), &["--rate", "1000", "--delay", "0.01"]);
    let axis = &found["axes"][0];
    // The weights change between the centers at 2.37 and 2.63 s.
    let time = axis["not_passive_from_s"].as_f64().unwrap();
    assert!(axis["passive"] == false && (2.0..3.0).contains(&time), "{found:#}");
    let offset = axis["largest_offset"].as_f64().unwrap();
    let energy = axis["switched_energy_j"].as_f64().unwrap();
    assert!(offset <= 10.0 / 30.0 && offset > 0.33, "{found:#}");
    assert!((energy / (0.5 * 370.0 * offset * offset) - 1.0).abs() < 1e-3, "{found:#}");
    // Ten samples late: near the limit of the continuous law, (pi/2) d/(delay + h/2), to which the spring of 30 N/m adds
    // 1 %.
    let limit = axis["contact_stiffness_limit"].as_f64().unwrap();
    assert!((limit / (core::f64::consts::FRAC_PI_2 * 10.0 / 0.0105) - 1.0).abs() < 2e-2, "{found:#}");
    let (text, _) = expect(0, folder.path(), &["check", "policy.json"]);
    assert!(text.contains("NOT from 2.") && text.contains("any force to 10.00 N"), "{text}");
}

/// The policy of [`write_policy`] with a mass on all axes.
fn write_inertial(folder: &Path, stiffness: impl Fn(usize) -> f64, damping: f64, mass: f64) {
    write_policy(folder, stiffness, damping);
    let mut policy = hpf_sim::Policy::parse(&read(folder.join("policy.json"))).unwrap();
    policy.admittance = hpf_sim::AdmittancePolicy { order: 2, mass: Some(vec![mass; policy.axes.len()]) };
    fs::write(folder.join("policy.json"), policy.to_json()).unwrap();
}

#[test]
fn a_law_of_second_order_is_certified_by_its_own_tests() {
    let folder = folder();
    write_inertial(folder.path(), |_| 100.0, 50.0, 2.0);
    let found = certificates(folder.path(), &["--load", "20"]);
    let axis = &found["axes"][0];
    assert_eq!((found["order"].as_u64(), axis["passive"].as_bool()), (Some(2), Some(true)));
    assert_eq!(axis["stable"], true);
    assert!((axis["stable_decay_per_s"].as_f64().unwrap() - 25.0).abs() < 1e-9, "a = d/m: {found:#}");
    // Roots 2.2 and 22.8 1/s: no overshoot, so the worst force is a steady one, and offsets stay within f/k.
    assert!((axis["largest_offset"].as_f64().unwrap() - 0.2).abs() < 1e-6, "{found:#}");
    // Lightly damped, a force that swings with the tool does more: about 4/pi over twice the damping ratio of it.
    write_inertial(folder.path(), |_| 400.0, 10.0, 4.0);
    let found = certificates(folder.path(), &["--load", "20"]);
    let ratio: f64 = 10.0 / (2.0 * (4.0 * 400.0_f64).sqrt());
    let over = (core::f64::consts::PI * ratio / (1.0 - ratio * ratio).sqrt()).exp();
    // Alternating at every zero of the impulse response: f/k (1 + r)/(1 - r), r the decay over half a swing.
    let expected = 0.05 * (1.0 + 1.0 / over) / (1.0 - 1.0 / over);
    let offset = found["axes"][0]["largest_offset"].as_f64().unwrap();
    assert!((offset / expected - 1.0).abs() < 1e-3, "{offset} {expected}");
    // A rise within a quarter of a second: neither proved stable nor passive, whatever the mass.
    write_inertial(folder.path(), |i| if i < 10 { 30.0 } else { 400.0 }, 10.0, 20.0);
    let axis = certificates(folder.path(), &[])["axes"][0].take();
    assert!(axis["stable"].is_null() && axis["passive"] == false, "{axis:#}");
    let heavy = axis["not_passive_from_s"].as_f64();
    write_inertial(folder.path(), |i| if i < 10 { 30.0 } else { 400.0 }, 10.0, 2.0);
    let axis = certificates(folder.path(), &[])["axes"][0].take();
    assert_eq!((axis["stable"].as_bool(), axis["not_passive_from_s"].as_f64()), (Some(true), heavy));
    let (text, _) = expect(0, folder.path(), &["check", "policy.json"]);
    assert!(text.contains("second-order law") && text.contains("NOT from 2."), "{text}");
}

#[test]
fn a_measured_contact_too_stiff_for_its_loop_is_warned_of() {
    let folder = folder();
    let text = read(task("cantilever.toml")) + "\n[sensor]\ndelay = 0.01\n";
    fs::write(folder.path().join("late.toml"), text).unwrap();
    let (stdout, _) = expect(0, folder.path(), &["check", "late.toml"]);
    // One sample late at the least gains, 30 N/m and 10 N s/m: k/(1 - exp(-k h/d)) with h = 0.01 s.
    assert!(stdout.contains("warning") && stdout.contains("as stiff as 1000000 N/m"), "{stdout}");
    assert!(stdout.contains(&format!("stable below {:.0} N/m", 30.0 / (1.0 - (-0.03_f64).exp()))), "{stdout}");
    let (stdout, _) = expect(0, folder.path(), &["check", &task("cantilever.toml"), "--json"]);
    let object: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(object["warnings"].as_array().unwrap().len(), 0);
}

#[test]
fn the_force_loop_is_certified_with_tool_and_contact_as_declared() {
    let folder = folder();
    write_policy(folder.path(), |_| 100.0, 100.0);
    let axis = |more: &[&str]| certificates(folder.path(), more)["axes"][0].take();
    let limit = |axis: &serde_json::Value| axis["contact_stiffness_limit"].as_f64().unwrap();
    let bare = axis(&[]);
    // 50 g behind the contact's spring: nearly a third.
    let heavy = axis(&["--contact-mass", "0.05"]);
    assert_eq!(heavy["contact_limited_by"], "behind");
    assert!((0.3..0.4).contains(&(limit(&heavy) / limit(&bare))), "{heavy:#}");
    // 0.5 kg behind the sensor: unstable before anything is touched, stable behind a filter or where it is light.
    let tool = axis(&["--tool-mass", "0.5"]);
    assert_eq!((limit(&tool), &tool["contact_limited_by"]), (0.0, &"free_air".into()));
    assert!(tool["tool_mass_limit"].as_f64().unwrap() < 0.5);
    let filtered = axis(&["--tool-mass", "0.5", "--cutoff", "10"]);
    assert!(limit(&filtered) > 1000.0 && filtered["safe_tool_mass"].as_f64().unwrap() > 0.5, "{filtered:#}");
    // A damper in the contact keeps the mass behind its spring from swinging. The damper on the ground costs: it pushes
    // back by a velocity that is a step late.
    let damped = ["0", "5", "10", "20"].map(|damping| axis(&["--contact-mass", "0.05", "--contact-damping", damping]));
    for (axis, damping) in damped.iter().zip([0.0, 5.0, 10.0, 20.0]) {
        let carried = carried_limit(100.0, damping, 0.05);
        match axis["contact_limited_by"].as_str() {
            Some("behind") => {
                assert!(limit(axis) < carried, "{axis:#}");
                assert!(!swings(0.97 * limit(axis), damping) && swings(1.03 * limit(axis), damping), "{axis:#}");
            }
            _ => assert!((limit(axis) / carried - 1.0).abs() < 3e-3 && !swings(carried, damping), "{axis:#} {carried}"),
        }
    }
    let [still, slightly, more, most] = damped.each_ref().map(limit);
    assert!(still == limit(&heavy) && still < slightly && slightly < more && most < still, "{damped:#?}");
    let late = axis(&["--lag", "0.005"]);
    assert!(limit(&late) < limit(&bare), "{late:#}");
    let (text, _) = expect(0, folder.path(), &["check", "policy.json", "--tool-mass", "0.5", "--lag", "0.005"]);
    assert!(text.contains("robot 5.000 ms behind its command, no filter, tool 0.5000 kg"), "{text}");
    let (text, _) = expect(0, folder.path(), &["check", "policy.json", "--tool-mass", "0.5"]);
    assert!(text.contains("none: a tool of 0.5000 kg oscillates in free air already"), "{text}");
    // Sensor and actuator of the task beside it are those of the certificate.
    let task = read(task("via_point.toml")) + "\n[sensor]\ndelay = 0.02\n[actuator]\nlag = 0.03\n";
    fs::write(folder.path().join("task.toml"), task).unwrap();
    let found = certificates(folder.path(), &[]);
    assert_eq!((found["delay_s"].as_f64(), found["lag_s"].as_f64()), (Some(0.02), Some(0.03)));
    let found = certificates(folder.path(), &["--delay", "0", "--lag", "0"]);
    assert_eq!((found["delay_s"].as_f64(), found["lag_s"].as_f64()), (Some(0.0), Some(0.0)));
}

/// The stiffness that a law `d u' = f`, read a step late, stands on the ground, with a damping C and a mass M that move with
/// the tool: `z^2 (z - 1) d/h + K z + C (z - 1)/h + M (z - 1)^2/(z h^2)` has a root at `exp(i a)`, whose imaginary part says
/// at which a.
fn carried_limit(damping: f64, contact_damping: f64, mass: f64) -> f64 {
    let h = 1e-3;
    let (c, m) = (contact_damping / h, mass / (h * h));
    // -z (z - 1) d/h - C (1 - 1/z)/h - M (1 - 1/z)^2/h^2, real and imaginary.
    let stiffness = |a: f64| {
        let (one, two) = (a.sin_cos(), (2.0 * a).sin_cos());
        let real = damping / h * (one.1 - two.1) - c * (1.0 - one.1) - m * (1.0 - 2.0 * one.1 + two.1);
        (real, damping / h * (one.0 - two.0) - c * one.0 - m * (2.0 * one.0 - two.0))
    };
    let angles = || (1..100_000).map(|i| f64::from(i) * core::f64::consts::PI / 1e5);
    let root = angles().find(|&a| stiffness(a).1 * stiffness(1e-5).1 < 0.0).unwrap();
    stiffness(root).0
}

/// Whether a law of 100 N/m and 100 N s/m, read a step late, swings ever more against 50 g behind a spring and a damper: in
/// time, in steps of a hundredth of the controller's.
fn swings(stiffness: f64, contact_damping: f64) -> bool {
    let (h, parts, ticks) = (1e-3, 100, 3000);
    let part = h / f64::from(parts);
    let decay = (-h * 100.0 / 100.0_f64).exp();
    let (mut tool, mut readings) = (0.0, [1.0, 1.0]);
    let (mut mass, mut velocity) = (0.0_f64, 0.0);
    let mut largest = [0.0_f64; 3];
    for tick in 0..ticks {
        let next = decay * tool + (1.0 - decay) / 100.0 * readings[1];
        let speed = (next - tool) / h;
        let force = |at: f64, mass: f64, velocity: f64| stiffness * (at - mass) + contact_damping * (speed - velocity);
        for i in 0..parts {
            let at = tool + speed * part * f64::from(i);
            velocity += part * force(at, mass, velocity) / 0.05;
            mass += part * velocity;
        }
        (readings, tool) = ([-force(next, mass, velocity), readings[0]], next);
        let third = &mut largest[3 * tick / ticks];
        // The force, not the place: where the free mass ends depends on the push.
        *third = third.max(readings[0].abs());
    }
    largest[2] >= largest[1]
}

#[test]
fn a_run_is_certified_at_the_rate_of_its_task() {
    let folder = folder();
    write_policy(folder.path(), |_| 100.0, 50.0);
    fs::copy(task("via_point.toml"), folder.path().join("task.toml")).unwrap();
    let (text, _) = expect(0, folder.path(), &["check", "."]);
    assert!(text.contains("a valid policy") && text.contains("at 100.0 Hz, measured force 10.00 ms late"), "{text}");
    assert_eq!(certificates(folder.path(), &["--rate", "500"])["rate_hz"], 500.0);
}

#[test]
fn conditions_that_cannot_be_are_refused() {
    let folder = folder();
    write_policy(folder.path(), |_| 100.0, 50.0);
    for (option, value) in [
        ("--rate", "0"),
        ("--rate", "nan"),
        ("--rate", "-1"),
        ("--delay", "-0.1"),
        ("--load", "inf"),
        ("--lag", "-1"),
        ("--cutoff", "0"),
        ("--tool-mass", "nan"),
        ("--contact-mass", "-1"),
        ("--contact-damping", "-1"),
        ("--rate", "900000"),
    ] {
        let argument = format!("{option}={value}");
        let (_, stderr) = expect(2, folder.path(), &["check", "policy.json", &argument]);
        assert!(stderr.contains("policy.json: ") && stderr.contains("must lie in"), "{argument}: {stderr}");
    }
    let (_, stderr) = expect(2, folder.path(), &["check", &task("reach.toml"), "--rate", "100"]);
    assert!(stderr.contains("--set rate=HZ"), "{stderr}");
}
