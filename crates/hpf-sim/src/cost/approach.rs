//! The least distance of a motion to a via point that may be passed at any time.

use crate::task::ViaPoint;
use crate::trace::Trace;

/// The sample nearest to a via point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approach {
    /// Which one.
    pub(crate) sample: usize,
    /// How far outside the radius.
    pub(crate) outside: f64,
}

impl Approach {
    /// Where `trace` comes nearest to `via`.
    pub(crate) fn nearest(via: &ViaPoint, trace: &Trace) -> Self {
        let distance = |i: usize| {
            let offsets = trace.axes.iter().zip(&via.position).map(|(axis, target)| axis.position[i] - target);
            offsets.map(|offset| offset * offset).sum::<f64>().sqrt()
        };
        let mut near = (0, distance(0));
        for i in 1..=trace.steps() {
            let distance = distance(i);
            // A motion that is no number anywhere is near nothing.
            if distance.is_nan() || distance < near.1 {
                near = (i, distance);
            }
        }
        let outside = near.1 - via.radius.unwrap_or(0.0);
        Self { sample: near.0, outside: if outside < 0.0 { 0.0 } else { outside } }
    }
}
