//! A file, read whole: its keys and types, then what contradicts itself.

use std::collections::HashSet;

use serde::de::DeserializeOwned;

use super::keys::{self, Document};
use super::{Diagnostic, Mistakes, repair};

/// What contradicts itself in a value that was read from a document: appended to what was found.
pub(super) type Rules<'r, V> = &'r dyn Fn(&V, &Document<'_>, &mut Vec<Diagnostic>);

/// Reads a file of what `schema` describes, called `whole` in messages; `rules` append what contradicts itself.
pub(super) fn read_checked<V: DeserializeOwned>(
    text: &str,
    schema: &serde_json::Value,
    whole: &str,
    rules: Rules<'_, V>,
) -> Result<V, Vec<Diagnostic>> {
    let document = Document::parse(text)?;
    let mut found = document.check_against(schema, whole);
    match toml::from_str::<V>(text) {
        Ok(value) => {
            // A number that is wrong by itself need not be wrong with others too.
            let told: HashSet<_> = found.iter().map(|diagnostic| diagnostic.span.clone()).collect();
            let before = found.len();
            rules(&value, &document, &mut found);
            let more = found.split_off(before);
            found.extend(more.into_iter().filter(|diagnostic| !told.contains(&diagnostic.span)));
            if found.is_empty() {
                return Ok(value);
            }
        }
        Err(error) if found.is_empty() => found.push(keys::from_toml(text, &error)),
        Err(_) => repair::contradictions(&document, schema, rules, &mut found),
    }
    found.sort_by_key(|diagnostic| diagnostic.span.start);
    Err(found)
}

/// As [`read_checked`] for other files than tasks; `rules` say a path, what is wrong there, and what helps.
pub(crate) fn read<V: DeserializeOwned>(
    text: &str,
    schema: &serde_json::Value,
    whole: &str,
    rules: impl Fn(&V, &mut dyn FnMut(&str, String, String)),
) -> Result<V, Mistakes> {
    let read = read_checked(text, schema, whole, &|value, document, found| {
        rules(value, &mut |path, message, help| found.push(Diagnostic { span: document.span(path), message, help }));
    });
    read.map_err(|found| Mistakes::new(text, found))
}
