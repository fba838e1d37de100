//! Recordings that once went wrong, through the program: what is right of each is stated beside it, in its folder's README.

use std::path::Path;

use serde_json::Value;

use crate::support::{Columns, expect, folder, json};

fn case(name: &str) -> String {
    format!("{}/../../tests/recordings/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Imitates the files of a case; the answer in the terminal and the summary.
fn imitate(folder: &Path, files: &[&str], options: &[&str]) -> (String, Value) {
    let files: Vec<String> = files.iter().map(|name| case(name)).collect();
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let (stdout, _) = expect(0, folder, &[&["imitate", "--force", "--out", "o"], files.as_slice(), options].concat());
    (stdout, json(folder.join("o/summary.json")))
}

fn reference(folder: &Path, column: &str) -> Vec<f64> {
    Columns::read(folder.join("o/trajectory.csv")).column(column)
}

#[test]
fn case_01_a_hump_between_a_start_and_a_goal_nearly_alike_keeps_its_height() {
    let folder = folder();
    imitate(folder.path(), &["01_goal_scaling/a.csv", "01_goal_scaling/b.csv"], &[]);
    let table = Columns::read(folder.path().join("o/demonstrations.csv"));
    let [made, a, b] =
        ["z_reference_m", "z_demonstration_1_m", "z_demonstration_2_m"].map(|column| table.column(column));
    let error = |i: usize| (made[i] - 0.5 * (a[i] + b[i])).abs();
    // With --scaling range 0.07 mm; goal scaling was off by 35 mm.
    let most = (0..made.len()).map(error).fold(0.0, f64::max);
    assert!(most < 0.3e-3, "{most}");
}

#[test]
fn case_02_the_mean_of_two_angles_beside_half_a_turn_is_half_a_turn() {
    let folder = folder();
    let (stdout, summary) = imitate(folder.path(), &["02_plus_minus_pi/a.csv", "02_plus_minus_pi/b.csv"], &[]);
    let yaw = reference(folder.path(), "yaw_reference_rad")[0];
    assert!((yaw.abs() - core::f64::consts::PI).abs() < 1e-6, "{yaw}");
    assert!(stdout.contains("is turned by 1 turns"), "{stdout}");
    // 0.083 rad apart at the start: each half of it from their mean.
    let spread = summary["imitation"]["axes"][0]["spread_rad"].as_f64().unwrap();
    assert!((0.02..0.06).contains(&spread), "{spread}");
}

#[test]
fn case_04_stiffness_from_force_is_right_mended_or_noted() {
    let folder = folder();
    let options = ["--stiffness-from", "force", "--path", "reference"];
    for (name, note) in [("right", ""), ("negative", "its sign is turned"), ("tare", "rest level of 5.000 N")] {
        let (stdout, _) = imitate(folder.path(), &[&format!("04_force_bounds/{name}.csv")], &options);
        assert!(stdout.contains(note), "{name}: {stdout}");
        let [stiffness, damping] =
            ["x_stiffness_n_m", "x_damping_n_s_m"].map(|column| reference(folder.path(), column));
        assert!(stiffness.iter().all(|k| (k - 200.0).abs() < 4.0), "{name}: {stiffness:?}");
        assert!(damping.iter().all(|d| (d - 20.0).abs() < 1.0), "{name}: {damping:?}");
        assert!(!stdout.contains("held within its bounds"), "{name}: {stdout}");
    }
    let (stdout, _) = imitate(folder.path(), &["04_force_bounds/stiff.csv"], &options);
    assert!(stdout.contains("the force says stiffness from") && stdout.contains("30 to 400"), "{stdout}");
}

#[test]
fn case_05_a_bridged_gap_keeps_the_rate() {
    let folder = folder();
    let file = case("05_gap/a.csv");
    let (_, stderr) = expect(2, folder.path(), &["imitate", &file]);
    assert!(stderr.contains("no sample between lines") && stderr.contains("--bridge"), "{stderr}");
    let (stdout, _) = imitate(folder.path(), &["05_gap/a.csv"], &["--bridge"]);
    assert!(stdout.contains("at 100 Hz") && stdout.contains("which is a guess"), "{stdout}");
}

#[test]
fn case_06_nanoseconds_are_read_by_the_option_that_the_refusal_names() {
    let folder = folder();
    let (_, stderr) = expect(2, folder.path(), &["imitate", &case("06_time_unit/ns.csv")]);
    assert!(stderr.contains("--time time_s:ns"), "{stderr}");
    let (stdout, _) = imitate(folder.path(), &["06_time_unit/ns.csv"], &["--time", "time_s:ns"]);
    assert!(stdout.contains("a policy of 2 s") && stdout.contains("at 20 Hz"), "{stdout}");
}

#[test]
fn case_07_the_spread_is_that_of_the_recordings_as_recorded() {
    let folder = folder();
    let (_, summary) = imitate(folder.path(), &["07_spread_told/a.csv", "07_spread_told/b.csv"], &[]);
    let axis = &summary["imitation"]["axes"][0];
    assert!((axis["spread_m"].as_f64().unwrap() - 25.25e-3).abs() < 0.05e-3, "{axis}");
    assert!((axis["aligned_spread_m"].as_f64().unwrap() - 0.30e-3).abs() < 0.05e-3, "{axis}");
    let table = Columns::read(folder.path().join("o/demonstrations.csv"));
    assert!((table.column("x_demonstration_2_m")[0] - 0.05).abs() < 1e-9, "as it was recorded");
}

#[test]
fn case_09_an_axis_that_never_moves_is_held_constant_and_the_others_go_on() {
    let folder = folder();
    let (stdout, summary) = imitate(folder.path(), &["09_still_axis/a.csv", "09_still_axis/b.csv"], &[]);
    assert!(stdout.contains("axis `z`: the demonstrations spread alike everywhere"), "{stdout}");
    let from: Vec<&str> = (0..2).map(|i| summary["imitation"]["axes"][i]["stiffness_from"].as_str().unwrap()).collect();
    assert_eq!(from, ["spread", "constant"]);
}

#[test]
fn cases_08_15_16_21_are_read_as_they_are() {
    let folder = folder();
    for name in ["08_nan_in_unread/a.csv", "15_axis_names/a.csv", "16_commented_header/a.csv"] {
        imitate(folder.path(), &[name], &[]);
    }
    for name in ["21_burst_stamps/a.csv", "21_burst_stamps/b.csv"] {
        let (stdout, _) = imitate(folder.path(), &[name], &[]);
        assert!(stdout.contains("1 time stamps, the first in line 22"), "{stdout}");
        let path = reference(folder.path(), "x_reference_m");
        for (i, x) in path.iter().enumerate().take(41) {
            let u = i as f64 / 40.0;
            let made = 0.3 * u * u * u * (10.0 - u * (15.0 - 6.0 * u));
            // 20 functions over 40 steps; it was off by 8 m and by 41 mm.
            assert!((x - made).abs() < 0.5e-3, "{name}: {x} {made}");
        }
    }
}

#[test]
fn cases_13_and_18_a_log_is_counted_whole() {
    let folder = folder();
    let info = |name: &str| expect(0, folder.path(), &["info", &case(name)]).0;
    let stdout = info("13_mcap_message_without_channel/a.mcap");
    assert!(
        stdout.contains("3 messages") && stdout.contains("1 message of channel 9, which nothing defines"),
        "{stdout}"
    );
    let stdout = info("18_mcap_two_in_one/a.mcap");
    assert!(stdout.contains("2 logs one behind the other"), "{stdout}");
    let kept =
        expect(0, folder.path(), &["recover", &case("18_mcap_two_in_one/a.mcap"), "--json", "--out", "r.mcap"]).0;
    let recovered: Value = serde_json::from_str(&kept).unwrap();
    let told: Value =
        serde_json::from_str(&expect(0, folder.path(), &["info", &case("18_mcap_two_in_one/a.mcap"), "--json"]).0)
            .unwrap();
    assert_eq!(told["messages"], recovered["messages"], "{told} {recovered}");
}

#[test]
fn a_file_of_other_names_is_read_by_the_command_that_is_offered() {
    let folder = folder();
    let rows: String = (0..51)
        .map(|i| {
            let u = f64::from(i) / 50.0;
            let s = u * u * u * (10.0 - u * (15.0 - 6.0 * u));
            format!("{},{},{}\n", 1_700_000_000_000_000_000_u64 + 20_000_000 * i as u64, 300.0 * s, 100.0 * s)
        })
        .collect();
    std::fs::write(folder.path().join("hand.csv"), format!("stamp,px,py\n{rows}")).unwrap();
    let (stdout, _) = expect(0, folder.path(), &["info", "hand.csv"]);
    let command = stdout.lines().find_map(|line| line.strip_prefix("next: hpf ")).unwrap();
    assert_eq!(command, "imitate hand.csv --time stamp:ns --axis x=px:mm --axis y=py:mm");
    let (_, stderr) = expect(2, folder.path(), &["imitate", "hand.csv"]);
    assert!(stderr.contains(&format!("try: hpf {command}")), "{stderr}");
    let words: Vec<&str> = command.split(' ').collect();
    let (stdout, _) = expect(0, folder.path(), &[words.as_slice(), &["--out", "o"]].concat());
    assert!(stdout.contains("a policy of 1 s") && stdout.contains("at 50 Hz"), "{stdout}");
    assert!((reference(folder.path(), "x_reference_m")[50] - 0.3).abs() < 1e-3);
}

#[test]
fn the_log_of_a_run_is_a_recording_of_it() {
    let folder = folder();
    let wipe = crate::support::task("demonstrations/wipe.csv");
    expect(0, folder.path(), &["imitate", &wipe]);
    expect(0, folder.path(), &["imitate", "runs/wipe/log.mcap", "--out", "again"]);
    let policy = json(folder.path().join("again/policy.json"));
    let units: Vec<&str> =
        policy["axes"].as_array().unwrap().iter().map(|axis| axis["unit"].as_str().unwrap()).collect();
    assert_eq!(units, ["m", "m"], "the log's own task states the units of its axes");
}
