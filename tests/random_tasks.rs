//! Random valid tasks through the program: the bulk of them goes through the library, in `hpf-sim`'s tests.

use std::fs;
use std::path::Path;

use crate::generator;
use crate::support::{expect, folder, hpf, read};

/// Tasks learned here.
const TASKS: u64 = 8;

#[test]
fn random_tasks_are_learned_drawn_and_run_again() {
    for seed in 0..TASKS {
        let folder = folder();
        fs::write(folder.path().join("task.toml"), generator::task(seed)).unwrap();
        let outcome = |arguments: &[&str]| {
            let output = hpf(folder.path(), arguments);
            let stderr = String::from_utf8_lossy(&output.stderr);
            assert!(matches!(output.status.code(), Some(0 | 3)), "task {seed}, {arguments:?}: {stderr}");
            assert!(stderr.is_empty(), "task {seed}, {arguments:?}: {stderr}");
        };
        outcome(&["check", "task.toml"]);
        outcome(&["learn", "task.toml", "--quiet", "--out", "run"]);
        outcome(&["run", "run"]);
        for command in ["info", "check"] {
            outcome(&[command, "run"]);
        }
        expect(0, folder.path(), &["plot", "run", "--force"]);
        let run = folder.path().join("run");
        for table in ["learning.csv", "trajectory.csv"] {
            numbers_are_finite(&run.join(table), &read(run.join(table)));
        }
        let summary = read(run.join("summary.json"));
        let bad = ["\"value\": null", "\"total\": null"].iter().find(|bad| summary.contains(**bad));
        assert_eq!(bad, None, "task {seed}: a number is not finite: {summary}");
        let log = read_log(&run.join("log.mcap"));
        assert!(log.contains("complete"), "task {seed}: {log}");
    }
}

fn numbers_are_finite(path: &Path, text: &str) {
    for (line, row) in text.lines().enumerate().skip(1) {
        let finite = row.split(',').all(|number| number.parse::<f64>().is_ok_and(f64::is_finite));
        assert!(finite, "{}:{}: {row}", path.display(), line + 1);
    }
}

fn read_log(path: &Path) -> String {
    expect(0, Path::new("."), &["info", &path.display().to_string()]).0
}
