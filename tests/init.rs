//! `hpf init` and `hpf schema`

use std::fs;

use crate::process::has_python;
use crate::support::{expect, folder, hpf, read, root};

const KINDS: [&str; 8] =
    ["reach", "via_point", "cantilever", "cantilever_moving_load", "wall", "joint", "stochastic", "process"];

#[test]
fn every_kind_is_a_commented_task_that_is_valid_and_learns() {
    let folder = folder();
    for kind in KINDS {
        let (stdout, _) = expect(0, folder.path(), &["init", kind]);
        let file = format!("{kind}.toml");
        assert!(stdout.starts_with(&format!("{file}: a task of kind {kind}")), "{stdout}");
        let text = read(folder.path().join(&file));
        assert!(text.contains(&format!("hpf learn {file}")), "{text}");
        let uncommented: Vec<&str> = text
            .lines()
            .filter(|line| ["duration", "rate"].iter().any(|key| line.starts_with(key)) && !line.contains('#'))
            .collect();
        assert!(uncommented.is_empty(), "{kind}: {uncommented:?} say no unit");
        assert!(text.contains(&format!("\nname = \"{kind}\"\n")), "{text}");
        expect(0, folder.path(), &["check", &file]);
        if kind == "process" && !has_python() {
            continue;
        }
        // Whether they meet their targets, the tests of the shipped tasks say.
        let few = hpf(folder.path(), &["learn", &file, "--quiet", "--set", "learning.updates=3"]);
        assert!([Some(0), Some(3)].contains(&few.status.code()), "{kind}: {}", String::from_utf8_lossy(&few.stderr));
    }
    let (help, _) = expect(0, folder.path(), &["init", "--help"]);
    assert!(KINDS.iter().all(|kind| help.contains(&format!("- {kind}: "))), "{help}");
}

#[test]
fn a_task_is_named_after_its_file_and_replaces_nothing() {
    let folder = folder();
    expect(0, folder.path(), &["init", "reach", "--out", "mine/my_arm.toml"]);
    let file = folder.path().join("mine/my_arm.toml");
    let text = read(&file);
    assert!(text.contains("\nname = \"my_arm\"\n") && text.contains("hpf learn mine/my_arm.toml"), "{text}");
    fs::write(&file, "mine").unwrap();
    let (_, stderr) = expect(2, folder.path(), &["init", "wall", "--out", "mine/my_arm.toml"]);
    assert!(stderr.contains("--force"), "{stderr}");
    assert_eq!(read(&file), "mine");
    expect(0, folder.path(), &["init", "wall", "--out", "mine/my_arm.toml", "--force", "--json"]);
    assert!(read(&file).contains("kind = \"wall\""));
    let (stdout, _) = expect(0, folder.path(), &["init", "reach", "--out", "-"]);
    assert!(stdout.contains("\nname = \"reach\"\n"), "{stdout}");
    // A name that no task may have stays in the file's name.
    expect(0, folder.path(), &["init", "reach", "--out", "my arm.toml"]);
    expect(0, folder.path(), &["check", "my arm.toml"]);
    expect(2, folder.path(), &["init", "nothing"]);
    let (_, stderr) = expect(2, folder.path(), &["init", "reach", "--out", "new/"]);
    assert!(stderr.contains("new/: this is a directory: name a file with --out"), "{stderr}");
}

#[test]
fn a_task_of_a_process_comes_with_its_program_and_names_it() {
    let folder = folder();
    let arm = ["init", "process", "--out", "my lab/arm.toml"];
    let (stdout, _) = expect(0, folder.path(), &[&arm[..], &["--json"]].concat());
    assert!(stdout.contains("\"program\": \"my lab/arm.py\""), "{stdout}");
    let text = read(folder.path().join("my lab/arm.toml"));
    assert!(text.contains("command = [\"python3\", \"arm.py\"]"), "{text}");
    assert!(text.contains("its equation in arm.py,") && !text.contains("point_mass"), "{text}");
    if has_python() {
        let few = ["--quiet", "--set", "learning.updates=2", "--set", "accept={}"];
        expect(0, folder.path(), &[&["learn", "my lab/arm.toml"][..], &few].concat());
    }
    // Neither file is replaced where one of them stands.
    for (left, other) in [("arm.toml", "arm.py"), ("arm.py", "arm.toml")] {
        fs::remove_file(folder.path().join("my lab").join(other)).unwrap();
        let (_, stderr) = expect(2, folder.path(), &arm);
        assert!(stderr.contains(left) && stderr.contains("--force"), "{stderr}");
        assert!(!folder.path().join("my lab").join(other).exists(), "{other}");
        expect(0, folder.path(), &[&arm[..], &["--force"]].concat());
    }
    for out in ["-", "arm.py"] {
        let (_, stderr) = expect(2, folder.path(), &["init", "process", "--out", out]);
        assert!(stderr.contains("two files"), "{stderr}");
    }
}

#[test]
fn a_file_name_of_any_signs_leaves_a_task_that_is_valid() {
    let folder = folder();
    for name in ["x\nduration = 99\n.toml", "a b.toml"] {
        expect(0, folder.path(), &["init", "reach", "--out", name]);
        expect(0, folder.path(), &["check", name]);
    }
    assert!(read(folder.path().join("a b.toml")).contains("hpf learn 'a b.toml'"));
}

#[test]
fn the_schema_is_json_and_knows_the_keys_of_the_shipped_tasks() {
    let folder = folder();
    let (stdout, _) = expect(0, folder.path(), &["schema"]);
    let schema: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert!(schema["$schema"].as_str().unwrap().starts_with("https://json-schema.org/"));
    let paths = fs::read_dir(root().join("tasks")).unwrap().map(|entry| entry.unwrap().path());
    for path in paths.filter(|path| path.extension().is_some_and(|extension| extension == "toml")) {
        let text = read(path);
        let tables = text.lines().filter_map(|line| line.strip_prefix('[')?.trim_start_matches('[').split(']').next());
        for table in tables {
            assert!(schema["properties"][table].is_object(), "{table}");
        }
    }
    expect(0, folder.path(), &["schema", "--out", "task.schema.json"]);
    assert_eq!(read(folder.path().join("task.schema.json")), stdout);
    expect(2, folder.path(), &["schema", "--out", "task.schema.json"]);
}
