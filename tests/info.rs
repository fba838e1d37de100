//! `hpf info`

use crate::support::{expect, folder, task};

/// The method whose motions can be counted beforehand.
const PI2: &str = "learning.method=pi2";

#[test]
fn every_kind_of_file_is_described() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "run", "--set", PI2]);
    expect(0, folder.path(), &["export", "run", "--format", "binary"]);
    expect(0, folder.path(), &["export", "run", "--ros2"]);
    for (file, words) in [
        ("run", "reach: pi2, 100 updates, 2101 motions"),
        ("run/policy.json", "reach: a valid policy"),
        ("run/task.toml", "reach: a valid task"),
        ("run/policy.bin", "a packed skill, intact: 1 axes in f64"),
        ("run/log.mcap", "/hpf/state"),
        ("run/ros2.mcap", "geometry_msgs/msg/PoseStamped"),
    ] {
        let (stdout, _) = expect(0, folder.path(), &["info", file]);
        assert!(stdout.contains(words), "{file}: {stdout}");
        let (stdout, _) = expect(0, folder.path(), &["info", file, "--json"]);
        let object: serde_json::Value = serde_json::from_str(&stdout).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert!(object["format"].as_str().unwrap().starts_with("hpf-") && object["version"] == 1, "{file}: {object}");
    }
}

#[test]
fn runs_stand_side_by_side_with_the_keys_in_which_they_differ() {
    let folder = folder();
    let reach = task("reach.toml");
    expect(0, folder.path(), &["learn", &reach, "--quiet", "--out", "long", "--set", PI2]);
    let fewer = [
        "learn",
        &reach,
        "--quiet",
        "--out",
        "short",
        "--set",
        PI2,
        "--set",
        "learning.updates=2",
        "--set",
        "accept={}",
    ];
    expect(0, folder.path(), &fewer);
    let (stdout, _) = expect(0, folder.path(), &["info", "long", "short"]);
    let line = |name: &str| {
        let found = stdout.lines().rfind(|line| line.trim_start().starts_with(name));
        found.unwrap_or_else(|| panic!("no {name}: {stdout}")).split_whitespace().collect::<Vec<_>>()
    };
    assert_eq!(line("motions")[1..], ["2101", "43"]);
    assert_eq!(line("learning.updates")[1..], ["100", "2"]);
    assert_eq!(line("accept.max_goal_error")[1..], ["0.005", "-"]);
    let total = line("total");
    assert!(total.len() >= 4 && total[2] == "*", "more updates cost less: {total:?}");

    let (json, _) = expect(0, folder.path(), &["info", "long", "short", "--json"]);
    let object: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((object["format"].as_str(), object["runs"].as_array().unwrap().len()), (Some("hpf-comparison"), 2));
    let keys: Vec<&String> = object["differing_keys"].as_object().unwrap().keys().collect();
    assert_eq!(keys, ["accept.max_goal_error", "learning.updates"]);
    assert_eq!(object["differing_keys"]["learning.updates"], serde_json::json!([100, 2]));
    let [of_run, shown] =
        [crate::support::json(folder.path().join("short/summary.json")), object["runs"][1]["summary"].clone()];
    assert_eq!(of_run, shown);

    let (same, _) = expect(0, folder.path(), &["info", "long", "long", "short"]);
    assert!(same.contains("learning.updates") && !same.contains("change"), "{same}");
    let (same, _) = expect(0, folder.path(), &["info", "long", "long"]);
    assert!(same.contains("the tasks are the same"), "{same}");
    let (_, stderr) = expect(2, folder.path(), &["info", "long", "short/policy.json"]);
    assert!(stderr.contains("short/policy.json: this is no run"), "{stderr}");
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
