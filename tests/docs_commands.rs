//! Every command that the help and the documentation show is run.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use crate::support::{expect, folder, read, root};

/// Commands that take minutes: their own tests run them, with less to do.
const ELSEWHERE: [&str; 3] = ["sweep", "reproduce", "benchmark"];

/// Copies the folder `from` with all that is in it.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let to = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &to);
        } else {
            fs::copy(entry.path(), to).unwrap();
        }
    }
}

/// A folder with the shipped tasks, what the commands shown start from.
fn workplace() -> tempfile::TempDir {
    let folder = folder();
    copy(&root().join("tasks"), &folder.path().join("tasks"));
    folder
}

/// The same with runs in it, which are made once.
fn workplace_with_runs() -> tempfile::TempDir {
    static MADE: OnceLock<tempfile::TempDir> = OnceLock::new();
    let made = MADE.get_or_init(|| {
        let folder = workplace();
        let readme = shell_lines(&read(root().join("README.md")));
        for line in readme.iter().filter(|line| line.starts_with("hpf learn")) {
            run(folder.path(), line, "README.md");
        }
        run(folder.path(), "hpf learn tasks/reach.toml --quiet --out runs/elsewhere", "before the examples");
        run(folder.path(), "cp runs/cantilever/policy.json policy.json", "before the examples");
        folder
    });
    let folder = folder();
    copy(made.path(), folder.path());
    folder
}

/// Runs one line of a shell; `hpf` is the built one. It ends as the line says: "exit code 3", else 0.
fn run(folder: &Path, line: &str, place: &str) {
    let expected = if line.contains("exit code 3") { 3 } else { 0 };
    let built = Path::new(env!("CARGO_BIN_EXE_hpf")).parent().unwrap();
    let path = format!("{}:{}", built.display(), std::env::var("PATH").unwrap_or_default());
    let output =
        Command::new("sh").current_dir(folder).env("PATH", path).args(["-c", line]).output().expect("sh starts");
    assert_eq!(
        output.status.code(),
        Some(expected),
        "{place}: {line}\n{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

fn is_cheap(line: &str) -> bool {
    !ELSEWHERE.iter().any(|command| line.starts_with(&format!("hpf {command}")))
}

/// The lines of a page's shell blocks that begin with `hpf`.
fn shell_lines(page: &str) -> Vec<String> {
    let blocks = page.split("```sh\n").skip(1).map(|rest| rest.split("```").next().unwrap_or_default());
    let lines = blocks.flat_map(str::lines);
    // What the README calls by way of cargo is the same program.
    let lines = lines.map(|line| line.replacen("cargo run --release -- ", "hpf ", 1));
    lines.filter(|line| line.starts_with("hpf ")).collect()
}

/// The run directory that a line `hpf learn ...` makes.
fn made(line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    match words.iter().position(|word| *word == "--out") {
        Some(option) => words[option + 1].to_owned(),
        None => format!("runs/{}", Path::new(words[2]).file_stem().unwrap_or_default().display()),
    }
}

#[test]
fn every_command_of_the_documentation_runs() {
    let root = root();
    let mut pages = vec![root.join("README.md")];
    pages.extend(fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path()));
    pages.retain(|page| page.extension().is_some_and(|extension| extension == "md"));
    // The README first: what it makes, the other pages look at.
    pages[1..].sort();
    let mut count = 0;
    for page in &pages {
        let lines = shell_lines(&read(page));
        let folder = if page == &pages[0] { workplace() } else { workplace_with_runs() };
        // What the page makes itself is not there before.
        for line in lines.iter().filter(|line| line.starts_with("hpf learn")) {
            let _ = fs::remove_dir_all(folder.path().join(made(line)));
        }
        for line in lines.iter().filter(|line| is_cheap(line)) {
            run(folder.path(), line, &page.display().to_string());
            count += 1;
        }
    }
    assert!(count >= 15, "only {count} commands are shown");
}

#[test]
fn every_example_of_the_help_runs() {
    let (main, _) = expect(0, folder().path(), &["--help"]);
    let commands = main.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let commands = commands.lines().map(|line| line.split_whitespace().next().unwrap()).filter(|name| *name != "help");
    let mut helps = vec![("hpf".to_owned(), main.clone())];
    helps.extend(commands.map(|name| (name.to_owned(), expect(0, folder().path(), &[name, "--help"]).0)));
    assert!(helps.len() > 10);
    for (name, help) in helps {
        let examples = help.split("\nExample").nth(1).unwrap_or_else(|| panic!("hpf {name} has no examples"));
        let lines: Vec<&str> = examples
            .lines()
            .filter_map(|line| line.strip_prefix("  "))
            .filter(|line| line.starts_with("hpf "))
            .collect();
        assert!(!lines.is_empty(), "hpf {name} has no examples");
        let makes_runs = ["hpf", "learn"].contains(&name.as_str());
        let folder = if makes_runs { workplace() } else { workplace_with_runs() };
        for line in lines.into_iter().filter(|line| is_cheap(line)) {
            run(folder.path(), line, &format!("hpf {name} --help"));
        }
    }
}
