//! Text tables: any separator, decimal comma, a header that is commented or absent, lines before it, units below it.
//!
//! ```text
//! text        UTF-8, UTF-16 with its mark, else Latin-1
//! separator   that by which most cells of the rows are numbers: comma, semicolon, tab, bar, else white space
//! decimal     a comma where it does not separate and numbers are written with it
//! header      the last line of words before the rows; else the last comment with as many cells; else none
//! ```

mod cells;
mod layout;

use hpf_sim::TableEnd;
use hpf_sim::task::MAX_STEPS;

use crate::mistake::{MAX_MISTAKES, Mistake, Refusal};
use crate::table::{Column, MAX_COLUMNS, Table};
use cells::{Dialect, Separator};
use layout::Layout;

/// Most numbers of a table: 1 GiB of memory.
pub const MAX_CELLS: usize = 1 << 27;

/// Reads a text table.
///
/// # Errors
/// A text without rows, and tables beyond the limits.
pub fn read(bytes: &[u8]) -> Result<Table, Refusal> {
    let mut notes = Vec::new();
    let text = decode(bytes, &mut notes)?;
    if text.trim().is_empty() {
        let message = "the file is empty; it needs a header such as time_s,x_m and a row per sample";
        return Err(Mistake::at(1, message).into());
    }
    let dialect = Dialect::of(&text);
    let layout = Layout::of(&text, dialect);
    let mut table = Table {
        kind: dialect.words(),
        header_line: layout.header_line,
        is_named: layout.is_named,
        preamble: layout.preamble,
        notes,
        ..Table::default()
    };
    if layout.names.len() > MAX_COLUMNS {
        let message = format!("{} columns; at most {MAX_COLUMNS} are read", layout.names.len());
        return Err(Mistake::at(layout.header_line, message).into());
    }
    if layout.is_after_preamble {
        let line = layout.header_line;
        table.notes.push(format!("the lines before the header in line {line} are no rows and left out"));
    }
    table.columns = layout.names.into_iter().map(|name| Column { name, ..Column::default() }).collect();
    rows(&text, dialect, layout.first_row, &mut table)?;
    drop_nameless(&mut table);
    end(&text, dialect, &mut table);
    Ok(table)
}

/// The text of a file.
fn decode(bytes: &[u8], notes: &mut Vec<String>) -> Result<String, Refusal> {
    let wide = |bytes: &[u8], number: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.as_chunks::<2>().0.iter().map(|pair| number(*pair)).collect();
        let wrong = || Refusal::from(Mistake::at(1, "the file begins as UTF-16 does, and is none"));
        String::from_utf16(&units).map_err(|_| wrong())
    };
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes)?,
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes)?,
        [0xef, 0xbb, 0xbf, rest @ ..] => plain(rest, notes)?,
        rest => plain(rest, notes)?,
    };
    // Line breaks of old programs: a carriage return alone.
    Ok(if text.contains('\r') && !text.contains('\n') { text.replace('\r', "\n") } else { text })
}

fn plain(bytes: &[u8], notes: &mut Vec<String>) -> Result<String, Refusal> {
    if let Ok(text) = str::from_utf8(bytes) {
        if text.contains('\0') {
            return Err(no_text(bytes, text.find('\0').unwrap_or_default()));
        }
        return Ok(text.to_owned());
    }
    // Text of old programs: a micro or degree sign in a name is one byte. What is no text has other control bytes.
    let strange =
        |byte: &u8| (*byte < 0x20 && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c)) || (0x7f..0xa0).contains(byte);
    if let Some(at) = bytes.iter().position(strange) {
        return Err(no_text(bytes, at));
    }
    notes.push("the text is not UTF-8 and was read as Latin-1".into());
    Ok(bytes.iter().map(|byte| char::from(*byte)).collect())
}

fn no_text(bytes: &[u8], at: usize) -> Refusal {
    let line = 1 + bytes[..at].iter().filter(|byte| **byte == b'\n').count() as u64;
    let message = "this is no text, and no format that is read: text tables, MCAP, NumPy .npy and .npz";
    Mistake::at(line, message).into()
}

/// Fills the columns of `table` with the rows from line `first` on.
fn rows(text: &str, dialect: Dialect, first: u64, table: &mut Table) -> Result<(), Refusal> {
    let count = table.columns.len();
    let most_rows = (MAX_CELLS / count.max(1)).min(MAX_STEPS + 2);
    let mut cells = Vec::with_capacity(count);
    for (line, row) in numbered(text).filter(|(line, row)| *line >= first && is_row(row)) {
        dialect.split(row, &mut cells);
        if cells.len() == count + 1 && cells.last().is_some_and(|cell| cell.is_empty()) {
            // A separator behind the last number.
            cells.pop();
        }
        if cells.len() != count {
            let of = if table.is_named { "of the header" } else { "of the first row" };
            table.mistakes.push(Mistake::at(line, format!("{} values for the {count} columns {of}", cells.len())));
            if table.mistakes.len() >= MAX_MISTAKES {
                break;
            }
            continue;
        }
        let at = table.lines.len();
        if at >= most_rows {
            let message = format!("more rows than are read: at most {} samples and {MAX_CELLS} numbers", MAX_STEPS + 1);
            return Err(Mistake::at(line, message).into());
        }
        for (column, cell) in table.columns.iter_mut().zip(&cells) {
            push(column, at, cell, dialect);
        }
        table.lines.push(line);
    }
    Ok(())
}

/// Digits from which a whole number may not be a float.
const MANY_DIGITS: usize = 16;

fn push(column: &mut Column, row: usize, cell: &str, dialect: Dialect) {
    // Time stamps in nanoseconds: the difference of whole numbers is exact, their floats are not.
    if cell.len() >= MANY_DIGITS
        && let Ok(whole) = cell.parse::<i64>()
    {
        if row == 0 {
            column.base = whole as f64;
        }
        if column.base != 0.0 && column.base.abs() < 9.2e18 {
            column.values.push((i128::from(whole) - column.base as i128) as f64);
            return;
        }
    }
    match dialect.number(cell) {
        Some(value) => {
            if !value.is_finite() {
                column.keep_bad(row, cell);
            }
            column.values.push(value - column.base);
        }
        None => {
            column.keep_bad(row, cell);
            column.values.push(f64::NAN);
        }
    }
}

/// Drops columns that have neither a name nor a number: what a separator at the end of each line makes.
fn drop_nameless(table: &mut Table) {
    if table.is_named {
        let is_kept = |column: &Column| !column.name.is_empty() || column.values.iter().any(|value| value.is_finite());
        table.columns.retain(is_kept);
    }
}

/// Refuses a last number that may be cut.
fn end(text: &str, dialect: Dialect, table: &mut Table) {
    if text.ends_with('\n') || !table.mistakes.is_empty() {
        return;
    }
    // The last column alone, with commas and points as there.
    let last = |row: &str| -> String {
        let cell = match dialect.separator {
            Separator::Blank => row.split_whitespace().next_back(),
            Separator::Char(separator) => row.rsplit(separator).next(),
        };
        let cell = cell.unwrap_or_default();
        if dialect.has_decimal_comma { cell.replace(',', ".") } else { cell.to_owned() }
    };
    let ends: Vec<String> = text.lines().filter(|row| is_row(row)).map(|row| format!("0,{}", last(row))).collect();
    let is_comment = text.lines().next_back().is_some_and(|row| !is_row(row));
    match TableEnd::of(&ends.join("\n")) {
        _ if is_comment => {}
        TableEnd::Cut { number, .. } => {
            let message = format!(
                "the last number, {number}, is shorter than the others and no line break follows: the file may be cut; \
                 where it is whole, end it with a line break"
            );
            let column = table.columns.last().map(|column| column.name.clone());
            table.mistakes.push(Mistake { line: table.lines.last().copied().unwrap_or(1), column, message });
        }
        TableEnd::Open { number } => {
            table.notes.push(format!("no line break follows the last number, {number}, which is taken as it stands"));
        }
        TableEnd::Whole => {}
    }
}

/// The lines of a text with their numbers, from 1.
fn numbered(text: &str) -> impl Iterator<Item = (u64, &str)> {
    text.lines().enumerate().map(|(i, line)| (i as u64 + 1, line))
}

/// Whether a line is neither empty nor a comment.
fn is_row(line: &str) -> bool {
    !line.trim().is_empty() && comment(line).is_none()
}

/// What is behind the sign of a comment: `#` or `%` in the first place.
fn comment(line: &str) -> Option<&str> {
    line.strip_prefix(['#', '%'])
}
