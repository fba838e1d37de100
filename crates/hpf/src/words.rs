//! Numbers as people read them, and names as they type them.

/// A number with four digits that count, without exponent where it is readable.
pub fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    // The power of ten after rounding to four digits: 9.99999 is 10.00.
    let exponent = format!("{value:.3e}");
    let digits = exponent.rsplit('e').next().and_then(|digits| digits.parse().ok()).unwrap_or(f64::NAN);
    if !(-5.0..7.0).contains(&digits) {
        return format!("{value:.3e}");
    }
    format!("{value:.*}", (3.0 - digits).clamp(0.0, 8.0) as usize)
}

/// `name` as a word that a shell reads back: in quotes where it needs them.
///
/// ```
/// use hpf::words::typed;
/// assert_eq!(typed("runs/wall"), "runs/wall");
/// assert_eq!(typed("my run"), "'my run'");
/// assert_eq!(typed("it's"), r"'it'\''s'");
/// ```
pub fn typed(name: impl ToString) -> String {
    let name = name.to_string();
    let is_plain = |sign: char| sign.is_alphanumeric() || "/._-+=,:@%".contains(sign);
    if !name.is_empty() && name.chars().all(is_plain) { name } else { format!("'{}'", name.replace('\'', r"'\''")) }
}

/// A measure in the unit that suits its size: millimetres for small lengths.
pub fn measure(value: f64, unit: &str) -> String {
    match unit {
        "m" if value.abs() < 0.1 => format!("{} mm", number(value * 1e3)),
        "" => number(value),
        unit => format!("{} {unit}", number(value)),
    }
}
