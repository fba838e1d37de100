//! `hpf learn`

use core::time::Duration;
use std::fs;
use std::process::Stdio;
use std::time::Instant;

use crate::support::{Columns, command, expect, folder, json, read, task};

#[test]
fn the_main_command_leaves_everything_it_names() {
    let folder = folder();
    let (stdout, stderr) = expect(0, folder.path(), &["learn", &task("cantilever.toml")]);
    for words in [
        "cost",
        "before",
        "after",
        "tracking",
        "max_deviation",
        "the paper: 0.1500 mm",
        "max_force_error",
        "stiffness",
        "damping",
        "next: hpf run runs/cantilever",
    ] {
        assert!(stdout.contains(words), "{words} is missing from\n{stdout}");
    }
    assert!(stderr.contains("update 600/600"), "progress is missing from {stderr}");

    let run = folder.path().join("runs/cantilever");
    let written =
        ["task.toml", "policy.json", "summary.json", "learning.csv", "trajectory.csv", "beam.csv", "log.mcap"];
    let snapshots = [0, 100, 200, 600].map(|update| format!("snapshots/{update}.csv"));
    let plots = ["cost", "stiffness", "damping", "beam", "path", "deviation", "contact_force"]
        .map(|name| format!("plots/{name}.png"));
    for file in written.into_iter().map(str::to_owned).chain(snapshots).chain(plots) {
        assert!(stdout.contains(&file), "{file} is not named in\n{stdout}");
        assert!(fs::metadata(run.join(&file)).expect(&file).len() > 100, "{file} is empty");
    }
    assert!(!folder.path().join("runs/cantilever.partial").exists());
    let leftovers = fs::read_dir(&run)
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().ends_with(".partial"));
    assert_eq!(leftovers.count(), 0);
}

#[test]
fn tables_and_summary_have_the_columns_and_keys_that_other_programs_read() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("cantilever.toml"), "--quiet", "--out", "c"]);
    let trajectory = Columns::read(folder.path().join("c/trajectory.csv"));
    assert_eq!(
        trajectory.header(),
        "time_s,phase,y_reference_m,y_reference_velocity_m_s,y_position_m,y_velocity_m_s,y_force_n,y_stiffness_n_m,\
         y_damping_n_s_m,deflection_m,deviation_m,contact_force_n"
    );
    // The movement, and 3.16 s of rest.
    assert_eq!(trajectory.column("time_s").len(), 501 + 316);
    let learning = Columns::read(folder.path().join("c/learning.csv"));
    assert_eq!(
        learning.header(),
        "update,rollouts,total,goal,end_velocity,via_point,tracking,contact_force,acceleration,stiffness,damping,rest,\
         exploration"
    );
    assert_eq!(learning.column("update").len(), 601);

    let summary = json(folder.path().join("c/summary.json"));
    let keys: Vec<&String> = summary.as_object().unwrap().keys().collect();
    assert_eq!(
        keys,
        [
            "format",
            "version",
            "task",
            "task_sha256",
            "policy_sha256",
            "method",
            "seed",
            "threads",
            "updates",
            "best_update",
            "rollouts_total",
            "learning_s",
            "total_s",
            "cost",
            "metrics",
            "rejected_rollouts",
            "stopped_because"
        ]
    );
    assert_eq!(summary["format"], "hpf-summary");
    assert_eq!(summary["rollouts_total"], 600 * 19 + 1);
    let terms: f64 = summary["cost"]["final"]
        .as_object()
        .unwrap()
        .iter()
        .filter(|(name, _)| *name != "total")
        .map(|(_, v)| v.as_f64().unwrap())
        .sum();
    let total = summary["cost"]["final"]["total"].as_f64().unwrap();
    assert!((terms / total - 1.0).abs() < 1e-12, "the terms add up to the total");
    let best = learning.column("total").into_iter().fold(f64::INFINITY, f64::min);
    assert_eq!(total, best, "the best policy is kept");
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let folder = folder();
    for name in ["via_point", "cantilever", "cantilever_moving_load", "reach"] {
        let file = task(&format!("{name}.toml"));
        // Sixty updates pass through every line that six hundred do; missed targets are not the point here.
        let few = "learning.updates=60";
        for threads in ["1", "2", "7"] {
            let out = format!("{name}-{threads}");
            let arguments = [
                "learn",
                &file,
                "--quiet",
                "--threads",
                threads,
                "--out",
                &out,
                "--set",
                few,
                "--set",
                "accept={}",
                "--set",
                "output={}",
            ];
            expect(0, folder.path(), &arguments);
        }
        for file in ["policy.json", "learning.csv", "trajectory.csv", "log.mcap", "task.toml"] {
            let bytes = |threads: &str| fs::read(folder.path().join(format!("{name}-{threads}")).join(file)).unwrap();
            assert!(bytes("1") == bytes("2") && bytes("1") == bytes("7"), "{name}: {file} differs");
        }
    }
}

#[test]
fn another_seed_gives_another_policy_and_is_recorded() {
    let folder = folder();
    for seed in ["1", "2"] {
        expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--seed", seed, "--out", seed]);
    }
    assert_ne!(read(folder.path().join("1/learning.csv")), read(folder.path().join("2/learning.csv")));
    assert_eq!(json(folder.path().join("2/policy.json"))["provenance"]["seed"], 2);
    assert!(read(folder.path().join("2/task.toml")).contains("seed = 2"));
}

#[test]
fn what_to_do_next_can_be_pasted_whatever_the_folder_is_called() {
    let folder = folder();
    let (stdout, _) = expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "my first run"]);
    assert!(stdout.contains("next: hpf run 'my first run' --rate 1000"), "{stdout}");
    let (stdout, _) = expect(0, folder.path(), &["init", "reach", "--out", "my task.toml"]);
    assert!(stdout.contains("next: hpf learn 'my task.toml'"), "{stdout}");
}

#[test]
fn options_work_before_and_after_the_command() {
    let folder = folder();
    expect(0, folder.path(), &["--quiet", "--out", "a", "learn", &task("reach.toml")]);
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "b"]);
    assert_eq!(read(folder.path().join("a/policy.json")), read(folder.path().join("b/policy.json")));
}

#[test]
fn json_is_one_object_on_stdout() {
    let folder = folder();
    let (stdout, stderr) = expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--json"]);
    let object: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&object["format"], &object["version"]), (&"hpf-summary".into(), &1.into()));
    assert_eq!(object["directory"], "runs/reach");
    assert_eq!(stderr, "");
}

#[test]
fn a_missed_target_exits_with_3_and_keeps_the_results() {
    let folder = folder();
    let (stdout, _) =
        expect(3, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--set", "accept.max_goal_error=1e-9"]);
    assert!(stdout.contains("MISSED"));
    assert!(folder.path().join("runs/reach/policy.json").exists());
}

#[test]
fn the_paper_preset_and_the_minimum_jerk_start_learn_too() {
    let folder = folder();
    let reach = task("reach.toml");
    // Noise at every step averages out: it needs a larger scale, and a lambda that suits this small cost.
    let noise = "learning.noise={ movement = 40.0, stiffness = 80.0, damping = 20.0 }";
    let settings =
        ["learning.method=pi2", "learning.preset=paper", "learning.temperature={ lambda = 0.01 }", noise, "accept={}"];
    let arguments =
        ["learn", &reach, "--quiet", "--out", "p"].into_iter().chain(settings.iter().flat_map(|set| ["--set", set]));
    expect(0, folder.path(), &arguments.collect::<Vec<_>>());
    let paper = json(folder.path().join("p/summary.json"));
    let cost = |summary: &serde_json::Value, when: &str| summary["cost"][when]["total"].as_f64().unwrap();
    assert!(cost(&paper, "final") < 0.5 * cost(&paper, "initial"));
    expect(
        0,
        folder.path(),
        &[
            "learn",
            &reach,
            "--quiet",
            "--out",
            "m",
            "--set",
            "learning.initial_path=minimum_jerk",
            "--set",
            "accept={}",
        ],
    );
    let fitted = json(folder.path().join("m/summary.json"));
    assert_ne!(cost(&fitted, "initial"), cost(&paper, "initial"));
}

#[test]
fn the_next_step_is_one_that_the_duration_allows() {
    let folder = folder();
    for (duration, rate, next) in [
        ("1.0", "100", "hpf run r --rate 1000\n"),
        ("1.2345", "2000", "hpf run r\n"),
        ("0.0015", "2000", "hpf run r\n"),
    ] {
        let keys = [format!("duration={duration}"), format!("rate={rate}")];
        let task = task("reach.toml");
        let args =
            ["learn", &task, "--out", "r", "--force", "--set", "accept={}", "--set", &keys[0], "--set", &keys[1]];
        let (stdout, _) = expect(0, folder.path(), &args);
        assert!(stdout.ends_with(&format!("next: {next}")), "{stdout}");
        expect(0, folder.path(), &next.split_whitespace().skip(1).collect::<Vec<_>>());
    }
}

#[test]
fn a_start_that_no_controller_takes_is_refused_before_it_is_learned() {
    let folder = folder();
    // The spring falls behind its own pull: the weights of a smooth path grow with alpha squared.
    for command in ["check", "learn"] {
        let task = task("cantilever.toml");
        let settings = ["--set", "learning.initial_path=minimum_jerk", "--set", "movement.alpha=50000"];
        let (_, stderr) = expect(2, folder.path(), &[&[command, task.as_str()][..], &settings].concat());
        assert!(stderr.contains("and a movement has at most 1.000e9; lower alpha"), "{command}: {stderr}");
    }
    assert!(!folder.path().join("runs/cantilever").exists());
}

#[test]
fn ctrl_c_ends_after_the_update_with_the_best_policy_saved() {
    let folder = folder();
    let arguments = [
        "learn",
        &task("cantilever.toml"),
        "--out",
        "c",
        "--set",
        "learning.updates=1000000",
        "--set",
        "learning.max_rollouts=100000000",
        "--set",
        "accept={}",
    ];
    let mut child = command(folder.path(), &arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let started = Instant::now();
    let log = folder.path().join("c.partial/log.mcap.partial");
    // The log has its first updates: learning is under way.
    while fs::metadata(&log).map_or(0, |file| file.len()) < 10_000 {
        assert!(started.elapsed() < Duration::from_secs(60), "learning does not begin");
        std::thread::sleep(Duration::from_millis(20));
    }
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let summary = json(folder.path().join("c/summary.json"));
    assert_eq!(summary["stopped_because"], "it was interrupted");
    assert!(summary["updates"].as_u64().unwrap() > 0);
    assert!(folder.path().join("c/log.mcap").exists());
    expect(0, folder.path(), &["run", "c"]);
}

#[test]
fn auto_meets_every_shipped_target_within_two_hundred_motions() {
    let folder = folder();
    for name in ["via_point", "cantilever", "cantilever_moving_load", "reach"] {
        let settings = ["learning.method=auto", "learning.max_rollouts=200"];
        for threads in ["1", "7"] {
            let (file, out) = (task(&format!("{name}.toml")), format!("{name}-{threads}"));
            let arguments = ["learn", &file, "--quiet", "--threads", threads, "--out", &out];
            let settings = settings.iter().flat_map(|setting| ["--set", setting]);
            expect(0, folder.path(), &arguments.into_iter().chain(settings).collect::<Vec<_>>());
        }
        for file in ["policy.json", "learning.csv", "trajectory.csv", "log.mcap"] {
            let bytes = |threads: &str| fs::read(folder.path().join(format!("{name}-{threads}")).join(file)).unwrap();
            assert!(bytes("1") == bytes("7"), "{name}: {file} differs");
        }
        let summary = json(folder.path().join(format!("{name}-1/summary.json")));
        assert_eq!(summary["method"], "auto");
        assert!(summary["rollouts_total"].as_u64().unwrap() <= 200);
    }
}
