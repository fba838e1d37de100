//! `hpf learn --resume`

use core::time::Duration;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::support::{command, expect, expect_same_run, folder, json, read, task};

/// Too long to be over before Ctrl-C comes, short enough to be finished.
const LONG: [&str; 8] = [
    "--quiet",
    "--set",
    "learning.updates=3000",
    "--set",
    "learning.max_rollouts=100000",
    "--set",
    "accept={}",
    "--force",
];

/// Begins the long run and presses Ctrl-C once learning is under way.
fn interrupted(folder: &Path, out: &str, more: &[&str]) -> String {
    let cantilever = task("cantilever.toml");
    let arguments = [&["learn", &cantilever, "--out", out], &LONG[..], more].concat();
    let child = command(folder, &arguments).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let started = Instant::now();
    let checkpoint = folder.join(format!("{out}.partial/checkpoint"));
    while fs::metadata(&checkpoint).map_or(0, |file| file.len()) < 50_000 {
        assert!(started.elapsed() < Duration::from_secs(60), "learning does not begin");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    String::from_utf8(output.stdout).unwrap()
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).unwrap();
        }
    }
}

#[test]
fn an_interrupted_run_goes_on_to_the_same_bytes_from_a_whole_cut_or_damaged_checkpoint() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let cantilever = task("cantilever.toml");
    expect(0, folder.path(), &[&["learn", &cantilever, "--out", "whole"], &LONG[..]].concat());

    let stdout = interrupted(folder.path(), "run", &[]);
    assert!(stdout.contains("it was interrupted") && stdout.contains("next: hpf learn --resume run"), "{stdout}");
    let updates = json(path("run/summary.json"))["updates"].as_u64().unwrap();
    assert!(0 < updates && updates < 3000);
    for name in ["cut", "damaged", "headless", "foreign", "edited", "alone"] {
        copy(&path("run"), &path(name));
    }

    // One checkpoint with all that was told, one cut short, one with a damaged byte: the same end.
    let checkpoint = fs::read(path("run/checkpoint")).unwrap();
    fs::write(path("cut/checkpoint"), &checkpoint[..checkpoint.len() / 2]).unwrap();
    let mut damaged = checkpoint.clone();
    damaged[checkpoint.len() / 3] ^= 1;
    fs::write(path("damaged/checkpoint"), damaged).unwrap();
    for (name, threads) in [("run", "2"), ("cut", "1"), ("damaged", "3")] {
        let (_, stderr) = expect(0, folder.path(), &["learn", "--resume", name, "--quiet", "--threads", threads]);
        assert_eq!(stderr.contains("are made again"), name != "run", "{name}: {stderr}");
        expect_same_run(&path("whole"), &path(name));
        let (_, stderr) = expect(2, folder.path(), &["learn", "--resume", name]);
        assert!(stderr.contains("is finished"), "{stderr}");
    }

    // What cannot be gone on with says why, as often as it is asked.
    fs::write(path("headless/checkpoint"), &checkpoint[9..]).unwrap();
    let text = String::from_utf8_lossy(&checkpoint[..60]).replace("checkpoint 3", "checkpoint 2");
    fs::write(path("foreign/checkpoint"), text).unwrap();
    let changed = read(path("edited/task.toml")).replace("seed = 1", "seed = 2");
    fs::write(path("edited/task.toml"), changed).unwrap();
    fs::remove_file(path("alone/task.toml")).unwrap();
    for (name, words) in [
        ("headless", "no checkpoint"),
        ("foreign", "version 2"),
        ("edited", "task.toml is not what this run began with"),
        ("alone", "there is no such file"),
        ("nowhere", "no run that was broken off"),
    ] {
        for _ in 0..2 {
            let (_, stderr) = expect(2, folder.path(), &["learn", "--resume", name]);
            assert!(stderr.contains(words) && !stderr.contains("panicked"), "{name}: {stderr}");
        }
    }
}

#[test]
fn what_a_run_began_with_must_be_as_it_was_and_everything_else_is_written_anew() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let few = ["--quiet", "--set", "learning.updates=5", "--set", "accept={}", "--set", "output={}"];
    expect(0, folder.path(), &[&["learn", &task("cantilever.toml"), "--out", "start"][..], &few].concat());
    let push = path("push.csv");
    fs::write(&push, "time_s,force_n\n0,0\n5,0.5\n").unwrap();
    let push = format!("disturbance=[{{ kind = \"table\", axis = \"y\", file = {:?} }}]", push.display().to_string());
    let more = ["--from", "start", "--set", &push];
    let cantilever = task("cantilever.toml");
    expect(0, folder.path(), &[&["learn", &cantilever, "--out", "whole"], &LONG[..], &more].concat());
    interrupted(folder.path(), "run", &more);
    // As a kill would have left it: that is where a refused run stays, too.
    let run = path("run.partial");
    fs::rename(path("run"), &run).unwrap();

    for (name, number, other) in [
        ("task.toml", "seed = 1", "seed = 2"),
        ("start_policy.json", "\"cost\": ", "\"cost\": 1"),
        ("disturbance_0.csv", "0.5", "0.6"),
    ] {
        let text = read(run.join(name));
        let edited = text.replacen(number, other, 1);
        assert_ne!(edited, text, "{name}");
        for damaged in [Some(&edited[..]), Some(&text[..text.len() / 2]), Some(""), None] {
            fs::remove_file(run.join(name)).unwrap();
            if let Some(damaged) = damaged {
                fs::write(run.join(name), damaged).unwrap();
            }
            let (_, stderr) = expect(2, folder.path(), &["learn", "--resume", "run"]);
            assert!(stderr.contains(name) && !stderr.contains("panicked"), "{name}: {stderr}");
            fs::write(run.join(name), &text).unwrap();
        }
    }
    for name in ["policy.json", "learning.csv", "trajectory.csv", "summary.json", "log.mcap", "plots/cost.png"] {
        assert!(run.join(name).exists(), "{name}");
        fs::write(run.join(name), b"\x00what?").unwrap();
    }
    expect(0, folder.path(), &["learn", "--resume", "run", "--quiet"]);
    expect_same_run(&path("whole"), &path("run"));
}

#[test]
fn a_run_goes_on_as_it_began() {
    let folder = folder();
    let reach = task("reach.toml");
    for more in [&["--seed", "2"][..], &["--out", "x"], &["--set", "rate=200"], &[&reach]] {
        let (_, stderr) = expect(2, folder.path(), &[&["learn", "--resume", "run"], more].concat());
        assert!(stderr.contains("--resume"), "{stderr}");
    }
    expect(2, folder.path(), &["learn"]);
}
