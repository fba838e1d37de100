//! A sweep in the terminal.

use core::fmt::Write as _;

use serde_json::Value;

use crate::render::wrapped;
use hpf::words::number;

/// The results of the runs of a sweep, by setting.
pub fn render(summary: &Value, kept: usize, seconds: f64, folder: &str, files: &[String]) -> String {
    let list = |key: &str| summary[key].as_array().map(Vec::as_slice).unwrap_or_default();
    let mut text = format!(
        "{}: {} of {} runs finished, {} failed, {kept} were there before; {seconds:.1} s\n\n",
        summary["task"].as_str().unwrap_or("?"),
        summary["finished"],
        summary["planned"],
        list("failures").len(),
    );
    let name = |setting: &Value| {
        let keys = setting["set"].as_object().into_iter().flatten();
        let parts: Vec<String> = keys.map(|(key, value)| format!("{key}={}", value.as_str().unwrap_or("?"))).collect();
        if parts.is_empty() { "as in the task".into() } else { parts.join(", ") }
    };
    let width = list("settings").iter().map(|setting| name(setting).chars().count()).max().unwrap_or(0).max(14);
    let _ = writeln!(text, "{:<width$}  runs  met targets   cost: median (quartiles)        motions", "setting");
    for setting in list("settings") {
        let of = |what: &str, which: &str| match what {
            "total" => setting["cost"]["total"][which].as_f64().map_or("-".into(), number),
            _ => setting[what][which].as_f64().map_or("-".into(), |value| format!("{value:.0}")),
        };
        let judged = setting["passed"].as_u64().unwrap_or(0) + setting["missed"].as_u64().unwrap_or(0);
        let met = if judged == 0 { "-".into() } else { format!("{} of {judged}", setting["passed"]) };
        let cost = format!(
            "{} ({} .. {})",
            of("total", "median"),
            of("total", "lower_quartile"),
            of("total", "upper_quartile")
        );
        let _ = writeln!(
            text,
            "{:<width$}  {:>4}  {met:>11}   {cost:<30} {:>8}",
            name(setting),
            setting["finished"].to_string(),
            of("motions", "median")
        );
    }
    let _ = write!(text, "\nwritten to {folder}, the runs in its runs/:\n{}", wrapped(files));
    text
}
