//! The law of the tool under a load: the kernels of `hpf-core` over any scalar, so that they tell their slopes too.
//!
//! A load is `f = b - K (y - e)`, or of one side only: `f = b - K max(0, side (y - e)) side`. Where the tool meets or
//! leaves it within a step, the step is split there.

use hpf_core::Real;
use hpf_core::admittance::{Instant, relax, step_offset};

/// Reference and gains at a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knot<T> {
    /// [m]
    pub(super) reference: T,
    /// [m/s]
    pub(super) velocity: T,
    /// [N/m]
    pub(super) stiffness: T,
    /// [N s/m]
    pub(super) damping: T,
}

/// A load at an instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Load<T> {
    /// b [N]
    pub(super) force: T,
    /// K [N/m]
    pub(super) stiffness: T,
    /// e [m]
    pub(super) place: T,
}

/// How the load acts on the tool, and how the tool is stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Law {
    /// +1 or -1 where the load acts on one side of its place only, at larger or smaller positions; else 0.
    pub(super) side: f64,
    /// Whether the force is read once a step and held over it.
    pub(super) is_sampled: bool,
    /// Whether the offset from the reference is stepped, the reference being exact: where no force depends on the tool.
    pub(super) is_offset: bool,
}

/// Halvings of a step in search of a crossing: they leave nothing between its ends.
const HALVINGS: u32 = f64::MANTISSA_DIGITS;

impl Law {
    fn depth<T: Real>(self, y: T, place: T) -> T {
        T::of(self.side) * (y - place)
    }

    /// Whether the load acts on a tool at `y`.
    pub(super) fn is_touching<T: Real>(self, y: T, load: &Load<T>) -> bool {
        self.side == 0.0 || self.depth(y, load.place).to_f64() >= 0.0
    }

    fn instant<T: Real>(self, knot: &Knot<T>, load: &Load<T>, is_touching: bool) -> Instant<T> {
        let stiffness = if is_touching { load.stiffness } else { T::ZERO };
        Instant {
            stiffness: knot.stiffness,
            damping: knot.damping,
            reference_position: knot.reference,
            reference_velocity: knot.velocity,
            load_force: load.force + stiffness * load.place,
            load_stiffness: stiffness,
        }
    }

    /// Velocity of the tool at `y` and force on it.
    pub(super) fn sample<T: Real>(self, y: T, knot: &Knot<T>, load: &Load<T>) -> [T; 2] {
        let instant = self.instant(knot, load, self.is_touching(y, load));
        [instant.velocity(y), instant.force(y)]
    }

    /// The position a step later: `middle` are stiffness and damping at its middle, `loads` those at its start, middle
    /// and end.
    pub(super) fn step<T: Real>(
        self,
        y: T,
        [now, next]: [&Knot<T>; 2],
        [stiffness, damping]: [T; 2],
        loads: [&Load<T>; 3],
        dt: f64,
    ) -> T {
        let is_touching = self.is_touching(y, loads[0]);
        if self.is_sampled {
            let force = self.instant(now, loads[0], is_touching).force(y);
            return next.reference + step_offset(y - now.reference, stiffness, damping, force, T::of(dt));
        }
        if self.is_offset {
            let [start, end] = [(now, loads[0]), (next, loads[2])].map(|(knot, load)| load.force / knot.stiffness);
            let offset = relax(y - now.reference, start, end, stiffness / damping * T::of(dt));
            return next.reference + offset;
        }
        let segment = |is_touching: bool| {
            let load = if is_touching { loads[1].stiffness } else { T::ZERO };
            let start = self.instant(now, loads[0], is_touching).target();
            let end = self.instant(next, loads[2], is_touching).target();
            (start, end, (stiffness + load) / damping * T::of(dt))
        };
        let advance = |(start, end, lambda): (T, T, T), y: T, from: T, to: T| {
            let target = |share: T| start + share * (end - start);
            relax(y, target(from), target(to), lambda * (to - from))
        };
        let own = segment(is_touching);
        let end = relax(y, own.0, own.1, own.2);
        if self.side == 0.0 || self.is_touching(end, loads[2]) == is_touching {
            return end;
        }
        let place = loads[1].place;
        let depth = |share: T| self.depth(advance(own, y, T::ZERO, share), place);
        let (mut before, mut after) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let share = 0.5 * (before + after);
            if (depth(T::of(share)).to_f64() >= 0.0) == is_touching {
                before = share;
            } else {
                after = share;
            }
        }
        // The slopes of the share at which the depth is zero: one step of Newton's method, of which the value is zero.
        let near = 0.5 * (before + after);
        let width = 1e-6;
        let slope = (depth(T::of(near + width)).to_f64() - depth(T::of(near - width)).to_f64()) / (2.0 * width);
        let share = if slope == 0.0 { T::of(near) } else { T::of(near) - depth(T::of(near)) / T::of(slope) };
        advance(segment(!is_touching), place, share, T::ONE)
    }
}
