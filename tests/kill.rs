//! `kill -9` at any moment of `hpf learn`.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Instant;

use crate::support::{command, expect, expect_same_run, folder, hpf, task};

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
        // Killed between its last two breaths it has its checkpoint yet: it may be resumed, and need not be.
        Left::Whole if run.join("checkpoint").exists() || run.join(".lock").exists() => {
            let resumed = hpf(folder, &["learn", "--resume", name, "--quiet"]);
            assert!(resumed.status.success());
        }
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
