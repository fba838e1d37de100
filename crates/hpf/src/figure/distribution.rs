//! Many runs, by setting: cost over the motions made, and measures of what was learned, with their spread over seeds.

use super::axis::{Axis, padded, span};
use super::chart::{Figure, Layer, Mark, Panel, Point};
use super::overlay::{cost_axis, motions_axis, steps};
use super::palette::{BLACK, MOST_SERIES, Pen, VERMILLION};
use crate::statistics::Spread;

/// Values farther apart than this, as a factor, are shown by their logarithm.
const WIDEST_LINEAR: f64 = 30.0;
/// Most places at which a curve is drawn.
const PLACES: usize = 4000;
/// Width of a median: thin, so that narrow bands are seen beside it [px].
const MEDIAN_WIDTH: f64 = 3.0;
/// The golden section: its multiples never crowd.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Runs of one setting.
pub struct Group {
    /// What sets it apart.
    pub name: String,
    /// The same, briefly, where there is little room.
    pub short: String,
    /// Its runs.
    pub members: Vec<Member>,
}

/// One run.
pub struct Member {
    /// Motions made and the cost then, in the order of learning.
    pub costs: Vec<Point>,
    /// Measures of what was learned.
    pub measures: Vec<Measure>,
}

/// One measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its value.
    pub value: f64,
    /// The largest value that passes.
    pub target: Option<f64>,
}

impl Member {
    /// The lowest cost so far, where learning kept the best of its policies.
    fn best(&self) -> Vec<Point> {
        let lowest = |best: &mut f64, point: &Point| {
            *best = best.min(point.1);
            Some((point.0, *best))
        };
        self.costs.iter().scan(f64::INFINITY, lowest).collect()
    }
}

/// How many groups were left out of a figure, in words.
fn left_out(all: usize) -> String {
    if all > MOST_SERIES { format!("; the first {MOST_SERIES} of {all} settings") } else { String::new() }
}

/// Draws the cost of the best policy so far over the motions made: median, and quartiles as a band.
pub fn cost(groups: &[Group]) -> Figure {
    let shown: Vec<&Group> = groups.iter().filter(|group| !group.members.is_empty()).take(MOST_SERIES).collect();
    let (mut bands, mut lines, mut costs) = (Vec::new(), Vec::new(), Vec::new());
    for (i, group) in shown.iter().enumerate() {
        let curve = spreads(&group.members.iter().map(Member::best).collect::<Vec<_>>());
        costs.extend(curve.iter().flat_map(|(_, spread)| [spread.lower, spread.upper]));
        let stepped = |of: fn(&Spread) -> f64| steps(curve.iter().map(|(x, spread)| (*x, of(spread))));
        let (lower, upper) = (stepped(|spread| spread.lower), stepped(|spread| spread.upper));
        let between = lower.iter().zip(&upper).map(|(low, high)| (low.0, low.1, high.1)).collect();
        bands.push(Layer::between(between, Pen::series(i)));
        let pen = Pen { width: MEDIAN_WIDTH, ..Pen::series(i) };
        lines.push(Layer::line(stepped(|spread| spread.median), pen).labelled(group.name.as_str()));
    }
    let ends = shown.iter().flat_map(|group| &group.members).filter_map(|member| member.costs.last()).map(|end| end.0);
    let one = matches!(shown.as_slice(), [one] if one.name.is_empty());
    if let (true, Some(line)) = (one, lines.first_mut()) {
        line.label = None;
    }
    let panel = Panel {
        heading: String::new(),
        note: format!("line: median, band: quartiles, over {}{}", seeds(groups), left_out(groups.len())),
        x: motions_axis(ends),
        y: cost_axis(costs.into_iter()),
        layers: bands.into_iter().chain(lines).collect(),
    };
    Figure::new("Cost of the best policy so far, by motions made", vec![panel]).with_direct_labels()
}

/// How many seeds there are, in words.
fn seeds(groups: &[Group]) -> String {
    match span(groups.iter().map(|group| group.members.len() as f64)).unwrap_or((0.0, 0.0)) {
        (few, many) if few == many => format!("{many} seeds"),
        (few, many) => format!("{few} to {many} seeds"),
    }
}

/// The spread of `curves` wherever one of them changes; each keeps its value until the next.
fn spreads(curves: &[Vec<Point>]) -> Vec<(f64, Spread)> {
    let begin = curves.iter().filter_map(|curve| curve.first()).map(|point| point.0).fold(0.0, f64::max);
    let mut places: Vec<f64> = curves.iter().flatten().map(|point| point.0).filter(|x| *x >= begin).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let every = places.len().div_ceil(PLACES).max(1);
    let last = places.len().saturating_sub(1);
    let kept = places.iter().enumerate().filter(|(i, _)| i % every == 0 || *i == last);
    let at = |curve: &Vec<Point>, x: f64| {
        let next = curve.partition_point(|point| point.0 <= x);
        next.checked_sub(1).map(|index| curve[index].1)
    };
    let spread = |x: f64| Spread::of(curves.iter().filter_map(|curve| at(curve, x))).map(|spread| (x, spread));
    kept.filter_map(|(_, x)| spread(*x)).collect()
}

/// Draws every measure that differs between runs, or all where none does: a dot for each seed, quartiles and median
/// beside them.
pub fn measures(groups: &[Group], varied: &str) -> Figure {
    let shown: Vec<&Group> = groups.iter().take(MOST_SERIES).collect();
    let mut names: Vec<&str> = Vec::new();
    for measure in shown.iter().flat_map(|group| &group.members).flat_map(|member| &member.measures) {
        if !names.contains(&measure.name.as_str()) {
            names.push(&measure.name);
        }
    }
    let ticks: Vec<String> = shown.iter().map(|group| group.short.clone()).collect();
    let x = Axis::named(varied, ticks);
    let of_measures = |with_same: bool| -> Vec<Panel> {
        names.iter().filter_map(|name| measure_panel(&shown, name, &x, with_same)).collect()
    };
    let mut panels = of_measures(false);
    let all_same = panels.is_empty();
    if all_same {
        panels = of_measures(true);
    }
    if let Some(first) = panels.first_mut() {
        let what = if all_same { "every run measures the same" } else { "a dot per seed; box: quartiles, bar: median" };
        first.note = format!("{what}, over {}{}", seeds(groups), left_out(groups.len()));
    }
    Figure::new("Measures of the learned policies", panels)
}

/// The panel of a measure; of one that is the same in every run only `with_same`.
fn measure_panel(groups: &[&Group], name: &str, x: &Axis, with_same: bool) -> Option<Panel> {
    let of = |member: &Member| member.measures.iter().find(|measure| measure.name == name).cloned();
    let all: Vec<Measure> = groups.iter().flat_map(|group| &group.members).filter_map(of).collect();
    let (low, high) = span(all.iter().map(|measure| measure.value))?;
    let target = all.iter().find_map(|measure| measure.target);
    if !with_same && high - low <= 1e-6 * high.abs() {
        return None;
    }
    let is_small = all[0].unit == "m" && high.abs().max(low.abs()) < 0.1;
    let (factor, unit) = if is_small { (1e3, "mm".to_owned()) } else { (1.0, all[0].unit.clone()) };
    // A few groups do not fill the figure.
    let narrow = (groups.len() as f64 / 3.0).min(1.0);
    let mut layers = Vec::new();
    for (i, group) in groups.iter().enumerate() {
        let values: Vec<f64> = group.members.iter().filter_map(of).map(|measure| factor * measure.value).collect();
        let (middle, colour) = (i as f64, Pen::series(i).colour);
        if let Some(spread) = Spread::of(values.iter().copied()) {
            let ends = (middle - 0.22 * narrow, middle - 0.06 * narrow);
            let at = |x: f64| (x, spread.lower, spread.upper);
            layers.push(Layer::between(vec![at(ends.0), at(ends.1)], Pen::thin(colour)));
            layers.push(Layer::line(vec![(ends.0, spread.median), (ends.1, spread.median)], Pen::plain(BLACK)));
        }
        // Side by side, so that equal values do not hide each other.
        let beside = |j: usize| middle + narrow * (0.02 + 0.2 * (j as f64 * GOLDEN).fract());
        let dots = values.iter().enumerate().map(|(j, value)| (beside(j), *value)).collect();
        layers.push(Layer::marks(Mark::Speck, dots, Pen::thin(colour)));
    }
    if let Some(target) = target {
        layers.push(Layer::level(factor * target, Pen::dashed(VERMILLION)).labelled("target, at most"));
    }
    let quantity = name.replace('_', " ");
    let logarithmic = low > 0.0 && high > WIDEST_LINEAR * low;
    let values = [low, high].into_iter().chain(target.filter(|target| !logarithmic || *target > 0.0));
    let (low, high) = span(values.map(|value| factor * value))?;
    let y = if logarithmic {
        Axis::logarithmic(quantity, unit, (low / 1.5, high * 1.5))
    } else {
        Axis::linear(quantity, unit, padded([low, high]))
    };
    Some(Panel { heading: String::new(), note: String::new(), x: x.clone(), y, layers })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_keep_their_value_until_the_next_and_after_their_end() {
        let spread = spreads(&[vec![(1.0, 8.0), (3.0, 2.0)], vec![(1.0, 4.0), (2.0, 0.0)]]);
        let medians: Vec<Point> = spread.iter().map(|(x, spread)| (*x, spread.median)).collect();
        assert_eq!(medians, [(1.0, 6.0), (2.0, 4.0), (3.0, 1.0)]);
    }

    #[test]
    fn the_cost_so_far_never_rises() {
        let member = Member { costs: vec![(1.0, 3.0), (2.0, 5.0), (3.0, 1.0)], measures: Vec::new() };
        assert_eq!(member.best(), [(1.0, 3.0), (2.0, 3.0), (3.0, 1.0)]);
    }
}
