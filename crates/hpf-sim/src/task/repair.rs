//! A task file with mistakes, made readable: what is wrong is replaced, so that the rest can be checked too.
//!
//! What stands in for a mistake is chosen twice, differently. A contradiction that is the same both times is one of the
//! file itself; one that comes and goes with the stand-in is not told.

use core::ops::Range;
use std::collections::HashSet;

use serde_json::Value as Schema;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

use super::keys::{Document, Schemas, names, required};

/// A document with stand-ins for what is told to be wrong.
pub(super) struct Repair<'s, 't> {
    pub(super) schemas: Schemas<'s>,
    /// Places of the mistakes.
    pub(super) told: &'t HashSet<Range<usize>>,
    /// Which of the two stand-ins.
    pub(super) is_second: bool,
}

impl<'s> Repair<'s, '_> {
    /// The whole of `document`, read by `schema`.
    pub(super) fn of(&self, document: &Document<'_>, schema: &'s Schema) -> Value {
        self.table(schema, document.root())
    }

    fn table(&self, schema: &'s Schema, table: &DeTable<'_>) -> Value {
        let mut whole = Table::new();
        for (name, value) in table {
            // What is not known is told, and nobody reads it.
            if let Some(schema) = schema["properties"].get(name.get_ref().as_ref()) {
                whole.insert(name.get_ref().to_string(), self.value(schema, value));
            }
        }
        for name in required(schema) {
            let stand_in = || self.stand_in(&schema["properties"][name]);
            whole.entry(name.to_owned()).or_insert_with(stand_in);
        }
        Value::Table(whole)
    }

    fn value(&self, schema: &'s Schema, value: &Spanned<DeValue<'_>>) -> Value {
        if self.told.contains(&value.span()) {
            return self.stand_in(schema);
        }
        let alternatives = self.schemas.alternatives(schema);
        match value.get_ref() {
            DeValue::Table(table) => match self.meant(&alternatives, table) {
                Some(schema) => self.table(schema, table),
                None => self.stand_in(schema),
            },
            DeValue::Array(items) => {
                let list = alternatives.iter().find(|schema| schema["type"] == "array").unwrap_or(&alternatives[0]);
                Value::Array(items.iter().map(|item| self.value(&list["items"], item)).collect())
            }
            DeValue::String(text) => Value::String(text.to_string()),
            DeValue::Boolean(is_true) => Value::Boolean(*is_true),
            DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
                Ok(number) => Value::Integer(number),
                Err(_) => self.stand_in(schema),
            },
            DeValue::Float(number) => Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Datetime(_) => self.stand_in(schema),
        }
    }

    /// Of several kinds of table the one that is meant, where that can be told.
    fn meant(&self, alternatives: &[&'s Schema], table: &DeTable<'_>) -> Option<&'s Schema> {
        let tables = || alternatives.iter().copied().filter(|schema| schema["type"] == "object");
        let kind = table.iter().find(|(key, _)| key.get_ref() == "kind").and_then(|(_, kind)| kind.get_ref().as_str());
        let is_kind = |schema: &&Schema| kind.is_some_and(|kind| names(&schema["properties"]["kind"]).contains(&kind));
        let has_all =
            |schema: &&Schema| required(schema).all(|name| table.iter().any(|(key, _)| key.get_ref() == name));
        tables().find(is_kind).or_else(|| tables().filter(|_| kind.is_none()).find(has_all)).or_else(|| {
            let mut only = tables();
            only.next().filter(|_| only.next().is_none())
        })
    }

    /// A value that `schema` allows.
    fn stand_in(&self, schema: &'s Schema) -> Value {
        let schema = self.schemas.alternatives(schema)[0];
        if let [first, ..] = names(schema)[..] {
            return Value::String(first.into());
        }
        let bound = |name: &str| schema[name].as_f64();
        let kind = match &schema["type"] {
            Schema::Array(kinds) => kinds.first().and_then(Schema::as_str),
            kind => kind.as_str(),
        };
        let more = f64::from(u8::from(self.is_second));
        match kind {
            Some("integer") => Value::Integer((bound("minimum").unwrap_or(0.0).max(1.0) + more) as i64),
            Some("number") => {
                let most = bound("maximum").or(bound("exclusiveMaximum")).unwrap_or(f64::INFINITY);
                let least = bound("minimum").or(bound("exclusiveMinimum")).unwrap_or(0.0);
                let share = 0.3 + 0.07 * more;
                Value::Float(if most.is_finite() { least + share * (most - least) } else { least + 1.0 + 0.7 * more })
            }
            Some("string") => Value::String(if self.is_second { "b" } else { "a" }.into()),
            Some("boolean") => Value::Boolean(self.is_second),
            Some("array") => {
                let count = schema["minItems"].as_u64().unwrap_or(0) as usize + usize::from(self.is_second);
                Value::Array(vec![self.stand_in(&schema["items"]); count])
            }
            _ => Value::Table(
                required(schema).map(|name| (name.into(), self.stand_in(&schema["properties"][name]))).collect(),
            ),
        }
    }
}
