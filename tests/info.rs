//! `hpf info`

use crate::support::{expect, folder, task};

#[test]
fn every_kind_of_file_is_described() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "run"]);
    for (file, words) in [
        ("run", "reach: pi2, 100 updates, 2101 motions"),
        ("run/policy.json", "reach: a valid policy"),
        ("run/task.toml", "reach: a valid task"),
        ("run/log.mcap", "/hpf/state"),
    ] {
        let (stdout, _) = expect(0, folder.path(), &["info", file]);
        assert!(stdout.contains(words), "{file}: {stdout}");
        let (stdout, _) = expect(0, folder.path(), &["info", file, "--json"]);
        serde_json::from_str::<serde_json::Value>(&stdout).unwrap_or_else(|error| panic!("{file}: {error}"));
    }
}

#[test]
fn a_truncated_log_is_described_as_far_as_it_goes() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "run"]);
    let whole = std::fs::read(folder.path().join("run/log.mcap")).unwrap();
    std::fs::write(folder.path().join("cut.mcap"), &whole[..whole.len() / 2]).unwrap();
    let (stdout, _) = expect(0, folder.path(), &["info", "cut.mcap"]);
    assert!(stdout.contains("truncated") && stdout.contains("policy.json"), "{stdout}");
    std::fs::write(folder.path().join("rubbish.mcap"), b"no log at all").unwrap();
    expect(2, folder.path(), &["info", "rubbish.mcap"]);
}
