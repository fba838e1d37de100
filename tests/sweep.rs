//! `hpf sweep`

use core::time::Duration;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Instant;

use serde_json::Value;

use crate::support::{command, expect, folder, json, read, task};

/// A small sweep of four runs into `s`, with more arguments.
fn sweep(code: i32, folder: &Path, more: &[&str]) -> (String, String) {
    let reach = task("reach.toml");
    let small = ["sweep", &reach, "--seeds", "2", "--set", "learning.updates=20", "--set", "accept={}", "--out", "s"];
    expect(code, folder, &[&small[..], &["--vary", "learning.noise.movement=5,20"], more].concat())
}

fn header_and_rows(path: impl AsRef<Path>) -> (Vec<String>, Vec<Vec<String>>) {
    let text = read(path);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().iter().map(str::to_owned).collect();
    (header, reader.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect())
}

#[test]
fn a_sweep_leaves_a_table_a_summary_figures_and_every_run() {
    let folder = folder();
    let (stdout, stderr) = sweep(0, folder.path(), &[]);
    for words in
        ["4 of 4 runs finished", "learning.noise.movement=5", "results.csv", "plots/cost.png", "plots/metrics.png"]
    {
        assert!(stdout.contains(words), "{words} is missing from\n{stdout}");
    }
    assert!(stderr.contains("4/4 runs"), "{stderr}");
    let s = folder.path().join("s");
    let (header, rows) = header_and_rows(s.join("results.csv"));
    for column in [
        "learning.noise.movement",
        "seed",
        "status",
        "pass",
        "total",
        "goal",
        "max_goal_error_m",
        "motions",
        "learning_s",
    ] {
        assert!(header.iter().any(|name| name == column), "{column} is missing from {header:?}");
    }
    let settings: Vec<_> = rows.iter().map(|row| (row[1].as_str(), row[2].as_str(), row[3].as_str())).collect();
    assert_eq!(settings, [("5", "1", "done"), ("5", "2", "done"), ("20", "1", "done"), ("20", "2", "done")]);

    let summary = json(s.join("summary.json"));
    assert_eq!((&summary["format"], &summary["version"]), (&"hpf-sweep".into(), &1.into()));
    assert_eq!((&summary["planned"], &summary["finished"]), (&4.into(), &4.into()));
    let totals: Vec<f64> = rows[..2].iter().map(|row| row[5].parse().unwrap()).collect();
    let median = summary["settings"][0]["cost"]["total"]["median"].as_f64().unwrap();
    assert_eq!(median, 0.5 * (totals[0] + totals[1]));
    for plot in ["cost", "metrics"] {
        assert!(fs::read(s.join(format!("plots/{plot}.png"))).unwrap().starts_with(b"\x89PNG"));
    }
    let mut files: Vec<_> = fs::read_dir(s.join("runs/learning.noise.movement=5/seed-1"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    assert_eq!(files, ["learning.csv", "policy.json", "summary.json", "task.toml", "trajectory.csv"]);
}

#[test]
fn a_run_of_a_sweep_is_the_run_that_learn_makes_for_any_number_of_threads() {
    let folder = folder();
    sweep(0, folder.path(), &["--threads", "3", "--full", "--quiet"]);
    let learn = ["learn", &task("reach.toml"), "--quiet", "--seed", "2", "--out", "l", "--set", "learning.updates=20"];
    let settings = ["--set", "accept={}", "--set", "learning.noise.movement=20", "--threads", "1"];
    expect(0, folder.path(), &[&learn[..], &settings].concat());
    let run = folder.path().join("s/runs/learning.noise.movement=20/seed-2");
    for file in ["task.toml", "policy.json", "learning.csv", "trajectory.csv", "log.mcap", "plots/cost.png"] {
        let bytes = |run: &Path| fs::read(run.join(file)).unwrap();
        assert!(bytes(&run) == bytes(&folder.path().join("l")), "{file} differs");
    }
}

#[test]
fn finished_runs_are_kept_and_the_missing_ones_made() {
    let folder = folder();
    sweep(0, folder.path(), &["--quiet"]);
    let run = |seed: u32| folder.path().join(format!("s/runs/learning.noise.movement=5/seed-{seed}"));
    let table = |folder: &Path| {
        let (_, rows) = header_and_rows(folder.join("s/results.csv"));
        // Without the times, which are those of the clock.
        rows.into_iter().map(|row| row[..12].to_vec()).collect::<Vec<_>>()
    };
    let (first, kept) = (table(folder.path()), read(run(1).join("summary.json")));
    fs::remove_dir_all(run(2)).unwrap();
    let (stdout, _) = sweep(0, folder.path(), &["--quiet"]);
    assert!(stdout.contains("3 were there before"), "{stdout}");
    assert_eq!(read(run(1).join("summary.json")), kept, "a finished run is not made again");
    assert_eq!(table(folder.path()), first);

    // The task changed: what stands there is of another one.
    let (_, stderr) = sweep(2, folder.path(), &["--set", "learning.updates=21"]);
    assert!(stderr.contains("another task") && stderr.contains("--force"), "{stderr}");
    assert_eq!(read(run(1).join("summary.json")), kept);
    sweep(0, folder.path(), &["--set", "learning.updates=21", "--force", "--quiet"]);
    assert!(read(run(1).join("task.toml")).contains("updates = 21"));
}

#[test]
fn a_failed_run_is_reported_and_the_others_go_on() {
    let folder = folder();
    let reach = task("reach.toml");
    let arguments = [
        "sweep",
        &reach,
        "--seeds",
        "2",
        "--vary",
        "cost.acceleration=1e-3,1e308",
        "--set",
        "accept={}",
        "--set",
        "learning.method=pi2",
    ];
    let (stdout, stderr) = expect(1, folder.path(), &arguments);
    assert!(stdout.contains("2 of 4 runs finished, 2 failed"), "{stdout}");
    assert!(stderr.contains("cost.acceleration=1e308/seed-1") && stderr.contains("finite cost"), "{stderr}");
    let (header, rows) = header_and_rows(folder.path().join("runs/reach-sweep/results.csv"));
    assert_eq!(rows.iter().map(|row| row[3].as_str()).collect::<Vec<_>>(), ["done", "done", "failed", "failed"]);
    assert!(rows[2].last().unwrap().contains("finite cost") && rows[2].len() == header.len());
    let summary = json(folder.path().join("runs/reach-sweep/summary.json"));
    assert_eq!(summary["failures"].as_array().map(Vec::len), Some(2));
    assert_eq!(summary["settings"][1]["cost"]["total"], Value::Null);
}

#[test]
fn a_missed_target_ends_with_3_and_is_in_the_table() {
    let folder = folder();
    let (stdout, _) = sweep(3, folder.path(), &["--quiet", "--json", "--set", "accept.max_goal_error=1e-9"]);
    let summary: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(summary["settings"][0]["missed"], 2);
    assert_eq!(header_and_rows(folder.path().join("s/results.csv")).1[0][4], "false");
}

#[test]
fn what_cannot_be_varied_is_refused_before_anything_is_learned() {
    let folder = folder();
    let reach = task("reach.toml");
    let cases = [
        ("learning.noise.movment=1,2", "did you mean `movement`?"),
        ("learning.noise.movement", "key.path=value,value"),
        ("learning.noise.movement=1,,2", "a value is missing"),
        ("learning.noise.movement=1,1", "named twice"),
        ("learning.noise.movement=", "a value is missing"),
        ("learning.noise.movement=a,b", "must be a number or an array of numbers"),
        ("=1,2", "--vary =1,2: the key has an empty part"),
        ("learning.seed=1,2", "--seeds"),
        ("stiffness.min=1,1000", "stiffness"),
    ];
    for (vary, words) in cases {
        let (_, stderr) = expect(2, folder.path(), &["sweep", &reach, "--vary", vary]);
        assert!(stderr.contains(words), "{vary}: {stderr}");
    }
    let (_, stderr) = expect(2, folder.path(), &["sweep", &reach, "--vary", "rate=100,200", "--vary", "rate=50"]);
    assert!(stderr.contains("varied already"), "{stderr}");
    let process = ["--set", "environment={ kind = \"process\", command = [\"true\"] }", "--set", "disturbance=[]"];
    let (_, stderr) = expect(2, folder.path(), &[&["sweep", &reach][..], &process].concat());
    assert!(stderr.contains("which hpf learn runs"), "{stderr}");
    assert!(fs::read_dir(folder.path()).unwrap().next().is_none(), "nothing is written");

    fs::create_dir(folder.path().join("mine")).unwrap();
    fs::write(folder.path().join("mine/thesis.txt"), "years").unwrap();
    let (_, stderr) = expect(2, folder.path(), &["sweep", &reach, "--out", "mine", "--force"]);
    assert!(stderr.contains("is no sweep"), "{stderr}");
}

#[test]
fn ctrl_c_keeps_the_finished_runs_and_the_sweep_goes_on_later() {
    let folder = folder();
    let cantilever = task("cantilever.toml");
    let arguments = [
        "sweep",
        &cantilever,
        "--seeds",
        "40",
        "--out",
        "s",
        "--quiet",
        "--set",
        "learning.updates=60",
        "--set",
        "accept={}",
        "--set",
        "output={}",
    ];
    let mut child = command(folder.path(), &arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let started = Instant::now();
    // The first run is whole: the sweep is under way.
    while !folder.path().join("s/runs/seed-1").exists() {
        assert!(started.elapsed() < Duration::from_secs(60), "the sweep does not begin");
        std::thread::sleep(Duration::from_millis(5));
    }
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let summary = json(folder.path().join("s/summary.json"));
    let finished = summary["finished"].as_u64().unwrap();
    assert!(summary["interrupted"] == true && (1..40).contains(&finished), "{finished}");
    let (stdout, _) = expect(0, folder.path(), &arguments);
    assert!(stdout.contains(&format!("40 of 40 runs finished, 0 failed, {finished} were there before")), "{stdout}");
}

#[test]
fn shards_learn_the_runs_of_a_sweep_between_them_and_the_sweep_joins_them() {
    let folder = folder();
    let (first, _) = sweep(0, folder.path(), &["--quiet", "--shard", "1/3"]);
    assert!(first.contains("learned 2 of 2 runs of the shard"), "{first}");
    assert!(!folder.path().join("s/results.csv").exists(), "a shard has no tables");
    let (third, _) = sweep(0, folder.path(), &["--quiet", "--shard", "3/3", "--json"]);
    let third: Value = serde_json::from_str(&third).unwrap();
    assert_eq!((&third["runs"], &third["kept"]), (&1.into(), &0.into()));
    sweep(0, folder.path(), &["--quiet", "--shard", "2/3"]);
    let (again, _) = sweep(0, folder.path(), &["--quiet", "--shard", "1/3"]);
    assert!(again.contains("2 of them before"), "{again}");

    let (joined, _) = sweep(0, folder.path(), &["--quiet"]);
    assert!(joined.contains("4 of 4 runs finished"), "{joined}");
    let s = folder.path().join("s");
    let hidden = fs::read_dir(&s)
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().starts_with('.'));
    assert_eq!(hidden.count(), 0, "no lock is left");
    fs::rename(&s, folder.path().join("joined")).unwrap();
    sweep(0, folder.path(), &["--quiet"]);
    for run in ["5/seed-1", "5/seed-2", "20/seed-1", "20/seed-2"] {
        let policy = |sweep: &str| {
            read(folder.path().join(sweep).join(format!("runs/learning.noise.movement={run}/policy.json")))
        };
        assert_eq!(policy("joined"), policy("s"), "{run}");
    }
}

#[test]
fn what_is_no_shard_is_refused_with_what_is_one() {
    let folder = folder();
    for shard in ["0/4", "5/4", "3", "1/0"] {
        let (_, stderr) = sweep(2, folder.path(), &["--shard", shard]);
        assert!(stderr.contains("such as 3/16"), "{stderr}");
    }
    assert!(!folder.path().join("s").exists());
}

#[test]
fn variants_of_a_task_are_set_beside_each_other() {
    let folder = folder();
    let reach = task("reach.toml");
    let variants =
        ["--variant", "as it is:", "--variant", "stiff: stiffness.initial=300; stiffness.min=200; learning.updates=3"];
    let small = ["sweep", &reach, "--seeds", "1", "--set", "learning.updates=2", "--set", "accept={}", "--out", "s"];
    let (stdout, _) = expect(0, folder.path(), &[&small[..], &variants, &["--quiet"]].concat());
    assert!(stdout.contains("variant=as it is") && stdout.contains("variant=stiff"), "{stdout}");
    let (header, rows) = header_and_rows(folder.path().join("s/results.csv"));
    assert_eq!((header[1].as_str(), rows.len()), ("variant", 2));
    let updates = header.iter().position(|name| name == "updates").unwrap();
    assert_eq!((rows[0][1].as_str(), rows[0][updates].as_str()), ("as it is", "2"));
    assert_eq!((rows[1][1].as_str(), rows[1][updates].as_str()), ("stiff", "3"));
    let (_, stderr) = expect(2, folder.path(), &[&small[..], &["--variant", "stiffness.min=200"]].concat());
    assert!(stderr.contains("NAME:"), "{stderr}");
}
