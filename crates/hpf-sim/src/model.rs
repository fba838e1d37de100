//! A model of the environment: fitted to the motions made, and planned in. See docs/learning.md.
//!
//! The law of the tool is the policy's own; unknown is only the force, `f = F(t, y)`, axis by axis. After each motion every
//! [`family`] of environments is fitted to all motions of an axis ([`fit`]), the family that explains and predicts them
//! best is taken ([`choice`]), and the whole cost of the task is minimised inside ([`plan`]). Nothing here looks at the
//! environment that the simulator has: only at what was recorded of motions.

mod affine;
mod choice;
mod dual;
mod family;
mod fit;
mod inside;
mod law;
mod plan;
mod record;
mod safety;
mod spline;
mod touch;
mod wall;
mod zero;

use std::sync::Arc;

use hpf_learn::{Descent, Model, Proposal};

use crate::simulation::{Planned, Simulation};
use choice::AxisEnvironment;
use family::{COEFFICIENTS, FINE_COEFFICIENTS, Family};
use fit::{Fitting, Made};
use record::Record;

/// Most steps of a motion that is modelled: fits take time in proportion.
const MOST_STEPS: usize = 5_000;
/// Most parameters of one axis, and most of them times steps: the slopes of a motion by its parameters are kept.
const MOST_PARAMETERS: usize = 400;
const MOST_SLOPES: usize = 500_000;
/// Parts of a box of bounds that count as much as one of the movement's scale.
const GAIN_PARTS: f64 = 20.0;
/// Forcing that counts as one: of the travel.
const FORCING: f64 = 10.0;

/// What never changes: the policy's law, and the families.
#[derive(Debug)]
struct Plant {
    simulation: Simulation,
    descent: Descent,
    axes: Vec<AxisPlant>,
}

/// The same of one axis.
#[derive(Debug)]
struct AxisPlant {
    fittings: Vec<Fitting>,
    /// How the plan answers to each parameter, alone.
    responses: Vec<Planned>,
    largest_stiffness: f64,
}

/// A model of the environment of a task.
#[derive(Clone, Debug)]
pub(crate) struct EnvironmentModel {
    plant: Arc<Plant>,
    axes: Vec<AxisEnvironment>,
    /// Deviation less position along the contact, and contact force with what the admittance sees of it, at each sample:
    /// sums over the motions made.
    contact: Option<[Vec<f64>; 2]>,
    made: usize,
    /// Where the search for the next motion begins, too.
    first: Vec<f64>,
    last: Option<Vec<f64>>,
}

impl EnvironmentModel {
    /// The model of a task that nothing was recorded of; `None` where its motions are of a law that is not modelled.
    pub(crate) fn new(simulation: &Simulation) -> Option<Self> {
        let steps = simulation.priced_samples() - 1;
        let axes = simulation.axis_count();
        let is_modelled = (0..axes).all(|a| simulation.has_first_order_law(a));
        let most = (0..axes).map(|a| simulation.axis_parameters(a).len()).max()?;
        if !is_modelled
            || simulation.is_random
            || steps > MOST_STEPS
            || most > MOST_PARAMETERS
            || most * steps > MOST_SLOPES
        {
            return None;
        }
        // As many over the movement, whatever the rest time.
        let [count, fine] = [COEFFICIENTS, FINE_COEFFICIENTS].map(|count| count * steps / simulation.step_count());
        let families = || -> Vec<Box<dyn Family>> {
            vec![
                Box::new(zero::Zero { count }),
                Box::new(zero::Zero { count: fine }),
                Box::new(wall::Wall { side: 1.0, count }),
                Box::new(wall::Wall { side: -1.0, count }),
                Box::new(affine::Affine { count }),
            ]
        };
        let plant = |a: usize| {
            let count = simulation.axis_parameters(a).len();
            let rest = simulation.planned(a, &vec![0.0; count]);
            let response = |j: usize| {
                let unit: Vec<f64> = (0..count).map(|i| if i == j { 1.0 } else { 0.0 }).collect();
                simulation.planned(a, &unit).less(&rest)
            };
            let laws = [simulation.is_sampled(), simulation.touched().is_some_and(|touched| touched.0 == a)];
            let fitting = |family| Fitting::new(family, 2 * steps + 1, laws, simulation.step_time());
            AxisPlant {
                fittings: families().into_iter().map(fitting).collect(),
                responses: (0..count).map(response).collect(),
                largest_stiffness: simulation.largest_stiffness(a),
            }
        };
        let scales = scales(simulation);
        let plant = Plant {
            descent: Descent::new(&simulation.blocks, &simulation.signals, &scales),
            axes: (0..axes).map(plant).collect(),
            simulation: simulation.clone(),
        };
        Some(Self {
            axes: plant.axes.iter().map(|axis| AxisEnvironment::new(axis.fittings.len())).collect(),
            contact: simulation.touched().map(|_| [(); 2].map(|()| vec![0.0; steps + 1])),
            plant: Arc::new(plant),
            made: 0,
            first: Vec::new(),
            last: None,
        })
    }
}

/// The size at which each parameter counts alike, whatever the units: of the movement that of a pull as strong as the one
/// to the goal, of the gains a share of their bounds.
fn scales(simulation: &Simulation) -> Vec<f64> {
    let travels: Vec<f64> = simulation.task.axis.iter().map(|axis| (axis.goal - axis.start).abs()).collect();
    let longest = travels.iter().copied().fold(0.0, f64::max);
    let blocks = simulation.blocks.len() / travels.len();
    let scale = |(b, block): (usize, &hpf_learn::Block)| {
        let a = b / blocks;
        let travel = if travels[a] > 0.0 { travels[a] } else { longest };
        let travel = if travel > 0.0 { travel } else { 1.0 };
        let scale = match b % blocks {
            0 => FORCING * travel / simulation.forcing_scale(a).abs(),
            1 | 2 if block.max > block.min => (block.max - block.min) / GAIN_PARTS,
            3 => travel,
            _ => 1.0,
        };
        vec![scale; block.count]
    };
    simulation.blocks.iter().enumerate().flat_map(scale).collect()
}

impl Model for EnvironmentModel {
    fn shown(&self) -> usize {
        record::size(&self.plant.simulation)
    }

    fn learn(&mut self, weights: &[f64], motion: &[f64]) -> bool {
        let plant = &self.plant;
        let record = Record::read(&plant.simulation, motion);
        if self.made == 0 {
            self.first = weights.to_vec();
        }
        self.made += 1;
        let mut explains = true;
        for (a, (axis, signals)) in self.axes.iter_mut().zip(record.axes).enumerate() {
            let planned = plant.simulation.planned(a, &weights[plant.simulation.axis_parameters(a)]);
            let [position, force] = signals;
            if let (Some((contact, direction)), Some(sums), Some([deviation, pressed])) =
                (plant.simulation.touched(), &mut self.contact, &record.contact)
                && contact == a
            {
                for i in 0..position.len() {
                    sums[0][i] += deviation[i] - direction * position[i];
                    sums[1][i] += pressed[i] + direction * force[i];
                }
            }
            let made = Made { planned, position: position.to_vec(), force: force.to_vec() };
            explains &= axis.learn(&plant.axes[a].fittings, made, plant.axes[a].largest_stiffness);
        }
        explains
    }

    fn propose(&mut self, anchor: &[f64], radius: f64) -> Option<Proposal> {
        let proposal = self.plan(anchor, radius)?;
        self.last = Some(proposal.weights.clone());
        Some(proposal)
    }

    fn explanation(&self) -> String {
        let axes = self.plant.simulation.task.axis.iter().zip(&self.axes).zip(&self.plant.axes);
        let words = axes
            .map(|((axis, found), plant)| format!("{}: {}", axis.name, plant.fittings[found.chosen()].family.name()));
        words.collect::<Vec<_>>().join(", ")
    }

    fn boxed(&self) -> Box<dyn Model> {
        Box::new(self.clone())
    }
}
