//! What reaches the terminal: no text of any source gives it orders.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::support::{expect, folder, hpf, json, read, task};

/// A title for the window, by both ways to begin such a sequence, and a turn of direction.
const ORDER: &str = "\u{1b}]0;owned\u{7}\u{9d}0;owned\u{9c}\u{202e}";

/// Runs hpf; nothing that a terminal obeys is in what it prints.
fn obeys(folder: &Path, arguments: &[&str]) -> String {
    let output = hpf(folder, arguments);
    let text = String::from_utf8([output.stdout, output.stderr].concat()).expect("what is printed is text");
    let obeyed = |sign: char| (sign.is_control() && sign != '\n') || sign == '\u{202e}';
    assert!(!text.chars().any(obeyed), "{arguments:?}: {text:?}");
    text
}

/// The same, and what was to be an order is in it as text. What reads the arguments takes sequences that begin with an
/// escape out of a message before this program sees it; the other way to begin one is shown there.
fn shows(folder: &Path, arguments: &[&str]) {
    let text = obeys(folder, arguments);
    let shown = ["\\u001b]0;owned", "␛]0;owned", "\\u009d0;owned"].iter().any(|order| text.contains(order));
    assert!(shown, "{arguments:?} does not show it: {text}");
}

#[test]
fn policies_and_summaries_give_no_orders() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "run"]);
    let mut policy = json(path("run/policy.json"));
    policy["task"] = ORDER.into();
    policy["axes"][0]["name"] = ORDER.into();
    policy["provenance"]["hpf"] = ORDER.into();
    fs::write(path("policy.json"), policy.to_string()).unwrap();
    for arguments in [&["check", "policy.json"][..], &["info", "policy.json"], &["check", "policy.json", "--json"]] {
        shows(folder.path(), arguments);
    }
    shows(folder.path(), &["run", "policy.json", "--task", "run/task.toml"]);
    let mut summary = json(path("run/summary.json"));
    for key in ["task", "method", "stopped_because"] {
        summary[key] = ORDER.into();
    }
    summary["metrics"][0]["name"] = ORDER.into();
    summary["cost"]["initial"][ORDER] = 1.0.into();
    fs::write(path("run/summary.json"), summary.to_string()).unwrap();
    shows(folder.path(), &["info", "run"]);
    shows(folder.path(), &["info", "run", "--json"]);
    shows(folder.path(), &["info", "run", "run"]);
    // Text that is no JSON at all is quoted in what is said of it.
    policy["format"] = ORDER.into();
    fs::write(path("other.json"), policy.to_string()).unwrap();
    let output = hpf(folder.path(), &["check", "other.json"]);
    assert!(!String::from_utf8(output.stderr).unwrap().contains('\u{1b}'));
}

#[test]
fn logs_give_no_orders() {
    let folder = folder();
    let mut writer = mcap::WriteOptions::new()
        .library(ORDER)
        .create(fs::File::create(folder.path().join("log.mcap")).unwrap())
        .unwrap();
    let metadata = BTreeMap::from([(ORDER.to_owned(), ORDER.to_owned())]);
    writer.write_metadata(&mcap::records::Metadata { name: ORDER.into(), metadata }).unwrap();
    let attachment = mcap::Attachment {
        log_time: 0,
        create_time: 0,
        name: ORDER.into(),
        media_type: ORDER.into(),
        data: std::borrow::Cow::Borrowed(b"x"),
    };
    writer.attach(&attachment).unwrap();
    let schema = writer.add_schema(ORDER, ORDER, b"").unwrap();
    writer.add_channel(schema, ORDER, ORDER, &BTreeMap::new()).unwrap();
    writer.finish().unwrap();
    drop(writer);
    for arguments in [&["info", "log.mcap"][..], &["info", "log.mcap", "--json"], &["recover", "log.mcap"]] {
        shows(folder.path(), arguments);
    }
}

#[test]
fn tables_and_tasks_give_no_orders() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let rows = "0,0\n0.1,0.1\n0.2,0.2\n0.3,0.3\n0.4,0.4\n";
    fs::write(path("header.csv"), format!("time_s,{ORDER}\n{rows}")).unwrap();
    fs::write(path("cell.csv"), format!("time_s,x_m\n{rows}0.5,{ORDER}\n")).unwrap();
    shows(folder.path(), &["imitate", "header.csv"]);
    shows(folder.path(), &["imitate", "cell.csv"]);
    fs::write(path("force.csv"), format!("time_s,force_n\n0,{ORDER}\n")).unwrap();
    let table = "\n[[disturbance]]\nkind = \"table\"\naxis = \"x\"\nfile = \"force.csv\"\n";
    fs::write(path("table.toml"), read(task("reach.toml")) + table).unwrap();
    shows(folder.path(), &["check", "table.toml"]);
    let escaped: String = ORDER.chars().map(|sign| format!("\\u{:04X}", u32::from(sign))).collect();
    for (name, line) in [
        ("key", format!("\"{escaped}\" = 1")),
        ("value", format!("name = '{ORDER}'")),
        ("comment", format!("dration = 1 # {ORDER}")),
    ] {
        fs::write(path("task.toml"), format!("{line}\n{}", read(task("reach.toml")))).unwrap();
        shows(folder.path(), &["check", "task.toml", "--color", "never"]);
        let output = hpf(folder.path(), &["check", "task.toml", "--color", "always"]);
        let text = String::from_utf8(output.stderr).unwrap();
        let orders: Vec<&str> = text.split('\u{1b}').skip(1).collect();
        let is_color = |order: &&str| {
            order
                .strip_prefix('[')
                .and_then(|rest| rest.split_once('m'))
                .is_some_and(|(codes, _)| codes.bytes().all(|byte| byte.is_ascii_digit() || byte == b';'))
        };
        assert!(!orders.is_empty() && orders.iter().all(is_color) && !text.contains('\u{9d}'), "{name}: {text:?}");
    }
}

#[test]
fn arguments_and_names_of_files_give_no_orders() {
    let folder = folder();
    let reach = task("reach.toml");
    let missing = format!("{ORDER}.toml");
    shows(folder.path(), &["check", &missing]);
    shows(folder.path(), &["check", &reach, "--set", &format!("{ORDER}=1")]);
    shows(folder.path(), &["check", &reach, "--set", &format!("name='{ORDER}'")]);
    shows(folder.path(), &["learn", &reach, &format!("--{ORDER}")]);
    shows(folder.path(), &["learn", &reach, "--color", ORDER]);
    fs::write(folder.path().join(&missing), read(&reach)).unwrap();
    shows(folder.path(), &["learn", &missing, "--quiet", "--out", ORDER]);
}

#[cfg(unix)]
#[test]
fn processes_give_no_orders() {
    let folder = folder();
    let text = "name = \"p\"\nduration = 1.0\nrate = 10.0\n[environment]\nkind = \"process\"\n\
        command = [\"sh\", \"answer.sh\"]\n[[axis]]\nname = \"x\"\nstart = 0.0\ngoal = 0.3\n\
        [stiffness]\ninitial = 100.0\nmin = 30.0\nmax = 400.0\n[damping]\ninitial = 50.0\nmin = 10.0\nmax = 100.0\n";
    fs::write(folder.path().join("p.toml"), text).unwrap();
    for answer in [ORDER.to_owned(), serde_json::json!({ "type": "error", "message": ORDER }).to_string()] {
        fs::write(folder.path().join("answer"), answer + "\n").unwrap();
        fs::write(folder.path().join("answer.sh"), "cat answer; cat > /dev/null\n").unwrap();
        obeys(folder.path(), &["learn", "p.toml", "--quiet", "--out", "o"]);
    }
}

#[cfg(unix)]
#[test]
fn help_and_version_tell_of_a_full_disk() {
    for arguments in ["--version", "--help", "learn --help"] {
        let script = format!("'{}' {arguments} > /dev/full", env!("CARGO_BIN_EXE_hpf"));
        let output = std::process::Command::new("sh").args(["-c", &script]).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(1) && stderr.contains("cannot write the result"), "{arguments}: {stderr}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_result_that_a_closed_stdout_loses_is_a_failure() {
    for arguments in ["--version", "--help", "learn --help", "schema"] {
        let script = format!("'{}' {arguments} >&-", env!("CARGO_BIN_EXE_hpf"));
        let output = std::process::Command::new("sh").args(["-c", &script]).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        let is_named = stderr == "error: cannot write the result: stdout is closed\n";
        assert!(output.status.code() == Some(1) && is_named, "{arguments}: {stderr}");
    }
    // Thrown away on purpose is not lost.
    let script = format!("'{}' --help > /dev/null", env!("CARGO_BIN_EXE_hpf"));
    assert!(std::process::Command::new("sh").args(["-c", &script]).status().unwrap().success());
}
