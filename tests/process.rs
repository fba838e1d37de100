//! `[environment] kind = "process"`: other programs make the rollouts.

use core::time::Duration;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::{command, expect, expect_same_run, folder, hpf, json, read, root};

/// Whether Python is here; where not, the test says so and ends.
pub fn has_python() -> bool {
    let found = Command::new("python3").arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success());
    if !found {
        eprintln!("SKIPPED: there is no python3 here");
    }
    found
}

fn toml() -> String {
    root().join("examples/process/point_mass.toml").display().to_string()
}

fn example() -> String {
    root().join("examples/process/point_mass.py").display().to_string()
}

/// Learns the example's task with `program` in `folder`.
fn arguments(program: &[&str], out: &str, settings: &[&str]) -> Vec<String> {
    let quoted: Vec<String> = program.iter().map(|word| format!("{word:?}")).collect();
    let command = format!("environment.command=[{}]", quoted.join(", "));
    let mut arguments = vec!["learn".to_owned(), toml()];
    arguments.extend(["--quiet", "--out", out, "--set", &command].map(str::to_owned));
    arguments.extend(settings.iter().flat_map(|setting| ["--set".to_owned(), (*setting).to_owned()]));
    arguments
}

fn learn(code: i32, folder: &Path, program: &[&str], out: &str, settings: &[&str]) -> (String, String) {
    let arguments = arguments(program, out, settings);
    expect(code, folder, &arguments.iter().map(String::as_str).collect::<Vec<_>>())
}

/// A file without the SHA-256 of its task: that differs with the settings of the environment.
fn lines(path: &Path) -> Vec<String> {
    read(path).lines().filter(|line| !line.contains("sha256")).map(str::to_owned).collect()
}

/// A worker written for one test: `body` is what it does with each `line` of requests, `n` counting them from 1.
fn worker(folder: &Path, body: &str) -> String {
    let path = folder.join("worker.py");
    let text = format!(
        "import json, os, sys, time\n\
         def say(**answer): print(json.dumps(answer), flush=True)\n\
         hello = json.loads(sys.stdin.readline())\n\
         say(type='ready', protocol=1, answers='costs')\n\
         def cost(request): return sum((k - 300.0) ** 2 for k in request['axes'][0]['weights']['stiffness'])\n\
         for n, line in enumerate(sys.stdin, 1):\n    request = json.loads(line)\n    id = request['id']\n    {}\n",
        body.replace('\n', "\n    ")
    );
    fs::write(&path, text).unwrap();
    path.display().to_string()
}

const COSTS: [&str; 5] =
    ["accept={}", "learning.method=pi2", "learning.updates=8", "environment.timeout=5.0", "environment.workers=1"];

#[test]
fn the_example_meets_its_targets_and_gives_the_same_bytes_for_any_number_of_workers() {
    if !has_python() {
        return;
    }
    let folder = folder();
    for workers in ["1", "3"] {
        let workers_key = format!("environment.workers={workers}");
        learn(0, folder.path(), &["python3", &example()], workers, &[&workers_key]);
    }
    let path = |name: &str| folder.path().join(name);
    for file in ["policy.json", "learning.csv", "trajectory.csv"] {
        assert_eq!(lines(&path("1").join(file)), lines(&path("3").join(file)), "{file} differs");
    }
    let summary = json(path("1/summary.json"));
    // The motion that the files show is one more.
    assert!(summary["rollouts_total"].as_u64().unwrap() <= 201);
    let cost = |when: &str| summary["cost"][when]["total"].as_f64().unwrap();
    assert!(cost("final") < 0.1 * cost("initial"));
    let check = expect(0, folder.path(), &["check", &toml()]).0;
    assert!(check.contains("process     2 of `python3"), "{check}");
}

#[test]
fn costs_alone_are_learned_too_and_a_kill_or_ctrl_c_is_gone_on_from() {
    if !has_python() {
        return;
    }
    let folder = folder();
    for method in ["auto", "pi2", "cma-es"] {
        let method = format!("learning.method={method}");
        let settings = ["accept={}", "learning.updates=8", method.as_str()];
        let program = ["python3", &example(), "--costs"];
        learn(0, folder.path(), &program, "whole", &settings);
        let summary = json(folder.path().join("whole/summary.json"));
        assert!(summary["cost"]["final"]["total"].as_f64() < summary["cost"]["initial"]["total"].as_f64());
        for signal in ["-KILL", "-INT"] {
            let words = arguments(&program, "broken", &settings);
            let mut child = command(folder.path(), &words.iter().map(String::as_str).collect::<Vec<_>>())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            let checkpoint = folder.path().join("broken.partial/checkpoint");
            while fs::metadata(&checkpoint).map_or(0, |file| file.len()) < 200 && child.try_wait().unwrap().is_none() {
                std::thread::sleep(Duration::from_millis(1));
            }
            Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
            child.wait().unwrap();
            // Over before the signal came, there is nothing to go on with.
            hpf(folder.path(), &["learn", "--resume", "broken", "--quiet"]);
            expect_same_run(&folder.path().join("whole"), &folder.path().join("broken"));
            fs::remove_dir_all(folder.path().join("broken")).unwrap();
        }
        fs::remove_dir_all(folder.path().join("whole")).unwrap();
    }
}

#[test]
fn a_worker_that_dies_hangs_or_babbles_is_replaced_and_named_and_changes_no_result() {
    if !has_python() {
        return;
    }
    let folder = folder();
    let good = worker(folder.path(), "say(type='done', id=id, cost=cost(request))");
    learn(0, folder.path(), &["python3", &good], "good", &COSTS);
    // Each does it once, and leaves a mark that it did.
    for (trouble, words) in [
        ("sys.exit(7)", "ended (exit status: 7)"),
        ("time.sleep(60)", "did not answer within 1 s"),
        ("print('oops', flush=True)", "printed `oops`, which is no answer"),
        ("say(type='done', id=0, cost=1.0)", "its id is 0"),
    ] {
        let mark = folder.path().join("mark").display().to_string();
        let _ = fs::remove_file(&mark);
        let body = format!(
            "if n == 5 and not os.path.exists({mark:?}):\n    open({mark:?}, 'w').close()\n    {trouble}\n\
             else: say(type='done', id=id, cost=cost(request))"
        );
        let bad = worker(folder.path(), &body);
        let settings = [&COSTS[..3], &["environment.timeout=1.0", "environment.workers=1"]].concat();
        let (_, stderr) = learn(0, folder.path(), &["python3", &bad], "bad", &settings);
        assert!(stderr.contains("worker 1 ") && stderr.contains(words) && stderr.contains("is made again"), "{stderr}");
        for file in ["policy.json", "learning.csv"] {
            let of = |name: &str| lines(&folder.path().join(name).join(file));
            assert_eq!(of("good"), of("bad"), "{trouble}: {file}");
        }
        fs::remove_dir_all(folder.path().join("bad")).unwrap();
    }
}

#[test]
fn a_worker_that_fails_again_and_again_ends_learning_which_goes_on_when_it_is_mended() {
    if !has_python() {
        return;
    }
    let folder = folder();
    let good = "say(type='done', id=id, cost=cost(request))";
    let program = worker(folder.path(), good);
    learn(0, folder.path(), &["python3", &program], "whole", &COSTS);
    worker(folder.path(), &format!("if id > 30: sys.exit(3)\n{good}"));
    let (_, stderr) = learn(1, folder.path(), &["python3", &program], "run", &COSTS);
    for words in ["worker 1 ended (exit status: 3)", "was tried 3 times", "hpf learn --resume", "run"] {
        assert!(stderr.contains(words), "{words} is missing from {stderr}");
    }
    worker(folder.path(), good);
    expect(0, folder.path(), &["learn", "--resume", "run", "--quiet"]);
    expect_same_run(&folder.path().join("whole"), &folder.path().join("run"));
}

#[test]
fn costs_that_are_no_number_and_errors_are_rejected_rollouts() {
    if !has_python() {
        return;
    }
    let folder = folder();
    let body = "if n % 7 == 3: say(type='done', id=id, cost=float('nan'))\n\
                elif n % 7 == 4: say(type='done', id=id, error='a joint limit')\n\
                else: say(type='done', id=id, cost=cost(request))";
    let (_, stderr) = learn(0, folder.path(), &["python3", &worker(folder.path(), body)], "run", &COSTS);
    assert!(stderr.contains("a joint limit"), "{stderr}");
    let summary = json(folder.path().join("run/summary.json"));
    assert!(summary["rejected_rollouts"].as_u64().unwrap() > 0);
    assert!(summary["cost"]["final"]["total"].as_f64().unwrap().is_finite());
}

#[test]
fn what_does_not_start_or_fit_is_refused_by_name() {
    let folder = folder();
    let (_, stderr) = learn(2, folder.path(), &["no-such-program"], "run", &COSTS);
    assert!(stderr.contains("cannot start `no-such-program`"), "{stderr}");
    let (_, stderr) = learn(2, folder.path(), &["true"], "run", &COSTS);
    assert!(stderr.contains("worker 1 ended (exit status: 0)"), "{stderr}");
    let (_, stderr) = learn(2, folder.path(), &["echo", "hello"], "run", &COSTS);
    assert!(stderr.contains("printed `hello`"), "{stderr}");
    let second = r#"{"type":"ready","protocol":2,"answers":"costs"}"#;
    let (_, stderr) = learn(2, folder.path(), &["echo", second], "run", &COSTS);
    assert!(stderr.contains("speaks version 2"), "{stderr}");
    // Targets need traces; what hpf simulates needs no process; a process runs only while learning.
    let costs = r#"{"type":"ready","protocol":1,"answers":"costs"}"#;
    let (_, stderr) = learn(2, folder.path(), &["echo", costs], "run", &COSTS[1..]);
    assert!(stderr.contains("[accept] need traces"), "{stderr}");
    let pushed =
        ["disturbance=[{ kind = \"step\", axis = \"x\", amplitude = 1.0, start = 0.1 }]", "output.snapshots=[0]"];
    let (_, stderr) = learn(2, folder.path(), &["true"], "run", &pushed);
    assert!(stderr.contains("is simulated, and the rollouts of this task are not"), "{stderr}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left");
}
