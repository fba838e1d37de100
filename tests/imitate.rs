//! `hpf imitate`, and learning from what it made.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support::{Columns, expect, folder, hpf, json, metric, read, task};

#[path = "../crates/hpf-sim/examples/demonstrations.rs"]
#[allow(dead_code, reason = "the example's main is not the test's")]
mod demonstrations;

fn demonstration(name: &str) -> String {
    task(&format!("demonstrations/{name}.csv"))
}

fn axis(summary: &Value, index: usize) -> &Value {
    &summary["imitation"]["axes"][index]
}

/// Imitates the shipped demonstration `name` into runs/`name`; returns the summary.
fn imitate(folder: &Path, name: &str, options: &[&str]) -> Value {
    let file = demonstration(name);
    expect(0, folder, &[&["imitate", &file], options].concat());
    json(folder.join("runs").join(name).join("summary.json"))
}

#[test]
fn the_shipped_demonstrations_are_those_of_their_example() {
    for (name, text) in demonstrations::files() {
        assert_eq!(
            read(task(&format!("demonstrations/{name}"))),
            text,
            "cargo run -p hpf-sim --example demonstrations"
        );
    }
}

#[test]
fn every_command_takes_what_imitate_leaves() {
    let folder = folder();
    let file = demonstration("wipe");
    let (stdout, stderr) = expect(0, folder.path(), &["imitate", &file]);
    assert!(stderr.is_empty(), "{stderr}");
    assert!(stdout.contains("wipe: a policy of 3 s from 1 demonstration, 150 steps at 50 Hz"), "{stdout}");
    assert!(stdout.contains("next: hpf learn runs/wipe/task.toml --from runs/wipe"), "{stdout}");
    let run = folder.path().join("runs/wipe");
    for name in ["task.toml", "policy.json", "trajectory.csv", "demonstrations.csv", "log.mcap", "summary.json"] {
        assert!(run.join(name).is_file(), "{name}");
    }
    assert!(run.join("plots/demonstration.png").is_file());
    expect(0, folder.path(), &["check", "runs/wipe/task.toml"]);
    expect(0, folder.path(), &["check", "runs/wipe"]);
    expect(0, folder.path(), &["run", "runs/wipe", "--rate", "1000"]);
    expect(0, folder.path(), &["export", "runs/wipe", "--format", "c"]);
    expect(0, folder.path(), &["plot", "runs/wipe", "--out", "figures"]);
    expect(0, folder.path(), &["plot", "runs/wipe", "--only", "demonstration", "--out", "only"]);
    for place in ["figures", "only"] {
        let drawn = fs::read(folder.path().join(place).join("demonstration.png")).unwrap();
        assert!(drawn == fs::read(run.join("plots/demonstration.png")).unwrap(), "{place} has another figure");
    }
    let (stdout, _) = expect(0, folder.path(), &["info", "runs/wipe"]);
    assert!(stdout.contains("imitation") && stdout.contains("demonstration_rmse"), "{stdout}");
    let (_, stderr) = expect(2, folder.path(), &["imitate", &file]);
    assert!(stderr.contains("--force"), "existing results stay: {stderr}");
}

#[test]
fn the_figure_of_the_demonstrations_is_offered_where_there_are_any_and_refuses_a_damaged_table() {
    let folder = folder();
    imitate(folder.path(), "wipe", &[]);
    let few = ["--quiet", "--set", "learning.updates=2", "--out", "learned"];
    expect(0, folder.path(), &[&["learn", "runs/wipe/task.toml", "--from", "runs/wipe"][..], &few].concat());
    let plot = |code, run: &str, only: &str| {
        expect(code, folder.path(), &["plot", run, "--out", "figures", "--force", "--only", only]).1
    };
    assert!(plot(2, "learned", "demonstration").ends_with("there are cost, stiffness, damping, path\n"));
    assert!(plot(2, "runs/wipe", "demo").contains("path, demonstration"));
    let file = folder.path().join("runs/wipe/demonstrations.csv");
    let whole = read(&file);
    for damaged in ["", &whole[..whole.len() / 2], &whole.replacen("x_demonstration_1_m", "z_demonstration_1_m", 1)] {
        fs::write(&file, damaged).unwrap();
        assert!(plot(2, "runs/wipe", "demonstration").contains("demonstrations.csv: "));
    }
}

#[test]
fn the_summary_and_the_tables_say_how_near_the_path_is() {
    let folder = folder();
    let summary = imitate(folder.path(), "wipe", &[]);
    assert_eq!(summary["method"], "imitation");
    let table = Columns::read(folder.path().join("runs/wipe/demonstrations.csv"));
    let mut whole = 0.0;
    for (i, name) in ["x", "y"].into_iter().enumerate() {
        let (made, seen) =
            (table.column(&format!("{name}_reference_m")), table.column(&format!("{name}_demonstration_1_m")));
        let squares: f64 = made.iter().zip(&seen).map(|(a, b)| (a - b).powi(2)).sum();
        let rmse = (squares / made.len() as f64).sqrt();
        assert!((rmse / axis(&summary, i)["rmse_m"].as_f64().unwrap() - 1.0).abs() < 1e-9);
        // 0.28 mm across the strokes, measured: three of them in 20 functions at 50 Hz.
        assert!(rmse < 0.4e-3, "{name}: {rmse}");
        whole += rmse * rmse;
    }
    assert!((metric(&summary, "demonstration_rmse") / whole.sqrt() - 1.0).abs() < 1e-9);
    let sources = summary["imitation"]["demonstrations"].as_array().unwrap();
    assert_eq!(sources.len(), 1);
    assert!(sources[0]["file"].as_str().unwrap().ends_with("wipe.csv"));
    // y ends where it starts: scaled by its range, 0.1 m.
    let policy = json(folder.path().join("runs/wipe/policy.json"));
    let scale = policy["axes"][1]["movement"]["forcing_scale"].as_f64().unwrap();
    assert!((scale - 0.1).abs() < 1e-3, "{scale}");
    assert_eq!(policy["provenance"]["task_sha256"], summary["task_sha256"]);
}

#[test]
fn three_reaches_make_a_stiffness_that_is_low_where_they_differ() {
    let folder = folder();
    let files = [1, 2, 3].map(|number| demonstration(&format!("reach_{number}")));
    let [a, b, c] = files.each_ref().map(String::as_str);
    let (stdout, _) = expect(0, folder.path(), &["imitate", a, b, c, "--name", "reach_softly", "--json"]);
    let summary: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(axis(&summary, 0)["stiffness_from"], "spread");
    assert_eq!(summary["directory"], "runs/reach_softly");
    let stiffness = Columns::read(folder.path().join("runs/reach_softly/trajectory.csv")).column("x_stiffness_n_m");
    let time = Columns::read(folder.path().join("runs/reach_softly/trajectory.csv")).column("time_s");
    let last = time.partition_point(|time| *time < 2.0 - 1e-9);
    assert!(stiffness[0] > 350.0 && stiffness[last] > 350.0, "they agree at both ends");
    assert!(stiffness[last / 2] < 60.0, "they differ between: {}", stiffness[last / 2]);
    assert_eq!(json(folder.path().join("runs/reach_softly/policy.json"))["duration_s"], 2.0, "the mean duration");
}

#[test]
fn stiffness_and_damping_come_from_what_was_recorded() {
    let folder = folder();
    let summary =
        imitate(folder.path(), "insert_emg", &["--stiffness-max", "600", "--damping-from", "ratio", "--mass", "2"]);
    assert_eq!(
        (&axis(&summary, 0)["stiffness_from"], &axis(&summary, 0)["damping_from"]),
        (&"emg".into(), &"ratio".into())
    );
    let columns = Columns::read(folder.path().join("runs/insert_emg/trajectory.csv"));
    let (stiffness, damping) = (columns.column("z_stiffness_n_m"), columns.column("z_damping_n_s_m"));
    assert!(stiffness[100] < 90.0 && stiffness[480] > 400.0, "{} {}", stiffness[100], stiffness[480]);
    // Until the end of the recording at 5 s.
    for (k, d) in stiffness.iter().zip(&damping).take(501) {
        assert!((d - 2.0 * (2.0 * k).sqrt()).abs() < 0.5, "critical for 2 kg: {k} {d}");
    }

    let summary = imitate(folder.path(), "push", &["--stiffness-from", "force", "--path", "reference"]);
    assert_eq!(axis(&summary, 0)["damping_from"], "force");
    let columns = Columns::read(folder.path().join("runs/push/trajectory.csv"));
    for (i, stiffness) in columns.column("x_stiffness_n_m").iter().enumerate().take(401) {
        let t: f64 = i as f64 / 400.0;
        let made = 80.0 + 220.0 * t * t * t * (10.0 - t * (15.0 - 6.0 * t));
        // Windows of 0.4 s over a rise of 220 N/m, and a tenth of a newton of noise; measured 12 N/m.
        assert!((stiffness - made).abs() < 20.0, "{stiffness} {made} at {t}");
    }
    assert!(columns.column("x_damping_n_s_m").iter().all(|damping| (damping - 30.0).abs() < 3.0));

    let summary = imitate(folder.path(), "turn", &[]);
    assert_eq!(axis(&summary, 0)["stiffness_from"], "columns");
    assert!(axis(&summary, 0)["rmse_rad"].as_f64().unwrap() < 1e-3);
    let columns = Columns::read(folder.path().join("runs/turn/trajectory.csv"));
    let stiffness = columns.column("elbow_stiffness_nm_rad");
    assert!((stiffness[0] - 40.0).abs() < 1.0 && (stiffness[100] - 100.0).abs() < 1.0);
}

#[test]
fn learning_goes_on_from_a_demonstration() {
    let folder = folder();
    imitate(folder.path(), "wipe", &[]);
    let few = ["--quiet", "--set", "learning.max_rollouts=60"];
    let from = ["learn", "runs/wipe/task.toml", "--from", "runs/wipe", "--out", "learned"];
    expect(0, folder.path(), &[&from[..], &few].concat());
    let imitated = json(folder.path().join("runs/wipe/summary.json"));
    let learned = json(folder.path().join("learned/summary.json"));
    assert_eq!(learned["cost"]["initial"], imitated["cost"]["final"], "the first motion is the imitated one");
    let total = |summary: &Value, when: &str| summary["cost"][when]["total"].as_f64().unwrap();
    assert!(total(&learned, "final") < total(&learned, "initial"));
    let weights = |file: &str| {
        let policy = json(folder.path().join(file));
        policy["axes"].as_array().unwrap().iter().map(|axis| axis["movement"]["weights"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(weights("learned/start_policy.json"), weights("runs/wipe/policy.json"));
    assert_ne!(weights("learned/policy.json"), weights("runs/wipe/policy.json"));
}

#[test]
fn a_policy_that_does_not_fit_the_task_is_refused_by_every_difference() {
    let folder = folder();
    imitate(folder.path(), "wipe", &["--basis", "15"]);
    let from = |changes: &[&str]| {
        let sets = changes.iter().flat_map(|change| ["--set", change]).collect::<Vec<_>>();
        let learn = ["learn", "runs/wipe/task.toml", "--from", "runs/wipe", "--out", "learned"];
        expect(2, folder.path(), &[&learn[..], &sets].concat()).1
    };
    let stderr = from(&["movement.basis=20", "stiffness.max=90", "stiffness.initial=80", "phase.decay=5"]);
    for words in [
        "policy.json: the policy does not fit the task: phase decay 4.605170185988092 for 5",
        "axis `x`: 15 basis functions of movement for 20",
        "axis `y`: stiffness 100 for bounds 30 to 90",
    ] {
        assert!(stderr.contains(words), "{words} is missing from {stderr}");
    }
    assert!(from(&["axis.1.name=z"]).contains("axes x, y for x, z"));
    assert!(from(&["movement.scaling=unit"]).contains("axis `x`: forcing scale"));
    assert!(from(&["stiffness.overlap=0.7"]).contains("other widths of the basis of stiffness"));
    assert!(from(&["learning.initial_path=minimum_jerk"]).contains("--from brings a path of its own"));
    assert!(!folder.path().join("learned").exists());
    // Another goal is what a movement primitive generalises to.
    let few = ["--quiet", "--set", "axis.0.goal=0.5", "--set", "learning.max_rollouts=60", "--set", "via_point=[]"];
    let learn = ["learn", "runs/wipe/task.toml", "--from", "runs/wipe/policy.json", "--out", "elsewhere"];
    expect(0, folder.path(), &[&learn[..], &few, &["--set", "cost.via_point=0"]].concat());
}

#[test]
fn a_run_is_imitated_into_its_task() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    let reach = task("reach.toml");
    // What was learned ends beyond the goal, for the force pushes back: carried to the goal itself, it misses its target.
    let imitate = ["imitate", "runs/reach", "--task", &reach, "--path", "reference", "--out", "again"];
    expect(3, folder.path(), &imitate);
    let [first, again] =
        ["runs/reach", "again"].map(|run| Columns::read(folder.path().join(run).join("trajectory.csv")));
    for column in ["x_stiffness_n_m", "x_damping_n_s_m"] {
        // Of the movement: after it a mixture goes beyond the samples that it was fitted to.
        let [first, again] = [&first, &again].map(|columns| columns.column(column)[..=100].to_vec());
        let difference = crate::support::largest_difference(&first, &again, 1);
        // Mixtures of the same functions, but for the penalty.
        assert!(difference < 1e-3, "{column}: {difference}");
    }
    let summary = json(folder.path().join("again/summary.json"));
    // Its reference leads a force and so ends in motion, which the fading of the forcing term holds back: measured 0.12 mm.
    assert!(axis(&summary, 0)["aligned_rmse_m"].as_f64().unwrap() < 2e-4, "{summary}");
    assert_eq!(json(folder.path().join("again/policy.json"))["axes"][0]["goal"], 0.3, "the task's own");
    let (_, stderr) = expect(2, folder.path(), &["imitate", "runs/reach", "--task", &reach, "--basis", "5"]);
    assert!(stderr.contains("--basis") && stderr.contains("--task"), "{stderr}");
}

#[test]
fn mistakes_are_told_by_file_line_and_column() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("bad.csv", "time_s,x_m\n0,0\n1,1\n1,2\n2,three\n3,3\n");
    let (stdout, stderr) = expect(2, folder.path(), &["imitate", "bad.csv"]);
    assert!(stdout.is_empty());
    assert!(stderr.contains("error: bad.csv:4: column `time_s`: the time 1 stands twice"), "{stderr}");
    assert!(stderr.contains("error: bad.csv:5: column `x_m`: `three` is no number"), "{stderr}");
    write("y.csv", "time_s,y_m\n0,0\n1,1\n2,2\n3,3\n4,4\n");
    let (_, stderr) = expect(2, folder.path(), &["imitate", &demonstration("reach_1"), "y.csv"]);
    assert!(stderr.contains("y.csv: it moves the axes y [m]") && stderr.contains("moves x [m]"), "{stderr}");
    let (_, stderr) = expect(2, folder.path(), &["imitate", &demonstration("wipe"), "--stiffness-from", "emg"]);
    assert!(stderr.contains("wipe.csv: axis `x` has no column x_emg"), "{stderr}");
    let (_, stderr) = expect(2, folder.path(), &["imitate", &demonstration("wipe"), "--stiffness-min", "500"]);
    assert!(stderr.contains("stiffness.min must not be above stiffness.max"), "{stderr}");
    let (_, stderr) = expect(2, folder.path(), &["imitate", &demonstration("wipe"), "--mass", "0"]);
    assert!(stderr.contains("it must be above 0"), "{stderr}");
    let (_, stderr) = expect(2, folder.path(), &["imitate", "missing.csv"]);
    assert!(stderr.contains("missing.csv: there is no such file"), "{stderr}");
    expect(2, folder.path(), &["imitate"]);
    assert!(!folder.path().join("runs").exists(), "nothing is written for bad demonstrations");
}

#[test]
fn the_same_demonstrations_give_the_same_bytes() {
    let folder = folder();
    let file = demonstration("insert_emg");
    for (out, threads) in [("one", "1"), ("two", "2")] {
        expect(0, folder.path(), &["imitate", &file, "--out", out, "--threads", threads]);
    }
    for name in
        ["policy.json", "task.toml", "trajectory.csv", "demonstrations.csv", "log.mcap", "plots/demonstration.png"]
    {
        let bytes = |run: &str| fs::read(folder.path().join(run).join(name)).unwrap();
        assert_eq!(bytes("one"), bytes("two"), "{name}");
    }
}

/// A recording of `rows` samples over `duration` s whose numbers are written by `write`.
fn recording(rows: usize, duration: f64, write: fn(f64) -> String) -> String {
    let u = |i: usize| i as f64 / (rows - 1) as f64;
    let jerk = |u: f64| 0.3 * u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u);
    let rows = (0..rows).map(|i| format!("{:.6},{}\n", duration * u(i), write(jerk(u(i)))));
    "time_s,x_m\n".to_owned() + &rows.collect::<String>()
}

#[test]
fn a_recording_that_was_cut_within_its_last_number_is_refused_and_one_without_a_line_break_is_told() {
    let folder = folder();
    let whole = recording(101, 1.0, |x| format!("{x:.6}"));
    let write = |text: &str| fs::write(folder.path().join("cut.csv"), text).unwrap();
    let arguments = ["imitate", "cut.csv", "--quiet", "--force", "--out", "o"];
    for end in [1, 3, 7] {
        write(&whole[..whole.len() - 1 - end]);
        let (_, stderr) = expect(2, folder.path(), &arguments);
        assert!(
            stderr.contains("cut.csv:102: column `x_m`: the last number") && stderr.contains("may be cut"),
            "{stderr}"
        );
    }
    write(whole.trim_end());
    let (stdout, _) = expect(0, folder.path(), &arguments);
    assert!(stdout.contains("note: cut.csv: no line break follows the last number, 0.300000"), "{stdout}");
    write(&whole);
    let (stdout, _) = expect(0, folder.path(), &arguments);
    assert!(!stdout.contains("line break"), "{stdout}");
    // Force tables too.
    let table = "\n[[disturbance]]\nkind = \"table\"\naxis = \"x\"\nfile = \"f.csv\"\n";
    fs::write(folder.path().join("t.toml"), read(task("reach.toml")) + table).unwrap();
    let check = |code: i32, text: &str| {
        fs::write(folder.path().join("f.csv"), text).unwrap();
        expect(code, folder.path(), &["check", "t.toml"]).1
    };
    let stderr = check(2, "time_s,force_n\n0.0,0.0\n0.5,1.0\n1.0,2");
    assert!(stderr.contains("f.csv:4:5: the last number, 2, is shorter"), "{stderr}");
    let stderr = check(0, "time_s,force_n\n0.0,0.0\n0.5,1.0\n1.0,2.0");
    assert!(stderr.contains("note: ") && stderr.contains("2.0, which is taken as it stands"), "{stderr}");
    // Every command that reads it says so, once.
    for command in ["learn", "sweep"] {
        let output = hpf(folder.path(), &[command, "t.toml", "--quiet", "--set", "learning.updates=2"]);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(stderr.matches("which is taken as it stands").count(), 1, "{command}: {stderr}");
    }
    assert_eq!(check(0, "time_s,force_n\n0.0,0.0\n0.5,1.0\n1.0,20\n"), "");
}

#[test]
fn a_low_cut_off_keeps_the_ends_and_never_leaves_the_range() {
    let folder = folder();
    fs::write(folder.path().join("base.csv"), recording(101, 1.0, |x| format!("{x:.6}"))).unwrap();
    for cut_off in ["0.0001", "0.05", "0.3", "1", "3.9"] {
        let arguments = ["imitate", "base.csv", "--smooth", cut_off, "--quiet", "--force", "--out", "o"];
        expect(0, folder.path(), &arguments);
        let path = Columns::read(folder.path().join("o/trajectory.csv")).column("x_reference_m");
        assert!((path[0], path[path.len() - 1]) == (0.0, path[path.len() - 1]));
        assert!((path[path.len() - 1] - 0.3).abs() < 0.01, "{cut_off}: ends at {}", path[path.len() - 1]);
        assert!(path.iter().all(|x| (-0.05..0.35).contains(x)), "{cut_off}: {path:?}");
    }
}

#[test]
fn a_rate_that_is_asked_for_is_kept_and_the_duration_told() {
    let folder = folder();
    fs::write(folder.path().join("real.csv"), recording(124, 1.234_567, |x| format!("{x:.6}"))).unwrap();
    let (stdout, _) = expect(0, folder.path(), &["imitate", "real.csv", "--rate", "1000", "--quiet", "--out", "o"]);
    assert!(stdout.contains("1235 steps at 1000 Hz"), "{stdout}");
    assert!(stdout.contains("note: the duration is 1.235 s instead of 1.234567 s"), "{stdout}");
    expect(0, folder.path(), &["run", "o", "--rate", "1000"]);
    expect(0, folder.path(), &["imitate", "real.csv", "--quiet", "--out", "own"]);
    let (_, stderr) = expect(2, folder.path(), &["run", "own", "--rate", "1000"]);
    assert!(stderr.contains("the nearest rates are"), "{stderr}");
}
