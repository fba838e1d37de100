//! Whether a table of numbers was cut within its last number.
//!
//! A number that is cut is another number: 0.3 becomes 0., 20 becomes 2. A file that ends with a line break was not cut
//! there. One that does not may be whole, for not every program writes the last line break: it is taken where its last
//! number is written as fully as the others of its column, and refused where it is shorter.

/// How a table ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TableEnd {
    /// With a line break.
    Whole,
    /// Without one, the last number as long as others: it may be whole.
    Open {
        /// The last number as it is written.
        number: String,
    },
    /// Without one, the last number shorter than others.
    Cut {
        /// The line, counted from 1.
        line: u64,
        /// The column of text where the number begins, counted from 1.
        column: usize,
        /// The last number as it is written.
        number: String,
    },
}

impl TableEnd {
    /// How the CSV table `text` ends; lines that begin with `#` are left out.
    ///
    /// ```
    /// use hpf_sim::TableEnd;
    /// assert_eq!(TableEnd::of("time_s,x_m\n0.0,0.1\n0.5,0.3\n"), TableEnd::Whole);
    /// assert_eq!(TableEnd::of("time_s,x_m\n0.0,0.1\n0.5,0.3"), TableEnd::Open { number: "0.3".into() });
    /// assert!(matches!(TableEnd::of("time_s,x_m\n0.0,0.1\n0.5,0."), TableEnd::Cut { line: 3, column: 5, .. }));
    /// ```
    pub fn of(text: &str) -> Self {
        let lines: Vec<&str> = text.split('\n').collect();
        let last = lines.last().copied().unwrap_or_default();
        if last.trim().is_empty() || last.starts_with('#') || last.ends_with('\r') {
            return Self::Whole;
        }
        let field = last.split(',').count() - 1;
        let number = last.rsplit(',').next().unwrap_or_default();
        let column = last.len() - number.len() + 1;
        let number = number.trim();
        let others = lines[..lines.len() - 1].iter().filter(|line| !line.starts_with('#'));
        let others = others.filter_map(|line| line.split(',').nth(field).map(str::trim));
        // What is no number, as in the header, says nothing about numbers.
        let shapes = others.filter(|text| text.parse::<f64>().is_ok()).map(Shape::of);
        let fullest = shapes.reduce(Shape::fullest).unwrap_or_default();
        let is_broken = number.ends_with(['.', 'e', 'E', '+', '-']);
        if is_broken || Shape::of(number).is_shorter(&fullest) {
            return Self::Cut { line: lines.len() as u64, column, number: number.into() };
        }
        Self::Open { number: number.into() }
    }
}

/// How fully a number is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Shape {
    /// Digits behind the point.
    decimals: usize,
    /// Digits of the exponent.
    exponent: usize,
    /// Digits of a number without either.
    digits: usize,
}

impl Shape {
    fn of(number: &str) -> Self {
        let count = |text: &str| text.bytes().filter(u8::is_ascii_digit).count();
        let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, ""));
        let (_, decimals) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let (decimals, exponent) = (count(decimals), count(exponent));
        Self { decimals, exponent, digits: if decimals + exponent == 0 { count(mantissa) } else { 0 } }
    }

    fn fullest(self, other: Self) -> Self {
        Self {
            decimals: self.decimals.max(other.decimals),
            exponent: self.exponent.max(other.exponent),
            digits: self.digits.max(other.digits),
        }
    }

    /// Whether a number may be the beginning of one that is written as fully as `fullest`.
    fn is_shorter(&self, fullest: &Self) -> bool {
        let has_only_digits = fullest.decimals + fullest.exponent == 0;
        self.decimals < fullest.decimals
            || self.exponent < fullest.exponent
            || (has_only_digits && self.digits < fullest.digits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every way to cut the last number of a table.
    fn cuts(text: &str) -> impl Iterator<Item = &str> {
        let body = text.trim_end();
        let start = body.rfind(',').expect("a table has two columns") + 1;
        (start + 1..body.len()).map(|end| &body[..end])
    }

    #[test]
    fn a_number_of_a_fixed_form_is_never_taken_when_it_is_cut() {
        for text in [
            "time_s,x_m\n0.00,0.100000\n0.01,10.250000\n0.02,-0.300000\n",
            "time_s,x_m\n0,1.000000000000000000e+00\n1,2.500000000000000000e-01\n",
            "time_s,x_m\r\n0.0,10\r\n0.5,10\r\n1.0,20\r\n",
        ] {
            assert_eq!(TableEnd::of(text), TableEnd::Whole);
            assert!(matches!(TableEnd::of(text.trim_end()), TableEnd::Open { .. }), "{text}");
            for cut in cuts(text) {
                assert!(matches!(TableEnd::of(cut), TableEnd::Cut { .. }), "{cut}");
            }
        }
    }

    #[test]
    fn a_table_without_the_last_line_break_is_taken_where_its_numbers_are_alike() {
        assert_eq!(TableEnd::of("a,b\n0,12.5\n1,5.5"), TableEnd::Open { number: "5.5".into() });
        assert_eq!(TableEnd::of("a,b\n0,1\n# the end"), TableEnd::Whole);
        assert!(matches!(
            TableEnd::of("time_s,force_n\n0.0,0.0\n0.5,1.0\n1.0,2"),
            TableEnd::Cut { line: 4, column: 5, .. }
        ));
    }
}
