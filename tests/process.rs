//! `[environment] kind = "process"`: other programs make the rollouts.

use core::time::Duration;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::{command, expect, expect_same_run, folder, hpf, json, read, root};

/// Whether Python is here; where not, the test says so and ends.
pub fn has_python() -> bool {
    let found = Command::new("python3").arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success());
    if !found {
        eprintln!("SKIPPED: there is no python3 here");
    }
    found
}

fn toml() -> String {
    root().join("examples/process/point_mass.toml").display().to_string()
}

fn example() -> String {
    root().join("examples/process/point_mass.py").display().to_string()
}

/// Learns the example's task with `program` in `folder`.
fn arguments(program: &[&str], out: &str, settings: &[&str]) -> Vec<String> {
    let quoted: Vec<String> = program.iter().map(|word| format!("{word:?}")).collect();
    let command = format!("environment.command=[{}]", quoted.join(", "));
    let mut arguments = vec!["learn".to_owned(), toml()];
    arguments.extend(["--quiet", "--out", out, "--set", &command].map(str::to_owned));
    arguments.extend(settings.iter().flat_map(|setting| ["--set".to_owned(), (*setting).to_owned()]));
    arguments
}

fn learn(code: i32, folder: &Path, program: &[&str], out: &str, settings: &[&str]) -> (String, String) {
    let arguments = arguments(program, out, settings);
    expect(code, folder, &arguments.iter().map(String::as_str).collect::<Vec<_>>())
}

/// A file without the SHA-256 of its task: that differs with the settings of the environment.
fn lines(path: &Path) -> Vec<String> {
    read(path).lines().filter(|line| !line.contains("sha256")).map(str::to_owned).collect()
}

/// A worker written for one test: `body` is what it does with each `line` of requests, `n` counting them from 1.
fn worker(folder: &Path, body: &str) -> String {
    let path = folder.join("worker.py");
    let text = format!(
        "import json, os, sys, time\n\
         def say(**answer): print(json.dumps(answer), flush=True)\n\
         hello = json.loads(sys.stdin.readline())\n\
         say(type='ready', protocol=1, answers='costs')\n\
         def cost(request): return sum((k - 300.0) ** 2 for k in request['axes'][0]['weights']['stiffness'])\n\
         for n, line in enumerate(sys.stdin, 1):\n    request = json.loads(line)\n    id = request['id']\n    {}\n",
        body.replace('\n', "\n    ")
    );
    fs::write(&path, text).unwrap();
    path.display().to_string()
}

const COSTS: [&str; 5] =
    ["accept={}", "learning.method=pi2", "learning.updates=8", "environment.timeout=60.0", "environment.workers=1"];

#[test]
fn the_example_meets_its_targets_and_gives_the_same_bytes_for_any_number_of_workers() {
    if !has_python() {
        return;
    }
    let folder = folder();
    for workers in ["1", "3"] {
        let workers_key = format!("environment.workers={workers}");
        learn(0, folder.path(), &["python3", &example()], workers, &[&workers_key, "environment.timeout=60.0"]);
    }
    let path = |name: &str| folder.path().join(name);
    for file in ["policy.json", "learning.csv", "trajectory.csv"] {
        assert_eq!(read(path("1").join(file)), read(path("3").join(file)), "{file} differs");
    }
    let summary = json(path("1/summary.json"));
    // The motion that the files show is one more.
    assert!(summary["rollouts_total"].as_u64().unwrap() <= 201);
    let cost = |when: &str| summary["cost"][when]["total"].as_f64().unwrap();
    assert!(cost("final") < 0.1 * cost("initial"));
    let check = expect(0, folder.path(), &["check", &toml()]).0;
    assert!(check.contains("process     2 of `python3"), "{check}");
}

#[test]
fn a_motion_that_fails_after_learning_costs_no_result_and_is_named() {
    if !has_python() {
        return;
    }
    let folder = folder();
    let settings = ["environment.workers=1", "environment.timeout=60.0", "learning.max_rollouts=40"];
    learn(3, folder.path(), &["python3", &example()], "whole", &[&settings[..], &["accept.max_cost=0"]].concat());
    let whole = json(folder.path().join("whole/summary.json"));
    let last = whole["rollouts_total"].as_u64().unwrap();
    for (failure, words) in [
        ("answer = dict(type='done', id=answer['id'], error='a joint limit')", "a joint limit"),
        ("answer['axes'][0]['position'] = [1e308] * len(answer['axes'][0]['position'])", "has no finite cost"),
    ] {
        let text = format!(
            "import json, subprocess, sys\n\
             pipe = subprocess.PIPE\n\
             child = subprocess.Popen([sys.executable, {:?}], stdin=pipe, stdout=pipe, text=True)\n\
             for n, line in enumerate(sys.stdin):\n    \
                 child.stdin.write(line)\n    child.stdin.flush()\n    \
                 answer = json.loads(child.stdout.readline())\n    \
                 if n == {last}: {failure}\n    \
                 print(json.dumps(answer), flush=True)\n",
            example()
        );
        let program = folder.path().join("failing.py");
        fs::write(&program, text).unwrap();
        let program = program.display().to_string();
        let (_, stderr) = learn(1, folder.path(), &["python3", &program], "run", &settings);
        assert!(stderr.contains("the motion that was learned failed") && stderr.contains(words), "{stderr}");
        for file in ["policy.json", "learning.csv"] {
            let of = |run: &str| lines(&folder.path().join(run).join(file));
            assert_eq!(of("run"), of("whole"), "{file} differs");
        }
        let summary = json(folder.path().join("run/summary.json"));
        assert_eq!(summary["rollouts_total"].as_u64(), Some(last));
        // Of a motion as planned the gains are all that is measured.
        let metrics = summary["metrics"].as_array().unwrap();
        assert!(metrics.iter().all(|metric| metric["value"].is_number()), "{summary}");
        fs::remove_dir_all(folder.path().join("run")).unwrap();
    }
}

#[test]
fn costs_alone_are_learned_too_and_a_kill_or_ctrl_c_is_gone_on_from() {
    if !has_python() {
        return;
    }
    let folder = folder();
    for method in ["auto", "pi2", "cma-es"] {
        let method = format!("learning.method={method}");
        let settings = ["accept={}", "learning.updates=8", "environment.timeout=60.0", method.as_str()];
        let program = ["python3", &example(), "--costs"];
        learn(0, folder.path(), &program, "whole", &settings);
        let summary = json(folder.path().join("whole/summary.json"));
        assert!(summary["cost"]["final"]["total"].as_f64() < summary["cost"]["initial"]["total"].as_f64());
        for signal in ["-KILL", "-INT"] {
            let words = arguments(&program, "broken", &settings);
            let mut child = command(folder.path(), &words.iter().map(String::as_str).collect::<Vec<_>>())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            let checkpoint = folder.path().join("broken.partial/checkpoint");
            while fs::metadata(&checkpoint).map_or(0, |file| file.len()) < 200 && child.try_wait().unwrap().is_none() {
                std::thread::sleep(Duration::from_millis(1));
            }
            Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
            child.wait().unwrap();
            // Over before the signal came, there is nothing to go on with.
            hpf(folder.path(), &["learn", "--resume", "broken", "--quiet"]);
            expect_same_run(&folder.path().join("whole"), &folder.path().join("broken"));
            fs::remove_dir_all(folder.path().join("broken")).unwrap();
        }
        fs::remove_dir_all(folder.path().join("whole")).unwrap();
    }
}

#[test]
fn a_worker_that_dies_hangs_or_babbles_is_replaced_and_named_and_changes_no_result() {
    if !has_python() {
        return;
    }
    let folder = folder();
    let good = worker(folder.path(), "say(type='done', id=id, cost=cost(request))");
    learn(0, folder.path(), &["python3", &good], "good", &COSTS);
    // Each does it once, and leaves a mark that it did.
    for (trouble, words) in [
        ("sys.exit(7)", "ended (exit status: 7)"),
        ("time.sleep(60)", "did not answer within 10 s"),
        ("sys.exit(0)", "ended (exit status: 0)"),
        ("os.close(1); time.sleep(60)", "closed its output"),
        ("os.write(1, b'{\"type\": \"do'); sys.exit(0)", "ended in the middle of a line"),
        ("os.write(1, b'\\xff\\xfe\\n')", "is not UTF-8"),
        // 64 KiB, and 32 bytes for each number of 3 signals at 101 instants of one axis.
        ("while True: sys.stdout.write('x' * 65536)", "more than 75232 bytes, the most of this task"),
        ("print('\\x1b[2Joops', flush=True)", "printed `\\u{1b}[2Joops`, which is no answer"),
        ("print('oops', flush=True)", "printed `oops`, which is no answer"),
        ("say(type='done', id=0, cost=1.0)", "its id is 0"),
    ] {
        let mark = folder.path().join("mark").display().to_string();
        let _ = fs::remove_file(&mark);
        let body = format!(
            "if n == 5 and not os.path.exists({mark:?}):\n    open({mark:?}, 'w').close()\n    {trouble}\n\
             else: say(type='done', id=id, cost=cost(request))"
        );
        let bad = worker(folder.path(), &body);
        let settings = [&COSTS[..3], &["environment.timeout=10.0", "environment.workers=1"]].concat();
        let (_, stderr) = learn(0, folder.path(), &["python3", &bad], "bad", &settings);
        assert!(!stderr.contains('\u{1b}'), "{stderr:?}");
        assert!(stderr.contains("worker 1 ") && stderr.contains(words) && stderr.contains("is made again"), "{stderr}");
        for file in ["policy.json", "learning.csv"] {
            let of = |name: &str| lines(&folder.path().join(name).join(file));
            assert_eq!(of("good"), of("bad"), "{trouble}: {file}");
        }
        fs::remove_dir_all(folder.path().join("bad")).unwrap();
    }
}

#[test]
fn a_worker_that_fails_again_and_again_ends_learning_which_goes_on_when_it_is_mended() {
    if !has_python() {
        return;
    }
    let folder = folder();
    let good = "say(type='done', id=id, cost=cost(request))";
    let program = worker(folder.path(), good);
    let settings = [&COSTS[..], &["environment.max_lost=0"]].concat();
    learn(0, folder.path(), &["python3", &program], "whole", &settings);
    worker(folder.path(), &format!("if id > 30: sys.exit(3)\n{good}"));
    let (_, stderr) = learn(1, folder.path(), &["python3", &program], "run", &settings);
    for words in ["worker 1 ended (exit status: 3)", "was tried 3 times", "hpf learn --resume", "run"] {
        assert!(stderr.contains(words), "{words} is missing from {stderr}");
    }
    worker(folder.path(), good);
    expect(0, folder.path(), &["learn", "--resume", "run", "--quiet"]);
    expect_same_run(&folder.path().join("whole"), &folder.path().join("run"));
}

#[test]
fn costs_that_are_no_number_and_errors_are_rejected_rollouts() {
    if !has_python() {
        return;
    }
    let folder = folder();
    let body = "if n % 7 == 3: say(type='done', id=id, cost=float('nan'))\n\
                elif n % 7 == 4: say(type='done', id=id, error='a joint\x1b[2J limit')\n\
                else: say(type='done', id=id, cost=cost(request))";
    let (_, stderr) = learn(0, folder.path(), &["python3", &worker(folder.path(), body)], "run", &COSTS);
    assert!(stderr.contains("a joint\\u{1b}[2J limit") && !stderr.contains('\u{1b}'), "{stderr:?}");
    let summary = json(folder.path().join("run/summary.json"));
    assert!(summary["rejected_rollouts"].as_u64().unwrap() > 0);
    assert!(summary["cost"]["final"]["total"].as_f64().unwrap().is_finite());
}

#[test]
fn what_does_not_start_or_fit_is_refused_by_name() {
    let folder = folder();
    let (_, stderr) = learn(2, folder.path(), &["no-such-program"], "run", &COSTS);
    assert!(stderr.contains("cannot start `no-such-program`"), "{stderr}");
    let (_, stderr) = learn(2, folder.path(), &["true"], "run", &COSTS);
    assert!(stderr.contains("worker 1 ended (exit status: 0)"), "{stderr}");
    let sleep = [&COSTS[..3], &["environment.timeout=0.5"]].concat();
    let (_, stderr) = learn(2, folder.path(), &["sleep", "60"], "run", &sleep);
    assert!(stderr.contains("worker 1 did not answer within 0.5 s"), "{stderr}");
    let (_, stderr) = learn(2, folder.path(), &["cat", "/dev/zero"], "run", &COSTS);
    assert!(stderr.contains("worker 1 printed a line of more than 75232 bytes"), "{stderr}");
    let (_, stderr) = learn(2, folder.path(), &["echo", "hello"], "run", &COSTS);
    assert!(stderr.contains("printed `hello`"), "{stderr}");
    let second = r#"{"type":"ready","protocol":2,"answers":"costs"}"#;
    let (_, stderr) = learn(2, folder.path(), &["echo", second], "run", &COSTS);
    assert!(stderr.contains("speaks version 2"), "{stderr}");
    // Targets need traces; what hpf simulates needs no process; a process runs only while learning.
    let costs = r#"{"type":"ready","protocol":1,"answers":"costs"}"#;
    let (_, stderr) = learn(2, folder.path(), &["echo", costs], "run", &COSTS[1..]);
    assert!(stderr.contains("[accept] need traces"), "{stderr}");
    let pushed =
        ["disturbance=[{ kind = \"step\", axis = \"x\", amplitude = 1.0, start = 0.1 }]", "output.snapshots=[0]"];
    let (_, stderr) = learn(2, folder.path(), &["true"], "run", &pushed);
    assert!(stderr.contains("is simulated, and the rollouts of this task are not"), "{stderr}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left");
}

/// A robot program that registers in a folder, and reports another one that is alive; the first of them hangs once. As
/// `child` it is meant to be run by a launcher, as `daemon` the robot is held by a process that has left the group and
/// hears no SIGTERM.
#[cfg(target_os = "linux")]
const ROBOT: &str = r#"
import json, os, signal, sys, time
folder, kind = sys.argv[1:]
def is_alive(pid):
    try: return open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError: return False
def hold():
    others = [pid for pid in os.listdir(folder) if is_alive(pid)]
    if others: open(folder + "-overlap", "w").close()
    open(f"{folder}/{os.getpid()}", "w").close()
before = len(os.listdir(folder))
if kind == "daemon":
    if os.fork() == 0:
        os.setsid()
        if os.fork(): os._exit(0)
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        os.close(0); os.close(1)
        hold()
        time.sleep(600)
        os._exit(0)
    while len(os.listdir(folder)) == before: time.sleep(0.01)
else: hold()
sys.stdin.readline()
print(json.dumps({"type": "ready", "protocol": 1, "answers": "costs"}), flush=True)
for n, line in enumerate(sys.stdin, 1):
    request = json.loads(line)
    if before == 0 and n == 2: time.sleep(600)
    cost = sum((k - 300.0) ** 2 for k in request["axes"][0]["weights"]["stiffness"])
    print(json.dumps({"type": "done", "id": request["id"], "cost": cost}), flush=True)
"#;

#[test]
#[cfg(target_os = "linux")]
fn what_a_launcher_started_is_gone_before_another_starts_and_at_the_end() {
    if !has_python() {
        return;
    }
    let folder = folder();
    let robot = folder.path().join("robot.py").display().to_string();
    fs::write(&robot, ROBOT).unwrap();
    for kind in ["child", "daemon"] {
        let held = folder.path().join(kind);
        fs::create_dir(&held).unwrap();
        let script = format!("python3 '{robot}' '{}' {kind}; true", held.display());
        let settings = [&COSTS[..3], &["learning.updates=2", "environment.workers=1"]].concat();
        let (_, stderr) = learn(0, folder.path(), &["sh", "-c", &script], &format!("run-{kind}"), &settings);
        assert!(stderr.contains("did not answer within"), "{stderr}");
        assert!(!folder.path().join(format!("{kind}-overlap")).exists(), "two robot programs at once");
        let robots: Vec<String> =
            fs::read_dir(&held).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        assert_eq!(robots.len(), 2, "one that hung, one in its place");
        for robot in robots {
            let stat = fs::read_to_string(format!("/proc/{robot}/stat")).unwrap_or_default();
            let state = stat.rsplit(')').next().and_then(|rest| rest.split_whitespace().next());
            assert!(state.is_none_or(|state| "ZX".contains(state)), "{robot} is left: {stat}");
        }
    }
}

#[test]
#[cfg(unix)]
fn a_signal_lets_no_program_start_and_ends_all_workers_at_once() {
    if !has_python() {
        return;
    }
    const WORKERS: usize = 8;
    let folder = folder();
    let starts = folder.path().join("starts");
    let asked = folder.path().join("asked").display().to_string();
    fs::create_dir(&starts).unwrap();
    let program = folder.path().join("deaf.py").display().to_string();
    let text = format!(
        "import json, os, signal, sys, time\n\
         signal.signal(signal.SIGTERM, signal.SIG_IGN)\n\
         open(f'{}/{{os.getpid()}}', 'w').close()\n\
         sys.stdin.readline()\n\
         print(json.dumps(dict(type='ready', protocol=1, answers='costs')), flush=True)\n\
         for line in sys.stdin:\n    open({asked:?}, 'w').close()\n    time.sleep(1)\n    sys.exit(3)\n\
         time.sleep(600)\n",
        starts.display()
    );
    fs::write(&program, text).unwrap();
    let count = format!("environment.workers={WORKERS}");
    let settings = [&COSTS[..3], &["environment.timeout=60.0", &count]].concat();
    let words = arguments(&["python3", &program], "run", &settings);
    let mut hpf = command(folder.path(), &words.iter().map(String::as_str).collect::<Vec<_>>())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !Path::new(&asked).exists() {
        assert_eq!(hpf.try_wait().unwrap(), None, "it ended by itself");
        std::thread::sleep(Duration::from_millis(5));
    }
    let since = std::time::Instant::now();
    Command::new("kill").args(["-TERM", &hpf.id().to_string()]).status().unwrap();
    let output = hpf.wait_with_output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert_eq!(fs::read_dir(&starts).unwrap().count(), WORKERS, "a program was started after the signal: {stderr}");
    // 2 s to end by itself and 2 s to hear SIGTERM: less than half of what one worker after the other takes.
    let most = Duration::from_secs(1 + 4 * WORKERS as u64 / 2);
    assert!(since.elapsed() < most, "{:?}", since.elapsed());
    assert!(stderr.contains("interrupted"), "{stderr}");
    assert!(!folder.path().join("run.partial").exists() && !folder.path().join("run").exists());
}

#[test]
fn a_motion_that_crashes_every_time_is_rejected_and_learning_goes_on_within_its_budget() {
    if !has_python() {
        return;
    }
    let folder = folder();
    let body = "if id % 20 == 7: os.abort()\nsay(type='done', id=id, cost=cost(request))";
    let program = worker(folder.path(), body);
    let (_, stderr) = learn(0, folder.path(), &["python3", &program], "run", &COSTS);
    assert!(stderr.contains("rollout 7 was tried 3 times and is given up, as 1 of at most 20"), "{stderr}");
    assert!(stderr.contains("rollout 27 was tried 3 times and is given up, as 2 of at most 20"), "{stderr}");
    let summary = json(folder.path().join("run/summary.json"));
    assert!(summary["cost"]["final"]["total"].as_f64() < summary["cost"]["initial"]["total"].as_f64());
    let settings = [&COSTS[..], &["environment.max_lost=1"]].concat();
    let (_, stderr) = learn(1, folder.path(), &["python3", &program], "less", &settings);
    assert!(stderr.contains("environment.max_lost = 1 were given up before"), "{stderr}");
    assert!(stderr.contains("hpf learn --resume"), "{stderr}");
}

#[test]
fn a_program_whose_every_answer_is_misshapen_is_not_started_for_other_motions() {
    if !has_python() {
        return;
    }
    let folder = folder();
    let program = worker(folder.path(), "open(__file__ + '.starts', 'a').write('x')\nsay(type='done', id=id, price=1)");
    let (_, stderr) = learn(1, folder.path(), &["python3", &program], "run", &COSTS);
    assert!(stderr.contains("none was ever answered right") && read(program + ".starts") == "xxx", "{stderr}");
}

#[test]
fn a_start_that_fails_its_motion_is_learned_from_where_a_motion_near_it_does_not() {
    if !has_python() {
        return;
    }
    let folder = folder();
    for failure in
        ["say(type='done', id=id, error='a joint limit')", "say(type='done', id=id, cost=float('nan'))", "sys.exit(3)"]
    {
        for method in ["pi2", "cma-es", "auto"] {
            let body = format!("if id < 4: {failure}\nelse: say(type='done', id=id, cost=cost(request))");
            let program = worker(folder.path(), &body);
            let method = format!("learning.method={method}");
            let settings = [&COSTS[..], &[method.as_str()]].concat();
            let (stdout, _) = learn(0, folder.path(), &["python3", &program], "run", &settings);
            assert!(stdout.contains("the start failed its motion"), "{method}: {stdout}");
            let summary = json(folder.path().join("run/summary.json"));
            let cost = |when: &str| summary["cost"][when]["total"].as_f64().unwrap();
            assert!(cost("final") < cost("initial"), "{method}");
            assert!(summary["rejected_rollouts"].as_u64().unwrap() >= 3);
            fs::remove_dir_all(folder.path().join("run")).unwrap();
        }
    }
    let program = worker(folder.path(), "say(type='done', id=id, error='no power')");
    let (_, stderr) = learn(2, folder.path(), &["python3", &program], "run", &COSTS);
    assert!(stderr.contains("neither has any of 50 tried near it") && !stderr.contains("--resume"), "{stderr}");
    assert!(!folder.path().join("run.partial").exists(), "there is nothing to go on from");
}

#[test]
fn a_program_is_looked_for_where_its_task_is_also_by_a_run_that_goes_on_from_elsewhere() {
    if !has_python() {
        return;
    }
    let (folder, elsewhere) = (folder(), tempfile::tempdir().unwrap());
    let lab = folder.path().join("my lab");
    fs::create_dir(&lab).unwrap();
    fs::copy(toml(), lab.join("arm.toml")).unwrap();
    let broken = lab.join("broken");
    fs::write(&broken, "").unwrap();
    worker(&lab, "if id > 12 and os.path.exists('broken'): sys.exit(3)\nsay(type='done', id=id, cost=cost(request))");
    let mut words =
        vec!["learn", "my lab/arm.toml", "--quiet", "--set", "environment.command=[\"python3\", \"worker.py\"]"];
    words.extend(COSTS.iter().chain(&["environment.max_lost=0"]).flat_map(|setting| ["--set", setting]));
    expect(1, folder.path(), &[&words[..], &["--out", "run"]].concat());
    fs::remove_file(&broken).unwrap();
    let run = folder.path().join("run").display().to_string();
    let (stdout, _) = expect(0, elsewhere.path(), &["learn", "--resume", &run, "--quiet"]);
    expect(0, folder.path(), &[&words[..], &["--out", "whole"]].concat());
    expect_same_run(&folder.path().join("whole"), &folder.path().join("run"));
    // The next step that is named can be made.
    let next = stdout.lines().find_map(|line| line.strip_prefix("next: hpf ")).expect("a next step");
    expect(0, folder.path(), &next.split(' ').collect::<Vec<_>>());
    // A folder of its own is one beside the task.
    let moved = [&words[..], &["--set", "environment.folder=..", "--out", "moved"]].concat();
    let (_, stderr) = expect(2, folder.path(), &moved);
    assert!(stderr.contains("worker 1 ended"), "{stderr}");
}

#[test]
fn residuals_of_ones_own_are_learned_from_as_signals() {
    if !has_python() {
        return;
    }
    let folder = folder();
    // 101 tracking errors and 21 of the stiffness, and the same as a cost alone: signals know which way to go.
    let body = "stiffness, planned = request['axes'][0]['weights']['stiffness'], request['axes'][0]['reference_position']\n\
        wanted = [0.2 * (n / (len(planned) - 1)) ** 2 for n in range(len(planned))]\n\
        errors = [(p - w) / 0.001 for p, w in zip(planned, wanted)] + [(k - 300.0) / 100.0 for k in stiffness]\n\
        say(type='done', id=id, residuals=errors)";
    let program = worker(folder.path(), body);
    let text = read(&program).replace(
        "answers='costs'",
        "answers='residuals', residuals=hello['steps'] + 1 + len(hello['policy']['axes'][0]['stiffness']['weights'])",
    );
    fs::write(&program, text).unwrap();
    let settings = ["accept={}", "learning.method=auto", "learning.max_rollouts=120", "environment.timeout=60.0"];
    learn(0, folder.path(), &["python3", &program], "run", &settings);
    let summary = json(folder.path().join("run/summary.json"));
    let total = |which: &str| summary["cost"][which]["total"].as_f64().unwrap();
    let (before, after) = (total("initial"), total("final"));
    assert!(after < 1e-3 * before, "{before} -> {after}");
    // A motion that could be measured there is none; and what needs a trace says so.
    let (_, stderr) = learn(2, folder.path(), &["python3", &program], "model", &["accept={}", "learning.method=model"]);
    assert!(stderr.contains("no model of its motions"), "{stderr}");
    let (_, stderr) = learn(2, folder.path(), &["python3", &program], "targets", &[]);
    assert!(stderr.contains("answers with residuals, and the targets of [accept] need traces"), "{stderr}");
}
