//! `hpf report`

use std::fs;

use serde_json::Value;

use crate::support::{expect, folder, read, task};

/// The data inside a page.
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once("id=\"data\">").expect("a page has data");
    serde_json::from_str(rest.split_once("</script>").unwrap().0).expect("the data is JSON")
}

#[test]
fn a_run_is_one_page_with_what_it_holds() {
    let folder = folder();
    let few = ["--set", "learning.updates=10", "--set", "output.snapshots=[0,10]", "--set", "accept={}"];
    let file = task("cantilever.toml");
    let learn = [&["learn", &file, "--quiet", "--out", "run", "--report"][..], &few].concat();
    let (stdout, _) = expect(0, folder.path(), &learn);
    assert!(stdout.contains("report.html"), "{stdout}");
    let page = read(folder.path().join("run/report.html"));
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
    let data = data(&page);
    let run = &data["runs"][0];
    assert_eq!(run["task"], read(folder.path().join("run/task.toml")));
    assert_eq!(run["policy"], read(folder.path().join("run/policy.json")));
    let summary: Value = serde_json::from_str(&read(folder.path().join("run/summary.json"))).unwrap();
    assert_eq!(run["summary"], summary);
    assert_eq!(run["snapshots"].as_array().unwrap().len(), 2);
    assert_eq!(run["learning"]["total"][0], summary["cost"]["initial"]["total"]);
    // The same run gives the same page, and one that is there stays.
    let (_, stderr) = expect(2, folder.path(), &["report", "run"]);
    assert!(stderr.contains("--force"), "{stderr}");
    expect(0, folder.path(), &["report", "run", "--out", "again.html"]);
    assert!(page == read(folder.path().join("again.html")));
}

#[test]
fn columns_are_those_of_the_trajectory() {
    let folder = folder();
    let few = ["--set", "learning.updates=5", "--set", "accept={}"];
    let file = task("reach.toml");
    let learn = [&["learn", &file, "--quiet", "--out", "run", "--report"][..], &few].concat();
    expect(0, folder.path(), &learn);
    let data = data(&read(folder.path().join("run/report.html")));
    let text = data["runs"][0]["trace"]["axes"][0]["position"].as_str().unwrap().to_owned();
    let shown = numbers(&text);
    let table = read(folder.path().join("run/trajectory.csv"));
    let mut rows = table.lines();
    let at = rows.next().unwrap().split(',').position(|name| name == "x_position_m").unwrap();
    let kept: Vec<f32> = rows.map(|row| row.split(',').nth(at).unwrap().parse::<f64>().unwrap() as f32).collect();
    assert_eq!(shown, kept);
}

/// Numbers of 32 bits, smallest byte first, in base 64.
fn numbers(text: &str) -> Vec<f32> {
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let (mut bytes, mut held, mut bits) = (Vec::new(), 0_u32, 0);
    for letter in text.bytes().filter(|letter| *letter != b'=') {
        held = (held << 6) | alphabet.iter().position(|one| *one == letter).unwrap() as u32;
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push((held >> bits) as u8);
            held &= (1 << bits) - 1;
        }
    }
    bytes.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect()
}

#[test]
fn several_runs_need_a_place_and_tasks_need_no_run() {
    let folder = folder();
    let (reach, wall) = (task("reach.toml"), task("wall.toml"));
    let (_, stderr) = expect(2, folder.path(), &["report", &reach, &wall]);
    assert!(stderr.contains("--out"), "{stderr}");
    expect(0, folder.path(), &["report", &reach, &wall, "--out", "playground/index.html"]);
    let data = data(&read(folder.path().join("playground/index.html")));
    assert_eq!(data["runs"][1]["outline"]["contact"]["movable"], true);
    assert_eq!(data["runs"][0]["policy"], Value::Null);
    let (stdout, _) = expect(0, folder.path(), &["report", &reach, "--json"]);
    let said: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(said["file"], "reach.html");
    assert_eq!(said["bytes"], fs::metadata(folder.path().join("reach.html")).unwrap().len());
    let (_, stderr) = expect(2, folder.path(), &["report", &reach, &reach, "--out", "x.html"]);
    assert!(stderr.contains("named twice"), "{stderr}");
}

#[test]
fn what_is_no_run_is_refused_by_name() {
    let folder = folder();
    let (_, stderr) = expect(2, folder.path(), &["report", "nowhere"]);
    assert!(stderr.contains("nowhere"), "{stderr}");
    let few = ["--set", "learning.updates=5", "--set", "accept={}", "--quiet", "--out", "run"];
    let file = task("reach.toml");
    expect(0, folder.path(), &[&["learn", &file[..]][..], &few].concat());
    fs::write(folder.path().join("run/summary.json"), "{}").unwrap();
    let (_, stderr) = expect(2, folder.path(), &["report", "run"]);
    assert!(stderr.contains("summary.json"), "{stderr}");
    assert!(!folder.path().join("run/report.html").exists());
}
