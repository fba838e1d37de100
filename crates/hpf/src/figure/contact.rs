//! Contact: deviation from the surface under the set-point force, and the force itself.

use core::iter;

use hpf_sim::ContactTrace;

use super::axis::{Axis, padded, span};
use super::chart::{Figure, Layer, Panel};
use super::motions::{Length, Motion, learned, motions};
use super::number::short;
use super::palette::{GREEN, Pen, VERMILLION, tint};
use super::signals::{time_axis, with_rest};
use crate::paper::paper_deviation;
use crate::results::Run;

/// An earlier motion is shown where it makes the range of the panel at most this many times larger.
const WIDEST: f64 = 4.0;
/// Where the learned motion in contact takes less than this share of the panel, it is drawn once more, enlarged.
const SMALL_SHARE: f64 = 0.3;

/// Draws the deviation over time.
pub fn deviation(run: &Run) -> Figure {
    let deviations = || run.trajectory.contact.iter().flat_map(|contact| &contact.deviation).copied();
    let band = paper_deviation(&run.task);
    let length = fitting(run, deviations().chain(band));
    let frame = band.map_or((0.0, 0.0), |band| (-band, band));
    let mut panel = compare(run, "deviation", length, frame, |contact| &contact.deviation);
    if let Some(band) = band {
        let shown = length.factor * band;
        let label = format!("±{} {}, the paper's claim", short(shown, 2), length.unit);
        panel.layers.insert(0, Layer::band(-shown, shown, Pen::thin(tint(GREEN, 0.18))).labelled(label));
    }
    let height = (panel.y.high - panel.y.low) / length.factor;
    let mut panels = vec![panel];
    if let Some(enlarged) = enlarged(run, SMALL_SHARE * height) {
        panels[0].heading = "overview".into();
        panels.push(enlarged);
    }
    with_rest(Figure::new("Deviation of the tool from the surface under load", panels), iter::once(run))
}

/// The learned deviation alone while the tool touches, where that is lower than `height` [m].
fn enlarged(run: &Run, height: f64) -> Option<Panel> {
    let learned = learned(run);
    let contact = learned.trace.contact.as_ref()?;
    let touching = contact.deviation.iter().zip(&contact.force);
    let signal: Vec<f64> = touching.map(|(value, force)| if *force > 0.0 { *value } else { f64::NAN }).collect();
    let (low, high) = span(signal.iter().copied())?;
    if high - low >= height || low == high {
        return None;
    }
    let length = fitting(run, [low, high].into_iter());
    let most = short(length.factor * low.abs().max(high.abs()), 3);
    Some(Panel {
        heading: "enlarged, in contact".into(),
        note: format!("at most {most} {}", length.unit),
        x: time_axis(run),
        y: Axis::linear("deviation", length.unit, padded([low, high, 0.0].map(|value| length.factor * value))),
        layers: vec![Layer::signal(&learned.trace.time, &signal, length.factor, learned.pen).labelled(learned.label)],
    })
}

/// The unit that fits lengths along the axis of the contact.
fn fitting(run: &Run, values: impl Iterator<Item = f64>) -> Length {
    let most = span(values.map(f64::abs)).map_or(0.0, |(_, high)| high);
    axis_of(run).map_or(Length::MM, |axis| Length::fitting(axis, most))
}

/// Draws the contact force over time.
pub fn force(run: &Run) -> Figure {
    let unit = "N";
    let set_point = run.trajectory.contact.as_ref().map_or(0.0, |contact| contact.set_point);
    let length = Length { factor: 1.0, unit };
    let mut panel = compare(run, "contact force", length, (set_point, set_point), |contact| &contact.force);
    let label = format!("set-point, {} {unit}", short(set_point, 3));
    panel.layers.push(Layer::level(set_point, Pen::dashed(VERMILLION)).labelled(label));
    with_rest(Figure::new("Contact force and its set-point", vec![panel]), iter::once(run))
}

fn axis_of(run: &Run) -> Option<&hpf_sim::task::Axis> {
    run.trajectory.contact.as_ref().map(|contact| &run.task.axis[contact.axis])
}

/// A panel with the learned signal, at a scale that shows it and what lies from `least` to `most`; with the earlier
/// ones that fit, and the others in words.
fn compare(
    run: &Run,
    quantity: &str,
    shown: Length,
    (least, most): (f64, f64),
    signal: impl for<'t> Fn(&'t ContactTrace) -> &'t Vec<f64>,
) -> Panel {
    let of = |motion: &Motion<'_>| -> Vec<f64> {
        let contact = motion.trace.contact.as_ref();
        contact.map(|contact| signal(contact).iter().map(|value| shown.factor * value).collect()).unwrap_or_default()
    };
    let mut motions = motions(run);
    let ends = [shown.factor * least, shown.factor * most];
    let learned = motions.pop().map(|motion| (of(&motion), motion));
    let must: Vec<f64> = learned.iter().flat_map(|(values, _)| values.iter().copied()).chain(ends).collect();
    let (low, high) = span(must.iter().copied()).unwrap_or((0.0, 1.0));

    let (mut layers, mut left_out, mut values) = (Vec::new(), Vec::new(), must);
    for motion in motions {
        let signal = of(&motion);
        let (least, most) = span(signal.iter().copied()).unwrap_or((low, high));
        if most.max(high) - least.min(low) <= WIDEST * (high - low) {
            layers.push(Layer::signal(&motion.trace.time, &signal, 1.0, motion.pen).labelled(motion.label));
            values.extend(signal);
        } else {
            let far = if most - high > low - least { most } else { least };
            left_out.push(format!("{} (to {} {})", motion.label, short(far, 3), shown.unit));
        }
    }
    if let Some((signal, motion)) = learned {
        layers.push(Layer::signal(&motion.trace.time, &signal, 1.0, motion.pen).labelled(motion.label));
    }
    Panel {
        heading: String::new(),
        note: match left_out.as_slice() {
            [] => String::new(),
            [first, rest @ ..] if rest.len() > 2 => format!("not shown: {first} and {} more", rest.len()),
            all => format!("not shown: {}", all.join(", ")),
        },
        x: time_axis(run),
        y: Axis::linear(quantity, shown.unit, padded(values)),
        layers,
    }
}
