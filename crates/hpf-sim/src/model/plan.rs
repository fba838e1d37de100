//! The best motion inside the model, near the best one made.
//!
//! Starts: the best motion made, and the last one planned. Where an axis may touch or leave something, also the first one;
//! the cost then has kinks at which a straight descent stalls: the stiffness of what it touches rises from a soft one to its
//! own, each time from where the one before led, and the best is tried with a touch at another time ([`super::touch`]).
//! Where a via point may be passed at any time, it is passed at several given times first.

use hpf_learn::{Begin, Effort, Proposal};
use rayon::prelude::*;

use super::EnvironmentModel;
use super::fit::Loads;
use super::inside::Inside;

/// Stiffnesses beside that of the policy that something touched is given on the way to its own.
const LADDER: [f64; 9] = [0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0];
const ROUGH: Effort = Effort { steps: 12, least_gain: 1e-3 };
pub(super) const FINE: Effort = Effort { steps: 60, least_gain: 1e-6 };
/// Times at which a via point without one is passed at first, evenly over the motion.
const MOMENTS: usize = 7;
/// The pull back into the radius grows so often, by so much.
const PULLS: i32 = 8;
const MORE_PULL: f64 = 6.0;
const FIRST_PULL: f64 = 0.1;

impl EnvironmentModel {
    /// The best motion within `radius` of `anchor`.
    pub(super) fn plan(&self, anchor: &[f64], radius: f64) -> Option<Proposal> {
        let plant = &self.plant;
        let loads: Option<Vec<Loads>> =
            self.axes.iter().zip(&plant.axes).map(|(axis, plant)| axis.loads(&plant.fittings)).collect();
        let loads = loads?;
        let share = 1.0 / self.made as f64;
        let contact =
            self.contact.as_ref().map(|sums| sums.each_ref().map(|sum| sum.iter().map(|x| share * x).collect()));
        let inside =
            |loads| Inside { simulation: &plant.simulation, plants: &plant.axes, loads, contact: contact.as_ref() };
        let own = inside(&loads);
        let descent = &plant.descent;
        let before = descent.cost(&own, anchor);
        let softened: Vec<Vec<Loads>> = self.softened(&loads);
        let mut starts: Vec<(&[f64], Option<usize>)> = vec![(anchor, None)];
        starts.extend(self.last.as_deref().map(|last| (last, None)));
        if !softened.is_empty() {
            starts.push((&self.first, None));
        }
        if descent.distances() > 0 {
            let moment = |m: usize| (m + 1) * (descent.moments() - 1) / (MOMENTS + 1);
            starts.extend((0..MOMENTS).map(|m| (anchor, Some(moment(m)))));
        }
        fn begin<'b>(weights: &'b [f64], anchor: &'b [f64]) -> Begin<'b> {
            Begin { weights, anchor, pull: 0.0, moments: None }
        }
        let found: Vec<(Vec<f64>, f64)> = starts
            .par_iter()
            .map(|(start, moment)| {
                let mut weights = start.to_vec();
                if let Some(moment) = moment {
                    let moments = vec![*moment; descent.distances()];
                    let begin = Begin { moments: Some(&moments), ..begin(&weights, anchor) };
                    weights = descent.least(&own, begin, ROUGH).0;
                }
                for soft in &softened {
                    weights = descent.least(&inside(soft), begin(&weights, anchor), ROUGH).0;
                }
                descent.least(&own, begin(&weights, anchor), FINE)
            })
            .collect();
        let best = found.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let best = if softened.is_empty() { best } else { self.at_another_time(&own, best) };
        let (weights, expected) = self.within(anchor, radius, best, before, &own);
        let (weights, mut expected) = if expected < before { (weights, expected) } else { (anchor.to_vec(), before) };
        let planned = self.within_limits(anchor, weights.clone(), &own)?;
        if planned != weights {
            expected = descent.cost(&own, &planned);
        }
        let weights = planned;
        Some(Proposal { length: descent.length(anchor, &weights), weights, expected, before })
    }

    /// The loads with what may be touched softer, from soft to less so; none where nothing may.
    fn softened(&self, loads: &[Loads]) -> Vec<Vec<Loads>> {
        let stiffness = |loads: &Loads| loads.loads.iter().map(|load| load.stiffness).fold(0.0, f64::max);
        let touching: Vec<bool> = loads.iter().map(|loads| loads.law.side != 0.0).collect();
        let rung = |ratio: f64| {
            let mut is_softer = false;
            let soft = loads.iter().zip(&touching).zip(&self.plant.axes).map(|((loads, touching), plant)| {
                let mut soft = loads.clone();
                let most = ratio * plant.largest_stiffness;
                if *touching && stiffness(loads) > most {
                    soft.loads.iter_mut().for_each(|load| load.stiffness = load.stiffness.min(most));
                    is_softer = true;
                }
                soft
            });
            let soft: Vec<Loads> = soft.collect();
            is_softer.then_some(soft)
        };
        LADDER.into_iter().filter_map(rung).collect()
    }

    /// `best` where it lies within `radius` of `anchor`; else the best that does.
    fn within(
        &self,
        anchor: &[f64],
        radius: f64,
        best: (Vec<f64>, f64),
        before: f64,
        inside: &Inside<'_>,
    ) -> (Vec<f64>, f64) {
        let descent = &self.plant.descent;
        let length = descent.length(anchor, &best.0);
        if length <= radius {
            return best;
        }
        let mut weights = best.0;
        let first = FIRST_PULL * before / (radius * radius * descent.learned() as f64);
        for k in 0..PULLS {
            let begin = Begin { weights: &weights, anchor, pull: first * MORE_PULL.powi(k), moments: None };
            let (pulled, expected) = descent.least(inside, begin, ROUGH);
            if descent.length(anchor, &pulled) <= radius {
                return (pulled, expected);
            }
            weights = pulled;
        }
        let share = radius / descent.length(anchor, &weights);
        let cut: Vec<f64> = anchor.iter().zip(&weights).map(|(a, w)| a + share * (w - a)).collect();
        let expected = descent.cost(inside, &cut);
        (cut, expected)
    }
}
