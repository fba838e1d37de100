//! `hpf run`

use crate::support::{Columns, expect, folder, json, largest_difference, metric, read, task};

#[test]
fn a_policy_learned_at_100_hz_moves_the_same_at_1000_hz() {
    let folder = folder();
    // Bounds from the second order of the step; measured differences are smaller by an order of magnitude.
    for (name, axes, bound) in [
        ("cantilever", &["y"][..], 0.005e-3),
        ("cantilever_moving_load", &["y"], 0.005e-3),
        ("via_point", &["x", "y"], 0.05e-3),
    ] {
        expect(0, folder.path(), &["learn", &task(&format!("{name}.toml")), "--quiet", "--out", name]);
        let fast = format!("{name}-fast");
        expect(0, folder.path(), &["run", name, "--rate", "1000", "--out", &fast]);
        let (slow, fast) = (folder.path().join(name), folder.path().join(fast));
        let [slow, fast] = [slow, fast].map(|run| Columns::read(run.join("trajectory.csv")));
        for axis in axes {
            let column = format!("{axis}_position_m");
            let difference = largest_difference(&slow.column(&column), &fast.column(&column), 10);
            assert!(difference < bound, "{name} {axis}: {difference}");
        }
    }
}

#[test]
fn a_run_reports_the_measures_of_the_learning_again() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    let (stdout, _) = expect(0, folder.path(), &["run", "runs/reach", "--json"]);
    let again: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let summary = json(folder.path().join("runs/reach/summary.json"));
    assert_eq!(again["metrics"], summary["metrics"]);
    assert_eq!(again["cost"]["final"], summary["cost"]["final"]);
    assert_eq!(again["policy_sha256"], summary["policy_sha256"]);
}

#[test]
fn the_environment_can_be_changed_and_the_policy_cannot() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    let calm = ["run", "runs/reach", "--json", "--set", "disturbance.0.amplitude=0"];
    let (stdout, _) = expect(3, folder.path(), &calm);
    let calm: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(metric(&calm, "peak_offset"), 0.0, "no force, no give");
    for change in ["axis.0.goal=0.5", "stiffness.max=500", "learning.updates=3", "duration=2"] {
        let (_, stderr) = expect(2, folder.path(), &["run", "runs/reach", "--set", change]);
        assert!(stderr.contains("the policy decides"), "{stderr}");
    }
}

#[test]
fn a_policy_file_runs_in_a_task_that_is_named() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    std::fs::copy(folder.path().join("runs/reach/policy.json"), folder.path().join("alone.json")).unwrap();
    let (_, stderr) = expect(2, folder.path(), &["run", "alone.json"]);
    assert!(stderr.contains("--task"), "{stderr}");
    expect(0, folder.path(), &["run", "alone.json", "--task", &task("reach.toml")]);
    let (_, stderr) = expect(2, folder.path(), &["run", "alone.json", "--task", &task("via_point.toml")]);
    assert!(stderr.contains("axes"), "{stderr}");
}

#[test]
fn damaged_policies_are_refused_by_the_place_of_the_damage() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--set", "learning.method=pi2"]);
    let path = folder.path().join("runs/reach/policy.json");
    let whole = read(&path);
    let damages: [(&str, &str, &str); 4] = [
        ("\"version\": 1", "\"version\": 2", "version"),
        ("\"beta\": 6.25", "\"beta\": 7.0", "axes[0].movement.beta"),
        ("\"max\": 400.0", "\"max\": 31.0", "axes[0].stiffness.weights"),
        ("\"unit\": \"m\",", "\"unit\": \"m\", \"colour\": 1,", "colour"),
    ];
    for (from, to, named) in damages {
        assert!(whole.contains(from), "{from}");
        std::fs::write(&path, whole.replacen(from, to, 1)).unwrap();
        let (_, stderr) = expect(2, folder.path(), &["run", "runs/reach"]);
        assert!(stderr.contains(named) && stderr.contains("policy.json"), "{stderr}");
    }
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    expect(2, folder.path(), &["run", "runs/reach"]);
}

#[test]
fn a_force_table_travels_with_the_run() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    std::fs::write(folder.path().join("data/push.csv"), "time_s,force_n\n0,0\n0.5,3\n1,0\n").unwrap();
    let text = read(task("reach.toml")).replace("kind = \"step\"", "kind = \"table\"\nfile = \"data/push.csv\"");
    let text = text.lines().filter(|line| !line.starts_with("amplitude") && !line.starts_with("start = 0.5"));
    let text = text.collect::<Vec<_>>().join("\n");
    std::fs::write(folder.path().join("pushed.toml"), text).unwrap();
    expect(0, folder.path(), &["learn", "pushed.toml", "--quiet", "--out", "run", "--set", "accept={}"]);
    std::fs::remove_dir_all(folder.path().join("data")).unwrap();
    let force = Columns::read(folder.path().join("run/trajectory.csv")).column("x_force_n");
    assert!((force[25] - 1.5).abs() < 1e-12 && (force[50] - 3.0).abs() < 1e-12);
    expect(0, folder.path(), &["run", "run"]);
}

/// The report of `hpf run RUN --controller` with more arguments, which must end with `code`.
fn controlled(folder: &std::path::Path, run: &str, more: &[&str], code: i32) -> serde_json::Value {
    let (stdout, _) = expect(code, folder, &[&["run", run, "--controller", "--json"][..], more].concat());
    serde_json::from_str(&stdout).unwrap()
}

#[test]
fn the_controller_does_what_was_simulated_and_says_what_it_did() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    let sampled = ["--rate", "1000", "--set", "sensor={}"];
    let (stdout, _) =
        expect(0, folder.path(), &[&["run", "runs/reach", "--json", "--out", "plain"][..], &sampled].concat());
    let plain: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let run = controlled(folder.path(), "runs/reach", &[&["--out", "robot"][..], &sampled].concat(), 0);
    assert_eq!((run["method"].as_str(), run["controller"]["ended"].as_u64()), (Some("controller"), Some(1)));
    assert_eq!(run["controller"]["modes"][0]["mode"], "run");
    assert!(run["controller"]["limited_steps"].as_object().unwrap().values().all(|steps| steps == 0));
    for name in ["max_goal_error", "peak_offset"] {
        assert!((metric(&run, name) - metric(&plain, name)).abs() < 1e-9, "{name}");
    }
    let [robot, plain] = ["robot", "plain"].map(|run| Columns::read(folder.path().join(run).join("trajectory.csv")));
    assert!(largest_difference(&robot.column("x_position_m"), &plain.column("x_position_m"), 1) < 1e-9);
    let table = read(folder.path().join("robot/controller.csv"));
    assert!(
        table.starts_with("time_s,mode,rate,energy_j,port_energy_j,events,x_limits,x_command_m,x_model_force_n\n"),
        "{table}"
    );
    // The last row that says so is that of the end of the movement: the step that ends at 1 s.
    let ended = table.lines().find(|line| line.contains("ended")).unwrap();
    assert!(ended.starts_with("1.0,run,1.0,"), "{ended}");
}

#[test]
fn settings_of_the_controller_are_kept_and_their_mistakes_shown() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    let settings = "[limits]\nvelocity = 0.2\n[[request]]\nkind = \"hold\"\ntime = 0.3\n";
    std::fs::write(folder.path().join("settings.toml"), settings).unwrap();
    let more = ["--settings", "settings.toml", "--rate", "1000", "--out", "robot"];
    let run = controlled(folder.path(), "runs/reach", &more, 3);
    assert_eq!(run["controller"]["modes"][1], serde_json::json!({ "time_s": 0.3, "mode": "hold" }));
    assert_eq!((run["controller"]["ended"].as_u64(), run["controller"]["faults"].as_u64()), (Some(0), Some(0)));
    assert_eq!(read(folder.path().join("robot/settings.toml")), settings);
    let speed = Columns::read(folder.path().join("robot/trajectory.csv")).column("x_velocity_m_s");
    assert!(speed.iter().all(|speed| speed.abs() <= 0.2 + 1e-9));
    std::fs::write(folder.path().join("settings.toml"), settings.replace("velocity", "velocty")).unwrap();
    let (_, stderr) = expect(2, folder.path(), &["run", "runs/reach", "--controller", "--settings", "settings.toml"]);
    assert!(stderr.contains("settings.toml:2") && stderr.contains("did you mean `velocity`"), "{stderr}");
    let (_, stderr) = expect(2, folder.path(), &["run", "runs/reach", "--settings", "settings.toml"]);
    assert!(stderr.contains("--controller"), "{stderr}");
    let refused = [
        ("[tank]\ncapacity = 0.1\nreserve = 0.2\n", "settings.toml:3:11", "must lie between 0 and 0.1"),
        ("[timing]\nramp = 20\n", "settings.toml:2:8", "from 0 to 10"),
        ("[limits]\nvelocity = 0\n", "settings.toml:2:12", "`velocity` is out of range: 0"),
        ("[port]\nforce_bias = 1\n", "settings.toml", "add [tank]"),
        ("[limits]\nposition_max = 0.1\n", "settings.toml:2:16", "the workspace of `x` is up to 0.1 m"),
    ];
    for (settings, place, words) in refused {
        std::fs::write(folder.path().join("settings.toml"), settings).unwrap();
        let (_, stderr) =
            expect(2, folder.path(), &["run", "runs/reach", "--controller", "--settings", "settings.toml"]);
        assert!(stderr.contains(place) && stderr.contains(words), "{settings}: {stderr}");
    }
}

#[test]
fn a_run_off_the_clock_or_the_goal_of_its_task_says_so() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    let of = |request: &str| {
        std::fs::write(folder.path().join("settings.toml"), request).unwrap();
        let args = ["run", "runs/reach", "--controller", "--settings", "settings.toml", "--rate", "1000"];
        String::from_utf8(crate::support::hpf(folder.path(), &args).stdout).unwrap()
    };
    for (request, reasons) in [
        ("[[request]]\nkind = \"start\"\ntime = 0.2\n", "the movement ends at 1.200 s, not 1.000 s"),
        ("[[request]]\nkind = \"hold\"\ntime = 0.2\n", "the movement does not end"),
        ("[[request]]\nkind = \"goal\"\ntime = 0.2\nposition = 0.2\n", "a request sets another goal"),
    ] {
        let stdout = of(request);
        let line = format!("  measures       by the clock and the goal of the task: {reasons}\n");
        assert!(stdout.contains(&line), "{stdout}");
    }
    assert!(!of("").contains("by the clock"));
}

#[test]
fn a_request_that_is_refused_is_named_with_its_time_and_its_reason() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    let settings = "[limits]\nposition_max = 0.5\n\
        [[request]]\nkind = \"start\"\ntime = 0.2\n[[request]]\nkind = \"tare\"\ntime = 0.1\n\
        [[request]]\nkind = \"tare\"\ntime = 0.3\n[[request]]\nkind = \"goal\"\ntime = 0.4\nposition = 0.6\n\
        [[request]]\nkind = \"reset\"\ntime = 0.5\n";
    std::fs::write(folder.path().join("settings.toml"), settings).unwrap();
    let args = ["run", "runs/reach", "--controller", "--settings", "settings.toml", "--rate", "1000", "--json"];
    let args: [&[&str]; 2] = [&args[..args.len() - 1], &args];
    let [text, json] = args.map(|args| String::from_utf8(crate::support::hpf(folder.path(), args).stdout).unwrap());
    let expected = [
        ("tare", 0.1, "the force has not stood still"),
        ("tare", 0.3, "not in run"),
        ("goal", 0.4, "it lies outside the workspace"),
        ("reset", 0.5, "not in run"),
    ];
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let refused = json["controller"]["refused"].as_array().unwrap();
    assert_eq!((refused.len(), json["controller"]["requests_refused"].as_u64()), (4, Some(4)), "{json}");
    for ((request, time, reason), refused) in expected.iter().zip(refused) {
        assert_eq!((refused["request"].as_str(), refused["reason"].as_str()), (Some(*request), Some(*reason)));
        assert!((refused["time_s"].as_f64().unwrap() - time).abs() < 1e-9, "{refused}");
        assert!(text.contains(&format!("  refused        {request} at {time:.4} s: {reason}\n")), "{text}");
    }
}

#[test]
fn a_press_on_nothing_is_refused() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    for settings in ["press = 5.0\n", "press = [5.0]\ncompliance = \"rigid\"\n"] {
        std::fs::write(folder.path().join("settings.toml"), settings).unwrap();
        let args = ["run", "runs/reach", "--controller", "--settings", "settings.toml", "--rate", "1000"];
        let (_, stderr) = expect(2, folder.path(), &args);
        assert!(stderr.contains("`press` presses on nothing"), "{stderr}");
    }
}

#[test]
fn a_limit_that_slows_the_path_is_named() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    for (settings, is_slow) in [("[limits]\nvelocity = 0.1\n", true), ("", false)] {
        std::fs::write(folder.path().join("settings.toml"), settings).unwrap();
        let args = ["run", "runs/reach", "--controller", "--settings", "settings.toml", "--rate", "1000"];
        let stdout = String::from_utf8(crate::support::hpf(folder.path(), &args).stdout).unwrap();
        assert_eq!(stdout.contains("  path           slower than asked for in"), is_slow, "{stdout}");
    }
}

#[test]
fn a_force_away_from_the_contact_is_warned_of() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("wall.toml"), "--quiet", "--set", "accept={}"]);
    for (press, is_away) in [("5.0", false), ("-5.0", true)] {
        std::fs::write(folder.path().join("settings.toml"), format!("press = {press}\n")).unwrap();
        let args = ["run", "runs/wall", "--controller", "--settings", "settings.toml", "--rate", "1000"];
        let output = crate::support::hpf(folder.path(), &args);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(stderr.contains("`press` points away from the contact"), is_away, "{press}: {stderr}");
    }
}

#[test]
fn the_promises_of_limits_and_tank_can_be_checked_from_the_tables() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    let settings = "[limits]\nforce = 1.5\n[tank]\ncapacity = 0.02\nreserve = 0.005\nrefill = 0.9\n\
        [[request]]\nkind = \"stop\"\ntime = 99.0\n";
    std::fs::write(folder.path().join("settings.toml"), settings).unwrap();
    let args = ["run", "runs/reach", "--controller", "--settings", "settings.toml", "--rate", "1000", "--out", "robot"];
    let output = crate::support::hpf(folder.path(), &args);
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(stdout.contains("requests       1 never made"), "{stdout}");
    // Some of its columns are words.
    let table = read(folder.path().join("robot/controller.csv"));
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| -> Vec<f64> {
        let place = rows[0].iter().position(|column| *column == name).unwrap();
        rows[1..].iter().map(|row| row[place].parse().unwrap()).collect()
    };
    let [command, force, energy] = ["x_command_m", "x_model_force_n", "energy_j"].map(column);
    assert!(force.iter().all(|force| force.abs() <= 1.5) && force.contains(&-1.5), "{force:?}");
    let mut sum = 0.0;
    // It starts at rest at 0.
    for i in 0..command.len() {
        sum += force[i] * (command[i] - if i == 0 { 0.0 } else { command[i - 1] });
        assert!(sum >= -(0.02 - energy[i]) - 1e-12 && sum >= -0.015 - 1e-12, "row {i}: {sum} J");
    }
}

#[test]
fn a_robot_can_do_the_cantilever_that_starts_away_from_the_clamp() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("cantilever_robot.toml"), "--quiet"]);
    let run = controlled(folder.path(), "runs/cantilever_robot", &[], 0);
    assert_eq!(run["controller"]["ended"], 1);
    assert!(run["metrics"].as_array().unwrap().iter().all(|metric| metric["pass"] != false), "{run}");
    // At the clamp it cannot: the least rate is that of d/h = K_e/2.
    let (stdout, _) = expect(0, folder.path(), &["check", &task("cantilever.toml")]);
    assert!(stdout.contains("holds it from 50000 Hz on"), "{stdout}");
    let (stdout, _) = expect(0, folder.path(), &["check", &task("cantilever_robot.toml")]);
    let rate: f64 =
        stdout.split("holds it from ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap().parse().unwrap();
    assert!(rate < 1000.0, "{rate} Hz");
}
