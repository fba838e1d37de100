//! Axes: ranges, round ticks and their labels.

use super::number::{number, power_of_ten, short};

/// Smallest range of an axis, as a fraction of its values: below it rounding is all there is to see.
const RESOLUTION: f64 = 1e-9;
/// Room beside the data, as a fraction of their range.
const PADDING: f64 = 0.06;

/// Beyond this, and below its reciprocal, differences and ratios of axes would leave the numbers there are: values are
/// drawn as this, by the logarithm as its reciprocal, or as 0.
const LARGEST: f64 = 1e307;

/// Smallest and largest of the finite values.
pub fn span(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values.into_iter().filter(|value| value.is_finite()).fold(None, |span, value| {
        let (low, high) = span.unwrap_or((value, value));
        Some((value.min(low), value.max(high)))
    })
}

/// A range that shows `values` with some room on both sides, also where all are equal or there are none.
pub fn padded(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let (low, high) = span(values).unwrap_or((0.0, 1.0));
    let (low, high) = (low.clamp(-LARGEST, LARGEST), high.clamp(-LARGEST, LARGEST));
    let most = low.abs().max(high.abs());
    if most < LARGEST.recip() {
        return (-1.0, 1.0);
    }
    if high - low > RESOLUTION * most {
        let room = PADDING * (high - low);
        (low - room, high + room)
    } else {
        let room = if most > 0.0 { 0.1 * most } else { 1.0 };
        (low - room, high + room)
    }
}

/// Costs that differ by a smaller factor are shown in proportion.
const NEARLY_CONSTANT: f64 = 1.2;
/// Room beside costs on an axis by the logarithm, as a factor.
const COST_ROOM: f64 = 1.5;

/// How values lie along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// In proportion.
    Linear,
    /// In proportion, the smallest at the far end: downwards, where the axis goes upwards.
    Reversed,
    /// In proportion, with ticks at whole numbers only.
    Counted,
    /// By their logarithm.
    Logarithmic,
    /// Things side by side, at 0, 1, 2 and so on, each with its name.
    Named,
}

/// An axis: what is on it, and from where to where.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What is shown.
    pub quantity: String,
    /// Its unit; empty for a number without one.
    pub unit: String,
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// How values lie between.
    pub scale: Scale,
    /// What is written at 0, 1, 2 and so on of an axis of named things.
    pub names: Vec<String>,
}

/// A tick: where, and its label; the unlabelled ones have an empty label.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// The value.
    pub value: f64,
    /// What is written beside it.
    pub label: String,
}

impl Axis {
    /// An axis in proportion.
    pub fn linear(quantity: impl Into<String>, unit: impl Into<String>, (low, high): (f64, f64)) -> Self {
        Self { quantity: quantity.into(), unit: unit.into(), low, high, scale: Scale::Linear, names: Vec::new() }
    }

    /// An axis by the logarithm, from `low` to `high`, both above 0.
    pub fn logarithmic(quantity: impl Into<String>, unit: impl Into<String>, (low, high): (f64, f64)) -> Self {
        let low = low.clamp(LARGEST.recip(), LARGEST);
        // Equal ends have room on both sides.
        let high = high.clamp(LARGEST.recip(), LARGEST);
        let range = if high > 1.01 * low { (low, high) } else { (low / 1.5, low * 1.5) };
        Self::linear(quantity, unit, range).with_scale(Scale::Logarithmic)
    }

    /// The axis of a cost that shows `values`: by the logarithm where all `totals` are
    /// above 0; in proportion where one is not, for a logarithm could not show it, and where all shown hardly differ.
    pub fn of_cost(totals: impl Iterator<Item = f64> + Clone, values: impl Iterator<Item = f64>) -> Self {
        match span(totals.clone()) {
            Some((least, _)) if least <= 0.0 => Self::linear("cost", "", padded(totals.chain(values))),
            _ => {
                let shown = values.chain(totals).filter(|value| *value > 0.0);
                let (low, high) = span(shown).unwrap_or((1.0, 1.0));
                if high < NEARLY_CONSTANT * low {
                    return Self::linear("cost", "", padded([low, high]));
                }
                Self::logarithmic("cost", "", (low / COST_ROOM, high * COST_ROOM))
            }
        }
    }

    /// An axis of things side by side.
    pub fn named(quantity: impl Into<String>, names: Vec<String>) -> Self {
        let range = (-0.5, names.len().max(1) as f64 - 0.5);
        Self { names, ..Self::linear(quantity, "", range).with_scale(Scale::Named) }
    }

    /// The same axis with another scale.
    pub fn with_scale(mut self, scale: Scale) -> Self {
        self.scale = scale;
        self
    }

    /// Where `value` lies along the axis: 0 at its near end, 1 at its far one.
    pub fn share(&self, value: f64) -> f64 {
        let value = value.clamp(-LARGEST, LARGEST);
        let linear = |low: f64, value: f64, high: f64| (value - low) / (high - low);
        match self.scale {
            Scale::Linear | Scale::Counted | Scale::Named => linear(self.low, value, self.high),
            Scale::Reversed => 1.0 - linear(self.low, value, self.high),
            // Zero and less lie endlessly far below: a line to them leaves the box downwards.
            Scale::Logarithmic if value <= 0.0 => -100.0,
            Scale::Logarithmic => linear(self.low.log10(), value.max(LARGEST.recip()).log10(), self.high.log10()),
        }
    }

    /// Power of ten that tick labels leave out, so that they stay short.
    fn exponent(&self) -> i32 {
        let most = self.low.abs().max(self.high.abs());
        if matches!(self.scale, Scale::Logarithmic | Scale::Named) || most == 0.0 || (1e-3..1e5).contains(&most) {
            return 0;
        }
        3 * (most.log10() / 3.0).floor() as i32
    }

    /// What is written along the axis: quantity and unit, with the power of ten that the labels leave out.
    pub fn title(&self) -> String {
        let factor = match self.exponent() {
            0 => String::new(),
            exponent => power_of_ten(exponent),
        };
        let unit =
            [factor, self.unit.clone()].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ");
        if unit.is_empty() { self.quantity.clone() } else { format!("{} [{unit}]", self.quantity) }
    }

    /// Ticks at round values, which cut the axis into at most `count` pieces.
    pub fn ticks(&self, count: f64) -> Vec<Tick> {
        match self.scale {
            Scale::Logarithmic => logarithmic_ticks(self.low, self.high, count),
            Scale::Named => {
                let tick = |(i, name): (usize, &String)| Tick { value: i as f64, label: name.clone() };
                self.names.iter().enumerate().map(tick).collect()
            }
            Scale::Linear | Scale::Reversed | Scale::Counted => {
                let factor = 10.0_f64.powi(self.exponent());
                let (low, high) = (self.low / factor, self.high / factor);
                let step = round_step(high - low, count);
                let step = if self.scale == Scale::Counted { whole(step * factor) / factor } else { step };
                let decimals = decimals(step);
                let values = multiples(low, high, step);
                values.map(|value| Tick { value: value * factor, label: number(value, decimals) }).collect()
            }
        }
    }
}

/// The round step (1, 2, 2.5 or 5 times a power of ten) that cuts `range` into at most `count` pieces.
fn round_step(range: f64, count: f64) -> f64 {
    let least = range / count.max(1.0);
    let power = 10.0_f64.powf(least.log10().floor());
    // The last one answers for rounding in the line above.
    let factors = [1.0, 2.0, 2.5, 5.0, 10.0];
    let factor = factors.into_iter().find(|factor| factor * power >= least * (1.0 - 1e-9)).unwrap_or(10.0);
    factor * power
}

/// The next whole step: 2.5 becomes 5.
fn whole(step: f64) -> f64 {
    if step < 1.0 {
        1.0
    } else if step.fract() > 0.0 {
        2.0 * step
    } else {
        step
    }
}

/// Multiples of `step` from `low` to `high`.
fn multiples(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    // An end that is a multiple but for rounding still gets its tick.
    let first = (low / step - 1e-6).ceil() as i64;
    let last = (high / step + 1e-6).floor() as i64;
    (first..=last).map(move |i| i as f64 * step)
}

/// Decimals that tell multiples of `step` apart.
fn decimals(step: f64) -> usize {
    (0..12)
        .find(|decimals| {
            let scaled = step * 10.0_f64.powi(*decimals);
            (scaled - scaled.round()).abs() < 1e-6 * scaled
        })
        .unwrap_or(12) as usize
}

fn logarithmic_ticks(low: f64, high: f64, count: f64) -> Vec<Tick> {
    let exponents = (low.log10() - 1e-6).ceil() as i32..=(high.log10() + 1e-6).floor() as i32;
    let decades = exponents.clone().count();
    let between = |digits: &[u8]| {
        let values = |exponent: i32| {
            digits.iter().map(move |digit| f64::from(*digit) * 10.0_f64.powi(exponent)).collect::<Vec<_>>()
        };
        let inside = (exponents.start() - 1..=*exponents.end()).flat_map(values);
        inside.filter(|value| (low..=high).contains(value)).collect::<Vec<_>>()
    };
    let main = between(&[1, 2, 5]);
    if decades < 2 && main.len() > 2 {
        let others = between(&[3, 4, 6, 7, 8, 9]);
        let others = others.into_iter().map(|value| Tick { value, label: String::new() });
        return main.into_iter().map(|value| Tick { value, label: short(value, 1) }).chain(others).collect();
    }
    if decades < 2 {
        // Too little for those: round values in proportion.
        let step = round_step(high - low, count.min(5.0));
        let is_plain = low >= 1e-4 && high < 1e5;
        let label = |value: f64| {
            // As many digits as tell multiples of the step apart, and one for a step of 2.5.
            let digits = (value / step).log10().floor().max(0.0) as usize + 2;
            if is_plain { number(value, decimals(step)) } else { short(value, digits) }
        };
        let labelled = |value| Tick { value, label: label(value) };
        return multiples(low, high, step).filter(|value| *value > 0.0).map(labelled).collect();
    }
    let every = (decades as f64 / count.max(2.0)).ceil() as i32;
    let plain = *exponents.start() >= -3 && *exponents.end() <= 4;
    let label = |exponent: i32| match exponent {
        _ if exponent.rem_euclid(every) != 0 => String::new(),
        _ if plain => number(10.0_f64.powi(exponent), usize::try_from(-exponent).unwrap_or(0)),
        _ => power_of_ten(exponent),
    };
    let mut ticks: Vec<Tick> =
        exponents.clone().map(|exponent| Tick { value: 10.0_f64.powi(exponent), label: label(exponent) }).collect();
    if decades <= 6 {
        let others = between(&[2, 3, 4, 5, 6, 7, 8, 9]);
        ticks.extend(others.into_iter().map(|value| Tick { value, label: String::new() }));
    }
    ticks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, count: f64) -> Vec<String> {
        axis.ticks(count).into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn ticks_are_round_and_reach_both_ends() {
        assert_eq!(labels(&Axis::linear("", "", (0.0, 5.0)), 5.0), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(labels(&Axis::linear("", "", (-0.15, 0.3)), 5.0), ["−0.1", "0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels(&Axis::linear("", "", (0.0, 10.0)), 4.0), ["0.0", "2.5", "5.0", "7.5", "10.0"]);
        assert_eq!(
            labels(&Axis::linear("", "", (999.999, 1000.002)), 3.0),
            ["999.999", "1000.000", "1000.001", "1000.002"]
        );
    }

    #[test]
    fn what_is_counted_has_whole_ticks() {
        let axis = |high| Axis::linear("update", "", (0.0, high)).with_scale(Scale::Counted);
        assert_eq!(labels(&axis(1.0), 9.0), ["0", "1"]);
        assert_eq!(labels(&axis(20.0), 9.0), ["0", "5", "10", "15", "20"]);
    }

    #[test]
    fn very_large_and_small_values_share_a_power_of_ten() {
        let axis = Axis::linear("stiffness", "N/m", (0.0, 1e6));
        assert_eq!(axis.title(), "stiffness [10⁶ N/m]");
        assert_eq!(labels(&axis, 4.0), ["0.00", "0.25", "0.50", "0.75", "1.00"]);
        assert_eq!(Axis::linear("force", "N", (-2e-5, 2e-5)).title(), "force [10⁻⁶ N]");
        assert_eq!(Axis::linear("update", "", (0.0, 600.0)).title(), "update");
    }

    #[test]
    fn any_values_make_a_range_with_ticks() {
        let cases: [&[f64]; 12] = [
            &[],
            &[0.0],
            &[3.0, 3.0],
            &[-1e-12],
            &[f64::NAN, 2.0, f64::INFINITY],
            &[1000.0, 1000.0 + 1e-12],
            &[-1e300, 1e300],
            &[1e-300, 2e-300],
            &[-1e308, 1e308],
            &[1.000_06e308, 1.000_15e308],
            &[1e-310, 2e-310],
            &[99.9999, 100.0001],
        ];
        for values in cases {
            let (low, high) = padded(values.iter().copied());
            assert!(low.is_finite() && high.is_finite() && low < high, "{values:?}");
            let ticks = Axis::linear("", "", (low, high)).ticks(6.0);
            assert!((2..=8).contains(&ticks.len()), "{values:?}: {ticks:?}");
            assert!(ticks.windows(2).all(|pair| pair[0].label != pair[1].label), "{values:?}: {ticks:?}");
        }
    }

    #[test]
    fn costs_of_any_size_lie_in_the_box() {
        for power in (-323..=308).step_by(3).chain([306, 307, 308]) {
            let size: f64 = format!("1e{power}").parse().unwrap();
            for values in [[size, 1.5 * size], [-size, size], [-1.5 * size, -size], [size, size]] {
                let values = values.map(|value| value.clamp(f64::MIN, f64::MAX));
                let axis = Axis::of_cost(values.iter().copied(), values.iter().copied());
                assert!(axis.low.is_finite() && axis.high.is_finite() && axis.low < axis.high, "{values:?}: {axis:?}");
                assert!(values.iter().all(|value| (0.0..=1.0).contains(&axis.share(*value))), "{values:?}: {axis:?}");
                assert!(!axis.ticks(6.0).is_empty(), "{values:?}: {axis:?}");
            }
        }
    }

    #[test]
    fn powers_of_ten_are_labelled_and_thinned_out() {
        let axis = |low, high| Axis::linear("", "", (low, high)).with_scale(Scale::Logarithmic);
        assert_eq!(labels(&axis(0.01, 100.0), 8.0), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(labels(&axis(1e-6, 1e2), 5.0), ["10⁻⁶", "10⁻⁴", "10⁻²", "10⁰", "10²"]);
        assert_eq!(labels(&axis(2.0, 7.0), 8.0), ["2", "3", "4", "5", "6", "7"]);
        // From less than two of them on, 1, 2 and 5 times each: the lower half of such an axis has labels too.
        assert_eq!(labels(&axis(4.3, 95.0), 8.0), ["5", "10", "20", "50"]);
        assert_eq!(labels(&axis(0.12, 2.4), 8.0), ["0.2", "0.5", "1", "2"]);
        assert_eq!(labels(&axis(1.5e-7, 1.5e-6), 8.0), ["2·10⁻⁷", "5·10⁻⁷", "10⁻⁶"]);
        assert_eq!(axis(0.01, 100.0).share(1.0), 0.5);
        assert!(axis(0.01, 100.0).share(0.0) < -1.0, "zero leaves the box");
    }
}
