//! NumPy arrays: `.npy`, and `.npz`, which is a ZIP archive of them.
//!
//! ```text
//! magic    93 4e 55 4d 50 59, version (2 bytes), length of the header (2 bytes; 4 from version 2 on)
//! header   a Python dictionary: 'descr' (type, or a list of names and types), 'fortran_order', 'shape'
//! data     numbers, row by row, or column by column where fortran_order
//! ```
//! A list of named types gives named columns, a plain array numbered ones. Of an archive, arrays of one dimension and one
//! length are columns by their names; an array of two dimensions gives a column for each of its own.
//!
//! Source: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

use std::io::{Cursor, Read as _};

use crate::mapping::Mapping;
use crate::mistake::{Mistake, Refusal};
use crate::saw::Topic;
use crate::table::{Column, MAX_COLUMNS, Table};
use crate::text::MAX_CELLS;

/// The first bytes of an array.
pub const MAGIC: &[u8] = b"\x93NUMPY";
/// The first bytes of an archive.
pub const ZIP_MAGIC: &[u8] = b"PK\x03\x04";
/// Longest header that is read [bytes].
const MAX_HEADER: usize = 1 << 20;
/// Most that the arrays of an archive unpack to [bytes].
const MAX_UNPACKED: u64 = 1 << 30;
/// An array with at most so many rows and ten times as many columns holds its samples in columns.
const FEW_ROWS: usize = 32;

/// Numbers less a base: time stamps in nanoseconds have more digits than a float keeps.
struct Series {
    base: f64,
    values: Vec<f64>,
}

/// An array: named columns of one length.
struct Array {
    columns: Vec<(Option<String>, Series)>,
    /// Dimensions.
    shape: Vec<usize>,
}

/// Reads one array.
pub fn read(bytes: &[u8]) -> Result<Table, Refusal> {
    let array = array(bytes).map_err(Mistake::whole)?;
    Ok(table("a NumPy array", "", vec![(String::new(), array)]))
}

/// Reads an archive: its arrays that belong together, or the one that the mapping names as topic.
pub fn read_archive(bytes: &[u8], mapping: &Mapping) -> Result<(Table, Vec<Topic>), Refusal> {
    let bad = |what: String| Refusal::from(Mistake::whole(what));
    let mut archive =
        zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| bad(format!("a damaged ZIP archive: {error}")))?;
    let (mut arrays, mut topics, mut left) = (Vec::new(), Vec::new(), MAX_UNPACKED);
    for i in 0..archive.len() {
        let file = archive.by_index(i).map_err(|error| bad(format!("a damaged ZIP archive: {error}")))?;
        let name = file.name().map_err(|error| bad(format!("a damaged ZIP archive: {error}")))?.into_owned();
        let Some(stem) = name.strip_suffix(".npy") else { continue };
        let mut inner = Vec::new();
        file.take(left + 1).read_to_end(&mut inner).map_err(|error| bad(format!("`{name}`: {error}")))?;
        left = left.checked_sub(inner.len() as u64).ok_or_else(|| {
            bad(format!("its arrays unpack to more than {} MB, which is the most that is read", MAX_UNPACKED >> 20))
        })?;
        match array(&inner) {
            Ok(array) => {
                let shape: Vec<String> = array.shape.iter().map(usize::to_string).collect();
                let kind = format!("array of {}", shape.join(" x "));
                topics.push(Topic { name: stem.into(), kind, count: array.rows(), is_read: true });
                arrays.push((stem.to_owned(), array));
            }
            Err(why) => topics.push(Topic { name: stem.into(), kind: why, count: 0, is_read: false }),
        }
    }
    if topics.is_empty() {
        return Err(bad("a ZIP archive without NumPy arrays (.npy): nothing of it is read".into()));
    }
    if let Some(wanted) = &mapping.topic {
        let names: Vec<&str> = wanted.split(',').map(str::trim).collect();
        if let Some(missing) = names.iter().find(|name| arrays.iter().all(|(array, _)| array != *name)) {
            let known: Vec<&str> = arrays.iter().map(|(name, _)| name.as_str()).collect();
            return Err(bad(format!("there is no array `{missing}`; there are {}", known.join(", "))));
        }
        arrays.retain(|(name, _)| names.contains(&name.as_str()));
    }
    // The arrays that belong together are those of the most frequent length beyond one.
    let lengths: Vec<usize> = arrays.iter().map(|(_, array)| array.rows()).filter(|rows| *rows > 1).collect();
    let usual =
        lengths.iter().max_by_key(|rows| (lengths.iter().filter(|other| other == rows).count(), **rows)).copied();
    let Some(usual) = usual else {
        let whys: Vec<String> = topics.iter().map(|topic| format!("`{}` {}", topic.name, topic.kind)).collect();
        return Err(bad(format!("no array of numbers with rows: {}", whys.join(", "))));
    };
    let (kept, others): (Vec<_>, Vec<_>) = arrays.into_iter().partition(|(_, array)| array.rows() == usual);
    let mut table = table("a NumPy archive", "", kept);
    if !others.is_empty() {
        let names: Vec<&str> = others.iter().map(|(name, _)| name.as_str()).collect();
        table.notes.push(format!("arrays of other lengths than {usual} are not read: {}", names.join(", ")));
    }
    Ok((table, topics))
}

fn table(kind: &str, topic: &str, arrays: Vec<(String, Array)>) -> Table {
    let rows = arrays.first().map_or(0, |(_, array)| array.rows());
    let mut table =
        Table { kind: kind.into(), topic: topic.into(), lines: (1..=rows as u64).collect(), ..Table::default() };
    for (name, array) in arrays {
        let count = array.columns.len();
        for (i, (own, Series { base, values })) in array.columns.into_iter().enumerate() {
            let name = match (name.as_str(), own) {
                ("", Some(own)) => own,
                ("", None) => (i + 1).to_string(),
                (name, Some(own)) => format!("{name}.{own}"),
                (name, None) if count == 1 => name.to_owned(),
                (name, None) => format!("{name}_{i}"),
            };
            table.is_named |= name.parse::<f64>().is_err();
            table.columns.push(Column { base, ..Column::of(name, values) });
        }
    }
    table
}

impl Array {
    fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, series)| series.values.len())
    }
}

/// The type of a number.
#[derive(Clone, Copy)]
struct Scalar {
    kind: u8,
    size: usize,
    is_big: bool,
}

impl Scalar {
    fn of(descr: &str) -> Result<Self, String> {
        let refuse = || format!("numbers of type `{descr}` are not read; real and whole ones are");
        let (order, rest) = descr.split_at_checked(1).ok_or_else(refuse)?;
        let (kind, size) = rest.split_at_checked(1).ok_or_else(refuse)?;
        let (kind, size) = (kind.as_bytes()[0], size.parse::<usize>().map_err(|_| refuse())?);
        let fits = match kind {
            b'f' => matches!(size, 4 | 8),
            b'i' | b'u' => matches!(size, 1 | 2 | 4 | 8),
            b'b' => size == 1,
            _ => false,
        };
        if fits { Ok(Self { kind, size, is_big: order == ">" }) } else { Err(refuse()) }
    }

    /// The bytes of a number, least first.
    fn little(self, bytes: &[u8]) -> u64 {
        let mut eight = [0; 8];
        if self.is_big {
            eight[8 - self.size..].copy_from_slice(bytes);
            eight.reverse();
        } else {
            eight[..self.size].copy_from_slice(bytes);
        }
        u64::from_le_bytes(eight)
    }

    fn number(self, bytes: &[u8]) -> f64 {
        let low = self.little(bytes);
        match (self.kind, self.size) {
            (b'f', 4) => f64::from(f32::from_bits(low as u32)),
            (b'f', _) => f64::from_bits(low),
            (b'i', 1) => f64::from(low as u8 as i8),
            (b'i', 2) => f64::from(low as u16 as i16),
            (b'i', 4) => f64::from(low as u32 as i32),
            (b'i', _) => low as i64 as f64,
            _ => low as f64,
        }
    }

    /// The numbers of a column.
    fn series<'b>(self, mut cells: impl Iterator<Item = &'b [u8]>) -> Series {
        let mut series = Series { base: 0.0, values: Vec::new() };
        let Some(first) = cells.next() else { return series };
        let whole = |bytes: &[u8]| match self.kind {
            b'i' => i128::from(self.little(bytes) as i64),
            _ => i128::from(self.little(bytes)),
        };
        if matches!(self.kind, b'i' | b'u') && self.size == 8 && whole(first).unsigned_abs() > EXACT {
            series.base = whole(first) as f64;
            let base = series.base as i128;
            series.values = core::iter::once(first).chain(cells).map(|cell| (whole(cell) - base) as f64).collect();
        } else {
            series.values = core::iter::once(first).chain(cells).map(|cell| self.number(cell)).collect();
        }
        series
    }
}

/// Whole numbers to here are floats.
const EXACT: u128 = 1 << 53;

/// Reads an array.
fn array(bytes: &[u8]) -> Result<Array, String> {
    let cut = || "the array ends in the middle".to_owned();
    let rest = bytes.strip_prefix(MAGIC).ok_or("this is no NumPy array")?;
    let (version, rest) = rest.split_at_checked(2).ok_or_else(cut)?;
    let width = if version[0] == 1 { 2 } else { 4 };
    let (length, rest) = rest.split_at_checked(width).ok_or_else(cut)?;
    let length = length.iter().rev().fold(0, |sum, byte| (sum << 8) | usize::from(*byte));
    if length > MAX_HEADER {
        return Err("the header of the array is longer than any".into());
    }
    let (header, data) = rest.split_at_checked(length).ok_or_else(cut)?;
    let header = str::from_utf8(header).map_err(|_| "the header of the array is no text")?;
    let fields = fields(value_of(header, "descr").ok_or("the header has no 'descr'")?)?;
    let is_by_column = value_of(header, "fortran_order").is_some_and(|value| value.starts_with("True"));
    let shape = shape(value_of(header, "shape").ok_or("the header has no 'shape'")?)?;
    let count = shape.iter().try_fold(1_usize, |product, n| product.checked_mul(*n));
    let size: usize = fields.iter().map(|(_, scalar)| scalar.size).sum();
    let count = count.filter(|count| count.saturating_mul(fields.len()) <= MAX_CELLS);
    let count = count.ok_or_else(|| format!("more than {MAX_CELLS} numbers, which is the most that is read"))?;
    if data.len() < count * size {
        return Err(cut());
    }
    // One column per named field.
    if fields.len() > 1 || fields[0].0.is_some() {
        let mut columns = Vec::new();
        let mut at = 0;
        for (name, scalar) in fields {
            let cell = |i: usize| &data[i * size + at..i * size + at + scalar.size];
            columns.push((name, scalar.series((0..count).map(cell))));
            at += scalar.size;
        }
        return Ok(Array { columns, shape });
    }
    let scalar = fields[0].1;
    let cell = |i: usize| &data[i * size..(i + 1) * size];
    let (rows, width) = match shape.as_slice() {
        [] => (1, 1),
        [rows] => (*rows, 1),
        [rows, width] => (*rows, *width),
        _ => return Err(format!("{} dimensions; one or two are read", shape.len())),
    };
    // Samples in columns, as MATLAB has them.
    let is_lying = rows <= FEW_ROWS && width > 10 * rows.max(1);
    let at = |row: usize, column: usize| if is_by_column { column * rows + row } else { row * width + column };
    let columns = if is_lying {
        (0..rows).map(|row| (None, scalar.series((0..width).map(|column| cell(at(row, column)))))).collect()
    } else if width <= MAX_COLUMNS {
        (0..width).map(|column| (None, scalar.series((0..rows).map(|row| cell(at(row, column)))))).collect()
    } else {
        return Err(format!("{width} columns; at most {MAX_COLUMNS} are read"));
    };
    Ok(Array { columns, shape })
}

/// What stands behind the key of a Python dictionary.
fn value_of<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let at = [format!("'{key}'"), format!("\"{key}\"")]
        .iter()
        .find_map(|key| header.find(key.as_str()).map(|at| at + key.len()))?;
    Some(header[at..].trim_start().strip_prefix(':')?.trim_start())
}

/// The texts within quotes of `text`, to the bracket that closes the first one.
fn quoted(text: &str) -> Vec<&str> {
    let end = text.find(']').unwrap_or(text.len());
    text[..end].split(['\'', '"']).skip(1).step_by(2).collect()
}

/// Names and types of the numbers of a row.
fn fields(descr: &str) -> Result<Vec<(Option<String>, Scalar)>, String> {
    if !descr.starts_with('[') {
        let name = quoted(descr).first().copied().ok_or("the type of the array is not read")?;
        return Ok(vec![(None, Scalar::of(name)?)]);
    }
    let words = quoted(descr);
    let (words, _) = words.as_chunks::<2>();
    if words.is_empty() || descr[..descr.find(']').unwrap_or(descr.len())].matches('(').count() != words.len() {
        return Err("fields of arrays are not read: one number per field is".into());
    }
    words.iter().map(|[name, scalar]| Ok((Some((*name).to_owned()), Scalar::of(scalar)?))).collect()
}

fn shape(text: &str) -> Result<Vec<usize>, String> {
    let wrong = || "the shape of the array is not read".to_owned();
    let inner = text.strip_prefix('(').and_then(|text| text.split(')').next()).ok_or_else(wrong)?;
    let numbers = inner.split(',').map(str::trim).filter(|number| !number.is_empty());
    numbers.map(|number| number.parse().map_err(|_| wrong())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(descr: &str, is_fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
        let order = if is_fortran { "True" } else { "False" };
        let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
        let length = (header.len() as u16).to_le_bytes();
        [MAGIC, &[1, 0], &length, header.as_bytes(), data].concat()
    }

    #[test]
    fn arrays_of_every_order_are_read() {
        let numbers = [1.0_f64, 2.0, 3.0, 4.0, 5.0, 6.0];
        let little: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        let big: Vec<u8> = numbers.iter().flat_map(|x| x.to_be_bytes()).collect();
        let columns = |bytes: &[u8]| read(bytes).unwrap().columns.into_iter().map(|one| one.values).collect::<Vec<_>>();
        assert_eq!(columns(&file("'<f8'", false, "(3, 2)", &little)), [[1.0, 3.0, 5.0], [2.0, 4.0, 6.0]]);
        assert_eq!(columns(&file("'<f8'", true, "(3, 2)", &little)), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        assert_eq!(columns(&file("'>f8'", false, "(6,)", &big)), [numbers]);
        let named = read(&file("[('t', '<f8'), ('x', '<f8')]", false, "(3,)", &little)).unwrap();
        assert_eq!((named.columns[1].name.as_str(), named.is_named), ("x", true));
        assert_eq!(named.columns[1].values, [2.0, 4.0, 6.0]);
        let whole: Vec<u8> = [-1_i16, 300].iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_eq!(columns(&file("'<i2'", false, "(2,)", &whole)), [[-1.0, 300.0]]);
    }

    #[test]
    fn what_is_no_array_of_numbers_is_refused() {
        for (bytes, words) in [
            (file("'<c16'", false, "(1,)", &[0; 16]), "type `<c16`"),
            (file("'<f8'", false, "(2,)", &[0; 8]), "ends in the middle"),
            (file("'<f8'", false, "(1, 1, 1)", &[0; 8]), "3 dimensions"),
            (file("'<f8'", false, "(99999999999999, 9999999999)", &[]), "more than"),
            (MAGIC.to_vec(), "ends in the middle"),
        ] {
            let refusal = read(&bytes).unwrap_err();
            assert!(refusal.mistakes[0].message.contains(words), "{refusal:?}");
        }
    }
}
