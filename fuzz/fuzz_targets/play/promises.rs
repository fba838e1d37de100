//! What a controller promises, worked out from what went in and what came out, never from its own books.

use hpf_core::controller::{Compliance, Counters, Input, Mode, Output, Request, Settings};
use hpf_core::{AxisPrimitives, Damping, Law, Real};

use super::draw::{N, Scalar};
use super::still::Still;

/// Within the bounds as the scalar rounds them.
fn bounded<T: Scalar>(value: T, lo: f64, hi: f64) {
    let [value, lo, hi] = [value, T::of(lo), T::of(hi)].map(Real::to_f64);
    assert!(value >= lo && value <= hi, "{value:e} is not in [{lo:e}, {hi:e}]");
}

/// A skill's laws are numbers in order; an accepted skill keeps them.
pub fn lawful<T: Scalar, const D: usize>(axes: &[AxisPrimitives<T, [T; N]>; D]) {
    for axis in axes {
        let Law::SecondOrder { mass, damping } = axis.law else { continue };
        bounded(mass, 1e-9, 1e9);
        if let Damping::Ratio { ratio, floor } = damping {
            bounded(ratio, 1e-9, 1e9);
            bounded(floor, 1e-9, 1e9);
        }
    }
}

/// A settings' numbers that must be in order, with their bounds; accepted settings keep them.
pub fn in_domain<T: Scalar, const D: usize>(settings: &Settings<T, D>) {
    for axis in &settings.axes {
        let limits = &axis.limits;
        for size in [limits.force, limits.offset, limits.velocity, limits.acceleration, axis.trip_force, axis.tracking]
        {
            bounded(size, 1e-9, 1e9);
        }
        let [min, max] = limits.position;
        bounded(min, -1e9, 1e9);
        bounded(max, -1e9, 1e9);
        assert!(min < max, "{settings:?}");
        if let Compliance::Press(force) = axis.compliance {
            bounded(force.abs(), 0.0, limits.force.to_f64());
        }
    }
    bounded(settings.timing.longest_step, 1e-6, 1.0);
    bounded(settings.timing.ramp, 0.0, 10.0);
    bounded(settings.timing.hold, 0.0, 1.0);
    bounded(settings.conditioning.tool_mass, 0.0, 1e9);
    settings.conditioning.gravity.iter().for_each(|&gravity| bounded(gravity, -1e9, 1e9));
    settings.conditioning.dead_zone.iter().for_each(|&width| bounded(width, 0.0, 1e9));
    if let Some(cutoff) = settings.conditioning.cutoff {
        bounded(cutoff, 1e-9, 1e9);
    }
    if let Some(port) = &settings.port {
        assert!(settings.tank.is_some() && port.force_delay <= 6, "{settings:?}");
        port.force_bias.iter().for_each(|&bias| bounded(bias, 0.0, 1e9));
    }
}

/// What an input owes by the table of faults: bad time in full [s, or steps], less a quarter of good time.
#[derive(Clone, Copy, Default)]
struct Owed {
    amount: f64,
    /// What it may owe if what it was bad in Idle is not forgiven.
    at_most: f64,
    /// For how long it has been good since it was bad, and for how long it has surely been lost [s].
    good_for: f64,
    lost_for: f64,
}

impl Owed {
    fn weigh(&mut self, bad: f64, good: f64, limit: f64, dt: f64) {
        self.amount = (self.amount + bad - good / 4.0).max(0.0);
        self.at_most = (self.at_most + bad - good / 4.0).max(0.0);
        self.good_for = if bad > 0.0 { 0.0 } else { self.good_for + good };
        // Good for as long as its limit, it is lost no more, whatever it owes.
        let lost = self.amount > limit * 1.001 + 1e-6 && self.good_for < limit * 0.999;
        self.lost_for = if lost { self.lost_for + dt } else { 0.0 };
    }
}

/// What is known from outside of a controller's past.
pub struct Witness<T, const D: usize> {
    last: Output<T, D>,
    /// Whether a tare may be asked for.
    ready: bool,
    /// The force, while it is in Idle.
    still: Still<D>,
    counters: Counters,
    /// Since the last reset: whether it has run, whether an input was bad, whether it has ended.
    started: bool,
    spoiled: bool,
    ended: bool,
    /// Force, position, rate and time.
    owed: [Owed; 4],
    /// The largest position, goal or offset there was: what rounding is measured by [axis unit].
    scale: f64,
    /// `sum f dx` since the reset, what rounding may have made of it, and what the tank held then [J].
    work: f64,
    doubt: f64,
    filled: Option<f64>,
    /// The least reserve since, and whether a limit of motion or a port has cut.
    reserve: f64,
    cut: bool,
}

/// What a sum or a difference of these may be off by.
pub fn rounding<T: Scalar>(parts: &[f64]) -> f64 {
    8.0 * T::EPSILON * parts.iter().map(|part| part.abs()).sum::<f64>()
}

/// The tool's weight along an axis [N].
pub fn weight<T: Scalar, const D: usize>(settings: &Settings<T, D>, axis: usize) -> f64 {
    settings.conditioning.tool_mass.to_f64() * settings.conditioning.gravity[axis].to_f64()
}

/// The mode after a request, where there is one.
fn requested(mode: Mode, request: &str) -> Option<Mode> {
    match (request, mode) {
        ("start", Mode::Idle) | ("resume", Mode::Run | Mode::Hold) => Some(Mode::Run),
        ("hold", Mode::Run | Mode::Hold) => Some(Mode::Hold),
        ("stop", Mode::Fault) => Some(Mode::Fault),
        ("stop", _) => Some(Mode::Stop),
        ("reset", Mode::Idle | Mode::Stop | Mode::Fault) => Some(Mode::Idle),
        ("goal", Mode::Idle | Mode::Run | Mode::Hold) => Some(mode),
        _ => None,
    }
}

fn name<T, const D: usize>(request: &Option<Request<T, D>>) -> &'static str {
    match request {
        None => "",
        Some(Request::Start) => "start",
        Some(Request::Hold) => "hold",
        Some(Request::Resume) => "resume",
        Some(Request::Stop) => "stop",
        Some(Request::Goal(_)) => "goal",
        Some(Request::Tare) => "tare",
        Some(Request::Reset(_)) => "reset",
    }
}

impl<T: Scalar, const D: usize> Witness<T, D> {
    /// Of a controller that was just made.
    pub fn new(first: &Output<T, D>, settings: &Settings<T, D>, axes: &[AxisPrimitives<T, [T; N]>; D]) -> Self {
        assert_eq!((first.mode, first.rate.to_f64(), first.phase.to_f64()), (Mode::Idle, 0.0, 1.0));
        let mut witness = Self {
            last: *first,
            ready: false,
            still: Still::default(),
            counters: Counters::default(),
            started: false,
            spoiled: false,
            ended: false,
            owed: [Owed::default(); 4],
            scale: 1.0,
            work: 0.0,
            doubt: 0.0,
            filled: None,
            reserve: 0.0,
            cut: false,
        };
        axes.iter().for_each(|axis| witness.grow(axis.movement.goal()));
        witness.put(settings);
        witness
    }

    fn grow(&mut self, size: T) {
        self.scale = self.scale.max(size.to_f64().abs());
    }

    /// Everything begins again.
    fn put(&mut self, settings: &Settings<T, D>) {
        (self.started, self.spoiled, self.ended, self.cut) = (false, false, false, false);
        self.owed = [Owed::default(); 4];
        (self.work, self.doubt) = (0.0, 0.0);
        self.filled = settings.tank.map(|tank| tank.capacity().to_f64());
        self.reserve = reserve(settings);
        self.still = Still::default();
    }

    /// After settings were replaced, or refused.
    pub fn changed(&mut self, accepted: bool, settings: &Settings<T, D>, now: &Output<T, D>, counters: &Counters) {
        if !accepted {
            assert_eq!((now, counters.refused), (&self.last, self.counters.refused.saturating_add(1)));
        }
        assert_eq!(
            (now.axes, now.mode, now.phase, now.rate),
            (self.last.axes, self.last.mode, self.last.phase, self.last.rate)
        );
        // By other settings the force has to stand still anew.
        self.ready &= !accepted;
        if accepted {
            self.still = Still::default();
        }
        // What was owed is measured against other limits: look again from here.
        self.owed.iter_mut().for_each(|owed| owed.lost_for = 0.0);
        if settings.tank.is_none() {
            self.filled = None;
        }
        self.reserve = self.reserve.min(reserve(settings));
        (self.last, self.counters) = (*now, *counters);
    }

    /// After an update.
    pub fn saw(
        &mut self,
        input: &Input<T, D>,
        dt: T,
        settings: &Settings<T, D>,
        axes: &[AxisPrimitives<T, [T; N]>; D],
        bias: [[T; D]; 2],
        now: &Output<T, D>,
        counters: &Counters,
    ) {
        let asked = self.requests(input, settings, bias, now);
        let mode = self.trips(input, settings, bias, asked, now);
        self.started |= mode == Mode::Run;
        let h = self.inputs(input, dt, settings, mode, now);
        self.path(input, settings, h, now);
        self.motion(settings, axes, h, now);
        self.energy(settings, axes, h, now);
        self.count(asked, now, counters);
        self.still.stand(input, settings, h, now);
        (self.last, self.ready) = (*now, now.status.tare_ready);
    }

    /// Requests are done or refused by the table of modes, the workspace, and whether the force has stood still.
    fn requests(
        &mut self,
        input: &Input<T, D>,
        settings: &Settings<T, D>,
        bias: [[T; D]; 2],
        now: &Output<T, D>,
    ) -> Mode {
        let inside = |place: &[T; D]| {
            place
                .iter()
                .zip(&settings.axes)
                .all(|(&at, axis)| at >= axis.limits.position[0] && at <= axis.limits.position[1])
        };
        let mode = self.last.mode;
        let request = name(&input.request);
        let next = match &input.request {
            None => Some(mode),
            Some(Request::Tare) => {
                assert!(!self.ready || mode == Mode::Idle);
                let taken = self.ready && self.still.is_steady(input, settings, bias[0], now);
                if taken {
                    self.still.tared(settings, bias[1]);
                    self.still = Still::default();
                }
                taken.then_some(mode)
            }
            Some(Request::Goal(place) | Request::Reset(place)) => requested(mode, request).filter(|_| inside(place)),
            Some(_) => requested(mode, request),
        };
        assert_eq!(now.status.refused, next.is_none(), "{request} in {mode:?}: {now:?}");
        match (&input.request, next) {
            (Some(Request::Reset(place)), Some(_)) => {
                for (axis, &position) in self.last.axes.iter_mut().zip(place) {
                    (axis.position, axis.velocity) = (position, T::ZERO);
                    (axis.offset, axis.force) = (T::ZERO, T::ZERO);
                }
                (self.last.phase, self.last.rate) = (T::ONE, T::ZERO);
                self.put(settings);
            }
            (Some(Request::Goal(place)), Some(_)) => place.iter().for_each(|&at| self.grow(at)),
            _ => {}
        }
        next.unwrap_or(mode)
    }

    /// Each axis is watched by itself for its force and its distance.
    fn trips(
        &self,
        input: &Input<T, D>,
        settings: &Settings<T, D>,
        [old, new]: [[T; D]; 2],
        mode: Mode,
        now: &Output<T, D>,
    ) -> Mode {
        let bias = if matches!(input.request, Some(Request::Tare)) { new } else { old }.map(Real::to_f64);
        let mut found = [false; 2];
        let mut near = false;
        for (i, axis) in settings.axes.iter().enumerate() {
            let force = input.measured_force[i].to_f64();
            let weight = weight(settings, i);
            if input.force_age <= settings.timing.oldest_force && force.is_finite() {
                let level = axis.trip_force.to_f64();
                let force = force.clamp(-1e9, 1e9);
                let seen = (force - bias[i] - weight).abs();
                found[0] |= seen > level;
                near |= (seen - level).abs() <= rounding::<T>(&[force, bias[i], weight, level]);
            }
            if let Some(measured) = input.measured_position.map(|all| all[i].to_f64()).filter(|at| at.is_finite()) {
                let (level, command) = (axis.tracking.to_f64(), self.last.axes[i].position.to_f64());
                let gap = (measured - command).abs();
                found[1] |= gap > level;
                near |= (gap - level).abs() <= rounding::<T>(&[measured, command, level]);
            }
        }
        let said = [now.status.force_tripped, now.status.tracking_tripped];
        assert!(near || said == found, "{found:?} {input:?} {now:?}");
        if said.contains(&true) && mode != Mode::Fault { Mode::Stop } else { mode }
    }

    /// Bad inputs, by their one table; returns the length of the step [s].
    fn inputs(&mut self, input: &Input<T, D>, dt: T, settings: &Settings<T, D>, mode: Mode, now: &Output<T, D>) -> f64 {
        let (status, timing) = (&now.status, &settings.timing);
        let [longest, hold, ramp] = [timing.longest_step, timing.hold, timing.ramp].map(Real::to_f64);
        let wide = dt.to_f64();
        let bad_time = !wide.is_finite() || wide < T::of(1e-6).to_f64();
        let h = if bad_time { 0.0 } else { wide.min(longest) };
        assert_eq!((status.bad_time, status.long_time), (bad_time, !bad_time && wide > longest), "{dt:?}");
        let force =
            input.force_age > timing.oldest_force || input.measured_force.iter().any(|force| !force.is_finite());
        let position = input.measured_position.is_some_and(|all| all.iter().any(|at| !at.is_finite()));
        let rate = !input.rate.is_finite();
        assert_eq!((status.bad_force, status.bad_input), (force, position || rate), "{input:?}");
        let clock = if bad_time { 1.0 } else { (wide / longest - 1.0).clamp(0.0, 1.0) };
        for (owed, bad) in self.owed.iter_mut().zip([force, position, rate]) {
            let [bad, good] = if bad { [h, 0.0] } else { [0.0, h] };
            owed.weigh(bad, good, hold, h);
        }
        self.owed[3].weigh(clock, f64::from(u8::from(clock == 0.0)), 20.0, h);
        self.spoiled |= force || position || rate || clock > 0.0;
        if mode == Mode::Idle {
            self.owed.iter_mut().for_each(|owed| *owed = Owed { at_most: owed.at_most, ..Owed::default() });
        }
        let lost = [status.force_lost, status.position_lost, status.rate_lost, status.time_lost];
        assert!(self.spoiled || !lost.contains(&true), "{now:?}");
        if mode == Mode::Idle || mode == Mode::Fault {
            assert_eq!(now.mode, mode);
            return h;
        }
        // A force may never have been read.
        for (lost, (owed, limit)) in lost.iter().zip(self.owed.iter().zip([hold, hold, hold, 20.0])).skip(1) {
            assert!(!lost || owed.at_most > limit * 0.999 - 1e-6, "{} of {limit}: {now:?}", owed.at_most);
        }
        let overdue = self.owed.iter().any(|owed| owed.lost_for > (ramp + 3.0 * longest) * 1.001);
        let dead = bad_time && self.owed[3].amount > 20.5;
        assert!(now.mode == Mode::Fault || !overdue && !dead, "no fault: {now:?}");
        if now.mode == Mode::Fault {
            assert!(lost.contains(&true), "{now:?}");
        } else {
            assert_eq!(now.mode, mode, "{now:?}");
        }
        h
    }

    /// Phase and rate of time.
    fn path(&mut self, input: &Input<T, D>, settings: &Settings<T, D>, h: f64, now: &Output<T, D>) {
        let [phase, rate, last_phase, last_rate] =
            [now.phase, now.rate, self.last.phase, self.last.rate].map(Real::to_f64);
        assert!((0.0..=1.0).contains(&phase) && phase <= last_phase && (0.0..=1.0).contains(&rate), "{now:?}");
        // The ramp is a step where it is shorter than one.
        let change = h / settings.timing.ramp.to_f64() * (1.0 + 1e-5) + 1e-6;
        // A start takes none.
        assert!(last_phase == 1.0 || rate <= last_rate + change, "{rate} after {last_rate}");
        let asked = input.rate.to_f64();
        let asked = if now.mode == Mode::Run && asked.is_finite() { asked.clamp(0.0, 1.0) } else { 0.0 };
        assert!(
            h == 0.0 && rate == 0.0
                || rate <= asked.max(last_rate - h / settings.timing.ramp.to_f64() * (1.0 - 1e-5)) + 1e-6
        );
        assert!(!(now.status.ended && self.ended), "ended twice");
        self.ended |= now.status.ended;
    }

    /// Every command is finite, within every limit, and where its velocity says.
    fn motion(&mut self, settings: &Settings<T, D>, axes: &[AxisPrimitives<T, [T; N]>; D], h: f64, now: &Output<T, D>) {
        let parts = now.axes.iter().zip(&self.last.axes).zip(&settings.axes).zip(axes);
        let (ported, mut scale) = (settings.port.is_some(), self.scale);
        for axis in now.axes.iter().chain(&self.last.axes) {
            let all = [axis.position, axis.velocity, axis.stiffness, axis.damping, axis.offset, axis.force];
            assert!(all.iter().all(|value| value.is_finite()), "{axis:?}");
            scale = scale.max(axis.position.to_f64().abs()).max(axis.offset.to_f64().abs());
        }
        self.scale = scale;
        for (((axis, last), settings), primitives) in parts {
            let limits = &settings.limits;
            let [min, max] = limits.position;
            assert!(axis.position >= min && axis.position <= max, "{axis:?} {limits:?}");
            assert!(
                axis.offset.abs() <= limits.offset && axis.velocity.abs() <= limits.velocity,
                "{axis:?} {limits:?}"
            );
            let moved = axis.position.to_f64() - last.position.to_f64();
            if h == 0.0 {
                // It shows the force of the step before, whatever the settings are by now.
                let found = (moved, axis.velocity, axis.offset, axis.force);
                assert_eq!(found, (0.0, T::ZERO, last.offset, last.force), "{axis:?} {last:?}");
                continue;
            }
            assert!(axis.force.abs() <= limits.force, "{axis:?} {limits:?}");
            assert!(settings.compliance != Compliance::Rigid || axis.force == T::ZERO, "{axis:?}");
            let k = &primitives.stiffness;
            let slack = 1.0 + 16.0 * T::EPSILON;
            let [stiffness, least, most] = [axis.stiffness, k.min(), k.max()].map(Real::to_f64);
            assert!(stiffness >= least / slack && stiffness <= most * slack, "{stiffness} of {least} to {most}");
            let damping = axis.damping.to_f64();
            let [least, most] = match primitives.law {
                Law::SecondOrder { mass, damping: Damping::Ratio { ratio, floor } } => {
                    let follows = 2.0 * ratio.to_f64() * (mass.to_f64() * stiffness).sqrt();
                    [follows.max(floor.to_f64()); 2]
                }
                _ => [primitives.damping.min(), primitives.damping.max()].map(Real::to_f64),
            };
            assert!(damping >= least / slack && damping <= most * slack, "{damping} of {least} to {most}");

            let rounding = 8.0 * T::EPSILON * self.scale;
            let [speed, before] = [axis.velocity, last.velocity].map(Real::to_f64);
            assert!(
                (moved - speed * h).abs() <= rounding + 8.0 * T::EPSILON * speed.abs() * h,
                "{moved} {axis:?} {last:?} {h}"
            );
            let most = limits.acceleration.to_f64() * h;
            assert!(
                (speed - before).abs()
                    <= most * (1.0 + 8.0 * T::EPSILON) + 2.0 * T::EPSILON * (speed.abs() + before.abs()),
                "{before} to {speed}, {most} at most"
            );
            // What has not started does not move, and a fault that is at rest stays, but for a port, which takes it back
            // to the robot.
            let resting = !self.started
                || !ported
                    && [now.mode, self.last.mode] == [Mode::Fault; 2]
                    && self.last.rate == T::ZERO
                    && last.velocity == T::ZERO;
            assert!(!resting || moved.abs() <= rounding, "{moved} {now:?}");
        }
    }

    /// The books of the tank, from forces and positions.
    fn energy(&mut self, settings: &Settings<T, D>, axes: &[AxisPrimitives<T, [T; N]>; D], h: f64, now: &Output<T, D>) {
        let [energy, port] = [now.energy, now.port_energy].map(Real::to_f64);
        let capacity = settings.tank.map_or(0.0, |tank| tank.capacity().to_f64());
        assert!(energy.is_finite() && energy <= capacity && (settings.tank.is_some() || energy == 0.0), "{now:?}");
        assert!(port.is_finite() && port <= capacity && (settings.port.is_some() || port == 0.0), "{now:?}");
        let mut largest = capacity;
        for ((axis, last), primitives) in now.axes.iter().zip(&self.last.axes).zip(axes) {
            let [force, offset, moved] = [axis.force, axis.offset, axis.position - last.position].map(Real::to_f64);
            self.work += force * (axis.position.to_f64() - last.position.to_f64());
            let mass = if let Law::SecondOrder { mass, .. } = primitives.law { mass.to_f64() } else { 0.0 };
            let reach = offset.abs().max(last.offset.to_f64().abs());
            let speed = if h > 0.0 { (moved.abs() + 2.0 * reach) / h } else { 0.0 };
            largest +=
                primitives.stiffness.max().to_f64() * reach * reach + mass * speed * speed + force.abs() * self.scale;
            self.cut |= axis.hits.any_motion();
        }
        // What a port takes back to the robot, it takes back whatever the model's force makes of it.
        self.cut |= settings.port.is_some() && now.status.energy_short;
        self.doubt += 16.0 * T::EPSILON * largest;
        // A part of the input without a tank is in nobody's books.
        let Some(filled) = self.filled else { return };
        let slack = self.doubt + 1e-12;
        assert!(self.work >= energy - filled - slack, "{} J, {energy} of {filled} left, {slack}", self.work);
        let kept = self.cut || self.work >= self.reserve - filled - slack;
        assert!(kept, "{} J of {filled}, {} in reserve, {slack}", self.work, self.reserve);
    }

    /// Counters count what the flags say, and entries into Fault from the mode that a request has led to.
    fn count(&mut self, asked: Mode, now: &Output<T, D>, counters: &Counters) {
        let status = &now.status;
        let entered = now.mode == Mode::Fault && asked != Mode::Fault;
        let more = |counter: u32, more: bool| counter.saturating_add(u32::from(more));
        let expected = Counters {
            bad_time: more(self.counters.bad_time, status.bad_time),
            long_time: more(self.counters.long_time, status.long_time),
            bad_force: more(self.counters.bad_force, status.bad_force),
            bad_input: more(self.counters.bad_input, status.bad_input),
            refused: more(self.counters.refused, status.refused),
            trips: more(self.counters.trips, status.force_tripped || status.tracking_tripped),
            faults: more(self.counters.faults, entered),
        };
        assert_eq!(*counters, expected);
        self.counters = *counters;
    }
}

/// What of the tank's energy is not to be spent [J]; it has no accessor, so it is what an empty tank cannot do.
fn reserve<T: Scalar, const D: usize>(settings: &Settings<T, D>) -> f64 {
    settings.tank.map_or(f64::MAX, |tank| (tank.capacity() - tank.available(tank.capacity())).to_f64())
}
