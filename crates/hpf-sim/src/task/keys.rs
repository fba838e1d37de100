//! Keys, types and ranges of a task file, checked against the schema of the structs that hold it.
//!
//! Reading into structs stops at the first mistake; a user wants them all. This walk of the parsed document finds
//! every unknown key, wrong type and number out of range, each with its place.

use core::fmt::Write as _;
use core::ops::{Range, RangeInclusive};
use std::borrow::Cow;

use serde_json::{Number, Value as Schema};
use toml::Spanned;
use toml::de::{DeArray, DeInteger, DeTable, DeValue};

use super::Diagnostic;

/// Keys that earlier versions had, and why they are gone.
const TAKEN_OUT: [(&str, &str); 1] = [("learning.elites", "it gained on one task and lost on another")];

/// A bracket left open is missed at every word after it: more errors of syntax than this say nothing new.
const MOST_SYNTAX_ERRORS: usize = 3;

/// A table of more keys is not told by its keys: the key that is wrong in it will be.
const MOST_KEYS: usize = 4;

/// A parsed task file: values with their places.
pub(super) struct Document<'a> {
    root: Spanned<DeTable<'a>>,
}

/// A mistake that the TOML parser found in `text`.
pub(super) fn from_toml(text: &str, error: &toml::de::Error) -> Diagnostic {
    let span = error.span().unwrap_or(0..0);
    let twice = text.get(span.clone()).filter(|_| error.message() == "duplicate key");
    let (message, help) = match twice {
        Some(key) => (
            format!("`{key}` is given twice"),
            "keep one of them; several of a kind, such as axes, stand under double brackets each: [[axis]]",
        ),
        None => (
            error.message().replace('\n', ", "),
            "the file must be valid TOML: lines of `key = value`, `[table]` or `# comment`, texts in quotes",
        ),
    };
    Diagnostic { span, message, help: help.into() }
}

impl<'a> Document<'a> {
    /// Parses TOML; the first errors of syntax are reported.
    pub(super) fn parse(text: &'a str) -> Result<Self, Vec<Diagnostic>> {
        let (root, errors) = DeTable::parse_recoverable(text);
        if errors.is_empty() {
            return Ok(Self { root });
        }
        let mut found: Vec<Diagnostic> = errors.iter().map(|error| from_toml(text, error)).collect();
        found.sort_by_key(|diagnostic| diagnostic.span.start);
        found.truncate(MOST_SYNTAX_ERRORS);
        Err(found)
    }

    /// The table of the whole file.
    pub(super) fn root(&self) -> &DeTable<'a> {
        self.root.get_ref()
    }

    /// All mistakes of keys, types and ranges.
    pub(super) fn check_against(&self, schema: &Schema, whole: &str) -> Vec<Diagnostic> {
        let mut walk = Walk { schemas: Schemas::of(schema), found: Vec::new() };
        walk.table(schema, self.root.get_ref(), 0..0, whole);
        walk.found
    }

    /// The place of the value at `path`, such as `via_point.0.time`; of the nearest table above it where the file
    /// leaves it out.
    pub(super) fn span(&self, path: &str) -> Range<usize> {
        let mut span = 0..0;
        let mut table = Some(self.root.get_ref());
        let mut array: Option<&DeArray<'a>> = None;
        for part in path.split('.') {
            let next = match (table, array) {
                (Some(table), _) => table.iter().find(|(key, _)| key.get_ref() == part).map(|(_, value)| value),
                (_, Some(array)) => part.parse().ok().and_then(|index: usize| array.get(index)),
                _ => None,
            };
            let Some(value) = next else { break };
            span = value.span();
            table = value.get_ref().as_table();
            array = value.get_ref().as_array();
        }
        span
    }
}

/// The schemas that others refer to.
#[derive(Clone, Copy)]
pub(super) struct Schemas<'s> {
    definitions: &'s Schema,
}

impl<'s> Schemas<'s> {
    /// Those of `schema`.
    pub(super) fn of(schema: &'s Schema) -> Self {
        Self { definitions: &schema["$defs"] }
    }

    fn resolve(&self, schema: &'s Schema) -> &'s Schema {
        match schema["$ref"].as_str().and_then(|reference| reference.rsplit('/').next()) {
            Some(name) => &self.definitions[name],
            None => schema,
        }
    }

    /// The schemas of which one must hold: the members of a union without "null", or the schema itself.
    pub(super) fn alternatives(&self, schema: &'s Schema) -> Vec<&'s Schema> {
        let schema = self.resolve(schema);
        let union = schema["anyOf"].as_array().or_else(|| schema["oneOf"].as_array());
        match union {
            Some(members) => {
                let members = members.iter().filter(|member| member["type"] != "null");
                members.flat_map(|member| self.alternatives(member)).collect()
            }
            None => vec![schema],
        }
    }
}

struct Walk<'s> {
    schemas: Schemas<'s>,
    found: Vec<Diagnostic>,
}

impl<'s> Walk<'s> {
    fn say(&mut self, span: Range<usize>, message: String, help: String) {
        self.found.push(Diagnostic { span, message, help });
    }

    fn alternatives(&self, schema: &'s Schema) -> Vec<&'s Schema> {
        self.schemas.alternatives(schema)
    }

    fn value(&mut self, schema: &'s Schema, value: &Spanned<DeValue<'_>>, key: &str) {
        let alternatives = self.alternatives(schema);
        let span = value.span();
        if let DeValue::String(text) = value.get_ref() {
            let names: Vec<&str> = alternatives.iter().flat_map(|schema| names(schema)).collect();
            if !names.is_empty() {
                if !names.contains(&text.as_ref()) {
                    self.say(span, unknown("value", text, &names), format!("`{key}` is one of: {}", names.join(", ")));
                }
                return;
            }
        }
        if let (DeValue::Table(table), true) = (value.get_ref(), alternatives.len() > 1) {
            return self.union_table(&alternatives, table, span, key);
        }
        let Some(schema) = alternatives.iter().copied().find(|schema| has_type(schema, value.get_ref())) else {
            let whole = alternatives.iter().any(|schema| has_type(schema, &DeValue::Integer(DeInteger::default())));
            let message = match value.get_ref() {
                DeValue::Float(_) if whole => format!("`{key}` cannot have a decimal point"),
                other => format!("`{key}` cannot be {}", noun(other)),
            };
            return self.say(span, message, format!("`{key}` must be {}", self.describe_all(&alternatives, key)));
        };
        match value.get_ref() {
            DeValue::Table(table) => self.table(schema, table, span, key),
            DeValue::Array(items) => {
                self.length(schema, items.len(), span, key);
                items.iter().for_each(|item| self.value(&schema["items"], item, key));
            }
            DeValue::Integer(number) => {
                let value = i128::from_str_radix(number.as_str(), number.radix());
                // TOML has integers of 64 bits with a sign; every reader takes those, and not all of them more.
                match value.ok().filter(|value| (i64::MIN.into()..=i64::MAX.into()).contains(value)) {
                    Some(value) => self.number(schema, value as f64, &number.to_string(), span, key),
                    None => {
                        let help = format!("`{key}` must be {}, 64 bits with a sign", self.describe(schema));
                        self.say(span, format!("`{key}` is out of range: {number}"), help);
                    }
                }
            }
            DeValue::Float(number) => {
                let value = number.as_str().parse().unwrap_or(f64::NAN);
                self.number(schema, value, number.as_str(), span, key);
            }
            _ => {}
        }
    }

    /// A table that may be one of several kinds: told apart by `kind`, or by the one key each has.
    fn union_table(&mut self, alternatives: &[&'s Schema], table: &DeTable<'_>, span: Range<usize>, key: &str) {
        let kinds: Vec<&str> = alternatives.iter().flat_map(|s| names(&s["properties"]["kind"])).collect();
        if kinds.is_empty() {
            return self.choice_table(alternatives, table, span, key);
        }
        let Some((_, kind)) = table.iter().find(|(key, _)| key.get_ref() == "kind") else {
            let help = format!("kind is one of: {}", kinds.join(", "));
            return match table.iter().find(|(name, _)| nearest(name.get_ref(), &["kind"]).is_some()) {
                Some((name, _)) => self.say(name.span(), unknown("key", name.get_ref(), &["kind"]), help),
                None => self.say(span, format!("{key} has no `kind`"), help),
            };
        };
        let help = format!("kind is one of: {}", kinds.join(", "));
        let Some(text) = kind.get_ref().as_str() else {
            return self.say(kind.span(), format!("`kind` cannot be {}", noun(kind.get_ref())), help);
        };
        match alternatives.iter().copied().find(|s| names(&s["properties"]["kind"]).contains(&text)) {
            Some(schema) => self.table(schema, table, span, key),
            None => self.say(kind.span(), unknown("kind", text, &kinds), help),
        }
    }

    /// A table that may be one of several, each with one key of its own.
    fn choice_table(&mut self, alternatives: &[&'s Schema], table: &DeTable<'_>, span: Range<usize>, key: &str) {
        let tables: Vec<&Schema> = alternatives.iter().copied().filter(|s| s["type"] == "object").collect();
        let keys: Vec<&str> = tables.iter().flat_map(|schema| required(schema)).collect();
        let given: Vec<&str> =
            keys.iter().copied().filter(|key| table.iter().any(|(name, _)| name.get_ref() == key)).collect();
        let help = format!("{key} takes one of: {}", keys.join(", "));
        match (tables.as_slice(), given.as_slice()) {
            ([], _) => {
                let message = format!("`{key}` cannot be a table");
                self.say(span, message, format!("`{key}` must be {}", self.describe_all(alternatives, key)));
            }
            ([schema], _) => self.table(schema, table, span, key),
            (_, []) if table.is_empty() => self.say(span, format!("{key} is empty"), help),
            (_, []) => {
                for (name, _) in table {
                    self.say(name.span(), unknown("key", name.get_ref(), &keys), help.clone());
                }
            }
            (_, [given]) => {
                let chosen = tables.iter().find(|schema| required(schema).any(|name| name == *given));
                self.table(chosen.expect("a given key is one of a table's"), table, span, key);
            }
            _ => self.say(span, format!("{key} has both `{}`", given.join("` and `")), help),
        }
    }

    fn table(&mut self, schema: &'s Schema, table: &DeTable<'_>, span: Range<usize>, key: &str) {
        let properties = &schema["properties"];
        let known: Vec<&str> = known(schema).collect();
        let mut misspelt = Vec::new();
        for (name, value) in table {
            match properties.get(name.get_ref().as_ref()) {
                Some(schema) => self.value(schema, value, name.get_ref()),
                None => {
                    let help = format!("{key} takes: {}", known.join(", "));
                    let own = format!("{key}.{}", name.get_ref());
                    match TAKEN_OUT.iter().find(|(key, _)| *key == own) {
                        Some((key, why)) => {
                            self.say(name.span(), format!("`{key}` was taken out: {why}"), "leave it out".into())
                        }
                        None => self.say(name.span(), unknown("key", name.get_ref(), &known), help),
                    }
                    misspelt.extend(nearest(name.get_ref(), &known));
                }
            }
        }
        for name in required(schema) {
            // A key that is there under a wrong name is one mistake, not two.
            if !misspelt.contains(&name) && !table.iter().any(|(key, _)| key.get_ref() == name) {
                let wanted = self.alternatives(&properties[name]);
                let help = format!("add `{name}`, {}", self.describe_all(&wanted, name));
                self.say(span.clone(), format!("{key} has no `{name}`"), help);
            }
        }
    }

    fn length(&mut self, schema: &Schema, count: usize, span: Range<usize>, key: &str) {
        let allowed = lengths(schema);
        if !allowed.contains(&count) {
            let help = format!("between {} and {} are allowed", allowed.start(), allowed.end());
            self.say(span, format!("`{key}` has {count} entries"), help);
        }
    }

    fn number(&mut self, schema: &Schema, value: f64, text: &str, span: Range<usize>, key: &str) {
        if !value.is_finite() {
            return self.say(
                span,
                format!("`{key}` is not a finite number"),
                format!("`{key}` must be {}", self.describe(schema)),
            );
        }
        let bound = |name: &str| bound(schema, name).and_then(|number| number.as_f64());
        let outside = bound("minimum").is_some_and(|min| value < min)
            || bound("exclusiveMinimum").is_some_and(|min| value <= min)
            || bound("maximum").is_some_and(|max| value > max)
            || bound("exclusiveMaximum").is_some_and(|max| value >= max);
        if outside {
            self.say(
                span,
                format!("`{key}` is out of range: {text}"),
                format!("`{key}` must be {}", self.describe(schema)),
            );
        }
    }

    /// A schema in words, such as "a number above 0".
    fn describe(&self, schema: &'s Schema) -> String {
        let names = names(schema);
        if !names.is_empty() {
            return any_of(&names);
        }
        let kind = match &schema["type"] {
            Schema::Array(kinds) => kinds.first().and_then(Schema::as_str),
            kind => kind.as_str(),
        };
        let mut text = match kind {
            Some("integer") => "a whole number",
            Some("number") => "a number",
            Some("string") => "a text in quotes",
            Some("boolean") => "true or false",
            Some("array") => "an array",
            _ => "a table",
        }
        .to_owned();
        if kind == Some("array") {
            match schema["items"]["type"].as_str() {
                Some("number" | "integer") => text += " of numbers",
                _ if schema["items"]["$ref"].is_string() => text += " of tables",
                _ => {}
            }
        }
        if kind == Some("object") {
            text += &self.shape(schema);
        }
        // A whole number is written as it is, whatever its size.
        let bound = |name: &str| {
            let number = bound(schema, name)?;
            let float = number.as_f64().filter(|_| number.is_f64());
            Some(float.map_or(number.to_string(), |n| if n.abs() < 1e7 { plain(n) } else { format!("{n:e}") }))
        };
        let (min, max) = (bound("minimum"), bound("maximum"));
        let _ = match (min, bound("exclusiveMinimum"), max, bound("exclusiveMaximum")) {
            (Some(min), _, Some(max), _) => write!(text, " from {min} to {max}"),
            (Some(min), ..) => write!(text, " of at least {min}"),
            (_, Some(min), Some(max), _) => write!(text, " above {min} and at most {max}"),
            (_, Some(min), _, Some(max)) => write!(text, " above {min} and below {max}"),
            (_, Some(min), ..) => write!(text, " above {min}"),
            _ => Ok(()),
        };
        text
    }

    /// The keys that a table must have, or where it needs none and has few, those it may have.
    fn shape(&self, schema: &'s Schema) -> String {
        let mut keys: Vec<&str> = required(schema).collect();
        if keys.is_empty() {
            keys.extend(known(schema));
        }
        if keys.len() > MOST_KEYS {
            return String::new();
        }
        let key = |key: &&str| {
            let values = self.alternatives(&schema["properties"][key]);
            let names: Vec<&str> = values.iter().flat_map(|schema| names(schema)).collect();
            format!("{key} = {}", if names.is_empty() { "...".into() } else { any_of(&names) })
        };
        format!(" {{ {} }}", keys.iter().map(key).collect::<Vec<_>>().join(", "))
    }

    /// The values that `key` takes, in words.
    fn describe_all(&self, schemas: &[&'s Schema], key: &str) -> String {
        let mut text = schemas.iter().map(|schema| self.describe(schema)).collect::<Vec<_>>().join(" or ");
        if schemas.iter().any(|schema| schema["items"]["$ref"].is_string()) {
            let _ = write!(text, ", each under [[{key}]]");
        }
        text
    }
}

/// A number without hundreds of zeros.
pub(crate) fn plain(value: f64) -> String {
    if value == 0.0 || (1e-6..1e15).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

/// A bound of a number: the one that is given, or that of the integers it is one of.
fn bound<'s>(schema: &'s Schema, name: &str) -> Option<Cow<'s, Number>> {
    match (&schema[name], name, schema["format"].as_str()) {
        (Schema::Number(number), ..) => Some(Cow::Borrowed(number)),
        (_, "maximum", Some("uint8")) => Some(Cow::Owned(u8::MAX.into())),
        (_, "maximum", Some("uint16")) => Some(Cow::Owned(u16::MAX.into())),
        (_, "maximum", Some("uint32")) => Some(Cow::Owned(u32::MAX.into())),
        _ => None,
    }
}

/// How many entries an array may have.
pub(super) fn lengths(schema: &Schema) -> RangeInclusive<usize> {
    let least = schema["minItems"].as_u64().unwrap_or(0) as usize;
    least..=schema["maxItems"].as_u64().map_or(usize::MAX, |most| most as usize)
}

pub(super) fn required(schema: &Schema) -> impl Iterator<Item = &str> {
    schema["required"].as_array().into_iter().flatten().filter_map(Schema::as_str)
}

/// The keys of a table.
fn known(schema: &Schema) -> impl Iterator<Item = &str> {
    schema["properties"].as_object().into_iter().flatten().map(|(name, _)| name.as_str())
}

/// Words of which one is allowed, as they stand in a file.
fn any_of(names: &[&str]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(" or ")
}

/// The words a string schema allows.
pub(super) fn names(schema: &Schema) -> Vec<&str> {
    let listed = schema["enum"].as_array().into_iter().flatten();
    listed.chain([&schema["const"]]).filter_map(Schema::as_str).collect()
}

pub(super) fn has_type(schema: &Schema, value: &DeValue<'_>) -> bool {
    let is = |name: &str| match &schema["type"] {
        Schema::Array(names) => names.iter().any(|n| n == name),
        one => one == name,
    };
    match value {
        DeValue::Integer(_) => is("integer") || is("number"),
        DeValue::Float(_) => is("number"),
        DeValue::String(_) => is("string"),
        DeValue::Boolean(_) => is("boolean"),
        DeValue::Array(_) => is("array"),
        DeValue::Table(_) => is("object"),
        DeValue::Datetime(_) => false,
    }
}

/// What a value is, in words.
fn noun(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::String(_) => "a text",
        DeValue::Boolean(_) => "true or false",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
        DeValue::Datetime(_) => "a date",
    }
}

/// "unknown key `x`", with the nearest known name where one is near.
pub(super) fn unknown(what: &str, name: &str, known: &[&str]) -> String {
    match nearest(name, known) {
        Some(near) => format!("unknown {what} `{name}`, did you mean `{near}`?"),
        None => format!("unknown {what} `{name}`"),
    }
}

/// The known name with the fewest letters to change, if at most a third of them (two in a short name).
pub(crate) fn nearest<'k>(name: &str, known: &[&'k str]) -> Option<&'k str> {
    let (distance, near) = known.iter().map(|known| (edits(name, known), *known)).min()?;
    (distance <= (name.len() / 3).max(2) && distance < name.len()).then_some(near)
}

/// Levenshtein distance in characters.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(row[j + 1] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_counts_the_letters_to_change() {
        assert_eq!(edits("stifness", "stiffness"), 1);
        assert_eq!(edits("", "abc"), 3);
        assert_eq!(edits("kitten", "sitting"), 3);
    }

    #[test]
    fn nearest_names_no_stranger() {
        assert_eq!(nearest("duraton", &["duration", "rate"]), Some("duration"));
        assert_eq!(nearest("zzz", &["duration", "rate"]), None);
    }
}
