//! Tools with inertia: the law of second order, free and in contact.
//!
//! Free, `m e'' + d e' + k e = f`: gains at mid-step, the known force held at its mean over the step.
//! In contact the load answers with `-K_e (x_r + e - y_s)`, so with `K = k + K_e`
//! ```text
//! m e'' + d e' + K (e - q(t)) = 0,    q = (f + f_d + K_e (y_s - x_r))/K
//! ```
//! and for a q that runs quadratically over the step, from three values of its own, `e = p + u`:
//! `p = q - (d/K) q' + (d^2/K^2 - m/K) q''`, u the step without force. Both are second order, and the second is right in
//! the stiff limit, velocity included (e -> q, e' -> q'). The kernel is [`Inertial`], which a controller steps.
//!
//! A stiff contact swings the tool within a step: a step is made in so many pieces that none is longer than half a radian
//! of the fastest swing, and each piece is split where the tool meets or leaves the surface.

use hpf_core::admittance::{Inertial, OffsetMotion};
use hpf_core::{Lanes, Real};

use super::motion::{Knot, Sample, Tool};
use super::tool::{ContactModel, Forces, MOST_CROSSINGS, is_free};
use crate::environment::Surface;

/// Most pieces of a step.
const MOST_PIECES: f64 = 200.0;
/// Longest piece [rad] of the fastest swing, as long as [`MOST_PIECES`] allow it.
const LONGEST_PIECE: f64 = 0.5;

/// A tool with inertia that touches nothing.
pub(super) struct FreeInertial<'a, const N: usize> {
    dt: f64,
    forces: &'a Forces,
    law: Inertial<Lanes<N>>,
    motion: OffsetMotion<Lanes<N>>,
}

impl<'a, const N: usize> FreeInertial<'a, N> {
    #[inline(always)]
    pub(super) fn new(dt: f64, forces: &'a Forces, law: Inertial<Lanes<N>>) -> Self {
        Self { dt, forces, law, motion: OffsetMotion { offset: Lanes::ZERO, velocity: Lanes::ZERO } }
    }
}

impl<const N: usize> Tool<N> for FreeInertial<'_, N> {
    #[inline(always)]
    fn sample(&self, i: usize, now: &Knot<N>) -> Sample<N> {
        Sample {
            reference_position: now.reference_position(),
            reference_velocity: now.reference_velocity,
            position: now.reference_position() + self.motion.offset,
            velocity: now.reference_velocity + self.motion.velocity,
            force: Lanes::of(self.forces[i].0),
            stiffness: now.stiffness,
            damping: now.damping,
            contact: None,
        }
    }

    #[inline(always)]
    fn advance(&mut self, i: usize, _: &Knot<N>, _: &Knot<N>, [stiffness, damping]: [Lanes<N>; 2]) {
        let (after, before_next) = self.forces[i];
        let force = Lanes::of(0.5 * (after + before_next));
        self.law.step(&mut self.motion, stiffness, damping, force, Lanes::of(self.dt));
    }
}

/// A tool with inertia in contact, each rollout by itself.
pub(super) struct TouchingInertial<'a, const N: usize> {
    dt: f64,
    forces: &'a Forces,
    model: &'a ContactModel,
    law: Inertial<f64>,
    pieces: usize,
    motions: [OffsetMotion<f64>; N],
}

impl<'a, const N: usize> TouchingInertial<'a, N> {
    /// A tool at rest where the contact has it; `stiffness` is the most it is held with, `start` that of its reference.
    pub(super) fn new(
        dt: f64,
        forces: &'a Forces,
        model: &'a ContactModel,
        law: Inertial<f64>,
        [stiffness, start]: [f64; 2],
    ) -> Self {
        let swing = dt * ((stiffness + model.largest_stiffness()) / law.mass()).sqrt();
        let pieces = (swing / LONGEST_PIECE).ceil().clamp(1.0, MOST_PIECES) as usize;
        let motion = OffsetMotion { offset: model.initial_position - start, velocity: 0.0 };
        Self { dt, forces, model, law, pieces, motions: [motion; N] }
    }
}

impl<const N: usize> Tool<N> for TouchingInertial<'_, N> {
    fn sample(&self, i: usize, now: &Knot<N>) -> Sample<N> {
        let surface = &self.model.surfaces[2 * i];
        let offset = Lanes(self.motions.map(|motion| motion.offset));
        let position = now.reference_position() + offset;
        let pressing = position.map(|position| surface.contact_force(position));
        let load = self.forces[i].0 + surface.direction * surface.set_point;
        Sample {
            reference_position: now.reference_position(),
            reference_velocity: now.reference_velocity,
            position,
            velocity: now.reference_velocity + Lanes(self.motions.map(|motion| motion.velocity)),
            force: pressing.map(|pressing| load - surface.direction * pressing),
            stiffness: now.stiffness,
            damping: now.damping,
            contact: Some([position.map(|position| surface.deviation(position)), pressing]),
        }
    }

    fn advance(&mut self, i: usize, now: &Knot<N>, next: &Knot<N>, [stiffness, damping]: [Lanes<N>; 2]) {
        let surfaces = [0, 1, 2].map(|half| &self.model.surfaces[2 * i + half]);
        let (after, before_next) = self.forces[i];
        for (lane, motion) in self.motions.iter_mut().enumerate() {
            let of = |lanes: Lanes<N>| lanes.0[lane];
            let step = Step {
                law: &self.law,
                dt: self.dt,
                surface: surfaces[0],
                start: [of(now.reference_position()), of(now.reference_velocity)],
                end: [of(next.reference_position()), of(next.reference_velocity)],
                forces: [after, before_next],
                stiffness: of(stiffness),
                damping: of(damping),
                contact_stiffness: surfaces[1].stiffness,
                target: Quadratic::default(),
            };
            let gains = [of(now.stiffness), step.stiffness, of(next.stiffness)];
            let target = core::array::from_fn(|j| {
                let share = 0.5 * j as f64;
                let load = step.force(share) + surfaces[0].direction * surfaces[0].set_point;
                let load_stiffness = surfaces[j].stiffness;
                (load + load_stiffness * (surfaces[j].position - step.reference(share))) / (gains[j] + load_stiffness)
            });
            let step = Step { target: Quadratic::through(target), ..step };
            let mut touching = !is_free(step.depth(motion, 0.0));
            for piece in 0..self.pieces {
                let share = |piece: usize| piece as f64 / self.pieces as f64;
                step.cross(motion, &mut touching, share(piece), share(piece + 1));
            }
        }
    }
}

/// `q(share) = a + b share + c share^2` over a step.
#[derive(Clone, Copy, Default)]
struct Quadratic {
    a: f64,
    b: f64,
    c: f64,
}

impl Quadratic {
    /// Through its values at the start, the middle and the end.
    fn through([start, middle, end]: [f64; 3]) -> Self {
        Self { a: start, b: 4.0 * middle - 3.0 * start - end, c: 2.0 * (start + end) - 4.0 * middle }
    }
}

/// One step of one rollout; shares of it run from 0 to 1.
#[derive(Clone, Copy)]
struct Step<'a> {
    law: &'a Inertial<f64>,
    dt: f64,
    surface: &'a Surface,
    /// Position [m] and velocity [m/s] of the reference.
    start: [f64; 2],
    end: [f64; 2],
    /// Disturbing force at both ends [N].
    forces: [f64; 2],
    /// At mid-step.
    stiffness: f64,
    damping: f64,
    contact_stiffness: f64,
    /// Where the offset would rest in contact [m].
    target: Quadratic,
}

impl Step<'_> {
    fn force(&self, share: f64) -> f64 {
        self.forces[0] + share * (self.forces[1] - self.forces[0])
    }

    /// Position of the reference, cubic between its ends [m].
    fn reference(&self, share: f64) -> f64 {
        let ([x0, v0], [x1, v1]) = (self.start, self.end);
        let rest = 1.0 - share;
        let bend = rest * self.dt * v0 - share * self.dt * v1 - (rest - share) * (x1 - x0);
        rest * x0 + share * x1 + share * rest * bend
    }

    fn depth(&self, motion: &OffsetMotion<f64>, share: f64) -> f64 {
        self.surface.depth(self.reference(share) + motion.offset)
    }

    /// The motion that the target alone would make: p and p'.
    fn following(&self, share: f64) -> OffsetMotion<f64> {
        let (Quadratic { a, b, c }, h) = (self.target, self.dt);
        let stiffness = self.stiffness + self.contact_stiffness;
        let late = self.damping / stiffness;
        let (slope, bend) = ((b + 2.0 * c * share) / h, 2.0 * c / (h * h));
        OffsetMotion {
            offset: a + share * (b + share * c) - late * slope + (late * late - self.law.mass() / stiffness) * bend,
            velocity: slope - late * bend,
        }
    }

    /// The motion at share `to`, from `motion` at share `from`, touching or free all the way.
    fn advance(&self, touching: bool, motion: &OffsetMotion<f64>, from: f64, to: f64) -> OffsetMotion<f64> {
        let dt = self.dt * (to - from);
        if !touching {
            let push = self.surface.direction * self.surface.set_point;
            let mut motion = *motion;
            let force = self.force(0.5 * (from + to)) + push;
            self.law.step(&mut motion, self.stiffness, self.damping, force, dt);
            return motion;
        }
        let (start, end) = (self.following(from), self.following(to));
        let mut rest =
            OffsetMotion { offset: motion.offset - start.offset, velocity: motion.velocity - start.velocity };
        self.law.step(&mut rest, self.stiffness + self.contact_stiffness, self.damping, 0.0, dt);
        OffsetMotion { offset: end.offset + rest.offset, velocity: end.velocity + rest.velocity }
    }

    /// Advances `motion` from share `from` to share `to`, changing between touching and free where the surface is crossed.
    fn cross(&self, motion: &mut OffsetMotion<f64>, touching: &mut bool, from: f64, to: f64) {
        let mut done = from;
        for _ in 0..MOST_CROSSINGS {
            let end = self.advance(*touching, motion, done, to);
            if is_free(self.depth(&end, to)) != *touching || done >= to {
                *motion = end;
                return;
            }
            let (mut before, mut after) = (done, to);
            // Halving an interval of at most 1 this often leaves nothing between its ends.
            for _ in 0..f64::MANTISSA_DIGITS {
                let share = 0.5 * (before + after);
                if is_free(self.depth(&self.advance(*touching, motion, done, share), share)) == *touching {
                    after = share;
                } else {
                    before = share;
                }
            }
            *motion = self.advance(*touching, motion, done, after);
            motion.offset = self.surface.position - self.reference(after);
            (done, *touching) = (after, !*touching);
        }
        *motion = self.advance(*touching, motion, done, to);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quadratic_goes_through_its_three_values() {
        let Quadratic { a, b, c } = Quadratic::through([1.0, -2.0, 0.5]);
        assert_eq!([0.0, 0.5, 1.0].map(|share| a + share * (b + share * c)), [1.0, -2.0, 0.5]);
    }
}
