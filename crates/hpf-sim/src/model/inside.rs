//! The task's cost inside the model: its signals, and how each of them answers to each parameter.
//!
//! With the local slopes of the step g over dual numbers, `S_{i+1} = (dg/dy) S_i + sum_u (dg/du) du/dw`, u being
//! reference and gains of the plan, which are linear in the parameters w. Signals are affine in the motion, so that the
//! slope of a signal is its change when the slopes of the motion are added to it.

use hpf_core::Real;
use hpf_learn::Computed;

use super::AxisPlant;
use super::dual::Dual;
use super::fit::{Loads, knot};
use super::law::{Knot, Load};
use crate::simulation::{Planned, Simulation};
use crate::trace::Trace;

/// A task inside a model of its environment.
pub(super) struct Inside<'m> {
    pub(super) simulation: &'m Simulation,
    pub(super) plants: &'m [AxisPlant],
    pub(super) loads: &'m [Loads],
    /// Deviation less position along the contact, and contact force with the force on the tool.
    pub(super) contact: Option<&'m [Vec<f64>; 2]>,
}

/// Numbers that a step answers to: y; reference position, velocity, stiffness and damping at its start; stiffness and
/// damping at its middle; the first four at its end.
const INPUTS: usize = 11;

impl Inside<'_> {
    /// Writes the motion of axis `a` into `trace`.
    pub(super) fn show(&self, a: usize, [position, velocity, force]: [&[f64]; 3], trace: &mut Trace) {
        let axis = &mut trace.axes[a];
        let own = [&mut axis.position, &mut axis.velocity, &mut axis.force];
        for (own, signal) in own.into_iter().zip([position, velocity, force]) {
            own[..signal.len()].copy_from_slice(signal);
        }
        if let (Some((touched, direction)), Some(contact), Some([deviation, pressed])) =
            (self.simulation.touched(), &mut trace.contact, self.contact)
            && touched == a
        {
            for i in 0..position.len() {
                contact.deviation[i] = direction * position[i] + deviation[i];
                contact.force[i] = pressed[i] - direction * force[i];
            }
        }
    }

    /// Position, velocity and force of axis `a`, and the slopes of each by each parameter: one column per parameter.
    fn sensitivities(&self, a: usize, planned: &Planned) -> ([Vec<f64>; 3], [Vec<f64>; 3]) {
        let (loads, responses) = (&self.loads[a], &self.plants[a].responses);
        let samples = planned.position.len();
        let n = responses.len();
        let mut signals = [0; 3].map(|_| Vec::with_capacity(samples));
        let mut slopes = [0; 3].map(|_| vec![0.0; n * samples]);
        let (mut y, mut by) = (loads.start, vec![0.0; n]);
        let load = |h: usize| {
            let Load { force, stiffness, place } = loads.loads[h];
            let of = <Dual<INPUTS> as Real>::of;
            Load { force: of(force), stiffness: of(stiffness), place: of(place) }
        };
        let input = |planned: &Planned, i: usize, first: usize| {
            let Knot { reference, velocity, stiffness, damping } = knot(planned, i);
            Knot {
                reference: Dual::<INPUTS>::input(reference, first),
                velocity: Dual::input(velocity, first + 1),
                stiffness: Dual::input(stiffness, first + 2),
                damping: Dual::input(damping, first + 3),
            }
        };
        for i in 0..samples {
            let (now, load_now) = (input(planned, i, 1), load(2 * i));
            let tool = Dual::input(y, 0);
            let [velocity, force] = loads.law.sample(tool, &now, &load_now);
            for (signal, value) in signals.iter_mut().zip([y, velocity.value, force.value]) {
                signal.push(value);
            }
            for (j, response) in responses.iter().enumerate() {
                let own = |dual: &Dual<INPUTS>| dual.slopes[0] * by[j] + response.at(i, &dual.slopes[1..5]);
                slopes[0][j * samples + i] = by[j];
                slopes[1][j * samples + i] = own(&velocity);
                slopes[2][j * samples + i] = own(&force);
            }
            if i + 1 == samples {
                break;
            }
            let next = input(planned, i + 1, 7);
            let middle = [Dual::input(planned.stiffness[2 * i + 1], 5), Dual::input(planned.damping[2 * i + 1], 6)];
            let ends = [load(2 * i + 1), load(2 * i + 2)];
            let stepped = loads.law.step(tool, [&now, &next], middle, [&load_now, &ends[0], &ends[1]], loads.dt);
            let slopes = &stepped.slopes;
            for (by, response) in by.iter_mut().zip(responses) {
                *by = slopes[0] * *by
                    + response.at(i, &slopes[1..5])
                    + response.at_middle(i, &slopes[5..7])
                    + response.at(i + 1, &slopes[7..11]);
            }
            y = stepped.value;
        }
        (signals, slopes)
    }
}

impl Computed for Inside<'_> {
    fn signals(&self, a: usize, weights: &[f64], signals: &mut Vec<f64>) -> bool {
        let [position, velocity, force] = self.loads[a].roll(&self.simulation.planned(a, weights));
        let mut trace = self.simulation.blank_trace();
        self.show(a, [&position, &velocity, &force], &mut trace);
        signals.clear();
        self.simulation.axis_signals_into(a, &trace, signals);
        signals.iter().all(|signal| signal.is_finite())
    }

    fn slopes(&self, a: usize, weights: &[f64], signals: &mut Vec<f64>, slopes: &mut Vec<f64>) -> bool {
        let (motion, by) = self.sensitivities(a, &self.simulation.planned(a, weights));
        let mut trace = self.simulation.blank_trace();
        let motion = motion.each_ref().map(Vec::as_slice);
        self.show(a, motion, &mut trace);
        signals.clear();
        self.simulation.axis_signals_into(a, &trace, signals);
        slopes.clear();
        let samples = motion[0].len();
        let mut moved = [0; 3].map(|_| vec![0.0; samples]);
        let mut changed = Vec::new();
        for j in 0..self.plants[a].responses.len() {
            let columns = by.each_ref().map(|by| &by[j * samples..][..samples]);
            // Slopes as large as the motion itself keep the digits of their differences.
            let size = |signal: &[f64]| signal.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let steepest = size(columns[0]).max(f64::MIN_POSITIVE.sqrt());
            let share = (size(motion[0]).max(f64::MIN_POSITIVE.sqrt()) / steepest).clamp(1e-9, 1e9);
            for ((moved, signal), column) in moved.iter_mut().zip(motion).zip(columns) {
                for ((moved, x), s) in moved.iter_mut().zip(signal).zip(column) {
                    *moved = x + share * s;
                }
            }
            self.show(a, moved.each_ref().map(Vec::as_slice), &mut trace);
            changed.clear();
            self.simulation.axis_signals_into(a, &trace, &mut changed);
            slopes.extend(changed.iter().zip(&*signals).map(|(changed, signal)| (changed - signal) / share));
        }
        signals.iter().chain(&*slopes).all(|x| x.is_finite())
    }
}
