//! What every reader leaves: named columns of numbers, each row with its place in the file.

use crate::mistake::{MAX_MISTAKES, Mistake};
use crate::units::{UnitWord, in_name};

/// Most columns of a table: its numbers are kept in memory, eight bytes each.
pub const MAX_COLUMNS: usize = 20_000;

/// Named columns of numbers.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// What kind of file it is, in words.
    pub kind: String,
    /// Name of the topic or array; empty where a file has one table.
    pub topic: String,
    /// The line of the header; 0 where there is none.
    pub header_line: u64,
    /// The line or row number of each row, counted from 1.
    pub lines: Vec<u64>,
    /// The columns, each with a number per row.
    pub columns: Vec<Column>,
    /// Rows that could not be read.
    pub mistakes: Vec<Mistake>,
    /// What was mended on the way.
    pub notes: Vec<String>,
    /// Whether the columns have names; without, they are numbered from 1.
    pub is_named: bool,
    /// The column of time, where the format says it.
    pub time: Option<usize>,
    /// Lines before the header that belong to no row, the first ones.
    pub preamble: Vec<String>,
}

/// A column of numbers.
#[derive(Clone, Debug, Default)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// A number per row, less `base`; not a number where there was none.
    pub values: Vec<f64>,
    /// What was subtracted: time stamps in nanoseconds have more digits than a number keeps.
    pub base: f64,
    /// The first cells that hold no number: row and text.
    pub bad: Vec<(usize, String)>,
    /// Its unit, where the format says it.
    pub unit: Option<UnitWord>,
}

impl Column {
    /// A column whose numbers are known.
    pub fn of(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self { name: name.into(), values, ..Self::default() }
    }

    /// The text of a cell that holds no finite number.
    pub fn text(&self, row: usize) -> String {
        let bad = self.bad.iter().find(|(at, _)| *at == row);
        bad.map_or_else(|| self.values[row].to_string(), |(_, text)| text.clone())
    }

    /// Keeps the text of a bad cell, of the first ones.
    pub fn keep_bad(&mut self, row: usize, text: &str) {
        if self.bad.len() < MAX_MISTAKES {
            self.bad.push((row, text.chars().take(40).collect()));
        }
    }

    /// Least and largest finite number; `None` where there is none.
    pub fn range(&self) -> Option<(f64, f64)> {
        let finite = self.values.iter().copied().filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (v.min(a), v.max(b)));
        (low <= high).then_some((low + self.base, high + self.base))
    }
}

impl Table {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.lines.len()
    }

    /// The column called `name`: by its name, else by the same letters and digits, with its unit or without, else by its number as `#3`.
    ///
    /// # Errors
    /// What there is instead.
    pub fn find(&self, name: &str) -> Result<usize, String> {
        if let Some(at) = self.columns.iter().position(|column| column.name == name) {
            return Ok(at);
        }
        let plain = plain(name);
        let whole: fn(&Column) -> String = |column| self::plain(&column.name);
        let without_unit: fn(&Column) -> String = |column| self::plain(&in_name(&column.name).0);
        for form in [whole, without_unit] {
            let mut alike = self.columns.iter().enumerate().filter(|(_, column)| form(column) == plain);
            if let (Some((at, _)), None) = (alike.next(), alike.next())
                && !plain.is_empty()
            {
                return Ok(at);
            }
        }
        if let Some(number) = name.strip_prefix('#').and_then(|number| number.parse::<usize>().ok())
            && (1..=self.columns.len()).contains(&number)
        {
            return Ok(number - 1);
        }
        let names: Vec<&str> = self.columns.iter().take(200).map(|column| column.name.as_str()).collect();
        let near = nearest(name, &names).map_or(String::new(), |near| format!(", did you mean `{near}`?"));
        let shown = names.iter().take(12).copied().collect::<Vec<_>>().join(", ");
        let more = if self.columns.len() > 12 { ", ..." } else { "" };
        Err(format!("there is no column `{name}`{near}; the columns are {shown}{more}"))
    }
}

/// The known name that `name` may have been meant to be.
pub fn nearest<'k>(name: &str, known: &[&'k str]) -> Option<&'k str> {
    let (distance, near) = known.iter().map(|known| (strsim::levenshtein(name, known), *known)).min()?;
    (distance <= (name.len() / 3).max(2) && distance < name.len()).then_some(near)
}

/// Letters and digits of a name in lower case, all else as one underscore.
pub fn plain(name: &str) -> String {
    let mut plain = String::new();
    for c in name.chars() {
        if c.is_alphanumeric() {
            plain.extend(c.to_lowercase());
        } else if !plain.ends_with('_') && !plain.is_empty() {
            plain.push('_');
        }
    }
    plain.trim_end_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_found_by_name_by_its_letters_or_by_number() {
        let columns = ["Time (s)", "O_T_EE[12]", "px"].map(|name| Column::of(name, Vec::new()));
        let table = Table { columns: columns.into(), ..Table::default() };
        assert_eq!(table.find("px"), Ok(2));
        assert_eq!(table.find("o_t_ee_12"), Ok(1));
        assert_eq!(table.find("#1"), Ok(0));
        assert!(table.find("pz").unwrap_err().contains("there is no column `pz`"), "{:?}", table.find("pz"));
    }
}
