//! Numbers as figures write them.

/// A number as it is written in figures: with a true minus, and zero without one.
pub fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|byte| matches!(byte, b'0' | b'.')) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// A number to `digits` significant digits.
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// A number in `digits` significant digits, without trailing zeros; with a power of ten where it is very large or
/// small.
pub fn short(value: f64, digits: usize) -> String {
    let rounded = rounded(value, digits);
    if rounded == 0.0 || !rounded.is_finite() {
        return number(rounded, 0);
    }
    // The exponent as it is written: a logarithm may miss it by one, and a power of ten leave the numbers there are.
    let scientific = format!("{rounded:e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        let text = number(rounded, decimals);
        return if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text };
    }
    let mantissa = mantissa.replace('-', "−");
    if mantissa == "1" { power_of_ten(exponent) } else { format!("{mantissa}·{}", power_of_ten(exponent)) }
}

/// 10 to the power of `exponent`, with raised digits.
pub fn power_of_ten(exponent: i32) -> String {
    let raised = |sign: char| match sign {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        // The others follow each other in Unicode.
        digit => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).unwrap_or(digit),
    };
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers_keep_what_counts() {
        let cases = [
            (0.15, "0.15"),
            (31.9996, "32"),
            (400.0, "400"),
            (0.0123, "0.012"),
            (1e7, "10⁷"),
            (-2.5e-6, "−2.5·10⁻⁶"),
            (0.0, "0"),
        ];
        for (value, text) in cases {
            assert_eq!(short(value, 2 + usize::from(value > 1.0)), text);
        }
    }
}
