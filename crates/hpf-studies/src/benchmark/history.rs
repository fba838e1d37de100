//! The history of benchmark figures: a table with a row per version, task and method, kept from version to version.
//!
//! A row is replaced where it measures the same again: the same version, task, method, seeds and budget. Rows of other
//! versions are never touched. No row has a time or a date: the same version gives the same rows on every machine.

use core::fmt::Write as _;
use std::path::Path;

use hpf::failure::Failure;
use hpf::files::{self, in_file, read_text};
use hpf::statistics::Spread;

use super::study::{Result, Study};

/// The first line of a history.
const HEADER: &str = "version,task,method,seeds,max_motions,median_motions,median_cost,worst_cost";
/// Columns that say what a row measures.
const KEYS: usize = 5;

/// The rows of a history.
pub struct History {
    rows: Vec<String>,
}

/// What a row measures: its first columns.
fn key(row: &str) -> Vec<&str> {
    row.split(',').take(KEYS).collect()
}

impl History {
    /// Reads the history in `path`; a file that is not there is a history without rows.
    ///
    /// # Errors
    /// [`Failure::Input`] for a file that cannot be read or is no such table.
    pub fn read(path: &Path) -> core::result::Result<Self, Failure> {
        let is_new = path.symlink_metadata().is_err();
        Self::parse(&if is_new { format!("{HEADER}\n") } else { read_text(path)? }).map_err(in_file(path))
    }

    fn parse(text: &str) -> core::result::Result<Self, String> {
        let mut lines = text.lines();
        if lines.next() != Some(HEADER) {
            return Err(format!("this is no history of benchmarks: the first line must be {HEADER}"));
        }
        let rows: Vec<String> = lines.map(str::to_owned).collect();
        let columns = HEADER.split(',').count();
        match rows.iter().position(|row| row.split(',').count() != columns) {
            Some(row) => Err(format!("line {}: a row has {columns} columns", row + 2)),
            None if !text.ends_with('\n') => Err("the last row does not end: the file was cut".into()),
            None => Ok(Self { rows }),
        }
    }

    /// Adds the results of `study`, made by `version`.
    pub fn add(&mut self, study: &Study, version: &str) {
        study.results.iter().for_each(|result| self.put(row(study, result, version)));
    }

    fn put(&mut self, row: String) {
        match self.rows.iter_mut().find(|old| key(old) == key(&row)) {
            Some(old) => *old = row,
            None => self.rows.push(row),
        }
    }

    /// Writes it to `path`.
    ///
    /// # Errors
    /// [`Failure::Work`] that names the file.
    pub fn write(&self, path: &Path) -> core::result::Result<(), Failure> {
        files::write(path, self.text())
    }

    fn text(&self) -> String {
        let mut text = format!("{HEADER}\n");
        for row in &self.rows {
            let _ = writeln!(text, "{row}");
        }
        text
    }
}

fn row(study: &Study, result: &Result, version: &str) -> String {
    let seeds = match study.seeds.as_slice() {
        [first, .., last] => format!("{first}-{last}"),
        seeds => seeds.iter().map(u64::to_string).collect(),
    };
    let motions = Spread::of(result.trials.iter().map(|trial| trial.summary.rollouts as f64));
    let (motions, cost) = (motions.map_or(f64::NAN, |spread| spread.median), result.last());
    format!(
        "{version},{},{},{seeds},{},{motions:?},{:?},{:?}",
        result.target.name, result.method, study.motions, cost.median, cost.largest
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_replaces_the_one_that_measures_the_same_and_no_other() {
        let old = format!("{HEADER}\n0.1.0,reach,auto,1-2,400,60.0,0.5,0.6\n0.2.0,reach,auto,1-2,400,50.0,0.4,0.5\n");
        let mut history = History::parse(&old).unwrap();
        assert_eq!(history.text(), old);
        history.put("0.2.0,reach,auto,1-2,400,40.0,0.3,0.4".into());
        history.put("0.2.0,reach,auto,1-3,400,40.0,0.3,0.4".into());
        let rows: Vec<String> = history.text().lines().skip(1).map(str::to_owned).collect();
        assert_eq!(
            rows,
            [
                "0.1.0,reach,auto,1-2,400,60.0,0.5,0.6",
                "0.2.0,reach,auto,1-2,400,40.0,0.3,0.4",
                "0.2.0,reach,auto,1-3,400,40.0,0.3,0.4",
            ]
        );
    }

    #[test]
    fn a_table_of_other_columns_and_a_cut_one_are_refused() {
        let refused = |text: &str| History::parse(text).err().unwrap();
        assert!(refused("a,b\n").starts_with("this is no history of benchmarks"));
        assert_eq!(refused(&format!("{HEADER}\n0.1.0,reach\n")), "line 2: a row has 8 columns");
        assert!(refused(&format!("{HEADER}\n0.1.0,reach,auto,1,400,60.0,0.5,0")).contains("the file was cut"));
    }
}
