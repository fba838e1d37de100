//! `kill -9` at any moment of `hpf learn`.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Instant;

use crate::support::{command, expect, expect_same_run, folder, task};

/// Kills of each method.
const KILLS: u32 = 25;

/// What a killed run left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Left {
    Nothing,
    Resumable,
    Whole,
}

fn arguments<'a>(reach: &'a str, method: &'a str, out: &'a str) -> Vec<&'a str> {
    let mut arguments = vec!["learn", reach, "--out", out, "--quiet", "--threads", "2", "--set", "accept={}"];
    arguments.extend(["--set", "output.snapshots=[0, 20]", "--set", method]);
    arguments
}

/// Runs a method to the end, then kills it again and again between its start and its end, and finishes what is left.
fn kill(method: &str) -> Vec<Left> {
    let folder = folder();
    let reach = task("reach.toml");
    let method = format!("learning.method={method}");
    let started = Instant::now();
    expect(0, folder.path(), &arguments(&reach, &method, "whole"));
    let time = started.elapsed();
    let run = |i: u32| {
        let name = format!("run{i}");
        let mut child = command(folder.path(), &arguments(&reach, &method, &name))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(time * i / KILLS);
        // A run that is over already is not killed, and counts as whole.
        let _ = child.kill();
        child.wait().unwrap();
        left(folder.path(), &name, &arguments(&reach, &method, &name))
    };
    (0..KILLS).map(run).collect()
}

/// Checks what is there, and finishes it.
fn left(folder: &Path, name: &str, again: &[&str]) -> Left {
    let (run, partial) = (folder.join(name), folder.join(format!("{name}.partial")));
    let left = match (run.exists(), partial.exists()) {
        (false, false) => Left::Nothing,
        (false, true) => Left::Resumable,
        (true, false) => Left::Whole,
        (true, true) => panic!("{name} is there twice"),
    };
    let log = partial.join("log.mcap.partial");
    if log.exists() && fs::metadata(&log).unwrap().len() > 20_000 {
        // The head of the log and the first updates.
        expect(0, folder, &["info", &log.display().to_string()]);
    }
    match left {
        Left::Nothing => drop(expect(0, folder, again)),
        Left::Resumable => drop(expect(0, folder, &["learn", "--resume", name, "--quiet"])),
        // Under its name it is what it will be: below, nothing else is in it.
        Left::Whole => {}
    }
    expect_same_run(&folder.join("whole"), &run);
    fs::remove_dir_all(&run).unwrap();
    let names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["whole"], "nothing else is left");
    left
}

#[test]
fn a_hundred_kills_leave_a_hundred_runs_that_end_with_the_same_bytes() {
    let methods = ["pi2", "gauss-newton", "auto", "cma-es"];
    let found: Vec<Vec<Left>> = std::thread::scope(|scope| {
        let kills: Vec<_> = methods.iter().map(|method| scope.spawn(|| kill(method))).collect();
        kills.into_iter().map(|kill| kill.join().unwrap()).collect()
    });
    let count = |left: Left| found.iter().flatten().filter(|found| **found == left).count();
    let counts = [Left::Nothing, Left::Resumable, Left::Whole].map(count);
    eprintln!("nothing, resumable, whole: {counts:?}");
    assert_eq!(counts.iter().sum::<usize>(), 100);
    assert!(counts[1] >= 20, "too few kills met a run at work: {counts:?}");
}

#[test]
fn a_run_killed_before_its_last_renaming_gets_its_name_and_needs_nothing_else() {
    let folder = folder();
    let reach = task("reach.toml");
    expect(0, folder.path(), &arguments(&reach, "learning.method=pi2", "whole"));
    expect(0, folder.path(), &arguments(&reach, "learning.method=pi2", "run"));
    let path = |name: &str| folder.path().join(name);
    // All is written, the checkpoint gone: what a kill at the renaming leaves, with and without the lock.
    for has_lock in [true, false] {
        fs::rename(path("run"), path("run.partial")).unwrap();
        if has_lock {
            fs::write(path("run.partial/.lock"), "").unwrap();
        }
        let (stdout, _) = expect(0, folder.path(), &["learn", "--resume", "run"]);
        assert!(stdout.contains("total"), "{stdout}");
        expect_same_run(&path("whole"), &path("run"));
        assert!(!path("run.partial").exists());
    }
    // A discarded run of which a part is left is none: it is discarded again.
    fs::create_dir(path("run.partial")).unwrap();
    fs::write(path("run.partial/.lock"), "").unwrap();
    fs::create_dir(path("run.partial/plots")).unwrap();
    expect(2, folder.path(), &["learn", "--resume", "run", "--force"]);
    expect(0, folder.path(), &[&arguments(&reach, "learning.method=pi2", "run")[..], &["--force"]].concat());
    expect_same_run(&path("whole"), &path("run"));
}
