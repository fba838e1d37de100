//! How the cells of a text table are written: what separates them, and what is before the decimals.

use super::is_row;

/// What separates cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// One character.
    Char(char),
    /// Any white space.
    Blank,
}

/// How cells are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dialect {
    pub separator: Separator,
    pub has_decimal_comma: bool,
}

/// Separators in the order they are tried: of two that fit alike the first is taken.
const SEPARATORS: [Separator; 5] =
    [Separator::Char(','), Separator::Char(';'), Separator::Char('\t'), Separator::Char('|'), Separator::Blank];

/// Rows that are looked at.
const SAMPLE: usize = 100;

impl Dialect {
    /// The dialect in which most cells of the rows in the middle of `text` are numbers.
    pub fn of(text: &str) -> Self {
        let rows: Vec<&str> = text.lines().filter(|row| is_row(row)).take(20 * SAMPLE).collect();
        let sample = &rows[rows.len() / 2..];
        let sample = &sample[..sample.len().min(SAMPLE)];
        let mut best = (0, Self { separator: SEPARATORS[0], has_decimal_comma: false });
        for separator in SEPARATORS {
            for has_decimal_comma in [false, true] {
                let dialect = Self { separator, has_decimal_comma };
                if has_decimal_comma && separator == Separator::Char(',') {
                    continue;
                }
                let numbers = dialect.numbers(sample);
                if numbers > best.0 {
                    best = (numbers, dialect);
                }
            }
        }
        best.1
    }

    /// How many of 1000 cells of `rows` are numbers, of rows that have two cells or more.
    fn numbers(self, rows: &[&str]) -> usize {
        let mut cells = Vec::new();
        let (mut numbers, mut all) = (0, 0);
        for row in rows {
            self.split(row, &mut cells);
            if cells.len() >= 2 {
                numbers += cells.iter().filter(|cell| self.number(cell).is_some()).count();
                all += cells.len();
            }
        }
        1000 * numbers / all.max(rows.len()).max(1)
    }

    /// The cells of a row, without blanks and quotes around them.
    pub fn split<'r>(self, row: &'r str, cells: &mut Vec<&'r str>) {
        cells.clear();
        match self.separator {
            Separator::Blank => cells.extend(row.split_whitespace().map(|cell| cell.trim_matches('"'))),
            Separator::Char(separator) if row.contains('"') => {
                // A separator within quotes is text.
                let mut is_quoted = false;
                let split = |c: char| {
                    is_quoted ^= c == '"';
                    c == separator && !is_quoted
                };
                cells.extend(row.split(split).map(|cell| cell.trim().trim_matches('"').trim()));
            }
            Separator::Char(separator) => cells.extend(row.split(separator).map(str::trim)),
        }
    }

    /// The number in a cell.
    pub fn number(self, cell: &str) -> Option<f64> {
        if self.has_decimal_comma {
            // A point would be one of thousands: 1.234,5 is not guessed at.
            return if cell.contains('.') { None } else { cell.replacen(',', ".", 1).parse().ok() };
        }
        cell.parse().ok()
    }

    /// The dialect in words.
    pub fn words(self) -> String {
        let separator = match self.separator {
            Separator::Char(',') => "commas",
            Separator::Char(';') => "semicolons",
            Separator::Char('\t') => "tabs",
            Separator::Char(_) => "bars",
            Separator::Blank => "blanks",
        };
        let decimal = if self.has_decimal_comma { ", decimal commas" } else { "" };
        format!("a text table, separated by {separator}{decimal}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dialect_is_that_in_which_most_cells_are_numbers() {
        let found = |text: &str| {
            let dialect = Dialect::of(text);
            (dialect.separator, dialect.has_decimal_comma)
        };
        assert_eq!(found("t,x\n0,1\n1,2\n2,3\n"), (Separator::Char(','), false));
        assert_eq!(found("t;x\n0,5;1,25\n1,5;2,5\n"), (Separator::Char(';'), true));
        assert_eq!(found("t;x\n0.5;1.25\n1.5;2.5\n"), (Separator::Char(';'), false));
        assert_eq!(found("t\tx\n0,5\t1,5\n1,5\t2,5\n"), (Separator::Char('\t'), true));
        assert_eq!(found("1 2 3\n4   5 6\n"), (Separator::Blank, false));
        assert_eq!(found("1,5 2,5\n2,5 3,5\n"), (Separator::Blank, true));
        assert_eq!(found("0.1, walk, 2\n0.2, walk, 3\n"), (Separator::Char(','), false));
    }

    #[test]
    fn quotes_hold_a_separator() {
        let mut cells = Vec::new();
        let dialect = Dialect { separator: Separator::Char(','), has_decimal_comma: false };
        dialect.split(r#""a, b", "2" ,3"#, &mut cells);
        assert_eq!(cells, ["a, b", "2", "3"]);
    }
}
