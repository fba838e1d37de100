//! Options of every command, completions and the manual.

use std::fs;
use std::process::Command;

use crate::support::{expect, folder, read, task};

const COMMANDS: [&str; 15] = [
    "learn",
    "sweep",
    "reproduce",
    "benchmark",
    "run",
    "imitate",
    "plot",
    "check",
    "export",
    "info",
    "recover",
    "init",
    "schema",
    "completions",
    "manual",
];

#[test]
fn an_option_whose_result_a_command_does_not_have_is_refused_and_the_others_hold() {
    let folder = folder();
    let reach = task("reach.toml");
    for arguments in [
        &["check", &reach, "--out", "there"][..],
        &["--out", "there", "info", &reach],
        &["completions", "bash", "--json"],
    ] {
        let (_, stderr) = expect(2, folder.path(), arguments);
        assert!(stderr.contains("means nothing to hpf "), "{arguments:?}: {stderr}");
    }
    for command in ["check", "info"] {
        let (plain, _) = expect(0, folder.path(), &[command, &reach]);
        let (same, _) = expect(0, folder.path(), &[command, &reach, "--force", "--threads", "2", "--quiet"]);
        assert_eq!(plain, same);
    }
    assert!(!folder.path().join("there").exists());
}

#[test]
fn common_options_work_before_and_after_the_command() {
    let folder = folder();
    let reach = task("reach.toml");
    let options = ["--seed", "2", "--threads", "1", "--out", "run", "--force", "--json", "--quiet", "--color", "never"];
    let (before, _) = expect(0, folder.path(), &[&options[..], &["learn", &reach]].concat());
    let log = fs::read(folder.path().join("run/log.mcap")).unwrap();
    let (after, _) = expect(0, folder.path(), &[&["learn", &reach][..], &options].concat());
    let [before, after] = [before, after].map(|text| serde_json::from_str::<serde_json::Value>(&text).unwrap());
    assert_eq!((&before["seed"], &before["cost"]), (&after["seed"], &after["cost"]));
    assert_eq!((before["seed"].as_u64(), before["threads"].as_u64()), (Some(2), Some(1)));
    assert!(fs::read(folder.path().join("run/log.mcap")).unwrap() == log);
}

#[test]
fn every_command_has_help_with_examples_and_a_manual_page() {
    let folder = folder();
    expect(0, folder.path(), &["manual", "--out", "man/man1"]);
    expect(2, folder.path(), &["manual", "--out", "man/man1"]);
    let (main, _) = expect(0, folder.path(), &["--help"]);
    for command in COMMANDS {
        assert!(main.contains(&format!("\n  {command} ")), "{main}");
        let (help, _) = expect(0, folder.path(), &[command, "--help"]);
        assert!(help.contains("\nExample") && help.contains(&format!("  hpf {command}")), "{help}");
        let page = read(folder.path().join(format!("man/man1/hpf-{command}.1")));
        assert!(page.contains(".SH SYNOPSIS") && page.contains("Example"), "{page}");
    }
    assert!(read(folder.path().join("man/man1/hpf.1")).contains("Exit codes"));
}

#[test]
fn completions_know_every_command_in_every_shell() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (script, _) = expect(0, folder.path(), &["completions", shell]);
        assert!(COMMANDS.iter().all(|command| script.contains(command)), "{shell}");
    }
    expect(0, folder.path(), &["completions", "bash", "--out", "hpf.bash"]);
    let output =
        Command::new("bash").current_dir(folder.path()).args(["-n", "hpf.bash"]).output().expect("bash starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn numbers_that_cannot_be_are_refused_with_what_is_allowed() {
    let folder = folder();
    let cases = [
        (&["learn", "t.toml", "--seed", "99999999999999999999"][..], "a whole number from 0 to 9223372036854775807"),
        (&["learn", "t.toml", "--seed", "-1"], "a whole number from 0 to 9223372036854775807"),
        (&["learn", "t.toml", "--threads", "0"], "a whole number from 1 to 1024"),
        (&["imitate", "d.csv", "--basis", "99999999999999999999"], "a whole number from 2 to 1000"),
        (&["imitate", "d.csv", "--alpha", "nan"], "it must be a number"),
        (&["imitate", "d.csv", "--decay", "inf"], "it must be a number"),
        (&["run", "policy.json", "--rate", "nan"], "it must be a number"),
        (&["sweep", "t.toml", "--seeds", "1001"], "a whole number from 1 to 1000"),
        (&["benchmark", "--motions", "10"], "a whole number from 100 to 10000000"),
    ];
    for (arguments, allowed) in cases {
        let (_, error) = expect(2, folder.path(), arguments);
        assert!(error.contains(allowed) && error.contains(arguments[arguments.len() - 1]), "{arguments:?}: {error}");
    }
    let reach = task("reach.toml");
    for number in ["99999999999999999999", "1e400"] {
        let (_, error) = expect(2, folder.path(), &["check", &reach, "--set", &format!("learning.updates={number}")]);
        let reason = "is not a TOML value: numbers are finite, whole ones have 64 bits with a sign";
        assert!(error.contains(reason), "{error}");
    }
}
