//! Numbers in the page: two digits that count, which every platform agrees on.

use hpf::figure::short;
use hpf::statistics::Spread;

/// Digits that count.
const DIGITS: usize = 2;

/// A number with its unit; small lengths in millimetres.
pub fn value(number: f64, unit: &str) -> String {
    if unit == "motions" {
        return format!("{number:.0} motions");
    }
    let (number, unit) = if unit == "m" && number.abs() < 0.1 { (1e3 * number, "mm") } else { (number, unit) };
    let text = short(number, if number.abs() >= 100.0 { DIGITS + 1 } else { DIGITS });
    if unit.is_empty() { text } else { format!("{text} {unit}") }
}

/// Which end of a spread is the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worst {
    /// The largest.
    Largest,
    /// The smallest.
    Smallest,
}

/// The worst value of a spread.
pub fn worst(spread: Spread, worst: Worst) -> f64 {
    match worst {
        Worst::Largest => spread.largest,
        Worst::Smallest => spread.smallest,
    }
}

/// Median and worst of a spread in words: once, where they are the same.
pub fn both(spread: Spread, end: Worst, unit: &str) -> String {
    let [median, worst] = [spread.median, worst(spread, end)].map(|number| value(number, unit));
    if median == worst { median } else { format!("{median}, worst {worst}") }
}
