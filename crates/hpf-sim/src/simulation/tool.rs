//! Tools: one that touches nothing, and one in contact.

use hpf_core::admittance::{Instant, relax};
use hpf_core::{Lanes, Real};

use super::motion::{Knot, Sample, Tool};
use crate::environment::Surface;

/// Disturbing force just after the start and just before the end of each step, and after the last [N].
pub(super) type Forces = [(f64, f64)];

/// A tool that touches nothing: the law of the offset, the reference being exact.
pub(super) struct Free<'a, const N: usize> {
    dt: f64,
    forces: &'a Forces,
    offset: Lanes<N>,
}

impl<'a, const N: usize> Free<'a, N> {
    #[inline(always)]
    pub(super) fn new(dt: f64, forces: &'a Forces) -> Self {
        Self { dt, forces, offset: Lanes::ZERO }
    }
}

#[inline(always)]
fn offset_law<const N: usize>(knot: &Knot<N>, force: f64) -> Instant<Lanes<N>> {
    Instant {
        stiffness: knot.stiffness,
        damping: knot.damping,
        reference_position: Lanes::ZERO,
        reference_velocity: Lanes::ZERO,
        load_force: Lanes::of(force),
        load_stiffness: Lanes::ZERO,
    }
}

impl<const N: usize> Tool<N> for Free<'_, N> {
    #[inline(always)]
    fn sample(&self, i: usize, now: &Knot<N>) -> Sample<N> {
        let (after, _) = self.forces[i];
        Sample {
            reference_position: now.reference_position(),
            reference_velocity: now.reference_velocity,
            position: now.reference_position() + self.offset,
            velocity: now.reference_velocity + offset_law(now, after).velocity(self.offset),
            force: Lanes::of(after),
            stiffness: now.stiffness,
            damping: now.damping,
            contact: None,
        }
    }

    #[inline(always)]
    fn advance(&mut self, i: usize, now: &Knot<N>, next: &Knot<N>, [stiffness, damping]: [Lanes<N>; 2]) {
        let (after, before_next) = self.forces[i];
        let [start, end] = [offset_law(now, after).target(), offset_law(next, before_next).target()];
        self.offset = relax(self.offset, start, end, stiffness / damping * Lanes::of(self.dt));
    }
}

/// What an axis may touch, and where its tool starts.
#[derive(Clone, Debug)]
pub(super) struct ContactModel {
    pub(super) axis: usize,
    pub(super) initial_position: f64,
    /// At every half step; it yields, but its position and direction are the same at all.
    pub(super) surfaces: Vec<Surface>,
}

impl ContactModel {
    /// Over all instants [N/m].
    pub(super) fn largest_stiffness(&self) -> f64 {
        self.surfaces.iter().map(|surface| surface.stiffness).fold(0.0, f64::max)
    }
}

/// A tool in contact: the coupled law of its position, split where it meets or leaves the surface.
pub(super) struct Touching<'a, const N: usize> {
    dt: f64,
    forces: &'a Forces,
    model: &'a ContactModel,
    position: Lanes<N>,
    /// -1 for a free tool, else 1. It is written at a crossing alone, so that the processor need not wait
    /// for a position to work out the exponential of the next step.
    mode: Lanes<N>,
}

impl<'a, const N: usize> Touching<'a, N> {
    #[inline(always)]
    pub(super) fn new(dt: f64, forces: &'a Forces, model: &'a ContactModel) -> Self {
        let position = Lanes::of(model.initial_position);
        Self { dt, forces, model, position, mode: mode(depth(&model.surfaces[0], position)) }
    }

    /// The law at sample `i`; lanes whose `mode` is negative are free.
    #[inline(always)]
    fn law(&self, i: usize, knot: &Knot<N>, force: f64, mode: Lanes<N>) -> Instant<Lanes<N>> {
        let surface = &self.model.surfaces[2 * i];
        let load_stiffness = while_touching(surface, mode);
        let load = Lanes::of(force + surface.direction * surface.set_point);
        Instant {
            stiffness: knot.stiffness,
            damping: knot.damping,
            reference_position: knot.reference_position(),
            reference_velocity: knot.reference_velocity,
            load_force: load + load_stiffness * Lanes::of(surface.position),
            load_stiffness,
        }
    }

    /// Step `i`, each lane in one mode: free where its `mode` is negative.
    #[inline(always)]
    fn segment(
        &self,
        i: usize,
        [now, next]: [&Knot<N>; 2],
        [stiffness, damping]: [Lanes<N>; 2],
        mode: Lanes<N>,
    ) -> Segment<N> {
        let (after, before_next) = self.forces[i];
        let load_stiffness = while_touching(&self.model.surfaces[2 * i + 1], mode);
        Segment {
            start: self.law(i, now, after, mode).target(),
            end: self.law(i + 1, next, before_next, mode).target(),
            lambda_dt: (stiffness + load_stiffness) / damping * Lanes::of(self.dt),
        }
    }
}

/// Stiffness towards the tool where `mode` is not negative.
#[inline(always)]
fn while_touching<const N: usize>(surface: &Surface, mode: Lanes<N>) -> Lanes<N> {
    mode.select_below(Lanes::ZERO, Lanes::ZERO, Lanes::of(surface.stiffness))
}

#[inline(always)]
fn depth<const N: usize>(surface: &Surface, position: Lanes<N>) -> Lanes<N> {
    position.map(|position| surface.depth(position))
}

/// -1 where the depth is negative, else 1: a depth that is NaN counts as touching.
#[inline(always)]
fn mode<const N: usize>(depth: Lanes<N>) -> Lanes<N> {
    depth.select_below(Lanes::ZERO, Lanes::of(-1.0), Lanes::ONE)
}

pub(super) fn is_free(depth: f64) -> bool {
    depth < 0.0
}

impl<const N: usize> Tool<N> for Touching<'_, N> {
    #[inline(always)]
    fn sample(&self, i: usize, now: &Knot<N>) -> Sample<N> {
        let surface = &self.model.surfaces[2 * i];
        let law = self.law(i, now, self.forces[i].0, self.mode);
        Sample {
            reference_position: now.reference_position(),
            reference_velocity: now.reference_velocity,
            position: self.position,
            velocity: law.velocity(self.position),
            force: law.force(self.position),
            stiffness: now.stiffness,
            damping: now.damping,
            contact: Some([
                self.position.map(|position| surface.deviation(position)),
                self.position.map(|position| surface.contact_force(position)),
            ]),
        }
    }

    #[inline(always)]
    fn advance(&mut self, i: usize, now: &Knot<N>, next: &Knot<N>, middle: [Lanes<N>; 2]) {
        let surface = &self.model.surfaces[2 * i];
        let end = self.segment(i, [now, next], middle, self.mode).advance(self.position, 0.0, 1.0);
        // On the surface itself counts as a crossing, which does no harm.
        let Lanes(agreement) = self.mode * depth(surface, end);
        if !agreement.iter().fold(false, |any, agreement| any | (*agreement <= 0.0)) {
            self.position = end;
            return;
        }
        let modes = [-1.0, 1.0].map(|mode| self.segment(i, [now, next], middle, Lanes::of(mode)));
        let mut position = end;
        for lane in (0..N).filter(|&lane| agreement[lane] <= 0.0) {
            let segments = modes.each_ref().map(|mode| mode.lane(lane));
            position.0[lane] = cross(self.position.0[lane], !is_free(self.mode.0[lane]), surface, segments);
        }
        self.position = position;
        self.mode = mode(depth(surface, position));
    }
}

/// One step in one mode, touching or free: the target at both ends and lambda times the step.
#[derive(Clone, Copy)]
struct Segment<const N: usize> {
    start: Lanes<N>,
    end: Lanes<N>,
    lambda_dt: Lanes<N>,
}

impl<const N: usize> Segment<N> {
    /// The position at share `to` of the step, from `position` at share `from`.
    #[inline(always)]
    fn advance(&self, position: Lanes<N>, from: f64, to: f64) -> Lanes<N> {
        let target = |share: f64| self.start + Lanes::of(share) * (self.end - self.start);
        relax(position, target(from), target(to), self.lambda_dt * Lanes::of(to - from))
    }

    fn lane(&self, lane: usize) -> Segment<1> {
        let [start, end, lambda_dt] = [self.start, self.end, self.lambda_dt].map(|lanes| Lanes([lanes.0[lane]]));
        Segment { start, end, lambda_dt }
    }
}

/// A step may meet or leave the surface this often; a motion that does so more often within one step is not resolved.
pub(super) const MOST_CROSSINGS: usize = 8;

/// Advances `position` by one step, changing between the segments, free and touching, where the surface is crossed.
#[cold]
#[inline(never)]
fn cross(mut position: f64, mut touching: bool, surface: &Surface, segments: [Segment<1>; 2]) -> f64 {
    let advance = |touching: bool, position: f64, from: f64, to: f64| {
        segments[usize::from(touching)].advance(Lanes([position]), from, to).to_f64()
    };
    let mut done = 0.0;
    for _ in 0..MOST_CROSSINGS {
        let end = advance(touching, position, done, 1.0);
        let inside = !is_free(surface.depth(end));
        if inside == touching || done >= 1.0 {
            return end;
        }
        let (mut before, mut after) = (done, 1.0);
        // Halving an interval of at most 1 this often leaves nothing between its ends.
        for _ in 0..f64::MANTISSA_DIGITS {
            let share = 0.5 * (before + after);
            if is_free(surface.depth(advance(touching, position, done, share))) == touching {
                after = share;
            } else {
                before = share;
            }
        }
        (position, done, touching) = (surface.position, after, !touching);
    }
    advance(touching, position, done, 1.0)
}
