//! What comes in: force, position, rate and time, good or bad, by the one table of [`faults`](super::faults).

use super::exchange::count;
use super::faults::CLOCK_STEPS;
use super::{Controller, Event, Input, Mode, Settings, Timing};
use crate::Real;
use crate::conditioning::TareWindow;
use crate::domain::{LARGEST, SHORTEST_STEP};
use crate::limits::cut;

impl<T: Real + PartialOrd, S: AsRef<[T]>, const D: usize> Controller<T, S, D> {
    /// The length of a step of `dt`, if it is one.
    #[inline]
    pub(super) fn validate_dt(&mut self, dt: T) -> Option<T> {
        let longest = self.settings.timing.longest_step;
        if dt >= T::of(SHORTEST_STEP) && dt <= longest {
            return Some(dt);
        }
        self.mistrust(dt, longest)
    }

    /// The same of a `dt` that is not in order.
    #[cold]
    fn mistrust(&mut self, dt: T, longest: T) -> Option<T> {
        let long = dt.is_finite() && dt > longest;
        let bad = if long { (dt / longest - T::ONE).at_most(T::ONE) } else { T::ONE };
        let still = self.mode == Mode::Idle;
        let steps = T::of(CLOCK_STEPS);
        self.debts.clock.owe(bad, steps, steps + T::ONE, still);
        self.debts.any = true;
        if long {
            // Nobody knows what the force did meanwhile.
            self.tare = TareWindow::default();
            self.status.long_time = true;
            count(&mut self.counters.long_time);
            return Some(longest);
        }
        self.status.bad_time = true;
        count(&mut self.counters.bad_time);
        None
    }

    /// A step of no time: the command stands still. What comes in is looked at all the same.
    #[cold]
    pub(super) fn stand(&mut self, input: &Input<T, D>) {
        self.rate = T::ZERO;
        for state in &mut self.axes {
            state.offset.velocity = T::ZERO;
            state.velocity = T::ZERO;
        }
        self.read(input);
        // Nobody knows for how long that force has stood still.
        self.tare = TareWindow::default();
        let blind = self.watch(input);
        let rateless = !input.rate.is_finite();
        if rateless {
            self.note_bad_input();
        }
        self.weigh(blind, rateless, T::ZERO);
        // The robot moves on towards its command, whatever the clock says.
        if self.settings.port.is_some() {
            self.observe(input);
        }
        if self.status.lost() {
            self.handle_event(Event::Lost);
        }
    }

    /// Calls the force zero that stands still, in Idle, where this reading is good and one of it; returns whether it did.
    pub(super) fn handle_tare(&mut self, input: &Input<T, D>) -> bool {
        let Settings { axes, conditioning, timing, .. } = &self.settings;
        let is_good = input.force_age <= timing.oldest_force && input.measured_force.iter().all(|f| f.is_finite());
        if self.mode != Mode::Idle || !is_good {
            return false;
        }
        let force = conditioning.compensated(&self.force, input.measured_force);
        let still = self.tare.mean_beside(force, axes.each_ref().map(|axis| axis.limits.force));
        if let Some(still) = still {
            self.force.tare(still);
            self.tare = TareWindow::default();
        }
        still.is_some()
    }

    /// The force that the model sees, good or not.
    pub(super) fn condition_force(&mut self, input: &Input<T, D>, dt: T) -> [T; D] {
        let compensated = self.read(input);
        let Settings { axes, conditioning, timing, .. } = &self.settings;
        if self.mode == Mode::Idle {
            if self.status.bad_force {
                self.tare = Default::default();
            } else {
                self.tare.observe(compensated, axes.each_ref().map(|axis| axis.limits.force), dt);
            }
            self.status.tare_ready = self.tare.mean().is_some();
        }
        if self.cache.dt != dt {
            (self.cache.dt, self.cache.settled, self.cache.rate) = (dt, conditioning.settled(dt), -T::ONE);
            // Without its sign: a ramp of -0 is one of 0.
            self.cache.ramp_share = (dt / timing.ramp).abs().at_most(T::ONE);
        }
        conditioning.settle(&mut self.force, compensated, self.cache.settled)
    }

    /// Reads the force; returns it compensated [N], the last good one where it is bad.
    #[inline]
    fn read(&mut self, input: &Input<T, D>) -> [T; D] {
        let Settings { axes, conditioning, timing, .. } = &self.settings;
        let largest = T::of(LARGEST);
        let measured = &input.measured_force;
        // One comparison an axis, where the reading is as it should be.
        let usual = input.force_age <= timing.oldest_force && measured.iter().all(|force| force.abs() <= largest);
        if !usual {
            return self.read_in_part(input);
        }
        self.good_force = *measured;
        let compensated = conditioning.compensated(&self.force, self.good_force);
        if compensated.iter().zip(axes).any(|(force, axis)| force.abs() > axis.trip_force) {
            self.status.force_tripped = true;
        }
        compensated
    }

    /// The same of a reading that is bad or huge: each axis by itself.
    #[cold]
    fn read_in_part(&mut self, input: &Input<T, D>) -> [T; D] {
        let Settings { axes, conditioning, timing, .. } = &self.settings;
        let fresh = input.force_age <= timing.oldest_force;
        let good = input.measured_force.map(|force| fresh && force.is_finite());
        for ((last, &force), _) in
            self.good_force.iter_mut().zip(&input.measured_force).zip(good).filter(|(_, good)| *good)
        {
            *last = cut(force, T::ZERO, T::of(LARGEST)).0;
        }
        if good.contains(&false) {
            self.status.bad_force = true;
            count(&mut self.counters.bad_force);
        }
        let compensated = conditioning.compensated(&self.force, self.good_force);
        let mut readings = compensated.iter().zip(axes).zip(good);
        if readings.any(|((force, axis), good)| good && force.abs() > axis.trip_force) {
            self.status.force_tripped = true;
        }
        compensated
    }

    /// Stops where a force or the robot's distance from the command is too large. Returns whether a position is bad.
    pub(super) fn watch(&mut self, input: &Input<T, D>) -> bool {
        let mut blind = false;
        if let Some(measured) = &input.measured_position {
            let gaps = measured.iter().zip(&self.axes).zip(&self.settings.axes);
            let mut gaps = gaps.map(|((&at, state), axis)| ((at - state.position).abs(), axis.tracking));
            if !gaps.all(|(gap, most)| gap <= most) {
                blind = self.look_in_part(measured);
            }
        }
        if self.status.force_tripped || self.status.tracking_tripped {
            count(&mut self.counters.trips);
            self.handle_event(Event::Tripped);
        }
        blind
    }

    /// Looks at positions of which one is bad or far off, each axis by itself. Returns whether one is bad.
    #[cold]
    fn look_in_part(&mut self, measured: &[T; D]) -> bool {
        let axes = measured.iter().zip(&self.axes).zip(&self.settings.axes);
        let (mut blind, mut far) = (false, false);
        for ((&at, state), axis) in axes {
            if at.is_finite() {
                far |= (at - state.position).abs() > axis.tracking;
            } else {
                blind = true;
            }
        }
        self.status.tracking_tripped = far;
        if blind {
            self.note_bad_input();
        }
        blind
    }

    /// Counts once a step that an input was no number.
    #[cold]
    fn note_bad_input(&mut self) {
        if !self.status.bad_input {
            self.status.bad_input = true;
            count(&mut self.counters.bad_input);
        }
    }

    /// Books what was bad in a step of `dt`, and what was good.
    #[cold]
    pub(super) fn weigh(&mut self, blind: bool, rateless: bool, dt: T) {
        let Timing { hold, ramp, longest_step, .. } = self.settings.timing;
        let still = self.mode == Mode::Idle;
        let (debts, status) = (&mut self.debts, &mut self.status);
        let inputs = [(&mut debts.force, status.bad_force), (&mut debts.position, blind), (&mut debts.rate, rateless)];
        for (debt, bad) in inputs {
            if bad {
                debt.owe(dt, hold, ramp + longest_step, still);
            } else {
                debt.pay(dt, still);
            }
        }
        if !status.bad_time && !status.long_time {
            debts.clock.pay(T::ONE, still);
        }
        debts.sum_up();
        let steps = T::of(CLOCK_STEPS);
        status.force_lost = debts.force.lost(hold);
        status.position_lost = debts.position.lost(hold);
        status.rate_lost = debts.rate.lost(hold);
        status.time_lost = debts.clock.lost(steps);
        let measured = [debts.force, debts.position, debts.rate];
        if debts.clock.hopeless(steps, steps) || measured.into_iter().any(|debt| debt.hopeless(hold, ramp)) {
            self.handle_event(Event::Lost);
        }
    }

    /// The rate of time in this step, where `asked` is asked for.
    pub(super) fn next_rate(&mut self, asked: T) -> T {
        let mut rate = asked;
        if !(T::ZERO..=T::ONE).contains(&asked) {
            rate = asked.at_least(T::ZERO).at_most(T::ONE);
            if !asked.is_finite() {
                rate = T::ZERO;
                self.note_bad_input();
            }
        }
        let lost = self.debts.any && self.status.lost();
        if self.mode != Mode::Run || lost {
            rate = T::ZERO;
        }
        // A path at rest at its start begins at any rate without a jump; only under way a change needs the ramp.
        if rate != self.rate && self.phase != self.skill.phase().start() {
            let change = self.cache.ramp_share;
            rate = rate.at_least(self.rate - change).at_most(self.rate + change);
        }
        if lost && rate <= T::ZERO {
            self.handle_event(Event::Lost);
        }
        rate
    }
}
