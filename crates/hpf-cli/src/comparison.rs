//! Runs side by side: their costs and measures, and the keys in which their tasks differ.

use core::fmt;
use std::collections::BTreeMap;

use serde_json::{Value, json};

use hpf::escape::line as one_line;
use hpf::words::{measure, number};

/// Longest value of a task key that is shown whole [letters].
const LONGEST: usize = 28;
/// Letters of the first column.
const FIRST: usize = 22;

/// One run.
pub struct Side {
    /// How it was named.
    pub name: String,
    /// Its summary.json.
    pub summary: Value,
    /// Its task, defaults filled in.
    pub task: Value,
}

/// Several runs.
pub struct Comparison {
    sides: Vec<Side>,
    /// The keys in which their tasks differ, with the value in each; null where it has none.
    differing: BTreeMap<String, Vec<Value>>,
}

/// A number of every run, where it has one.
struct Row {
    name: String,
    /// Of each run: a measure over axes of several units has none.
    units: Vec<String>,
    values: Vec<Option<f64>>,
    /// Of each run, whether its target was met.
    passes: Vec<Option<bool>>,
    /// Whether the least is marked.
    marks_least: bool,
}

impl Comparison {
    /// Compares runs.
    pub fn new(sides: Vec<Side>) -> Self {
        let mut keys = vec![BTreeMap::new(); sides.len()];
        for (side, keys) in sides.iter().zip(&mut keys) {
            flatten(&side.task, String::new(), keys);
        }
        let mut differing = BTreeMap::new();
        for key in keys.iter().flat_map(BTreeMap::keys) {
            let values: Vec<Value> = keys.iter().map(|keys| keys.get(key).cloned().unwrap_or_default()).collect();
            if values.iter().any(|value| *value != values[0]) {
                differing.insert(key.clone(), values);
            }
        }
        Self { sides, differing }
    }

    /// The same for programs.
    pub fn to_json(&self) -> Value {
        let runs = self.sides.iter().map(|side| json!({ "directory": side.name, "summary": side.summary }));
        json!({
            "format": "hpf-comparison", "version": 1,
            "runs": runs.collect::<Vec<_>>(), "differing_keys": self.differing,
        })
    }

    /// Whether all runs are of one task: only then is the least cost the best.
    fn is_one_task(&self) -> bool {
        self.sides.iter().all(|side| side.summary["task"] == self.sides[0].summary["task"])
    }

    /// A cost term before or after learning, in the order of the first run that has it.
    fn costs(&self, when: &str) -> Vec<Row> {
        let terms = |side: &Side| side.summary["cost"][when].as_object().cloned().unwrap_or_default();
        // The total is the last line, as under a sum.
        let mut names = names_of(self.sides.iter().map(|side| terms(side).keys().cloned().collect()));
        names.sort_by_key(|name| name == "total");
        let row = |name: String| Row {
            values: self.sides.iter().map(|side| terms(side).get(&name).and_then(Value::as_f64)).collect(),
            passes: vec![None; self.sides.len()],
            units: vec![String::new(); self.sides.len()],
            marks_least: self.is_one_task(),
            name,
        };
        let mut rows: Vec<Row> = names.into_iter().map(row).collect();
        rows.retain(|row| row.values.iter().any(|value| value.is_some_and(|value| value != 0.0)));
        rows
    }

    fn measures(&self) -> Vec<Row> {
        let of = |side: &Side| side.summary["metrics"].as_array().cloned().unwrap_or_default();
        let text = |metric: &Value, key: &str| metric[key].as_str().unwrap_or_default().to_owned();
        let names = self.sides.iter().map(|side| of(side).iter().map(|metric| text(metric, "name")).collect());
        let row = |name: String| {
            let found = self.sides.iter().map(|side| of(side).into_iter().find(|metric| metric["name"] == *name));
            let found: Vec<Value> = found.map(Option::unwrap_or_default).collect();
            Row {
                units: found.iter().map(|metric| text(metric, "unit")).collect(),
                values: found.iter().map(|metric| metric["value"].as_f64()).collect(),
                passes: found.iter().map(|metric| metric["pass"].as_bool()).collect(),
                marks_least: self.is_one_task() && name.starts_with("max_"),
                name,
            }
        };
        names_of(names).into_iter().map(row).collect()
    }
}

/// All names, each once, in the order of their first appearance.
fn names_of(lists: impl Iterator<Item = Vec<String>>) -> Vec<String> {
    let mut names = Vec::new();
    for name in lists.flatten() {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// The values of a task by their keys, as `--set` names them.
fn flatten(value: &Value, path: String, keys: &mut BTreeMap<String, Value>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Object(table) => table.iter().for_each(|(key, value)| flatten(value, below(key), keys)),
        // A list of tables goes entry by entry, a list of numbers is one value.
        Value::Array(list) if list.iter().any(Value::is_object) => {
            list.iter().enumerate().for_each(|(i, value)| flatten(value, below(&i.to_string()), keys));
        }
        Value::Null => {}
        value => drop(keys.insert(path, value.clone())),
    }
}

impl Row {
    /// Cells: each value, `*` at the least of those that differ, `!` where a target is missed; for two runs the change.
    fn cells(&self) -> Vec<String> {
        let known = self.values.iter().flatten();
        let (least, most) = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), v| (l.min(*v), m.max(*v)));
        let cell = |((value, unit), pass): ((&Option<f64>, &String), &Option<bool>)| {
            let Some(value) = value else { return "-  ".to_owned() };
            let miss = if *pass == Some(false) { "!" } else { " " };
            let best = if self.marks_least && least < most && *value == least { "*" } else { " " };
            format!("{}{miss}{best}", measure(*value, unit))
        };
        let mut cells: Vec<String> = self.values.iter().zip(&self.units).zip(&self.passes).map(cell).collect();
        if let [Some(first), Some(second)] = self.values[..]
            && self.units[0] == self.units[1]
        {
            cells.push(change(first, second));
        }
        cells
    }
}

/// How much larger `second` is, in percent, or as a factor where percents say little.
fn change(first: f64, second: f64) -> String {
    let ratio = second / first;
    match ratio {
        _ if first == second => "=".into(),
        _ if !ratio.is_finite() || ratio <= 0.0 => String::new(),
        ratio if ratio > 1e4 => format!("x {ratio:.1e}"),
        ratio if ratio < 1e-4 => format!("x 1/{:.1e}", ratio.recip()),
        ratio if ratio > 10.0 => format!("x {}", number(ratio)),
        ratio if ratio < 0.1 => format!("x 1/{}", number(ratio.recip())),
        ratio => format!("{:+.1} %", 100.0 * (ratio - 1.0)),
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.sides.iter().map(|side| side.name.chars().count() + 2).max().unwrap_or(0).max(18);
        let mut line = |name: &str, cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|cell| format!("{:>width$}", one_line(cell))).collect();
            let (name, gap) = (one_line(name.trim_start_matches('\n')), if name.starts_with('\n') { "\n" } else { "" });
            writeln!(f, "{gap}{}", format!("{name:<FIRST$}{}", cells.concat()).trim_end())
        };
        let each = |of: &dyn Fn(&Side) -> String| self.sides.iter().map(|side| of(side) + "  ").collect::<Vec<_>>();
        let word = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let mut head = each(&|side| side.name.clone());
        if self.sides.len() == 2 {
            head.push("change".into());
        }
        line("run", &head)?;
        for (name, key) in [
            ("task", "task"),
            ("method", "method"),
            ("seed", "seed"),
            ("updates", "updates"),
            ("motions", "rollouts_total"),
        ] {
            line(name, &each(&|side| word(&side.summary[key])))?;
        }
        line("learning", &each(&|side| format!("{:.2} s", side.summary["learning_s"].as_f64().unwrap_or(f64::NAN))))?;
        for (title, rows) in [
            ("\ncost before", self.costs("initial").split_off(self.costs("initial").len().saturating_sub(1))),
            ("\ncost after", self.costs("final")),
            ("\nmeasure", self.measures()),
        ] {
            line(title, &[])?;
            rows.iter().try_for_each(|row| line(&format!("  {}", row.name), &row.cells()))?;
        }
        if self.differing.is_empty() {
            line("\nthe tasks are the same", &[])?;
        } else {
            line("\nkey of the task", &[])?;
        }
        for (key, values) in &self.differing {
            let words: Vec<String> =
                values.iter().map(|value| if value.is_null() { "-".into() } else { word(value) }).collect();
            let shown = shortened(&words).into_iter().map(|word| word + "  ");
            line(&format!("  {key}"), &shown.collect::<Vec<_>>())?;
        }
        let least = if self.is_one_task() { "* the least of the row   " } else { "" };
        writeln!(f, "\n{least}! misses its target")
    }
}

/// Texts that are not all the same, each cut to what a column holds; what the long ones have in common goes first.
fn shortened(texts: &[String]) -> Vec<String> {
    let is_long = |text: &&String| text.chars().count() > LONGEST;
    let same = |at: usize| {
        let mut letters = texts.iter().filter(is_long).map(|text| text.chars().nth(at));
        let first = letters.next().flatten();
        first.is_some() && letters.all(|letter| letter == first)
    };
    let common = (0..).take_while(|at| same(*at)).count();
    // A difference that the beginning shows, or one long text alone, needs no cut in front.
    let from = if common + 6 < LONGEST || texts.iter().filter(is_long).count() < 2 { 0 } else { common - 3 };
    let cut = |text: &String| {
        if !is_long(&text) {
            return text.clone();
        }
        let front = if from == 0 { "" } else { "..." };
        let rest: String = text.chars().skip(from).collect();
        let room = LONGEST - front.len();
        let is_rest_long = rest.chars().count() > room;
        let shown: String = rest.chars().take(if is_rest_long { room - 3 } else { room }).collect();
        format!("{front}{shown}{}", if is_rest_long { "..." } else { "" })
    };
    texts.iter().map(cut).collect()
}

#[cfg(test)]
mod tests {
    use super::shortened;

    #[test]
    fn long_values_are_cut_so_that_their_difference_shows() {
        let of = |texts: &[&str]| shortened(&texts.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>());
        assert_eq!(of(&["short", "-"]), ["short", "-"]);
        assert_eq!(of(&["abcdefghijklmnopqrstuvwxyz0123456789", "-"]), ["abcdefghijklmnopqrstuvwxy...", "-"]);
        let long = |end: &str| format!("[\"movement\", \"goal\", \"stiffness\", {end}]");
        assert_eq!(of(&[&long("\"damping\""), &long("\"mass\"")]), ["..., \"damping\"]", "..., \"mass\"]"]);
        assert_eq!(of(&[&long("1"), &long("1")[1..]])[1], "\"movement\", \"goal\", \"stif...");
    }
}
