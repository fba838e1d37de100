//! Numbers among the arguments: read right, or refused with what is allowed.

use core::fmt::Display;
use core::ops::RangeInclusive;
use core::str::FromStr;

/// A finite number.
pub fn number(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| "it must be a number".into())
}

pub fn positive(text: &str) -> Result<f64, String> {
    number(text).and_then(|value| if value > 0.0 { Ok(value) } else { Err("it must be above 0".into()) })
}

pub fn not_negative(text: &str) -> Result<f64, String> {
    number(text).and_then(|value| if value >= 0.0 { Ok(value) } else { Err("it must be at least 0".into()) })
}

/// A whole number, however many digits it is written with.
pub fn whole<N: FromStr + PartialOrd + Display>(
    range: RangeInclusive<N>,
) -> impl Fn(&str) -> Result<N, String> + Clone + Send + Sync + 'static
where
    RangeInclusive<N>: Clone + Send + Sync + 'static,
{
    move |text| {
        let within = text.parse().ok().filter(|number| range.contains(number));
        within.ok_or_else(|| format!("it must be a whole number from {} to {}", range.start(), range.end()))
    }
}
