//! `hpf run`

use crate::support::{Columns, expect, folder, json, largest_difference, metric, read, task};

#[test]
fn a_policy_learned_at_100_hz_moves_the_same_at_1000_hz() {
    let folder = folder();
    // Bounds from the second order of the step; measured differences are smaller by an order of magnitude.
    for (name, axes, bound) in [
        ("cantilever", &["y"][..], 0.005e-3),
        ("cantilever_moving_load", &["y"], 0.005e-3),
        ("via_point", &["x", "y"], 0.05e-3),
    ] {
        expect(0, folder.path(), &["learn", &task(&format!("{name}.toml")), "--quiet", "--out", name]);
        let fast = format!("{name}-fast");
        expect(0, folder.path(), &["run", name, "--rate", "1000", "--out", &fast]);
        let (slow, fast) = (folder.path().join(name), folder.path().join(fast));
        let [slow, fast] = [slow, fast].map(|run| Columns::read(run.join("trajectory.csv")));
        for axis in axes {
            let column = format!("{axis}_position_m");
            let difference = largest_difference(&slow.column(&column), &fast.column(&column), 10);
            assert!(difference < bound, "{name} {axis}: {difference}");
        }
    }
}

#[test]
fn a_run_reports_the_measures_of_the_learning_again() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    let (stdout, _) = expect(0, folder.path(), &["run", "runs/reach", "--json"]);
    let again: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let summary = json(folder.path().join("runs/reach/summary.json"));
    assert_eq!(again["metrics"], summary["metrics"]);
    assert_eq!(again["cost"]["final"], summary["cost"]["final"]);
    assert_eq!(again["policy_sha256"], summary["policy_sha256"]);
}

#[test]
fn the_environment_can_be_changed_and_the_policy_cannot() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    let calm = ["run", "runs/reach", "--json", "--set", "disturbance.0.amplitude=0"];
    let (stdout, _) = expect(3, folder.path(), &calm);
    let calm: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(metric(&calm, "peak_offset"), 0.0, "no force, no give");
    for change in ["axis.0.goal=0.5", "stiffness.max=500", "learning.updates=3", "duration=2"] {
        let (_, stderr) = expect(2, folder.path(), &["run", "runs/reach", "--set", change]);
        assert!(stderr.contains("the policy decides"), "{stderr}");
    }
}

#[test]
fn a_policy_file_runs_in_a_task_that_is_named() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet"]);
    std::fs::copy(folder.path().join("runs/reach/policy.json"), folder.path().join("alone.json")).unwrap();
    let (_, stderr) = expect(2, folder.path(), &["run", "alone.json"]);
    assert!(stderr.contains("--task"), "{stderr}");
    expect(0, folder.path(), &["run", "alone.json", "--task", &task("reach.toml")]);
    let (_, stderr) = expect(2, folder.path(), &["run", "alone.json", "--task", &task("via_point.toml")]);
    assert!(stderr.contains("axes"), "{stderr}");
}

#[test]
fn damaged_policies_are_refused_by_the_place_of_the_damage() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--set", "learning.method=pi2"]);
    let path = folder.path().join("runs/reach/policy.json");
    let whole = read(&path);
    let damages: [(&str, &str, &str); 4] = [
        ("\"version\": 1", "\"version\": 2", "version"),
        ("\"beta\": 6.25", "\"beta\": 7.0", "axes[0].movement.beta"),
        ("\"max\": 400.0", "\"max\": 31.0", "axes[0].stiffness.weights"),
        ("\"unit\": \"m\",", "\"unit\": \"m\", \"colour\": 1,", "colour"),
    ];
    for (from, to, named) in damages {
        assert!(whole.contains(from), "{from}");
        std::fs::write(&path, whole.replacen(from, to, 1)).unwrap();
        let (_, stderr) = expect(2, folder.path(), &["run", "runs/reach"]);
        assert!(stderr.contains(named) && stderr.contains("policy.json"), "{stderr}");
    }
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    expect(2, folder.path(), &["run", "runs/reach"]);
}

#[test]
fn a_force_table_travels_with_the_run() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    std::fs::write(folder.path().join("data/push.csv"), "time_s,force_n\n0,0\n0.5,3\n1,0\n").unwrap();
    let text = read(task("reach.toml")).replace("kind = \"step\"", "kind = \"table\"\nfile = \"data/push.csv\"");
    let text = text.lines().filter(|line| !line.starts_with("amplitude") && !line.starts_with("start = 0.5"));
    let text = text.collect::<Vec<_>>().join("\n");
    std::fs::write(folder.path().join("pushed.toml"), text).unwrap();
    expect(0, folder.path(), &["learn", "pushed.toml", "--quiet", "--out", "run", "--set", "accept={}"]);
    std::fs::remove_dir_all(folder.path().join("data")).unwrap();
    let force = Columns::read(folder.path().join("run/trajectory.csv")).column("x_force_n");
    assert!((force[25] - 1.5).abs() < 1e-12 && (force[50] - 3.0).abs() < 1e-12);
    expect(0, folder.path(), &["run", "run"]);
}
