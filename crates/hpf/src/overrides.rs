//! `--set key.path=value`: changes to a task file that leave its comments and layout alone.

use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

use crate::failure::Failure;

/// Most parts of a key: twice as many as any key has. Without a limit a long one would overflow the stack.
const MOST_PARTS: usize = 8;

/// `text` with each override applied, in their order. Keys are checked afterwards, with the whole file.
///
/// # Errors
/// [`Failure::Input`] for an override that is no `key.path=value`, or whose path leads nowhere.
pub fn apply(text: &str, overrides: &[String]) -> Result<String, Failure> {
    let mut document: DocumentMut = text.parse().map_err(|error| Failure::Input(format!("{error}")))?;
    for one in overrides {
        set(document.as_table_mut(), one).map_err(|why| Failure::Input(format!("--set {one}: {why}")))?;
    }
    Ok(document.to_string())
}

/// `text` without `keys` of its table `table`.
///
/// # Errors
/// [`Failure::Input`] where it is no TOML.
pub fn without(text: &str, table: &str, keys: &[&str]) -> Result<String, Failure> {
    let mut document: DocumentMut = text.parse().map_err(|error| Failure::Input(format!("{error}")))?;
    if let Some(table) = document.get_mut(table).and_then(Item::as_table_like_mut) {
        for key in keys {
            table.remove(key);
        }
    }
    Ok(document.to_string())
}

/// A text as a value of TOML.
pub fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

fn set(root: &mut dyn TableLike, one: &str) -> Result<(), String> {
    let Some((path, value)) = one.split_once('=') else {
        return Err("write it as key.path=value, such as learning.updates=100".into());
    };
    let (path, value) = (path.trim(), value.trim());
    // What begins like a number is meant as one.
    let is_word = value.starts_with(|c: char| c.is_alphabetic() || "_/.".contains(c))
        && !value.contains(['"', '\'', '[', '{', ',']);
    let value = match value.parse() {
        Ok(value) => value,
        // A shell takes the quotes off: a bare word is a text.
        Err(_) if is_word => Value::from(value),
        Err(_) => {
            let begins_as_number = value.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
            let help = if begins_as_number { ": numbers are finite, whole ones have 64 bits with a sign" } else { "" };
            return Err(format!("`{value}` is not a TOML value{help}"));
        }
    };
    let parts: Vec<&str> = path.split('.').collect();
    if parts.contains(&"") {
        return Err("the key has an empty part".into());
    }
    if parts.len() > MOST_PARTS {
        return Err(format!("the key has {} parts, at most {MOST_PARTS} are allowed", parts.len()));
    }
    assign(root, &parts, value)
}

/// Puts `value` where `parts` lead from `table`: keys, made where they are missing, and positions in lists.
fn assign(table: &mut dyn TableLike, parts: &[&str], value: Value) -> Result<(), String> {
    let Some((key, rest)) = parts.split_first() else { return Err("the path ends at a list".into()) };
    if rest.is_empty() {
        match table.get_mut(key) {
            Some(Item::Value(old)) => replace(old, value),
            _ => drop(table.insert(key, Item::Value(value))),
        }
        return Ok(());
    }
    let item = table.entry(key).or_insert_with(|| Item::Table(Table::new()));
    let position = |count: usize| match rest[0].parse() {
        Ok(index) if index < count => Ok(index),
        _ => Err(format!("`{key}` is a list of {count}, counted from 0: there is no `{}`", rest[0])),
    };
    match item {
        Item::ArrayOfTables(tables) => {
            let index = position(tables.len())?;
            match tables.get_mut(index) {
                Some(table) => assign(table, &rest[1..], value),
                None => Err(format!("`{key}` has no entry {index}")),
            }
        }
        Item::Value(Value::Array(array)) => {
            let index = position(array.len())?;
            match array.get_mut(index) {
                Some(old) if rest.len() == 1 => {
                    replace(old, value);
                    Ok(())
                }
                Some(Value::InlineTable(table)) => assign(table, &rest[1..], value),
                _ => Err(format!("`{key}.{index}` is not a table")),
            }
        }
        item => match item.as_table_like_mut() {
            Some(table) => assign(table, rest, value),
            None => Err(format!("`{key}` is not a table")),
        },
    }
}

/// Replaces a value, its comment staying where it is.
fn replace(old: &mut Value, mut new: Value) {
    *new.decor_mut() = old.decor().clone();
    *old = new;
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "rate = 100.0 # Hz\nnoise = { movement = 1.0 }\n\n[[axis]]\nname = \"x\"\nvia = [1.0, 2.0]\n";

    fn set_one(one: &str) -> String {
        apply(TEXT, &[one.to_owned()]).unwrap()
    }

    #[test]
    fn a_value_is_replaced_and_its_comment_stays() {
        assert!(set_one("rate=200.0").starts_with("rate = 200.0 # Hz\n"));
    }

    #[test]
    fn a_path_leads_through_inline_tables_lists_and_missing_tables() {
        assert!(set_one("noise.movement=2").contains("{ movement = 2 }"));
        assert!(set_one("axis.0.name=y").contains("name = \"y\""));
        assert!(set_one("axis.0.via.1=3.5").contains("[1.0, 3.5]"));
        assert!(set_one("learning.updates=5").contains("[learning]\nupdates = 5"));
    }

    #[test]
    fn keys_are_left_out_wherever_their_table_stands() {
        for text in ["[a]\nb = 1\n# of c\nc = 2 # m\nd = 3\n", "[a]\nb = 1\nd = 3\n"] {
            assert_eq!(without(text, "a", &["c", "none"]).unwrap(), "[a]\nb = 1\nd = 3\n");
        }
        assert_eq!(without("a = { c = 2, b = 1 }\n", "a", &["c"]).unwrap().replace(' ', ""), "a={b=1}\n");
        assert_eq!(without(TEXT, "a", &["c"]).unwrap(), TEXT);
        let text = "C:\\my \"lab\"\\a'b";
        let document: DocumentMut = format!("folder = {}", quoted(text)).parse().unwrap();
        assert_eq!(document["folder"].as_str(), Some(text));
    }

    #[test]
    fn what_leads_nowhere_is_refused() {
        for one in [
            "rate",
            "=1",
            "a..b=1",
            "axis.1.name=y",
            "axis.name=y",
            "rate.x=1",
            "rate=[",
            "rate=",
            "rate=1e999x",
            "rate=99999999999999999999",
        ] {
            assert!(apply(TEXT, &[one.to_owned()]).is_err(), "{one}");
        }
    }
}
