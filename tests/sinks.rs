//! Logs and figures only show a run: one that cannot be made does not cost it.

use std::fs;
use std::process::Command;

use crate::support::{expect, folder, json, read};

const TASK: &str = "name = \"scale\"\nduration = 1.0\nrate = 20.0\n[[axis]]\nname = \"x\"\nstart = 0.0\ngoal = 0.3\n\
    [movement]\nbasis = 3\n[stiffness]\nbasis = 3\ninitial = 200.0\nmin = 50.0\nmax = 500.0\n\
    [damping]\nbasis = 3\ninitial = 30.0\nmin = 10.0\nmax = 120.0\n[cost]\ngoal = 1.0\n\
    [learning]\nmethod = \"pi2\"\nupdates = 3\nrollouts = 4\n";

#[cfg(unix)]
#[test]
fn figures_that_cannot_be_written_leave_the_run_whole() {
    let folder = folder();
    fs::write(folder.path().join("scale.toml"), TASK).unwrap();
    // No file may become larger than this: tables fit, figures do not.
    let script = "trap '' XFSZ; ulimit -f 24; exec \"$0\" \"$@\"";
    let limited = |arguments: &[&str]| {
        let output = Command::new("sh")
            .args(["-c", script, env!("CARGO_BIN_EXE_hpf")])
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    expect(0, folder.path(), &["learn", "scale.toml", "--quiet", "--out", "free"]);
    let commands: [&[&str]; 3] = [
        &["learn", "scale.toml", "--quiet", "--out", "run"],
        &["run", "free", "--out", "run"],
        &["imitate", "free", "--out", "run", "--name", "scale"],
    ];
    for arguments in commands {
        let (code, stderr) = limited(arguments);
        assert_eq!(code, Some(1), "{arguments:?}: {stderr}");
        assert!(stderr.contains("plots/cost.png") && stderr.contains("all other results are in run"), "{stderr}");
        assert!(!stderr.contains("panicked"), "{stderr}");
        assert_eq!(json(folder.path().join("run/summary.json"))["task"], "scale");
        for name in ["policy.json", "learning.csv", "trajectory.csv", "task.toml"] {
            assert!(!read(folder.path().join("run").join(name)).is_empty());
        }
        expect(0, folder.path(), &["run", "run"]);
        fs::remove_dir_all(folder.path().join("run")).unwrap();
        assert!(!folder.path().join("run.partial").exists());
    }
}

#[test]
fn costs_of_any_size_are_learned_and_drawn() {
    let folder = folder();
    fs::write(folder.path().join("scale.toml"), TASK).unwrap();
    for weight in ["1e-290", "1e-14", "1e20", "1e90", "1e150"] {
        let change = format!("cost.goal={weight}");
        let arguments = ["learn", "scale.toml", "--quiet", "--out", weight, "--set", &change];
        let (_, stderr) = expect(0, folder.path(), &arguments);
        assert_eq!(stderr, "");
        assert!(folder.path().join(weight).join("plots/cost.png").is_file());
    }
    let compared = ["plot", "1e-290", "1e-14", "1e20", "1e90", "1e150", "--out", "all"];
    expect(0, folder.path(), &compared);
}

#[test]
fn the_edge_of_what_a_log_can_tell_of_time_is_told() {
    let folder = folder();
    fs::write(folder.path().join("scale.toml"), TASK).unwrap();
    // The longest task is shorter than the stamps reach, with the rest time after it: 2 durations of a slow spring.
    for (duration, rate, alpha, words) in [
        ("1e9", "1e-7", "1.0", "time stamps of ROS messages end at 2147483647 s"),
        ("1e-9", "1e12", "25.0", "logs count time in nanoseconds"),
    ] {
        let keys = [format!("duration={duration}"), format!("rate={rate}"), format!("movement.alpha={alpha}")];
        let keys: Vec<&str> = keys.iter().flat_map(|key| ["--set", key]).collect();
        let (stdout, _) = expect(0, folder.path(), &[&["check", "scale.toml"], &keys[..]].concat());
        assert!(stdout.contains(words), "{stdout}");
        let learn = [&["learn", "scale.toml", "--quiet", "--out", duration], &keys[..]].concat();
        let (stdout, _) = expect(0, folder.path(), &learn);
        assert!(stdout.contains(words), "{stdout}");
        let (_, stderr) = expect(0, folder.path(), &["export", duration, "--ros2"]);
        assert!(stderr.contains(words), "{stderr}");
    }
    // The same duration with a quick spring rests before the stamps end.
    let quick = ["check", "scale.toml", "--set", "duration=1e9", "--set", "rate=1e-7"];
    let (stdout, _) = expect(0, folder.path(), &quick);
    assert!(!stdout.contains("warning"), "{stdout}");
}
