//! What may be written where, and what may not.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::{expect, folder, read, task};

fn learn(folder: &Path, code: i32, more: &[&str]) -> (String, String) {
    let reach = task("reach.toml");
    let arguments = [&["learn", &reach, "--quiet"], more].concat();
    expect(code, folder, &arguments)
}

#[test]
fn existing_results_are_left_alone_until_force_is_given() {
    let folder = folder();
    learn(folder.path(), 0, &["--out", "run"]);
    let before = read(folder.path().join("run/learning.csv"));
    let (_, stderr) = learn(folder.path(), 2, &["--out", "run", "--seed", "9"]);
    assert!(stderr.contains("--force"), "{stderr}");
    assert_eq!(read(folder.path().join("run/learning.csv")), before);
    learn(folder.path(), 0, &["--out", "run", "--seed", "9", "--force"]);
    assert_ne!(read(folder.path().join("run/learning.csv")), before);
    let names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["run"], "nothing else is left beside the run");
}

#[test]
fn force_does_not_replace_what_is_no_run() {
    let folder = folder();
    fs::create_dir(folder.path().join("thesis")).unwrap();
    fs::write(folder.path().join("thesis/chapter1.txt"), "years of work").unwrap();
    for more in
        [&["--out", "thesis"][..], &["--out", "thesis", "--force"], &["--out", "thesis/chapter1.txt", "--force"]]
    {
        learn(folder.path(), 2, more);
    }
    assert_eq!(read(folder.path().join("thesis/chapter1.txt")), "years of work");
}

#[test]
fn an_empty_directory_may_be_filled() {
    let folder = folder();
    fs::create_dir(folder.path().join("run")).unwrap();
    learn(folder.path(), 0, &["--out", "run"]);
    assert!(folder.path().join("run/policy.json").exists());
}

#[test]
fn a_broken_off_run_is_discarded_only_when_asked() {
    let folder = folder();
    fs::create_dir(folder.path().join("run.partial")).unwrap();
    fs::write(folder.path().join("run.partial/task.toml"), "of a run that was killed").unwrap();
    let (_, stderr) = learn(folder.path(), 2, &["--out", "run"]);
    assert!(stderr.contains("run.partial"), "{stderr}");
    learn(folder.path(), 0, &["--out", "run", "--force"]);
}

#[test]
fn what_only_looks_like_a_broken_off_run_is_left_alone() {
    let folder = folder();
    for name in ["run.partial", "run.replaced", "run.replaced-0"] {
        fs::create_dir(folder.path().join(name)).unwrap();
        fs::write(folder.path().join(name).join("chapter1.txt"), "years of work").unwrap();
    }
    let (_, stderr) = learn(folder.path(), 2, &["--out", "run", "--force"]);
    assert!(stderr.contains("run.partial"), "{stderr}");
    fs::rename(folder.path().join("run.partial"), folder.path().join("thesis")).unwrap();
    learn(folder.path(), 0, &["--out", "run"]);
    learn(folder.path(), 0, &["--out", "run", "--force"]);
    for name in ["thesis", "run.replaced", "run.replaced-0"] {
        assert_eq!(read(folder.path().join(name).join("chapter1.txt")), "years of work");
    }
}

#[test]
fn a_finished_run_that_is_called_like_one_under_way_is_left_alone() {
    let folder = folder();
    for ending in ["beginning", "partial"] {
        let (_, stderr) = learn(folder.path(), 2, &["--out", &format!("run.{ending}")]);
        assert!(stderr.contains(&format!("names that end in .{ending} are those of runs under way")), "{stderr}");
        learn(folder.path(), 0, &["--out", "other"]);
        let named = folder.path().join(format!("run.{ending}"));
        fs::rename(folder.path().join("other"), &named).unwrap();
        let policy = fs::read(named.join("policy.json")).unwrap();
        for force in [&[][..], &["--force"]] {
            let (_, stderr) = learn(folder.path(), 2, &[&["--out", "run"], force].concat());
            assert!(stderr.contains("holds a finished run: move it"), "{stderr}");
        }
        assert_eq!(fs::read(named.join("policy.json")).unwrap(), policy);
        fs::rename(&named, folder.path().join(ending)).unwrap();
    }
}

#[test]
fn two_runs_do_not_share_a_place() {
    let folder = folder();
    let long = ["learn", &task("cantilever.toml"), "--out", "run", "--quiet", "--set", "learning.updates=1000000"];
    let long = [&long[..], &["--set", "learning.max_rollouts=100000000", "--set", "accept={}"]].concat();
    let mut first = crate::support::command(folder.path(), &long).spawn().unwrap();
    let lock = folder.path().join("run.partial/snapshots");
    while !lock.exists() {
        std::thread::sleep(core::time::Duration::from_millis(5));
    }
    for force in [&[][..], &["--force"]] {
        let (_, stderr) = learn(folder.path(), 2, &[&["--out", "run"], force].concat());
        assert!(stderr.contains("a run that is going on"), "{stderr}");
    }
    Command::new("kill").args(["-INT", &first.id().to_string()]).status().unwrap();
    assert_eq!(first.wait().unwrap().code(), Some(130));
    expect(0, folder.path(), &["run", "run"]);
}

#[cfg(unix)]
#[test]
fn a_link_leads_to_where_the_results_go() {
    let folder = folder();
    fs::create_dir(folder.path().join("disk")).unwrap();
    std::os::unix::fs::symlink("disk", folder.path().join("run")).unwrap();
    learn(folder.path(), 0, &["--out", "run"]);
    learn(folder.path(), 0, &["--out", "run", "--force", "--seed", "2"]);
    assert!(folder.path().join("run").is_symlink());
    assert!(read(folder.path().join("disk/task.toml")).contains("seed = 2"));
}

#[test]
fn a_place_that_cannot_be_written_is_named_and_nothing_is_left() {
    let folder = folder();
    fs::write(folder.path().join("file"), "").unwrap();
    let (_, stderr) = learn(folder.path(), 1, &["--out", "file/run"]);
    assert!(stderr.contains("cannot write") && stderr.contains("file"), "{stderr}");
    let (_, stderr) = learn(folder.path(), 1, &["--out", "/proc/hpf/run"]);
    assert!(stderr.contains("/proc/hpf"), "{stderr}");
}

/// Needs the right to mount a file system of a given size; where it is missing, the test says so and ends.
#[test]
fn a_full_disk_is_reported_and_leaves_nothing_half_written() {
    // Full at the first tables, at the log, in the middle of the figures.
    for size in ["size=64k", "size=160k", "size=300k"] {
        full_disk(size);
    }
}

fn full_disk(size: &str) {
    let folder = folder();
    let disk = folder.path().join("disk");
    fs::create_dir(&disk).unwrap();
    let disk_name = disk.display().to_string();
    let mounted = Command::new("mount").args(["-t", "tmpfs", "-o", size, "tmpfs", &disk_name]).output();
    if !mounted.is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: no right to mount a small disk here");
        return;
    }
    let out = disk.join("run").display().to_string();
    let result = std::panic::catch_unwind(|| {
        let (_, stderr) = learn(Path::new("."), 1, &["--out", &out]);
        assert!(stderr.contains("cannot write") && stderr.contains("space"), "{stderr}");
        assert!(!Path::new(&out).exists(), "no result under its final name");
        for folder in ["/run.partial", "/run.partial/plots", "/run.partial/snapshots"] {
            for entry in fs::read_dir(disk_name.clone() + folder).into_iter().flatten() {
                let name = entry.unwrap().file_name();
                assert!(!name.to_string_lossy().contains(".partial"), "half-written: {name:?}");
            }
        }
    });
    Command::new("umount").arg(&disk).status().expect("umount starts");
    if let Err(panic) = result {
        std::panic::resume_unwind(panic);
    }
}
