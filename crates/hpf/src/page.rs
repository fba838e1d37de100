//! A page that shows runs and lets them be touched: one HTML file that needs no network.
//!
//! Scripts, style and the core of HPF, compiled for pages (`web/`), lie in the file with the data; a content security
//! policy lets nothing else in. Text of runs is data for the scripts and never markup.
//!
//! ```
//! use hpf::page::{self, Exhibit};
//! # let task = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tasks/reach.toml");
//! let exhibit = Exhibit::load(task.as_ref(), "reach".into())?;
//! let html = page::html(&[exhibit], "hpf report tasks/reach.toml")?;
//! assert!(html.starts_with("<!DOCTYPE html>") && html.len() < page::MAX_BYTES);
//! # Ok::<(), hpf::Failure>(())
//! ```

mod data;

use std::path::Path;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use hpf_sim::environment::Disturbance;
use hpf_sim::task::Task;
use serde_json::{Map, Value, json};
use sha2::{Digest as _, Sha256};

use crate::failure::Failure;
use crate::files::{in_file, read_task, read_text, verify_run};
use crate::results::Run;
use crate::words::typed;

/// The largest page [bytes].
pub const MAX_BYTES: usize = 3_000_000;
/// The most runs in a page.
pub const MOST_RUNS: usize = 16;

const TEMPLATE: &str = include_str!("page/page.html");
const STYLE: [&str; 2] = [include_str!("page/uplot/uPlot.min.css"), include_str!("page/style.css")];
const UPLOT_LICENCE: &str = include_str!("page/uplot/LICENSE");
const UPLOT: &str = include_str!("page/uplot/uPlot.iife.min.js");
/// The scripts in the order in which they need each other.
const SCRIPTS: [&str; 8] = [
    include_str!("page/base.js"),
    include_str!("page/charts.js"),
    include_str!("page/scene.js"),
    include_str!("page/engine.js"),
    include_str!("page/edit.js"),
    include_str!("page/touch.js"),
    include_str!("page/result.js"),
    include_str!("page/app.js"),
];
/// The core as `scripts/web.sh --update` builds it of `web/`.
const GLUE: &str = include_str!("page/core/core.js");
const CORE: &[u8] = include_bytes!("page/core/core.wasm.gz");

/// What a page shows: a run, or a task that is not learned yet.
pub struct Exhibit {
    /// What it is called.
    pub name: String,
    /// The task.
    task: Task,
    /// Its text.
    text: String,
    /// What was learned.
    run: Option<Run>,
    /// The result of the run.
    summary: Option<Value>,
    /// The line that makes it.
    commands: Vec<String>,
    /// What the reader is to know of it.
    notes: Vec<String>,
}

impl Exhibit {
    /// The run directory or task file `path`, called `name`.
    ///
    /// # Errors
    /// [`Failure::Input`] that names what is missing or damaged.
    pub fn load(path: &Path, name: String) -> Result<Self, Failure> {
        if !path.is_dir() {
            let loaded = read_task(path, &[])?;
            let commands = vec![format!("hpf learn {}", typed(path.display()))];
            return Ok(Self {
                name,
                task: loaded.task,
                text: loaded.text,
                run: None,
                summary: None,
                commands,
                notes: loaded.notes,
            });
        }
        let run = Run::load(path)?;
        let text = read_text(&path.join("task.toml"))?;
        let task = read_task(&path.join("task.toml"), &[])?.task;
        let place = path.join("summary.json");
        verify_run(&place)?;
        let summary: Value = serde_json::from_str(&read_text(&place)?).map_err(in_file(&place))?;
        if !is_summary(&summary) {
            return Err(in_file(&place)("this is not the summary of a run"));
        }
        let shown = typed(path.display());
        let commands = vec![format!("hpf learn {shown}/task.toml --out again"), format!("hpf info {shown} again")];
        Ok(Self { name, task, text, run: Some(run), summary: Some(summary), commands, notes: Vec::new() })
    }

    /// The force tables that the task names, each a list of \[s, N\].
    fn tables(&self) -> Map<String, Value> {
        let tables = self.task.disturbance.iter().filter_map(|disturbance| match disturbance {
            Disturbance::Table(table) => {
                let rows: Vec<Value> = table.samples.rows().map(|(time, force)| json!([time, force])).collect();
                Some((table.file.clone(), Value::Array(rows)))
            }
            _ => None,
        });
        tables.collect()
    }
}

/// Whether the parts of a summary that a page shows are there.
fn is_summary(summary: &Value) -> bool {
    let cost = |which: &str| summary["cost"][which].is_object();
    let are_measures = summary["metrics"].as_array().is_some_and(|all| all.iter().all(Value::is_object));
    cost("initial") && cost("final") && are_measures
}

/// The page of `exhibits`, made by the line `command`.
///
/// # Errors
/// [`Failure::Input`] for no exhibits, too many, or more than fits into [`MAX_BYTES`].
pub fn html(exhibits: &[Exhibit], command: &str) -> Result<String, Failure> {
    if exhibits.is_empty() || exhibits.len() > MOST_RUNS {
        let message = format!("{} runs: a page shows 1 to {MOST_RUNS}", exhibits.len());
        return Err(Failure::Input(message));
    }
    let title = match exhibits {
        [one] => one.name.clone(),
        many => format!("{} and {} more", many[0].name, many.len() - 1),
    };
    let style = STYLE.concat();
    // A scope of its own: a name of the charts or the core is no name here.
    let script = format!("(() => {{\n\"use strict\";\n{}\n}})();\n", SCRIPTS.join("\n"));
    let wasm = BASE64_STANDARD.encode(CORE);
    let data = data::of(exhibits, command).to_string();
    let policy = content_policy(&style, &[GLUE, UPLOT, &script]);
    let fill = |name: &str| -> String {
        match name {
            "title" => escaped(&title),
            "version" => env!("CARGO_PKG_VERSION").to_owned(),
            "policy" => policy.clone(),
            "licence" => escaped(UPLOT_LICENCE),
            "style" => style.clone(),
            // Inside a script no text may end it or begin another.
            "data" => data.replace('<', "\\u003c"),
            "wasm" => wasm.clone(),
            "glue" => GLUE.to_owned(),
            "uplot" => UPLOT.to_owned(),
            "script" => script.clone(),
            other => unreachable!("the template has no {{{other}}}"),
        }
    };
    let page = filled(TEMPLATE, fill);
    if page.len() > MAX_BYTES {
        let message = format!(
            "a page of {} bytes, and at most {MAX_BYTES} make a file to mail: show fewer runs at once",
            page.len()
        );
        return Err(Failure::Input(message));
    }
    Ok(page)
}

/// `template` with what `fill` says in place of every `{name}`; what is filled in is not looked at again.
fn filled(template: &str, fill: impl Fn(&str) -> String) -> String {
    let mut page = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('{') {
        let (name, after) = after.split_once('}').expect("the template closes what it opens");
        page += before;
        page += &fill(name);
        rest = after;
    }
    page + rest
}

/// Lets in the style and scripts of the page by their hashes, the core and its worker, and nothing else.
fn content_policy(style: &str, scripts: &[&str]) -> String {
    let hash = |text: &str| format!("'sha256-{}'", BASE64_STANDARD.encode(Sha256::digest(text.as_bytes())));
    let scripts: Vec<String> = scripts.iter().map(|script| hash(script)).collect();
    format!(
        "default-src 'none'; script-src {} 'wasm-unsafe-eval'; style-src {}; worker-src blob:; base-uri 'none'; \
         form-action 'none'",
        scripts.join(" "),
        hash(style)
    )
}

/// Text as HTML has it.
fn escaped(text: &str) -> String {
    let mut safe = String::new();
    for letter in text.chars() {
        match letter {
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '&' => safe += "&amp;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            letter => safe.push(letter),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exhibit(name: &str) -> Exhibit {
        let task = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tasks/reach.toml");
        Exhibit::load(task.as_ref(), name.into()).unwrap()
    }

    #[test]
    fn names_with_markup_stay_text() {
        let hostile = "</script><script>alert(1)</script>\u{2028}<!--";
        let page = html(&[exhibit(hostile)], hostile).unwrap();
        assert!(!page.contains("<script>alert"));
        assert!(!page.contains("</script><script>a"));
        assert!(page.contains("&lt;/script&gt;&lt;script&gt;alert"));
        // Scripts end where the template ends them.
        assert_eq!(page.matches("</script").count(), TEMPLATE.matches("</script").count());
        assert_eq!(page.matches("<!--").count(), 0);
    }

    #[test]
    fn the_policy_names_the_hash_of_each_script_and_style_that_is_in_the_page() {
        let page = html(&[exhibit("reach")], "hpf report").unwrap();
        let said: Vec<&str> = page.split('\'').filter(|part| part.starts_with("sha256-")).collect();
        let mut found = Vec::new();
        for tag in ["style", "script"] {
            for part in page.split(&format!("<{tag}")).skip(1) {
                let (attributes, rest) = part.split_once('>').unwrap();
                let text = rest.split_once(&format!("</{tag}>")).unwrap().0;
                if !attributes.contains("type=") {
                    found.push(format!("sha256-{}", BASE64_STANDARD.encode(Sha256::digest(text))));
                }
            }
        }
        found.sort();
        let mut said: Vec<String> = said.iter().map(|one| (*one).to_owned()).collect();
        said.sort();
        assert_eq!(said, found);
        assert_eq!(found.len(), 4);
    }

    #[test]
    fn nothing_in_the_page_names_an_address_to_load_from() {
        let page = html(&[exhibit("reach")], "hpf report").unwrap();
        for loader in [" src=", "@import", "url(", "fetch(\"", "<link"] {
            let hits = page.matches(loader).count();
            assert_eq!(hits, 0, "{loader}");
        }
    }
}
