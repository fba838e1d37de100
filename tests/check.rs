//! `hpf check`, and what every command says of a bad task file.

use std::fs;
use std::path::Path;

use crate::support::{expect, folder, read, task};

/// The via point task with `from` replaced by `to`.
fn changed(folder: &Path, from: &str, to: &str) -> &'static str {
    let text = read(task("via_point.toml"));
    assert!(text.contains(from), "{from}");
    fs::write(folder.join("bad.toml"), text.replacen(from, to, 1)).unwrap();
    "bad.toml"
}

#[test]
fn shipped_tasks_are_valid() {
    let folder = folder();
    for name in
        ["via_point", "via_point_stochastic", "cantilever", "cantilever_moving_load", "cantilever_robot", "reach"]
    {
        let (stdout, _) = expect(0, folder.path(), &["check", &task(&format!("{name}.toml"))]);
        assert!(stdout.starts_with(&format!("{name}: a valid task")), "{stdout}");
    }
}

#[test]
fn each_mistake_is_answered_with_its_place_and_what_is_allowed() {
    let folder = folder();
    let mistakes = [
        ("rate = 100.0", "rate = 200000", "parameters at every step are 120000000 numbers"),
        ("rollouts = 18 ", "rollouts = 100001 ", "from 2 to 100000"),
        ("duration = 5.0", "duraton = 5.0", "unknown key `duraton`, did you mean `duration`?"),
        ("rate = 100.0", "rate = \"fast\"", "`rate` must be a number above 0"),
        ("rate = 100.0", "rate = 0", "`rate` must be a number above 0"),
        ("rate = 100.0", "rate = nan", "not a finite number"),
        ("rate = 100.0", "rate = -inf", "not a finite number"),
        ("time = 2.5", "time = 7.5", "no later than duration = 5 s"),
        ("name = \"y\"", "name = \"x\"", "two axes are called `x`"),
        ("min = 30.0", "min = 500.0", "above"),
        ("goal = 1.0", "goal = 0.0", "goal scaling"),
        ("basis = 20", "basis = 0", "from 2 to 1000"),
        ("basis = 20", "basis = 1", "from 2 to 1000"),
        ("position = [0.6, 0.8]", "position = [0.6]", "one number per axis"),
        ("kind = \"sine\"", "kind = \"sinus\"", "did you mean `sine`?"),
        ("axis = \"x\"", "axis = \"z\"", "no axis `z`"),
        ("method = \"pi2\"", "method = \"pi3\"", "did you mean `pi2`?"),
        ("[0, 100, 200, 600]", "[0, 100, 200, 100]", "kept twice"),
        ("goal = 1.0 ", "goal = [1.0 ", "missing comma"),
    ];
    for (from, to, words) in mistakes {
        let file = changed(folder.path(), from, to);
        for command in ["check", "learn"] {
            let (stdout, stderr) = expect(2, folder.path(), &[command, file]);
            assert!(stdout.is_empty());
            assert!(stderr.contains(words), "{to}: {words} is missing from\n{stderr}");
            assert!(has_place(&stderr, "bad.toml"), "{to}: no place in\n{stderr}");
        }
        assert!(!folder.path().join("runs").exists(), "nothing is written for a bad task");
    }
}

/// Whether a report names `file:line:column`.
fn has_place(report: &str, file: &str) -> bool {
    report.split(&format!("{file}:")).skip(1).any(|rest| {
        let mut numbers = rest.split(|c: char| !c.is_ascii_digit());
        [numbers.next(), numbers.next()].iter().all(|n| n.is_some_and(|n| !n.is_empty()))
    })
}

#[test]
fn a_negative_width_of_the_beam_is_refused() {
    let folder = folder();
    fs::write(folder.path().join("bad.toml"), read(task("cantilever.toml")).replace("width = 0.05", "width = -0.05"))
        .unwrap();
    let (_, stderr) = expect(2, folder.path(), &["learn", "bad.toml"]);
    assert!(stderr.contains("bad.toml:") && stderr.contains("`width` must be a number above 0"), "{stderr}");
}

#[test]
fn all_mistakes_are_shown_at_once() {
    let folder = folder();
    let text = read(task("via_point.toml"))
        .replace("decay = ", "decoy = ")
        .replace("period = 5.0", "period = 0")
        .replace("updates = 600", "updates = 0")
        .replace("time = 2.5", "time = 25");
    fs::write(folder.path().join("bad.toml"), text).unwrap();
    let (_, stderr) = expect(2, folder.path(), &["check", "bad.toml"]);
    for words in [
        "unknown key `decoy`, did you mean `decay`?",
        "`period` is out of range",
        "`updates` is out of range",
        "`time` must lie after 0 s",
        "5 mistakes in bad.toml",
    ] {
        assert!(stderr.contains(words), "{words} is missing from\n{stderr}");
    }
}

#[test]
fn what_is_no_task_file_is_refused() {
    let folder = folder();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    write("empty.toml", b"");
    write("blank.toml", b" \n\n");
    write("binary.toml", &[0x7f, b'E', b'L', b'F', 0xff, 0xfe, 0x00, 0x80]);
    write("zeros.toml", &[0; 4096]);
    write("broken.toml", b"name = \"x\nduration = ");
    for (file, words) in [
        ("empty.toml", "the file is empty"),
        ("blank.toml", "the file is empty"),
        ("binary.toml", "binary.toml:1:5: this is not text"),
        ("zeros.toml", "zeros.toml:1:1"),
        ("broken.toml", "broken.toml:1:"),
        ("missing.toml", "missing.toml: there is no such file"),
        (".", "this is a directory"),
    ] {
        for command in ["learn", "check"] {
            let (_, stderr) = expect(2, folder.path(), &[command, file]);
            assert!(stderr.contains(words), "{file}: {stderr}");
        }
    }
}

#[test]
fn bad_force_tables_are_answered_with_their_line() {
    let folder = folder();
    let text = read(task("reach.toml")).replace("kind = \"step\"", "kind = \"table\"\nfile = \"push.csv\"");
    let text: Vec<&str> =
        text.lines().filter(|line| !line.starts_with("amplitude") && !line.starts_with("start = 0.5")).collect();
    fs::write(folder.path().join("pushed.toml"), text.join("\n")).unwrap();
    for (table, words) in [
        ("time_s,force_n\n0,1\n1,x\n", "push.csv:3:3: `x` is not a number"),
        ("time_s,force_n\n0,1\n1\n", "push.csv:3:1: the row does not have two numbers"),
        ("time_s,force_n\n0,1\n0,2\n", "push.csv:3:1: the time does not rise"),
        ("time_s,force_n\n0,nan\n", "push.csv:2:1: a number is not finite"),
        ("time_s,force_n\n", "push.csv:1:1: the table has no row"),
        ("t,f\n0,1\n", "push.csv:1:1: the header must be time_s,force_n"),
    ] {
        fs::write(folder.path().join("push.csv"), table).unwrap();
        let (_, stderr) = expect(2, folder.path(), &["check", "pushed.toml"]);
        assert!(stderr.contains(words), "{words} is missing from {stderr}");
    }
    fs::remove_file(folder.path().join("push.csv")).unwrap();
    let (_, stderr) = expect(2, folder.path(), &["check", "pushed.toml"]);
    assert!(stderr.contains("push.csv: there is no such file"), "{stderr}");
}

#[test]
fn a_full_stderr_or_stdout_changes_no_exit_code_but_a_lost_result_does() {
    let folder = folder();
    let full = || fs::File::create("/dev/full").unwrap();
    let run = |arguments: &[&str]| crate::support::command(folder.path(), arguments);
    assert_eq!(run(&["check", "nowhere.toml"]).stderr(full()).status().unwrap().code(), Some(2));
    let learn = ["learn", &task("reach.toml")];
    assert_eq!(run(&learn).stderr(full()).stdout(std::process::Stdio::null()).status().unwrap().code(), Some(0));
    assert_eq!(
        run(&["check", &task("reach.toml")])
            .stdout(full())
            .stderr(std::process::Stdio::null())
            .status()
            .unwrap()
            .code(),
        Some(1)
    );
}

#[test]
fn overrides_are_checked_like_the_file() {
    let folder = folder();
    let file = task("via_point.toml");
    for (change, words) in [
        ("learning.udates=3", "did you mean `updates`?"),
        ("learning.updates=many", "`updates` must be a whole number"),
        ("via_point.1.time=2", "there is no `1`"),
        ("rate", "key.path=value"),
        ("rate=[", "not a TOML value"),
    ] {
        let (_, stderr) = expect(2, folder.path(), &["check", &file, "--set", change]);
        assert!(stderr.contains(words), "{change}: {stderr}");
    }
    let (stdout, _) = expect(
        0,
        folder.path(),
        &["check", &file, "--set", "learning.updates=3", "--set", "output={}", "--set", "rate=1000"],
    );
    assert!(stdout.contains("5000 steps") && stdout.contains("3 updates"), "{stdout}");
}

#[test]
fn bad_arguments_exit_with_2() {
    let folder = folder();
    for arguments in
        [&["lern"][..], &["learn"], &["learn", "x", "--threads", "0"], &["learn", "x", "--seed", "one"], &["run"], &[]]
    {
        expect(2, folder.path(), arguments);
    }
}

#[test]
fn contradictions_are_told_beside_mistakes_of_type() {
    let folder = folder();
    let text = read(task("reach.toml"));
    assert!(text.contains("\nrate = "), "{text}");
    let text = text.replacen("\nrate = ", "\nrate = \"fast\" # ", 1);
    let contradiction = "\n[[via_point]]\ntime = 99.0\nposition = [0.1, 0.2]\n[[disturbance]]\nkind = \"step\"\naxis = \"q\"\nforce = \"much\"\n";
    fs::write(folder.path().join("t.toml"), text + contradiction).unwrap();
    let (_, stderr) = expect(2, folder.path(), &["check", "t.toml"]);
    for words in [
        "`rate` cannot be a text",
        "the via point at 99 s lies outside",
        "a position with 2 numbers",
        "unknown key `force`",
        "disturbance has no `amplitude`",
        "there is no axis `q`",
    ] {
        assert!(stderr.contains(words), "{words}: {stderr}");
    }
    assert!(!stderr.contains("steps"), "what hangs on the rate is not told: {stderr}");
}

#[test]
fn whole_numbers_that_no_reader_takes_are_refused_where_they_stand() {
    let folder = folder();
    let largest = i64::MAX.to_string();
    for key in ["seed", "max_rollouts"] {
        for (number, code) in [(largest.as_str(), 0), ("9223372036854775808", 2), ("18446744073709551615", 2)] {
            let text = format!("{}\n", read(task("reach.toml")));
            let text = text.replacen("[learning]", &format!("[learning]\n{key} = {number}"), 1);
            let text = text.lines().filter(|line| !line.starts_with(key) || line.contains(number)).collect::<Vec<_>>();
            fs::write(folder.path().join("t.toml"), text.join("\n") + "\n").unwrap();
            let (_, stderr) = expect(code, folder.path(), &["check", "t.toml"]);
            assert!(
                code == 0 || (stderr.contains(&format!("`{key}` is out of range")) && stderr.contains(&largest)),
                "{stderr}"
            );
            let learn = ["learn", "t.toml", "--quiet", "--force", "--out", "o", "--set", "learning.updates=1"];
            expect(code, folder.path(), &[&learn[..], &["--set", "accept={}"]].concat());
        }
    }
    let (schema, _) = expect(0, folder.path(), &["schema"]);
    let schema: serde_json::Value = serde_json::from_str(&schema).unwrap();
    for key in ["seed", "max_rollouts"] {
        assert_eq!(schema["$defs"]["Learning"]["properties"][key]["maximum"].as_i64(), Some(i64::MAX), "{key}");
    }
}

#[test]
fn the_force_error_is_judged_after_the_time_that_the_task_says() {
    let folder = folder();
    let measure = |time: &str| {
        let change = format!("accept.settling_time={time}");
        let cantilever = task("cantilever.toml");
        let arguments = [
            "learn",
            &cantilever,
            "--quiet",
            "--force",
            "--out",
            "o",
            "--json",
            "--set",
            "learning.updates=1",
            "--set",
            "learning.method=pi2",
            "--set",
            "accept={}",
            "--set",
            &change,
        ];
        let (stdout, _) = expect(0, folder.path(), &arguments);
        crate::support::metric(&serde_json::from_str(&stdout).unwrap(), "max_force_error")
    };
    let columns = |time: f64| {
        let table = crate::support::Columns::read(folder.path().join("o/trajectory.csv"));
        let set_point = 10.0;
        let rows = table.column("time_s").into_iter().zip(table.column("contact_force_n"));
        rows.filter(|(t, _)| *t >= time && *t <= 5.0).map(|(_, force)| (force - set_point).abs()).fold(0.0, f64::max)
    };
    for (text, time) in [("0.0", 0.0), ("0.1", 0.1), ("2.0", 2.0)] {
        let found = measure(text);
        assert!((found - columns(time)).abs() < 1e-12, "{text}: {found}");
    }
    let (_, stderr) = expect(2, folder.path(), &["check", &task("reach.toml"), "--set", "accept.settling_time=1"]);
    assert!(stderr.contains("`accept.settling_time` has nothing to measure"), "{stderr}");
}
