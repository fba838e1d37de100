//! What tired users and broken disks hand over: no command panics, and every refusal names the file.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};

use crate::support::{command, expect, folder, hpf, read, task};

/// Runs `hpf`, which may refuse its input but not break; returns its exit code and stderr.
#[track_caller]
fn try_hpf(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output = hpf(folder, arguments);
    (code(&output, arguments), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[track_caller]
fn code(output: &Output, arguments: &[&str]) -> i32 {
    let stderr = String::from_utf8_lossy(&output.stderr);
    let arguments: String = arguments.join(" ").chars().take(200).collect();
    let code = output.status.code().unwrap_or_else(|| panic!("hpf {arguments} was ended by a signal: {stderr}"));
    assert!([0, 1, 2, 3].contains(&code) && !stderr.contains("panicked"), "hpf {arguments}: {code}\n{stderr}");
    assert_eq!(code == 1 || code == 2, stderr.contains("error"), "hpf {arguments}: {code}\n{stderr}");
    code
}

/// A short run of a task with a contact, snapshots and a table of the beam.
fn run(folder: &Path) -> PathBuf {
    let short = ["--set", "learning.updates=2", "--set", "output.snapshots=[0, 2]", "--set", "accept={}"];
    expect(0, folder, &[&["learn", &task("cantilever.toml"), "--quiet", "--out", "run"][..], &short].concat());
    folder.join("run")
}

#[test]
fn every_command_refuses_what_is_no_file_of_its_kind_by_name() {
    let folder = folder();
    let utf16: Vec<u8> = read(task("reach.toml")).encode_utf16().flat_map(u16::to_le_bytes).collect();
    let files: [(&str, &[u8]); 5] = [
        ("empty", b""),
        ("binary", &[0x7f, b'E', b'L', b'F', 0, 0xff, 0x80, 0]),
        ("utf16", &[&[0xff, 0xfe][..], &utf16].concat()),
        ("zeros", &[0; 4096]),
        ("text", b"dear diary"),
    ];
    fs::create_dir(folder.path().join("folder.toml")).unwrap();
    for (name, bytes) in files {
        for extension in ["toml", "json", "mcap"] {
            let file = format!("{name}.{extension}");
            fs::write(folder.path().join(&file), bytes).unwrap();
            refused(folder.path(), &file);
        }
    }
    refused(folder.path(), "folder.toml");
    refused(folder.path(), "missing.toml");
    refused(folder.path(), "missing.json");
}

/// Every command that reads `file` refuses it by name.
fn refused(folder: &Path, file: &str) {
    let commands: [&[&str]; 6] = [
        &["learn", file],
        &["check", file],
        &["info", file],
        &["run", file, "--task", file],
        &["plot", file],
        &["export", file, "--format", "c"],
    ];
    for arguments in commands {
        let (code, stderr) = try_hpf(folder, arguments);
        assert!(code == 1 || code == 2, "hpf {arguments:?}: {code}\n{stderr}");
        assert!(stderr.contains(file), "hpf {arguments:?} does not name the file: {stderr}");
    }
    assert!(!folder.join("runs").exists(), "nothing is written for {file}");
}

#[test]
fn endless_files_are_not_read_to_their_end() {
    let folder = folder();
    for arguments in [["check", "/dev/zero"], ["learn", "/dev/zero"]] {
        let (_, stderr) = expect(2, folder.path(), &arguments);
        assert!(stderr.contains("/dev/zero: more than 1048576 bytes"), "{stderr}");
    }
}

#[cfg(unix)]
#[test]
fn a_device_is_read_up_to_a_stated_limit_and_a_file_above_its_limit_not_at_all() {
    let folder = folder();
    let run = |command: &str, file: &str| {
        // A gigabyte of addresses is half of what a file may have, and more than a pipe may.
        let line = format!("ulimit -v 1048576; exec '{}' {command} {file}", env!("CARGO_BIN_EXE_hpf"));
        let mut shell = std::process::Command::new("sh");
        let output =
            shell.current_dir(folder.path()).args(["-c", &line]).env("MALLOC_ARENA_MAX", "1").output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let sparse = fs::File::create(folder.path().join("sparse.csv")).unwrap();
    sparse.set_len((2 << 30) + 1).unwrap();
    for command in ["imitate", "recover --out out.mcap"] {
        let (code, stderr) = run(command, "/dev/zero");
        let limit = "/dev/zero: more than 67108864 bytes, which is the most that is read of a device or a pipe";
        assert!(code == Some(2) && stderr.contains(limit), "{command}: {code:?} {stderr}");
        let (code, stderr) = run(command, "sparse.csv");
        let limit = "sparse.csv: more than 2147483648 bytes, which is the most that is read\n";
        assert!(code == Some(2) && stderr.contains(limit), "{command}: {code:?} {stderr}");
    }
}

#[test]
fn what_windows_editors_write_is_read() {
    let folder = folder();
    let text = read(task("reach.toml"));
    let crlf = text.replace('\n', "\r\n");
    for (name, text) in
        [("bom", format!("\u{feff}{text}")), ("crlf", crlf.clone()), ("both", format!("\u{feff}{crlf}"))]
    {
        let file = format!("{name}.toml");
        fs::write(folder.path().join(&file), text).unwrap();
        expect(0, folder.path(), &["check", &file]);
        let few = ["--set", "learning.updates=2", "--set", "accept={}"];
        expect(0, folder.path(), &[&["learn", &file, "--quiet", "--out", name][..], &few].concat());
        expect(0, folder.path(), &["run", name]);
        expect(0, folder.path(), &["plot", name, "--force"]);
    }
}

#[test]
fn numbers_of_any_size_are_learned_or_refused() {
    let folder = folder();
    let file = task("cantilever.toml");
    for change in [
        "axis.0.goal=32", // millimetres, where metres are meant
        "axis.0.goal=1e300",
        "axis.0.start=-1e308",
        "contact.thickness=4",
        "contact.thickness=1e-300",
        "contact.youngs_modulus=1e308",
        "contact.force=1e300",
        "contact.contact_stiffness=5e-324",
        "stiffness.max=1e308",
        "damping.min=5e-324",
        "movement.alpha=1e308",
        "movement.alpha=1e-308",
        "movement.overlap=1e-300",
        "movement.overlap=0.9999999999999999",
        "phase.decay=5e-324",
        "phase.decay=100",
        "cost.goal=1e308",
        "learning.noise.movement=1e308",
        "learning.noise.stiffness=1e308",
        "learning.temperature={ lambda = 5e-324 }",
        "learning.temperature={ range = 1e308 }",
        "learning.final_noise=5e-324",
        "duration=1e-300",
        "duration=1e300",
        "rate=1e300",
        "learning.seed=-1",
        "learning.updates=99999999999999999999",
    ] {
        let few = ["--set", "learning.updates=2", "--set", "output={}", "--set", "accept={}", "--set", change];
        let learn = [&["learn", &file, "--quiet", "--force", "--out", "run"][..], &few].concat();
        let (code, stderr) = try_hpf(folder.path(), &learn);
        let (checked, _) = try_hpf(folder.path(), &[&["check", &file][..], &few].concat());
        assert!(checked == code || code == 1, "{change}: check says {checked}, learn {code}: {stderr}");
        if code == 0 {
            try_hpf(folder.path(), &["run", "run"]);
            try_hpf(folder.path(), &["check", "run"]);
            try_hpf(folder.path(), &["export", "run", "--format", "binary", "--scalar", "f32", "--out", "-"]);
        }
    }
}

#[test]
fn keys_given_twice_are_named() {
    let folder = folder();
    let text = read(task("reach.toml"));
    for (twice, key) in [("rate = 100.0\nrate = 100.0", "`rate`"), ("rate = 100.0\n\"rate\" = 1", "rate")] {
        fs::write(folder.path().join("twice.toml"), text.replacen("rate = 100.0", twice, 1)).unwrap();
        let (_, stderr) = expect(2, folder.path(), &["check", "twice.toml"]);
        assert!(stderr.contains(key) && stderr.contains("given twice"), "{stderr}");
    }
}

#[test]
fn nesting_without_end_is_refused() {
    let folder = folder();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    write("arrays.toml", format!("name = {}", "[".repeat(500_000)));
    write("tables.toml", format!("name = {}", "{a=".repeat(300_000)));
    write("keys.toml", format!("{}a = 1", "a.".repeat(500_000)));
    write("heads.toml", format!("[{}a]", "a.".repeat(500_000)));
    write("arrays.json", "[".repeat(1_000_000));
    write("objects.json", "{\"format\":".repeat(1_000_000));
    for file in ["arrays.toml", "tables.toml", "keys.toml", "heads.toml", "arrays.json", "objects.json"] {
        let (code, stderr) = try_hpf(folder.path(), &["check", file]);
        assert!(code == 2 && stderr.contains(file), "{file}: {stderr}");
    }
    for change in [format!("{}a=1", "a.".repeat(10_000)), format!("a={}", "[".repeat(50_000))] {
        let (code, _) = try_hpf(folder.path(), &["check", &task("reach.toml"), "--set", &change]);
        assert_eq!(code, 2, "{}", &change[..20]);
    }
}

#[test]
fn paths_may_hold_spaces_and_letters_of_any_alphabet() {
    let folder = folder();
    let place = folder.path().join("mein Ordner ü/走る 🤖");
    fs::create_dir_all(&place).unwrap();
    fs::copy(task("reach.toml"), place.join("the task.toml")).unwrap();
    let few = ["--set", "learning.updates=2", "--set", "accept={}"];
    expect(0, &place, &[&["learn", "the task.toml", "--quiet", "--out", "a run 走"][..], &few].concat());
    for arguments in [
        &["run", "a run 走"][..],
        &["info", "a run 走/log.mcap"],
        &["plot", "a run 走", "--out", "figures ü"],
        &["export", "a run 走", "--format", "rust", "--out", "the skill.rs"],
    ] {
        expect(0, &place, arguments);
    }
}

#[cfg(unix)]
#[test]
fn a_path_that_is_no_text_is_a_path_too() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = folder();
    let name = std::ffi::OsStr::from_bytes(b"t\xff.toml");
    if fs::copy(task("reach.toml"), folder.path().join(name)).is_err() {
        eprintln!("skipped: this file system takes no such name");
        return;
    }
    let output = command(folder.path(), &["check"]).arg(name).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Root may read and write everything: there, and where no user is known, the test says so and ends.
#[cfg(unix)]
#[test]
fn missing_permissions_are_named() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = folder();
    let run = run(folder.path());
    fs::set_permissions(run.join("policy.json"), fs::Permissions::from_mode(0o000)).unwrap();
    if fs::read(run.join("policy.json")).is_ok() {
        eprintln!("skipped: this user may read everything");
        return;
    }
    let (code, stderr) = try_hpf(folder.path(), &["run", "run"]);
    assert!(code == 2 && stderr.contains("policy.json"), "{stderr}");
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o500)).unwrap();
    let (code, stderr) = try_hpf(folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "new"]);
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o700)).unwrap();
    assert!(code == 1 && stderr.contains("new"), "{stderr}");
}

#[test]
fn a_closed_stdout_breaks_no_command() {
    let folder = folder();
    run(folder.path());
    for arguments in [
        &["--help"][..],
        &["schema"],
        &["completions", "bash"],
        &["init", "reach", "--out", "-"],
        &["check", "run"],
        &["info", "run/log.mcap", "--json"],
        &["run", "run", "--json"],
        &["export", "run", "--format", "binary", "--out", "-"],
        &["learn", &task("reach.toml"), "--quiet", "--set", "learning.updates=2", "--set", "accept={}"],
    ] {
        let mut child =
            command(folder.path(), arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(code(&output, arguments), 0, "{arguments:?}");
    }
    assert!(folder.path().join("runs/reach/policy.json").exists(), "what was learned is kept");
}

#[test]
fn a_damaged_run_directory_is_refused_by_the_name_of_the_damaged_file() {
    let folder = folder();
    let run = run(folder.path());
    let names =
        ["task.toml", "policy.json", "learning.csv", "trajectory.csv", "snapshots/2.csv", "summary.json", "log.mcap"];
    let commands: [(&[&str], &[&str]); 7] = [
        (&["recover", "run/log.mcap", "--out", "rescued.mcap", "--force"], &["log.mcap"]),
        (&["run", "run"], &["task.toml", "policy.json", "summary.json"]),
        (&["check", "run"], &["task.toml", "policy.json", "summary.json"]),
        (&["info", "run"], &["summary.json", "policy.json"]),
        (&["info", "run/log.mcap"], &["log.mcap"]),
        (&["export", "run", "--format", "c", "--out", "-"], &["policy.json", "summary.json"]),
        (&["plot", "run", "--out", "figures", "--force"], &names[..6]),
    ];
    for name in names {
        let whole = fs::read(run.join(name)).unwrap();
        let nan = String::from_utf8_lossy(&whole).replacen("0.0", "nan", 40).into_bytes();
        let damages: [(&str, Option<&[u8]>); 5] = [
            ("missing", None),
            ("empty", Some(b"")),
            ("cut", Some(&whole[..whole.len() / 2])),
            ("garbled", Some(b"\x00\xffwhat?\x00")),
            ("without numbers", Some(&nan)),
        ];
        for (damage, bytes) in damages {
            fs::remove_file(run.join(name)).unwrap();
            if let Some(bytes) = bytes {
                fs::write(run.join(name), bytes).unwrap();
            }
            for (arguments, reads) in commands {
                let (code, stderr) = try_hpf(folder.path(), arguments);
                let must_fail = matches!(damage, "empty" | "garbled") && reads.contains(&name);
                assert!(!must_fail || code != 0, "{arguments:?} takes {name}, {damage}");
                assert!(
                    code == 0 || stderr.contains(name),
                    "{arguments:?}, {name} {damage}, does not name it: {stderr}"
                );
                assert!(code == 0 || reads.contains(&name), "{arguments:?} needs no {name}: {stderr}");
            }
            fs::write(run.join(name), &whole).unwrap();
        }
    }
}

#[test]
fn a_sweep_takes_no_damaged_run_for_a_finished_one() {
    let folder = folder();
    let sweep = ["sweep", &task("reach.toml"), "--seeds", "1", "--set", "learning.updates=2", "--set", "accept={}"];
    let sweep = [&sweep[..], &["--quiet", "--out", "s"]].concat();
    expect(0, folder.path(), &sweep);
    let run = folder.path().join("s/runs/seed-1");
    for name in ["summary.json", "policy.json", "learning.csv"] {
        let whole = fs::read(run.join(name)).unwrap();
        for damaged in [None, Some(&b""[..]), Some(&whole[..whole.len() / 2]), Some(b"\x00\xffwhat?\x00")] {
            fs::remove_file(run.join(name)).unwrap();
            if let Some(damaged) = damaged {
                fs::write(run.join(name), damaged).unwrap();
            }
            let (code, stderr) = try_hpf(folder.path(), &sweep);
            assert!(code == 2 && stderr.contains(name) && stderr.contains("seed-1"), "{name}: {code} {stderr}");
            fs::write(run.join(name), &whole).unwrap();
        }
    }
    // What a sweep writes itself, and what it does not read, may be in any state.
    for name in ["s/results.csv", "s/plots/cost.png", "s/runs/seed-1/trajectory.csv", "s/runs/seed-1/task.toml"] {
        fs::write(folder.path().join(name), b"what?").unwrap();
    }
    let (stdout, _) = expect(0, folder.path(), &sweep);
    assert!(stdout.contains("1 were there before"), "{stdout}");
    fs::write(folder.path().join("s/summary.json"), b"what?").unwrap();
    let (code, stderr) = try_hpf(folder.path(), &sweep);
    assert!(code == 2 && stderr.contains("s is no sweep"), "{stderr}");
}

#[test]
fn a_summary_without_its_parts_is_shown_as_far_as_it_goes() {
    let folder = folder();
    let run = run(folder.path());
    for summary in [
        r#"{"format": "hpf-summary", "version": 1}"#,
        r#"{"format": "hpf-summary", "version": 1, "metrics": 3, "cost": [1], "task": {}}"#,
        r#"{"format": "hpf-summary", "version": 1, "metrics": [{}, {"name": 7, "value": "x"}], "cost": {"initial": null}}"#,
    ] {
        fs::write(run.join("summary.json"), summary).unwrap();
        try_hpf(folder.path(), &["info", "run"]);
    }
}

/// Learns under a limit of memory, in bytes; whether it went well.
#[cfg(unix)]
fn learns_within(folder: &Path, bytes: f64, keys: &[&str]) -> bool {
    let line = format!("ulimit -v {}; exec \"$0\" \"$@\"", (bytes / 1024.0) as u64);
    let mut shell = std::process::Command::new("sh");
    shell.current_dir(folder).args(["-c", &line, env!("CARGO_BIN_EXE_hpf"), "learn"]).args(keys);
    // What an allocator sets aside for more threads is not used, yet counts.
    shell.args(["--quiet", "--force", "--out", "run"]).env("MALLOC_ARENA_MAX", "1");
    shell.output().is_ok_and(|output| output.status.success())
}

#[cfg(unix)]
#[test]
fn learning_needs_no_more_memory_than_check_says() {
    let folder = folder();
    let file = task("via_point.toml");
    let large = ["--set", "learning.updates=1", "--set", "output={}", "--set", "accept={}"];
    for keys in [
        &["rate=20000", "learning.method=pi2"][..],
        &["rate=2000", "learning.preset=paper", "learning.rollouts=40"],
        &["rate=4000", "learning.method=gauss-newton", "learning.max_rollouts=150"],
    ] {
        let mut arguments = vec![file.as_str()];
        arguments.extend(large);
        arguments.extend(keys.iter().flat_map(|key| ["--set", key]));
        let mut check = command(folder.path(), &[&["check", "--json"], &arguments[..]].concat());
        let output = check.env("RAYON_NUM_THREADS", "1").output().unwrap();
        let stdout = String::from_utf8(output.stdout).unwrap();
        arguments.extend(["--threads", "1"]);
        let said = serde_json::from_str::<serde_json::Value>(&stdout).unwrap()["memory_bytes"].as_f64().unwrap();
        assert!(said > 3e8, "{keys:?} is not large: {said}");
        assert!(learns_within(folder.path(), said, &arguments), "{keys:?} needs more than {said} bytes");
        assert!(!learns_within(folder.path(), 0.2 * said, &arguments), "{keys:?} needs far less than {said} bytes");
    }
}

#[test]
fn a_policy_that_is_not_the_one_its_run_was_finished_with_is_refused_wherever_the_run_is_read() {
    let folder = folder();
    let run = run(folder.path());
    let policy = read(run.join("policy.json"));
    let other = policy.replacen("\"updates\"", " \"updates\"", 1);
    assert_ne!(policy, other);
    fs::write(run.join("policy.json"), &other).unwrap();
    let place = run.display().to_string();
    let file = run.join("policy.json").display().to_string();
    let task = format!("{place}/task.toml");
    let commands: [&[&str]; 10] = [
        &["info", &place],
        &["info", &place, &place],
        &["imitate", &place, "--out", "imitated"],
        &["info", &file],
        &["check", &place],
        &["run", &place],
        &["plot", &place, "--force"],
        &["export", &place, "--format", "c"],
        &["export", &place, "--ros2"],
        &["learn", &task, "--from", &place, "--out", "further"],
    ];
    for arguments in commands {
        let (code, stderr) = try_hpf(folder.path(), arguments);
        assert!(
            code == 2 && stderr.contains("policy_sha256") && stderr.contains("policy.json"),
            "{arguments:?}: {stderr}"
        );
    }
    // A summary that says nothing of its policy verifies none.
    let summary = read(run.join("summary.json"));
    let unsaid = summary.replacen("policy_sha256", "policy_sha", 1);
    for damaged in ["", &summary[..300], &unsaid] {
        fs::write(run.join("summary.json"), damaged).unwrap();
        for arguments in commands {
            let (code, stderr) = try_hpf(folder.path(), arguments);
            assert!(code == 2 && stderr.contains("summary.json"), "{arguments:?} of {damaged:?}: {stderr}");
        }
    }
    // Nor is a run whole without its policy.
    fs::write(run.join("summary.json"), &summary).unwrap();
    fs::remove_file(run.join("policy.json")).unwrap();
    for arguments in &commands[..3] {
        let (code, stderr) = try_hpf(folder.path(), arguments);
        assert!(code == 2 && stderr.contains("policy.json"), "{arguments:?}: {stderr}");
    }
    // Taken out of the run it is a policy like any other.
    fs::write(folder.path().join("policy.json"), &other).unwrap();
    expect(0, folder.path(), &["check", "policy.json"]);
}
