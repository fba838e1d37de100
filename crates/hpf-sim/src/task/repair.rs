//! A task file with mistakes, made readable: what is wrong is replaced, so that the rest can be checked too.
//!
//! What stands in for a mistake is chosen twice, differently. A contradiction that is the same both times is one of the
//! file itself; one that comes and goes with the stand-in is not told.

use core::cell::RefCell;
use core::ops::Range;
use std::collections::HashSet;

use serde::de::DeserializeOwned;
use serde_json::Value as Schema;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

use super::Diagnostic;
use super::keys::{Document, Schemas, has_type, lengths, names, required};
use super::reading::Rules;

/// Appends the contradictions of a `document` that cannot be read for its other mistakes, those `found`: what does not
/// hang on any of them.
pub(super) fn contradictions<V: DeserializeOwned>(
    document: &Document<'_>,
    schema: &Schema,
    rules: Rules<'_, V>,
    found: &mut Vec<Diagnostic>,
) {
    let told: HashSet<_> = found.iter().map(|diagnostic| diagnostic.span.clone()).collect();
    let of_repaired = |is_second: bool| {
        let schemas = Schemas::of(schema);
        let repair = Repair { schemas, told: &told, is_second, replaced: RefCell::default() };
        let value = V::deserialize(Value::Table(repair.table(schema, document.root()))).ok()?;
        let mut all = found.clone();
        rules(&value, document, &mut all);
        Some((all.split_off(found.len()), repair.replaced.take()))
    };
    let (Some((first, replaced)), Some((second, _))) = (of_repaired(false), of_repaired(true)) else { return };
    let is_told = |span: &Range<usize>| {
        told.contains(span) || replaced.iter().any(|whole| whole.start <= span.start && span.end <= whole.end)
    };
    found.extend(first.into_iter().filter(|one| second.contains(one) && !is_told(&one.span)));
}

/// Stand-ins for what is told to be wrong in a document.
struct Repair<'s, 't> {
    schemas: Schemas<'s>,
    /// Places of the mistakes.
    told: &'t HashSet<Range<usize>>,
    /// Which of the two stand-ins.
    is_second: bool,
    /// Places of what is replaced, with all that it holds.
    replaced: RefCell<Vec<Range<usize>>>,
}

impl<'s> Repair<'s, '_> {
    fn table(&self, schema: &'s Schema, table: &DeTable<'_>) -> Table {
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
        whole
    }

    fn value(&self, schema: &'s Schema, value: &Spanned<DeValue<'_>>) -> Value {
        let alternatives = self.schemas.alternatives(schema);
        // What is told of a table is what it lacks, which is filled in: the rest stays.
        if let DeValue::Table(table) = value.get_ref()
            && let Some(schema) = self.meant(&alternatives, table)
        {
            return Value::Table(self.table(schema, table));
        }
        self.read(&alternatives, value).unwrap_or_else(|| {
            self.replaced.borrow_mut().push(value.span());
            self.stand_in(schema)
        })
    }

    /// A value that is no table, where it can be read. A list under double brackets has the place of its first table: what
    /// is told there need not be told of the list.
    fn read(&self, alternatives: &[&'s Schema], value: &Spanned<DeValue<'_>>) -> Option<Value> {
        let schema = alternatives.iter().find(|schema| has_type(schema, value.get_ref()))?;
        if let DeValue::Array(items) = value.get_ref() {
            let items = lengths(schema).contains(&items.len()).then_some(items)?;
            return Some(Value::Array(items.iter().map(|item| self.value(&schema["items"], item)).collect()));
        }
        if self.told.contains(&value.span()) {
            return None;
        }
        Some(match value.get_ref() {
            DeValue::String(text) => Value::String(text.to_string()),
            DeValue::Boolean(is_true) => Value::Boolean(*is_true),
            DeValue::Integer(number) => Value::Integer(i64::from_str_radix(number.as_str(), number.radix()).ok()?),
            DeValue::Float(number) => Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Array(_) | DeValue::Table(_) | DeValue::Datetime(_) => return None,
        })
    }

    /// Of several kinds of table the one that is meant: that of its `kind`, the one it has a key of, or the only one. Of
    /// an unknown kind, one of them: what is wrong with two of them is wrong with the table.
    fn meant(&self, alternatives: &[&'s Schema], table: &DeTable<'_>) -> Option<&'s Schema> {
        let tables: Vec<&Schema> = alternatives.iter().copied().filter(|schema| schema["type"] == "object").collect();
        let has = |name: &str| table.iter().any(|(key, _)| key.get_ref() == name);
        if let [only] = tables[..] {
            return Some(only);
        }
        if tables.iter().all(|schema| schema["properties"]["kind"].is_object()) {
            let kind =
                table.iter().find(|(key, _)| key.get_ref() == "kind").and_then(|(_, kind)| kind.get_ref().as_str());
            let is_kind =
                |schema: &&Schema| kind.is_some_and(|kind| names(&schema["properties"]["kind"]).contains(&kind));
            let any = tables.get(usize::from(self.is_second)).copied();
            return tables.iter().copied().find(is_kind).or(any);
        }
        let mut given = tables.iter().copied().filter(|schema| required(schema).any(has));
        given.next().filter(|_| given.next().is_none())
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
