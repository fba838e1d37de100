//! The key-by-key page of the task file is what the code says: `UPDATE_DOCS=1 cargo test -p hpf-sim --test all docs::`
//! writes it, the test without it checks it.

use core::fmt::Write as _;
use std::path::Path;

use hpf_sim::Task;
use serde_json::Value;

const OPENING: &str = "\
# The task file, key by key

TOML. SI units: a linear axis in m and N, a rotary one in rad and N m. A value per axis is one number for all axes, or
an array in axis order. A key without a default must be given. `hpf check TASK` answers every mistake with its place,
and `--set key.path=value` overrides a key from the command line (lists by position: `via_point.0.time=2.0`).

This page is made from the code: `UPDATE_DOCS=1 cargo test -p hpf-sim --test all docs::`.
";

struct Page<'s> {
    definitions: &'s Value,
    text: String,
}

impl<'s> Page<'s> {
    fn resolve(&self, schema: &'s Value) -> &'s Value {
        match schema["$ref"].as_str().and_then(|reference| reference.rsplit('/').next()) {
            Some(name) => &self.definitions[name],
            None => schema,
        }
    }

    fn members(&self, schema: &'s Value) -> Vec<&'s Value> {
        let schema = self.resolve(schema);
        match schema["anyOf"].as_array().or_else(|| schema["oneOf"].as_array()) {
            Some(members) => members.iter().flat_map(|m| self.members(m)).filter(|m| m["type"] != "null").collect(),
            None => vec![schema],
        }
    }

    /// A type in a few words.
    fn kind(&self, schema: &'s Value) -> String {
        let mut words = Vec::new();
        for member in self.members(schema) {
            let names = member["enum"].as_array().into_iter().flatten().chain([&member["const"]]);
            let names: Vec<String> = names.filter_map(Value::as_str).map(|name| format!("`\"{name}\"`")).collect();
            let kind = member["type"].as_str().or_else(|| member["type"][0].as_str()).unwrap_or_default();
            words.push(match kind {
                _ if !names.is_empty() => names.join(", "),
                "array" => match self.kind(&member["items"]).as_str() {
                    table if table.starts_with("table") => "tables, see below".to_owned(),
                    items => format!("array of {items}"),
                },
                "object" => {
                    let keys: Vec<&String> =
                        member["properties"].as_object().into_iter().flatten().map(|p| p.0).collect();
                    match keys.as_slice() {
                        [only] => format!("`{{ {only} = ... }}`"),
                        _ => "table, see below".to_owned(),
                    }
                }
                kind => kind.to_owned(),
            });
        }
        words.dedup();
        let mut limits = vec![words.join(" or ")];
        let bounds = [("minimum", ">="), ("exclusiveMinimum", ">"), ("maximum", "<="), ("exclusiveMaximum", "<")];
        for (name, sign) in bounds {
            // A whole number is written as it is, whatever its size.
            if let Some(bound) = schema[name].as_i64() {
                limits.push(format!("{sign} {bound}"));
            } else if let Some(bound) = schema[name].as_f64() {
                let (plain, short) = (bound.to_string(), format!("{bound:e}"));
                limits.push(format!("{sign} {}", if plain.len() > 7 { short } else { plain }));
            }
        }
        limits.join(", ")
    }

    fn table(&mut self, title: &str, schema: &'s Value) {
        let description = one_line(&schema["description"]);
        let _ = writeln!(
            self.text,
            "\n## {title}\n\n{description}\n\n| key | type | default | meaning |\n|---|---|---|---|"
        );
        let required: Vec<&str> =
            schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        for (key, property) in schema["properties"].as_object().into_iter().flatten() {
            if key == "kind" {
                continue;
            }
            let default = match &property["default"] {
                _ if required.contains(&key.as_str()) => "".to_owned(),
                Value::Null => "none".to_owned(),
                Value::Object(_) | Value::Array(_) => "".to_owned(),
                default => format!("`{default}`"),
            };
            let target = self.resolve(property);
            let meaning = one_line(if property["description"].is_null() {
                &target["description"]
            } else {
                &property["description"]
            });
            let kind = self.kind(property);
            let _ = writeln!(self.text, "| `{key}` | {kind} | {default} | {meaning} |");
        }
    }
}

fn one_line(text: &Value) -> String {
    text.as_str().unwrap_or_default().replace('\n', " ")
}

#[test]
fn the_page_of_the_task_file_is_what_the_code_says() {
    let schema = Task::schema();
    let mut page = Page { definitions: &schema["$defs"], text: OPENING.to_owned() };
    page.table("Top level", &schema);
    for (key, name) in [
        ("[[axis]]", "Axis"),
        ("[phase]", "Phase"),
        ("[movement]", "Movement"),
        ("[stiffness] and [damping]", "Gain"),
        ("[movement], [stiffness] and [damping] basis", "BasisTable"),
        ("[admittance]", "Admittance"),
        ("[sensor]", "Sensor"),
        ("[actuator]", "Actuator"),
        ("[recording]", "Recording"),
        ("[[via_point]]", "ViaPoint"),
        ("[cost]", "CostWeights"),
        ("[learning]", "Learning"),
        ("[learning] noise", "Noise"),
        ("[learning] covariance", "CovarianceKind"),
        ("[learning.safety]", "Safety"),
        ("[output]", "Output"),
        ("[accept]", "Accept"),
    ] {
        page.table(key, &schema["$defs"][name]);
    }
    for (key, name) in [("[environment]", "Environment"), ("[[disturbance]]", "Disturbance"), ("[contact]", "Contact")]
    {
        for member in schema["$defs"][name]["oneOf"].as_array().expect("kinds") {
            let mut merged = page.resolve(member);
            if merged["properties"].as_object().is_none_or(|keys| keys.len() < 2) {
                merged = member;
            }
            let kind = member["properties"]["kind"]["const"].as_str().expect("a kind");
            page.table(&format!("{key} kind = \"{kind}\""), merged);
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/task-file.md");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&path, &page.text).expect("docs/ is writable");
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == page.text,
        "docs/task-file.md is out of date: UPDATE_DOCS=1 cargo test -p hpf-sim --test all docs::"
    );
}
