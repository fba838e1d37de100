//! A task as a page has it: its text, and what can be drawn and dragged of it.

use std::collections::BTreeMap;

use hpf_sim::Task;
use hpf_sim::environment::Disturbance;
use hpf_sim::environment::disturbance::Samples;
use toml_edit::DocumentMut;
use wasm_bindgen::JsError;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::refused;

/// The rows of each force table that the task names: times [s] and forces [N].
type Tables = BTreeMap<String, Vec<(f64, f64)>>;

/// A task that was read.
#[wasm_bindgen]
#[derive(Clone)]
pub struct WebTask {
    pub(crate) task: Task,
    pub(crate) text: String,
    tables: Tables,
}

impl WebTask {
    /// Reads `text`, whose force tables are `tables`.
    ///
    /// # Errors
    /// Every mistake with its line and column; a table that is not there; an environment that is a process.
    pub fn read(text: &str, tables: Tables) -> Result<Self, String> {
        let mut task = Task::parse(text).map_err(|mistakes| mistakes.to_string())?;
        for disturbance in &mut task.disturbance {
            if let Disturbance::Table(table) = disturbance {
                let rows = tables.get(&table.file).ok_or_else(|| {
                    format!("the page does not hold the force table `{}`: keep `file` as it was", table.file)
                })?;
                table.samples = Samples::new(rows).map_err(|error| format!("{}: {error}", table.file))?;
            }
        }
        if task.environment.is_some() {
            return Err("the motions of this task are made by a process, which a page cannot start".into());
        }
        Ok(Self { task, text: text.to_owned(), tables })
    }

    /// The text with `value` in place of that of the key `path`, or with the key where its table is there without it;
    /// comments and order stay.
    ///
    /// # Errors
    /// Where the table of `path` is not in the text, `value` is no value of TOML, or the task would be none.
    pub fn changed(&self, path: &str, value: &str) -> Result<Self, String> {
        let mut document: DocumentMut = self.text.parse().map_err(|error| format!("{error}"))?;
        let value: toml_edit::Value = value.parse().map_err(|error| format!("{value}: {error}"))?;
        let mut item = document.as_item_mut();
        let (parents, last) = path.rsplit_once('.').map_or(("", path), |(parents, last)| (parents, last));
        for part in parents.split('.').filter(|part| !part.is_empty()) {
            let next = match part.parse::<usize>() {
                Ok(index) => item.get_mut(index),
                Err(_) => item.get_mut(part),
            };
            item = next.ok_or_else(|| format!("the task has no `{path}`"))?;
        }
        if let Some(table) = item.as_table_like_mut().filter(|table| !table.contains_key(last)) {
            table.insert(last, toml_edit::value(value));
            return Self::read(&document.to_string(), self.tables.clone());
        }
        let item = match last.parse::<usize>() {
            Ok(index) => item.get_mut(index),
            Err(_) => item.get_mut(last),
        };
        let item = item.ok_or_else(|| format!("the task has no `{path}`"))?;
        let slot = item.as_value_mut().ok_or_else(|| format!("`{path}` is no single value"))?;
        let decor = slot.decor().clone();
        *slot = value;
        *slot.decor_mut() = decor;
        Self::read(&document.to_string(), self.tables.clone())
    }
}

#[wasm_bindgen]
impl WebTask {
    /// Reads the task `text`; `tables` is a JSON object of the force tables that it names, each a list of [s, N].
    ///
    /// # Errors
    /// What is wrong with it, by line and column.
    #[wasm_bindgen(constructor)]
    pub fn parse(text: &str, tables: &str) -> Result<WebTask, JsError> {
        let tables = serde_json::from_str(tables).map_err(refused)?;
        Self::read(text, tables).map_err(refused)
    }

    /// The text.
    pub fn text(&self) -> String {
        self.text.clone()
    }

    /// What can be drawn and dragged, as JSON: axes with start, goal and bounds, via points, contact, forces, method.
    pub fn describe(&self) -> String {
        self.task.outline().to_string()
    }

    /// The task with `value`, TOML, in place of that of the key `path`, such as `via_point.0.position`.
    ///
    /// # Errors
    /// What is wrong with the task that it would be.
    pub fn with(&self, path: &str, value: &str) -> Result<WebTask, JsError> {
        self.changed(path, value).map_err(refused)
    }
}

/// The JSON schema of the task file.
#[wasm_bindgen]
pub fn schema() -> String {
    Task::schema().to_string()
}
