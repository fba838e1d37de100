//! Statistics of a few numbers: median, quartiles, extremes.

use serde_json::{Value, json};

/// The spread of some numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The smallest.
    pub smallest: f64,
    /// A quarter lies below.
    pub lower: f64,
    /// Half lies below.
    pub median: f64,
    /// A quarter lies above.
    pub upper: f64,
    /// The largest.
    pub largest: f64,
}

impl Spread {
    /// The spread of `values`; `None` where there are none. A value that is no number counts as the largest.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        // Between neighbours in proportion, as numpy does by default.
        let at = |share: f64| {
            let place = share * (values.len() - 1) as f64;
            let (below, above) = (values[place.floor() as usize], values[place.ceil() as usize]);
            if below == above { below } else { below + place.fract() * (above - below) }
        };
        (!values.is_empty()).then(|| Self {
            smallest: at(0.0),
            lower: at(0.25),
            median: at(0.5),
            upper: at(0.75),
            largest: at(1.0),
        })
    }

    /// The spread for other programs.
    pub fn to_json(self) -> Value {
        json!({
            "smallest": self.smallest,
            "lower_quartile": self.lower,
            "median": self.median,
            "upper_quartile": self.upper,
            "largest": self.largest,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_lie_between_neighbours_in_proportion() {
        let spread = Spread::of([4.0, 1.0, 3.0, 2.0]).unwrap();
        assert_eq!(
            [spread.smallest, spread.lower, spread.median, spread.upper, spread.largest],
            [1.0, 1.75, 2.5, 3.25, 4.0]
        );
        assert_eq!(Spread::of([7.0]).unwrap().upper, 7.0);
        assert_eq!(Spread::of([]), None);
        assert!(Spread::of([f64::NAN, 1.0]).unwrap().largest.is_nan());
    }
}
