//! Where the header and the rows of a text table are.

use std::collections::HashMap;

use super::cells::Dialect;
use super::{comment, is_row, numbered};
use crate::units;

/// Where things are in a text table.
#[derive(Debug, Default)]
pub struct Layout {
    /// Names of the columns: those of the header, else their numbers from 1.
    pub names: Vec<String>,
    /// The line of the header, from 1.
    pub header_line: u64,
    /// The line of the first row.
    pub first_row: u64,
    pub is_named: bool,
    /// Whether lines that are no comments come before the header.
    pub is_after_preamble: bool,
    /// The first of these.
    pub preamble: Vec<String>,
}

/// Lines among which a header is searched.
const SEARCHED: usize = 60;
/// Rows of numbers before a line of words from which on it is a damaged row, no header.
const ROWS_BEFORE: usize = 3;
/// Lines of the preamble that are kept.
const KEPT: usize = 20;

/// What a line holds.
struct Line<'t> {
    number: u64,
    cells: Vec<&'t str>,
    /// Cells that are numbers.
    numbers: usize,
}

impl Line<'_> {
    fn is_words(&self) -> bool {
        self.numbers == 0
    }
}

impl Layout {
    pub fn of(text: &str, dialect: Dialect) -> Self {
        let cells = |row: &'_ str| -> Vec<String> {
            let mut cells = Vec::new();
            dialect.split(row, &mut cells);
            cells.into_iter().map(str::to_owned).collect()
        };
        let lines: Vec<Line<'_>> = numbered(text)
            .filter(|(_, row)| is_row(row))
            .take(SEARCHED)
            .map(|(number, row)| {
                let mut cells = Vec::new();
                dialect.split(row, &mut cells);
                let numbers = cells.iter().filter(|cell| dialect.number(cell).is_some()).count();
                Line { number, cells, numbers }
            })
            .collect();
        let width = usual_width(&lines);
        let header = header(&lines, width);
        let Some(at) = header else {
            return Self::without_header(text, &lines, width, cells);
        };
        let mut names: Vec<String> = lines[at].cells.iter().map(|cell| (*cell).to_owned()).collect();
        let mut first_row = lines[at].number + 1;
        // A row of units below the names.
        if let Some(below) = lines.get(at + 1)
            && is_of_units(below)
            && below.cells.len() == names.len()
        {
            for (name, unit) in names.iter_mut().zip(&below.cells) {
                let unit = unit.trim_matches(['[', ']', '(', ')']);
                if units::of_word(unit).is_some() {
                    *name = format!("{name} [{unit}]");
                }
            }
            first_row = below.number + 1;
        }
        let above = &lines[..at];
        tell_apart(&mut names, above);
        let kept = above.iter().take(KEPT).map(|line| line.cells.join(",").chars().take(400).collect());
        Self {
            names,
            header_line: lines[at].number,
            first_row,
            is_named: true,
            is_after_preamble: at > 0,
            preamble: kept.collect(),
        }
    }

    /// The names in the last comment before the rows with as many cells, or numbers.
    fn without_header(text: &str, lines: &[Line<'_>], width: usize, cells: impl Fn(&str) -> Vec<String>) -> Self {
        let first_row = lines.first().map_or(1, |line| line.number);
        let before = numbered(text).take_while(|(number, _)| *number < first_row);
        let commented = before.filter_map(|(number, row)| {
            let inside = comment(row)?.trim_start_matches(['#', '%']).trim();
            // The signs of units are no separators: `# timestamp [s] tx ty` has as many names as columns.
            let names =
                [cells(inside), inside.split_whitespace().map(str::to_owned).collect(), comma_separated(inside)];
            names.into_iter().find(|names| names.len() == width && is_header(names)).map(|names| (number, names))
        });
        match commented.last() {
            Some((header_line, names)) => Self { names, header_line, first_row, is_named: true, ..Self::default() },
            None => {
                let names = (1..=width).map(|number| number.to_string()).collect();
                Self { names, first_row, ..Self::default() }
            }
        }
    }
}

fn comma_separated(text: &str) -> Vec<String> {
    text.split(',').map(|name| name.trim().to_owned()).collect()
}

/// Whether these may be the names of columns: words, none empty.
fn is_header(names: &[String]) -> bool {
    names.iter().all(|name| !name.is_empty() && name.parse::<f64>().is_err())
}

/// Cells of most lines that hold numbers.
fn usual_width(lines: &[Line<'_>]) -> usize {
    let mut counts: HashMap<usize, usize> = HashMap::new();
    for line in lines.iter().filter(|line| 2 * line.numbers >= line.cells.len()) {
        *counts.entry(line.cells.len()).or_default() += 1;
    }
    let usual = counts.into_iter().max_by_key(|(width, count)| (*count, *width));
    usual.map_or_else(|| lines.first().map_or(0, |line| line.cells.len()), |(width, _)| width)
}

/// Which line is the header: the last one of words before the rows, best with as many cells as a row.
fn header(lines: &[Line<'_>], width: usize) -> Option<usize> {
    let is_row = |line: &Line<'_>| line.cells.len() == width && 2 * line.numbers > line.cells.len();
    let mut rows = 0;
    let mut end = 0;
    for (i, line) in lines.iter().enumerate() {
        if is_row(line) {
            rows += 1;
        }
        if rows >= ROWS_BEFORE {
            break;
        }
        if line.is_words() {
            end = i + 1;
        }
    }
    let before = &lines[..end];
    let fits = |line: &Line<'_>| line.is_words() && (line.cells.len() == width || line.cells.len() == width + 1);
    let named = |i: &usize| fits(&before[*i]) && !(is_of_units(&before[*i]) && *i > 0 && fits(&before[*i - 1]));
    // One cell is no header of several columns, but for a table that has only one line of words.
    (0..before.len()).rev().find(named).or_else(|| (0..before.len()).rev().find(|i| before[*i].is_words()))
}

/// Whether all cells are words of units, or empty.
fn is_of_units(line: &Line<'_>) -> bool {
    let word = |cell: &&str| cell.trim_matches(['[', ']', '(', ')']).to_owned();
    line.is_words()
        && line.cells.iter().any(|cell| units::of_word(&word(cell)).is_some())
        && line
            .cells
            .iter()
            .map(word)
            .all(|word| matches!(word.as_str(), "" | "-" | "1") || units::of_word(&word).is_some())
}

/// Puts what stands above before the names, as motion capture writes bodies and signals above their axes: in lines whose
/// first cell is empty.
fn tell_apart(names: &mut [String], above: &[Line<'_>]) {
    let is_label =
        |line: &&Line<'_>| line.cells.len() == names.len() && line.cells.first().is_some_and(|cell| cell.is_empty());
    let wide: Vec<&Line<'_>> = above.iter().filter(is_label).collect();
    for (i, name) in names.iter_mut().enumerate() {
        let is_of_use = |cell: &&str| !cell.is_empty() && cell.len() <= 60;
        let mut words: Vec<&str> = wide.iter().map(|line| line.cells[i]).filter(is_of_use).collect();
        words.dedup();
        if !words.is_empty() {
            *name = format!("{} {name}", words.join(" "));
        }
    }
}
