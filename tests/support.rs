//! Running `hpf` and reading what it leaves behind.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// The repository's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A shipped task file.
pub fn task(name: &str) -> String {
    root().join("tasks").join(name).display().to_string()
}

/// A folder that is removed with its contents.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("the system's temporary folder is writable")
}

/// `hpf` with `arguments`, in `folder`, not yet started.
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hpf"));
    command.current_dir(folder).args(arguments).env_remove("NO_COLOR");
    command
}

/// Runs `hpf` with `arguments` in `folder`.
pub fn hpf(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().expect("hpf starts")
}

/// Runs `hpf` and checks its exit code; returns stdout and stderr.
pub fn expect(code: i32, folder: &Path, arguments: &[&str]) -> (String, String) {
    let output = hpf(folder, arguments);
    let stdout = String::from_utf8(output.stdout).expect("stdout is text");
    let stderr = String::from_utf8(output.stderr).expect("stderr is text");
    assert_eq!(output.status.code(), Some(code), "hpf {arguments:?}\n{stdout}\n{stderr}");
    (stdout, stderr)
}

/// Reads a text file.
pub fn read(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Reads a JSON file.
pub fn json(path: impl AsRef<Path>) -> Value {
    serde_json::from_str(&read(path)).expect("the file is JSON")
}

/// Asserts that two run directories have the same files with the same bytes, wall times and threads left out.
pub fn expect_same_run(a: &Path, b: &Path) {
    let names = |folder: &Path| {
        let mut names = Vec::new();
        for folder in [folder.to_owned(), folder.join("plots"), folder.join("snapshots")] {
            let entries = std::fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path());
            names.extend(entries.filter(|path| path.is_file()));
        }
        let mut names: Vec<PathBuf> = names.iter().map(|path| path.strip_prefix(folder).unwrap().to_owned()).collect();
        names.sort();
        names
    };
    assert_eq!(names(a), names(b), "{} and {}", a.display(), b.display());
    for name in names(a).iter().filter(|name| !name.ends_with("summary.json")) {
        let bytes = |folder: &Path| std::fs::read(folder.join(name)).unwrap();
        assert!(bytes(a) == bytes(b), "{} differs between {} and {}", name.display(), a.display(), b.display());
    }
    let summary = |folder: &Path| {
        let mut summary = json(folder.join("summary.json"));
        for key in ["learning_s", "total_s", "threads"] {
            summary[key] = Value::Null;
        }
        summary
    };
    assert_eq!(summary(a), summary(b));
}

/// The value of a metric in a summary.
pub fn metric(summary: &Value, name: &str) -> f64 {
    let metrics = summary["metrics"].as_array().expect("a list of metrics");
    let found = metrics.iter().find(|metric| metric["name"] == name);
    found.and_then(|metric| metric["value"].as_f64()).unwrap_or_else(|| panic!("no metric {name}"))
}

/// A CSV file by columns.
pub struct Columns {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Columns {
    /// Reads a CSV file of numbers.
    pub fn read(path: impl AsRef<Path>) -> Self {
        let text = read(path);
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let names = reader.headers().expect("a header").iter().map(str::to_owned).collect();
        Self { names, rows: reader.deserialize().map(|row| row.expect("a row of numbers")).collect() }
    }

    /// The header as one line.
    pub fn header(&self) -> String {
        self.names.join(",")
    }

    /// One column.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let index = self.names.iter().position(|n| n == name).unwrap_or_else(|| panic!("no column {name}"));
        self.rows.iter().map(|row| row[index]).collect()
    }
}

/// The largest difference between two signals, the second taken at every `every`-th sample.
pub fn largest_difference(a: &[f64], b: &[f64], every: usize) -> f64 {
    a.iter().zip(b.iter().step_by(every)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
