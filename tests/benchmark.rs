//! `hpf benchmark`

use std::fs;

use crate::support::{expect, folder, json, read};

#[test]
fn every_method_is_measured_on_the_tasks_that_are_named() {
    let folder = folder();
    let arguments = ["benchmark", "--task", "reach,dmpbbo_via_point", "--seeds", "2", "--motions", "150", "--out", "b"];
    let (stdout, _) = expect(0, folder.path(), &arguments);
    let page = read(folder.path().join("b/benchmarks.md"));
    let data = json(folder.path().join("b/benchmarks.json"));
    assert_eq!((&data["format"], &data["version"]), (&"hpf-benchmark".into(), &1.into()));
    assert_eq!(data["results"].as_array().unwrap().len(), 10);
    for task in ["reach", "dmpbbo_via_point"] {
        assert!(page.contains(&format!("## {task}\n")) && stdout.contains(task));
        let figure = fs::read(folder.path().join(format!("b/images/benchmarks/{task}.png"))).unwrap();
        assert!(figure.starts_with(b"\x89PNG"));
    }
    for method in ["paper", "pi2", "pi-bb", "auto", "cma-es"] {
        assert_eq!(page.matches(&format!("| `{method}` |")).count(), 2, "{method}");
    }
    // Learning from signals reaches the lowest level of the first task with all seeds, the paper's PI2 none.
    let lowest = |method: &str| {
        let found = data["results"].as_array().unwrap().iter().find(|r| r["task"] == "reach" && r["method"] == method);
        found.unwrap()["levels"][2].clone()
    };
    assert_eq!(lowest("auto")["seeds"], 2);
    assert!(lowest("auto")["motions"]["largest"].as_f64().unwrap() <= 150.0);
    assert_eq!(lowest("paper")["seeds"], 0);
    assert!(lowest("paper")["motions"]["median"].is_null());

    let (_, stderr) = expect(2, folder.path(), &arguments);
    assert!(stderr.contains("b/benchmarks.md exists and is left as it is"), "{stderr}");
    fs::write(folder.path().join("file"), "").unwrap();
    for command in ["benchmark", "reproduce"] {
        let (_, stderr) = expect(1, folder.path(), &[command, "--out", "file/under"]);
        assert!(stderr.starts_with("error: cannot write file/under"), "before anything is learned: {stderr}");
    }
    let (_, stderr) = expect(2, folder.path(), &["benchmark", "--task", "walls"]);
    assert!(stderr.contains("there is no task `walls` to compare on; there are: via_point, cantilever"), "{stderr}");
}

#[test]
fn a_history_grows_by_a_row_for_each_task_and_method_and_keeps_other_versions() {
    const HEADER: &str = "version,task,method,seeds,max_motions,median_motions,median_cost,worst_cost";
    let folder = folder();
    let older = "0.0.1,reach,auto,1-2,150,90.0,0.5,0.6";
    fs::write(folder.path().join("history.csv"), format!("{HEADER}\n{older}\n")).unwrap();
    let run = |code: i32, history: &str| {
        let arguments = ["benchmark", "--task", "reach", "--seeds", "2", "--motions", "150", "--quiet", "--force"];
        expect(code, folder.path(), &[&arguments[..], &["--out", "b", "--history", history]].concat())
    };
    run(0, "history.csv");
    let text = read(folder.path().join("history.csv"));
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!((lines.len(), lines[0], lines[1]), (7, HEADER, older));
    let data = json(folder.path().join("b/benchmarks.json"));
    for (line, result) in lines[2..].iter().zip(data["results"].as_array().unwrap()) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells[..2], [env!("CARGO_PKG_VERSION"), "reach"]);
        assert_eq!((cells[2], cells[3], cells[4]), (result["method"].as_str().unwrap(), "1-2", "150"));
        let cost = |cell: usize, which: &str| {
            assert_eq!(cells[cell].parse::<f64>().ok(), result["final_cost"][which].as_f64(), "{line}");
        };
        cost(6, "median");
        cost(7, "largest");
        assert!(cells[5].parse::<f64>().unwrap() <= 150.0, "{line}");
    }
    // The same version measures the same again: the file stays as it is.
    run(0, "history.csv");
    assert_eq!(read(folder.path().join("history.csv")), text);
    // What is no history is refused before anything is learned.
    let (_, stderr) = run(2, "b/benchmarks.json");
    assert!(stderr.contains("b/benchmarks.json: this is no history of benchmarks"), "{stderr}");
}
