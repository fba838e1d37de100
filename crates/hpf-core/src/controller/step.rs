//! One step of a controller: rate, reference, offset, limits and the books of energy.

use super::port::confined;
use super::{AxisState, Compliance, Controller, Input, Mode};
use crate::Real;
use crate::admittance::{Inertial, OffsetMotion, step_offset};
use crate::limits::{Hits, brake, cut};
use crate::passivity::{EnergyTank, kinetic_energy, spring_energy};
use crate::reference::{Course, Stride};

impl<T: Real + PartialOrd, S: AsRef<[T]>, const D: usize> Controller<T, S, D> {
    /// One step of a `dt` that is in order.
    pub(super) fn advance(&mut self, input: &Input<T, D>, dt: T) {
        let force = self.condition_force(input, dt);
        let blind = self.watch(input);
        let rateless = !input.rate.is_finite();
        if self.debts.any || self.status.bad_force || blind || rateless {
            self.weigh(blind, rateless, dt);
        }
        // A trip or a loss in the very step of the start leaves the arm where it is.
        self.moved |= self.mode == Mode::Run;
        if self.settings.port.is_some() {
            self.observe(input);
        }
        let rate = self.next_rate(input.rate);
        self.update_cache(rate, dt);
        self.advance_axes(force, rate, dt);
        if !self.ended && self.skill.phase().has_ended(self.phase) {
            self.ended = true;
            self.status.ended = true;
        }
    }

    /// Makes anew what the rate of time decides, where it or the step's length is not what it was.
    #[inline]
    fn update_cache(&mut self, rate: T, dt: T) {
        if self.cache.rate == rate {
            return;
        }
        self.cache.rate = rate;
        self.stride = Stride::new(self.skill.phase(), self.skill.axes(), rate, dt);
    }

    /// Whether the arm gives way to force: it has started, and feels.
    fn gives(&self) -> bool {
        let may = match self.mode {
            Mode::Run | Mode::Hold => true,
            Mode::Stop => self.moved,
            Mode::Idle | Mode::Fault => false,
        };
        may && !self.status.force_lost
    }

    /// Advances reference, offsets and commands.
    fn advance_axes(&mut self, force: [T; D], rate: T, dt: T) {
        let tank = self.settings.tank.as_ref();
        // What has not moved stands where it was put, wherever the robot is.
        let walled = self.settings.port.is_some() && self.moved;
        let gives = self.gives();
        let half = self.stride.half;
        let middle = half.middle(self.phase);

        // Stiffness as the tank allows it; the whole step of every reference, and what it would cost.
        let mut next = [Course::NONE; D];
        let mut share = T::ONE;
        let mut cost = T::ZERO;
        let mut short = false;
        let parts = next.iter_mut().zip(&mut self.axes).zip(&self.settings.axes);
        let profiles = self.skill.at(middle);
        let parts = parts.zip(&force).zip(&profiles).zip(self.skill.axes()).zip(&self.stride.axes);
        for ((((((next, state), settings), &force), profile), primitives), step) in parts {
            let (sensed, strong) = cut(force, T::ZERO, settings.limits.force);
            let force = if settings.compliance == Compliance::Rigid { T::ZERO } else { sensed };
            let stiffness = tank.map_or(profile.stiffness, |tank| {
                let (energy, offset) = (&mut self.energy, state.offset.offset);
                tank.stiffness(energy, state.stiffness, profile.stiffness, offset, dt)
            });
            short |= stiffness < profile.stiffness;
            let damping = primitives.law.damping(stiffness, profile.damping);
            (state.force, state.stiffness, state.damping) = (force, stiffness, damping);
            state.hits = Hits::default();
            if strong {
                state.hits.force = true;
            }

            *next = state.reference.ahead(step, profile.forcing);
            let distance = next.distance();
            let farthest = settings.limits.velocity * dt;
            if distance.abs() > farthest {
                share = lesser(share, farthest, distance.abs());
            }
            if walled {
                let wanted = distance / dt;
                let (found, less) =
                    confined(wanted, state.position, &state.port.walls, settings.limits.acceleration, dt);
                // Back to the walls goes the offset, not the path.
                if less && distance != T::ZERO {
                    share = lesser(share, (found / wanted).at_least(T::ZERO), T::ONE);
                    short = true;
                }
            }
            cost = cost - force * distance;
        }
        // What is left goes down no faster than it would by the ramp: a path that has to slow down has the time to.
        let mut left = tank.map_or(T::ZERO, |tank| tank.available(self.energy.level()));
        if tank.is_some() {
            if cost > left * self.cache.ramp_share {
                share = lesser(share, left * self.cache.ramp_share, cost);
                short = true;
            }
            // Rounded, the share may cost a little more than there is: less than nothing is never left.
            left = (left - (share * cost).at_least(T::ZERO)).at_least(T::ZERO);
        }
        half.advance(&mut self.phase, &mut self.phase_remainder, middle, share);
        self.rate = rate * share;

        let mut balance = T::ZERO;
        for ((state, next), settings) in self.axes.iter_mut().zip(&next).zip(&self.settings.axes) {
            let AxisState { force, stiffness, damping, .. } = *state;
            let law = state.law;
            let stored = |at: OffsetMotion<T>| {
                let spring = spring_energy(stiffness, at.offset);
                law.map_or(spring, |law| spring + kinetic_energy(law.mass(), at.velocity))
            };
            let travel = share * next.distance();
            state.reference.go(next, share);

            let before = state.offset;
            let mut wanted = T::ZERO;
            if gives {
                let gains = [stiffness, damping, force, dt];
                state.offset = match settings.compliance {
                    Compliance::Press(setpoint) => {
                        let (pressed, throttled) = press(law, before, gains, setpoint, tank, &mut left);
                        short |= throttled;
                        pressed
                    }
                    _ => give_way(law, before, gains),
                };
                wanted = (state.offset.offset - before.offset) / dt;
            } else {
                state.offset.velocity = T::ZERO;
            }
            let limits = &settings.limits;
            let room = [limits.offset + before.offset, limits.offset - before.offset];
            let (giving, held) = brake(wanted, room, limits.acceleration, dt);
            let mut wanted = travel / dt + giving;
            let mut stopped = false;
            if walled {
                (wanted, stopped) = confined(wanted, state.position, &state.port.walls, limits.acceleration, dt);
                short |= stopped;
            }
            let (velocity, hits) = limits.velocity(state.position, state.velocity, wanted, dt);
            if held || stopped || hits.any_motion() {
                let give = if stopped || hits.any_motion() { velocity * dt - travel } else { giving * dt };
                let offset = before.offset + give;
                let (kept, dragged) = cut(offset, T::ZERO, limits.offset);
                state.offset = OffsetMotion { offset: kept, velocity: give / dt };
                state.reference.shift(offset - kept);
                state.hits = Hits { force: state.hits.force, offset: held || dragged, ..hits };
            }
            balance += force * (velocity * dt) - (stored(state.offset) - stored(before));

            let [min, max] = limits.position;
            state.position = (state.reference.position() + state.offset.offset).at_least(min).at_most(max);
            state.velocity = velocity;
        }
        if let Some(tank) = tank {
            tank.book(&mut self.energy, balance);
        }
        self.status.energy_short = short;
    }
}

/// The smaller of `share` and `part / whole`; what seldom happens stays out of the way of what always does.
#[cold]
#[inline(never)]
fn lesser<T: Real>(share: T, part: T, whole: T) -> T {
    share.at_most(part / whole)
}

/// How an offset gives way to a force held over a step; `gains` are stiffness, damping, force and dt.
#[inline(always)]
fn give_way<T: Real>(law: Option<Inertial<T>>, before: OffsetMotion<T>, gains: [T; 4]) -> OffsetMotion<T> {
    if let Some(law) = law {
        return step_inertial(law, before, gains);
    }
    let [stiffness, damping, force, dt] = gains;
    let offset = step_offset(before.offset, stiffness, damping, force, dt);
    OffsetMotion { offset, velocity: (offset - before.offset) / dt }
}

/// [`give_way`] to a force and a set-point p, of which the part q = c p acts that the tank can pay for; also whether
/// that is less than all. Takes what q costs at most, `q (e+ - e)`, out of what is `left` [J].
///
/// The step is affine in q, so the cost is convex in c, and zero at zero: the part c `left`/cost of a c that costs
/// too much costs `left` at most.
#[inline(never)]
fn press<T: Real + PartialOrd>(
    law: Option<Inertial<T>>,
    before: OffsetMotion<T>,
    gains: [T; 4],
    setpoint: T,
    tank: Option<&EnergyTank<T>>,
    left: &mut T,
) -> (OffsetMotion<T>, bool) {
    let [stiffness, damping, force, dt] = gains;
    let pressed = |part: T| {
        let after = give_way(law, before, [stiffness, damping, force + part * setpoint, dt]);
        (after, part * setpoint * (after.offset - before.offset))
    };
    let Some(tank) = tank else { return (pressed(T::ONE).0, false) };
    // From rest, a step takes nothing but the set-point to a velocity of p/(d + m/h) at most.
    let resistance = damping + law.map_or(T::ZERO, |law| law.mass() / dt);
    let mut part = tank.valve(*left, setpoint * setpoint * dt / resistance);
    let (mut after, mut cost) = pressed(part);
    if cost > *left {
        part = part * (*left / cost);
        (after, cost) = pressed(part);
    }
    *left = (*left - cost.at_least(T::ZERO)).at_least(T::ZERO);
    (after, part < T::ONE)
}

/// A step of a tool with inertia; in a function of its own, because its length would slow those without.
#[inline(never)]
fn step_inertial<T: Real>(law: Inertial<T>, mut motion: OffsetMotion<T>, gains: [T; 4]) -> OffsetMotion<T> {
    let [stiffness, damping, force, dt] = gains;
    law.step(&mut motion, stiffness, damping, force, dt);
    motion
}
