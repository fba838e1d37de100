//! What stands where hpf reads and writes: pipes, links and devices are neither waited for nor replaced.

#![cfg(unix)]

use std::fs;
use std::os::unix::fs::{FileTypeExt as _, symlink};
use std::path::Path;
use std::process::Command;

use crate::support::{expect, folder, read, task};

fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

/// Runs `hpf` under a limit that only a run that waits for somebody reaches; returns its exit code and stderr.
fn within_limit(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let hpf = env!("CARGO_BIN_EXE_hpf");
    let output = Command::new("timeout").args(["120", hpf]).args(arguments).current_dir(folder).output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn force_replaces_regular_files_only() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "run"]);
    expect(0, folder.path(), &["imitate", "run", "--out", "imitated", "--quiet", "--name", "imitated"]);
    pipe(&path("pipe"));
    fs::write(path("target"), "keep").unwrap();
    symlink("target", path("link")).unwrap();
    symlink("nowhere", path("dangling")).unwrap();
    let _socket = std::os::unix::net::UnixListener::bind(path("socket")).unwrap();
    let mut nodes = vec!["pipe", "link", "dangling", "socket"];
    // Only root can make a device.
    if Command::new("mknod").arg(path("device")).args(["c", "1", "3"]).output().unwrap().status.success() {
        nodes.push("device");
    }
    let kind = |name: &str| path(name).symlink_metadata().unwrap().file_type();
    let before: Vec<_> = nodes.iter().map(|name| kind(name)).collect();
    let commands: [&[&str]; 12] = [
        &["schema"],
        &["completions", "bash"],
        &["init", "reach"],
        &["export", "run", "--format", "c"],
        &["export", "run", "--ros2"],
        &["recover", "run/log.mcap"],
        &["learn", "run/task.toml", "--quiet"],
        &["run", "run"],
        &["imitate", "run"],
        &["plot", "run"],
        &["manual"],
        &["sweep", "run/task.toml", "--seeds", "1"],
    ];
    for node in &nodes {
        for arguments in commands {
            let (code, stderr) = within_limit(folder.path(), &[arguments, &["--out", node, "--force"]].concat());
            // A link to a place for runs leads there, and what stands there is named.
            let is_named = stderr.contains(node) || stderr.contains("target");
            assert!(code == Some(2) && is_named, "{arguments:?} {node}: {code:?} {stderr}");
        }
    }
    for (name, before) in nodes.iter().zip(before) {
        assert!(kind(name) == before, "{name} is another kind of node now");
    }
    assert_eq!(read(path("target")), "keep");
    // Inside of directories too, and under the temporary names.
    fs::remove_file(path("run/plots/cost.png")).unwrap();
    symlink("../../target", path("run/plots/cost.png")).unwrap();
    let (code, stderr) = within_limit(folder.path(), &["plot", "run", "--force"]);
    assert!(code == Some(1) && stderr.contains("cost.png") && stderr.contains("a symbolic link"), "{stderr}");
    pipe(&path("schema.json.partial"));
    let (code, stderr) = within_limit(folder.path(), &["schema", "--out", "schema.json"]);
    assert!(code == Some(1) && stderr.contains("a named pipe"), "{code:?} {stderr}");
    assert_eq!(read(path("target")), "keep");
}

#[test]
fn force_does_not_replace_a_directory_that_only_holds_a_task() {
    let folder = folder();
    fs::create_dir(folder.path().join("project")).unwrap();
    expect(0, folder.path(), &["init", "reach", "--out", "project/task.toml"]);
    fs::write(folder.path().join("project/notes.txt"), "mine").unwrap();
    let (_, stderr) =
        expect(2, folder.path(), &["learn", "project/task.toml", "--out", "project", "--force", "--quiet"]);
    assert!(stderr.contains("no run directory"), "{stderr}");
    assert_eq!(read(folder.path().join("project/notes.txt")), "mine");
}

#[test]
fn a_pipe_that_nobody_writes_to_is_not_waited_for() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    for name in ["p", "p.toml", "p.json", "p.mcap", "p.csv"] {
        pipe(&path(name));
    }
    let commands: [&[&str]; 10] = [
        &["check", "p.toml"],
        &["check", "p.json"],
        &["learn", "p.toml"],
        &["info", "p"],
        &["info", "p.mcap"],
        &["recover", "p.mcap"],
        &["imitate", "p.csv"],
        &["sweep", "p.toml"],
        &["run", "p.json", "--task", "p.toml"],
        &["export", "p.json", "--format", "c"],
    ];
    for arguments in commands {
        let (code, stderr) = within_limit(folder.path(), arguments);
        assert!(
            code == Some(2) && stderr.contains("this is a named pipe, a file is wanted"),
            "{arguments:?}: {stderr}"
        );
    }
    let (code, stderr) = within_limit(folder.path(), &["plot", "p"]);
    assert!(code == Some(2) && stderr.contains("p: this is a named pipe, a run directory is wanted"), "{stderr}");
    let table = "\n[[disturbance]]\nkind = \"table\"\naxis = \"x\"\nfile = \"p.csv\"\n";
    fs::write(path("table.toml"), read(task("reach.toml")) + table).unwrap();
    let (code, stderr) = within_limit(folder.path(), &["check", "table.toml"]);
    assert!(code == Some(2) && stderr.contains("p.csv"), "{code:?} {stderr}");
    // And every file of a run.
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "run"]);
    for name in ["task.toml", "policy.json", "learning.csv", "trajectory.csv", "summary.json", "snapshots/0.csv"] {
        let (file, kept) = (path("run").join(name), path("kept"));
        fs::rename(&file, &kept).unwrap();
        pipe(&file);
        let commands: [&[&str]; 6] = [
            &["info", "run"],
            &["run", "run"],
            &["plot", "run", "--out", "figures", "--force"],
            &["export", "run", "--format", "c", "--out", "x.h", "--force"],
            &["export", "run", "--ros2", "--out", "x.mcap", "--force"],
            &["learn", "--resume", "run"],
        ];
        for arguments in commands {
            let (code, stderr) = within_limit(folder.path(), arguments);
            assert!([Some(0), Some(1), Some(2)].contains(&code), "{name}: {arguments:?}: {code:?} {stderr}");
        }
        assert!(file.symlink_metadata().unwrap().file_type().is_fifo());
        fs::rename(&kept, &file).unwrap();
    }
}

#[test]
fn the_pipes_of_a_shell_are_read() {
    let folder = folder();
    let script = format!("cat '{}' | '{}' check /dev/stdin", task("reach.toml"), env!("CARGO_BIN_EXE_hpf"));
    let output = Command::new("sh").args(["-c", &script]).current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
