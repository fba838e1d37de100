//! Touching something at another time.
//!
//! A descent never leaves the step in which the tool first touches: before it, no force says how far the tool is away. So
//! a motion is also begun from with its references so much faster or slower, up to their ends, that it touches some steps
//! earlier or later. The change of the weights is the one whose references are nearest (least squares): references are
//! linear in the weights.

use hpf_learn::{Begin, gram};
use nalgebra::DVector;
use rayon::prelude::*;

use super::inside::Inside;
use super::plan::FINE;
use super::{AxisPlant, EnvironmentModel};

/// Steps by which something is touched earlier.
const EARLIER: [isize; 8] = [1, -1, 2, -2, 4, -4, 8, -8];
/// Most times that the best of them is gone on from.
const ROUNDS: usize = 8;
/// Keeps weights that hardly move a reference small, as a share of what moves it most.
const RIDGE: f64 = 1e-9;

impl EnvironmentModel {
    /// `best` with its cost, or a cheaper motion that touches something at another time.
    pub(super) fn at_another_time(&self, inside: &Inside<'_>, mut best: (Vec<f64>, f64)) -> (Vec<f64>, f64) {
        for _ in 0..ROUNDS {
            let begun = EARLIER.par_iter().filter_map(|steps| self.touching_earlier(inside, &best.0, *steps));
            let found: Vec<(Vec<f64>, f64)> = begun
                .map(|weights| {
                    let begin = Begin { weights: &weights, anchor: &weights, pull: 0.0, moments: None };
                    self.plant.descent.least(inside, begin, FINE)
                })
                .collect();
            match found.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some(found) if found.1 < (1.0 - FINE.least_gain) * best.1 => best = found,
                _ => break,
            }
        }
        best
    }

    /// `weights` with references that touch something `steps` earlier; `None` where nothing does, or it cannot be so early.
    fn touching_earlier(&self, inside: &Inside<'_>, weights: &[f64], steps: isize) -> Option<Vec<f64>> {
        let simulation = &self.plant.simulation;
        let per_axis = simulation.blocks.len() / simulation.axis_count();
        let mut moved = None;
        for (a, (plant, loads)) in self.plant.axes.iter().zip(inside.loads).enumerate() {
            let movement = &simulation.blocks[per_axis * a];
            if loads.law.side == 0.0 || movement.noise == 0.0 {
                continue;
            }
            let range = simulation.axis_parameters(a);
            let planned = simulation.planned(a, &weights[range.clone()]);
            let [position, ..] = loads.roll(&planned);
            let is_touching = |(i, y): (usize, &f64)| loads.law.is_touching(*y, &loads.loads[2 * i]);
            let Some(touch) = position.iter().enumerate().position(is_touching).filter(|touch| *touch > 1) else {
                continue;
            };
            let earlier = touch.checked_add_signed(-steps).filter(|earlier| *earlier > 1)?;
            let change = change_by_speed(&planned.position, touch as f64 / earlier as f64);
            let by = plant.weights_for(&change, movement.count)?;
            let moved = moved.get_or_insert_with(|| weights.to_vec());
            moved[range].iter_mut().zip(&by).for_each(|(weight, by)| *weight += by);
        }
        moved
    }
}

/// What changes in `path` where it is gone along at `speed` times its own, up to its end.
fn change_by_speed(path: &[f64], speed: f64) -> Vec<f64> {
    let last = path.len() - 1;
    let at = |i: usize| {
        let place = (i as f64 * speed).min(last as f64);
        let (before, share) = (place as usize, place.fract());
        path[before] + share * (path[(before + 1).min(last)] - path[before])
    };
    path.iter().enumerate().map(|(i, now)| at(i) - now).collect()
}

impl AxisPlant {
    /// The change of the first `count` parameters, the weights of the movement, that changes the reference positions by
    /// nearly `change`; `None` where none does.
    fn weights_for(&self, change: &[f64], count: usize) -> Option<DVector<f64>> {
        if self.responses[..count].iter().any(|response| response.position.is_empty()) {
            return None;
        }
        let columns: Vec<f64> =
            self.responses[..count].iter().flat_map(|response| &response.position).copied().collect();
        let mut square = gram(&columns, change.len());
        let most = square.diagonal().iter().copied().fold(0.0, f64::max);
        (0..count).for_each(|j| square[(j, j)] += RIDGE * most);
        let product = |column: &[f64]| column.iter().zip(change).map(|(a, b)| a * b).sum();
        let right = DVector::from_iterator(count, columns.chunks(change.len()).map(product));
        Some(square.cholesky()?.solve(&right))
    }
}

#[cfg(test)]
mod tests {
    use super::change_by_speed;

    #[test]
    fn a_path_at_twice_its_speed_is_where_it_would_be_at_twice_the_time() {
        let path: Vec<f64> = (0..=10).map(f64::from).collect();
        assert_eq!(change_by_speed(&path, 2.0), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0]);
        assert_eq!(change_by_speed(&path, 0.5)[..3], [0.0, -0.5, -1.0]);
        assert_eq!(change_by_speed(&path, 1.0), [0.0; 11]);
    }
}
