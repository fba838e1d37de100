//! An adversary: hostile inputs, settings and requests, for 1 to 7 axes in both precisions. What the controller promises is
//! worked out here from what went in and from the positions that came out, never from the controller's own books.
//!
//! A bounded share; `HPF_CAMPAIGN_UPDATES=10000000` asks for more.

use crate::support::{Family, skill};
use hpf_core::controller::{AxisSettings, Compliance, Controller, Input, Mode, Output, Request, Settings, Timing};
use hpf_core::limits::Limits;
use hpf_core::passivity::EnergyTank;
use hpf_core::{Damping, Law};

/// Updates of each precision, all numbers of axes together.
const UPDATES: u64 = 700_000;

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn one_in(&mut self, n: u64) -> bool {
        self.next().is_multiple_of(n)
    }
}

/// What an input owes by the rule of the docs [s, or steps]: bad time in full, less a quarter of good time.
#[derive(Clone, Copy, Default)]
struct Owed {
    most: f64,
    /// How long it has been good since it was bad [s, or steps].
    good_for: f64,
    /// How long it has surely been lost [s].
    lost_for: f64,
}

impl Owed {
    fn weigh(&mut self, bad: f64, good: f64, limit: f64, dt: f64) {
        self.most = (self.most + bad - good / 4.0).max(0.0);
        self.good_for = if bad > 0.0 { 0.0 } else { self.good_for + good };
        // Good for as long as its limit, it is lost no more, whatever it still owes.
        let lost = self.most > limit * 1.001 + 1e-9 && self.good_for < limit * 0.999;
        self.lost_for = if lost { self.lost_for + dt } else { 0.0 };
    }
}

/// Which input is being spoiled for a while, and how often.
#[derive(Clone, Copy)]
struct Attack {
    force: u64,
    age: u64,
    position: u64,
    rate: u64,
    clock: u64,
}

impl Attack {
    fn draw(dice: &mut Dice) -> Self {
        let mut one = || match dice.next() % 8 {
            0 => 100,
            1 => 95,
            2 => 50,
            3 => 10,
            _ => 0,
        };
        // Mostly one or two of the five.
        let all = [one(), one(), one(), one(), one()];
        let keep = [dice.next() % 5, dice.next() % 5];
        let [force, age, position, rate, clock] =
            core::array::from_fn(|i| if keep.contains(&(i as u64)) { all[i] } else { 0 });
        Self { force, age, position, rate, clock }
    }
}

macro_rules! adversary {
    ($name:ident, $float:ident) => {
        mod $name {
            use super::*;

            const WORST: [$float; 9] = [
                $float::NAN,
                $float::INFINITY,
                $float::NEG_INFINITY,
                $float::MAX,
                $float::MIN,
                $float::MIN_POSITIVE / 1024.0, // subnormal
                -0.0,
                -1.0,
                1e300_f64 as $float,
            ];

            fn worst(dice: &mut Dice) -> $float {
                if dice.one_in(4) {
                    return $float::from_bits(dice.next() as _);
                }
                WORST[dice.next() as usize % WORST.len()]
            }

            /// Settings that are usually in order, with now and then a number that no one means.
            fn settings<const D: usize>(dice: &mut Dice) -> Settings<$float, D> {
                let wild = dice.one_in(10);
                let mut number = |lo: f64, hi: f64| {
                    if wild && dice.one_in(10) { worst(dice) } else { dice.within(lo, hi) as $float }
                };
                let axes = core::array::from_fn(|_| {
                    let limits = Limits {
                        force: number(20.0, 80.0),
                        offset: number(0.05, 0.2),
                        velocity: number(0.1, 1.5),
                        acceleration: number(2.0, 50.0),
                        position: [number(-0.8, -0.5), number(0.5, 0.8)],
                    };
                    let compliance = match number(0.0, 3.0) {
                        x if x < 0.7 => Compliance::Rigid,
                        x if x < 1.2 => Compliance::Press(number(-15.0, 15.0)),
                        _ => Compliance::Compliant,
                    };
                    AxisSettings { compliance, limits, trip_force: number(60.0, 120.0), tracking: number(0.02, 0.1) }
                });
                let mut settings = Settings::compliant(axes.map(|axis: AxisSettings<$float>| axis.limits));
                settings.axes = axes;
                settings.conditioning.tool_mass = number(0.0, 2.0);
                settings.conditioning.gravity = [number(-9.81, 9.81); D];
                settings.conditioning.cutoff = (number(0.0, 1.0) < 0.5).then(|| number(2.0, 200.0));
                settings.tank = EnergyTank::new(number(0.1, 5.0), 0.01, number(0.0, 1.0), number(1.0, 100.0)).ok();
                settings.timing = Timing {
                    longest_step: number(0.004, 0.02),
                    ramp: number(0.01, 0.4),
                    hold: number(0.0, 0.05),
                    oldest_force: 4,
                };
                settings
            }

            fn law(dice: &mut Dice) -> Law<$float> {
                let mut number = |lo: f64, hi: f64| {
                    if dice.one_in(100) { worst(dice) } else { dice.within(lo, hi) as $float }
                };
                let damping = if number(0.0, 1.0) < 0.5 {
                    Damping::Primitive
                } else {
                    Damping::Ratio { ratio: number(0.2, 2.0), floor: number(1.0, 20.0) }
                };
                if number(0.0, 1.0) < 0.5 {
                    Law::FirstOrder
                } else {
                    Law::SecondOrder { mass: number(0.1, 10.0), damping }
                }
            }

            /// The mode after a request, and whether it is taken, by a table of its own.
            fn requested(mode: Mode, request: &str) -> Option<Mode> {
                match (request, mode) {
                    ("start", Mode::Idle) => Some(Mode::Run),
                    ("hold", Mode::Run | Mode::Hold) => Some(Mode::Hold),
                    ("resume", Mode::Run | Mode::Hold) => Some(Mode::Run),
                    ("stop", Mode::Fault) => Some(Mode::Fault),
                    ("stop", _) => Some(Mode::Stop),
                    ("reset", Mode::Idle | Mode::Stop | Mode::Fault) => Some(Mode::Idle),
                    _ => None,
                }
            }

            fn attack<const D: usize>(updates: u64, seed: u64) -> [u64; 5] {
                let mut dice = Dice(seed);
                let family = Family::ALL[D % 2];
                let mut arm = loop {
                    let laws = core::array::from_fn(|_| law(&mut dice));
                    let skill = skill::<$float, D>(family, 2.0).with_laws(laws);
                    let made = skill.and_then(|skill| Controller::new(skill, settings(&mut dice), [0.0; D]));
                    if let Ok(arm) = made {
                        break arm;
                    }
                };
                let mut seen = [0; 5];
                let mut attack = Attack::draw(&mut dice);
                let mut base = [0.0; D];
                // What is known of the past from outside.
                let mut last: Output<$float, D> = arm.output();
                let mut velocity = [0.0_f64; D];
                let mut started = false;
                let [mut force_owed, mut position_owed, mut rate_owed, mut clock_owed] = [Owed::default(); 4];
                for update in 0..updates {
                    if dice.one_in(2000) {
                        attack = if dice.one_in(2) {
                            Attack::draw(&mut dice)
                        } else {
                            Attack { force: 0, age: 0, position: 0, rate: 0, clock: 0 }
                        };
                    }
                    if dice.one_in(700) {
                        base = core::array::from_fn(|_| dice.within(-50.0, 50.0));
                    }
                    if dice.one_in(1000) {
                        let before = *arm.settings();
                        if arm.set(settings(&mut dice)).is_err() {
                            assert_eq!(*arm.settings(), before);
                        } else {
                            // What was owed is measured against other limits: look again from here.
                            for owed in [&mut force_owed, &mut position_owed, &mut rate_owed, &mut clock_owed] {
                                owed.lost_for = 0.0;
                            }
                        }
                    }
                    let settings = *arm.settings();
                    let spoiled = |percent: u64, dice: &mut Dice| dice.next() % 100 < percent || dice.one_in(3000);
                    let axis = dice.next() as usize % D;
                    let mut measured_force: [$float; D] =
                        core::array::from_fn(|i| (base[i] + dice.within(-1.0, 1.0)) as $float);
                    if spoiled(attack.force, &mut dice) {
                        measured_force[axis] = worst(&mut dice);
                    }
                    let force_age = if spoiled(attack.age, &mut dice) { 5 + dice.next() as u32 % 9 } else { 0 };
                    let mut position: [$float; D] =
                        core::array::from_fn(|i| last.axes[i].position + dice.within(-0.015, 0.015) as $float);
                    if spoiled(attack.position, &mut dice) {
                        position[axis] = worst(&mut dice);
                    }
                    let measured_position = (attack.position > 0 || dice.one_in(2)).then_some(position);
                    let rate = if spoiled(attack.rate, &mut dice) { worst(&mut dice) } else { 1.0 };
                    let dt = if spoiled(attack.clock, &mut dice) {
                        worst(&mut dice)
                    } else {
                        dice.within(8e-4, 1.2e-3) as $float
                    };
                    let place: [$float; D] = core::array::from_fn(|_| {
                        if dice.one_in(20) { worst(&mut dice) } else { dice.within(-0.49, 0.49) as $float }
                    });
                    let (name, request) = match (dice.next() % 2000, last.mode) {
                        (0..=2, _) => ("hold", Some(Request::Hold)),
                        (3..=8, _) => ("resume", Some(Request::Resume)),
                        (9, _) => ("stop", Some(Request::Stop)),
                        (10..=14, _) => ("goal", Some(Request::Goal(place))),
                        (15..=20, _) => ("tare", Some(Request::Tare)),
                        (21, _) | (22..=60, Mode::Stop | Mode::Fault) => ("reset", Some(Request::Reset(place))),
                        (61, _) | (62..=90, Mode::Idle) => ("start", Some(Request::Start)),
                        _ => ("", None),
                    };
                    let bias = arm.bias();
                    let input = Input { measured_force, force_age, measured_position, rate, request };
                    let now = arm.update(&input, dt);
                    let at = format!("{} axes, update {update}, {name} in {:?}, dt {dt:e}", D, last.mode);

                    // Requests, by the table and the workspace.
                    let inside = |axes: &[$float; D]| {
                        axes.iter().zip(&settings.axes).all(|(at, axis)| {
                            let [min, max] = axis.limits.position;
                            *at >= min && *at <= max
                        })
                    };
                    let mut mode = last.mode;
                    let mut put = false;
                    match name {
                        "" => assert!(!now.status.refused, "{at}"),
                        "goal" => {
                            let may = matches!(mode, Mode::Idle | Mode::Run | Mode::Hold) && inside(&place);
                            assert_eq!(now.status.refused, !may, "{at}");
                        }
                        "tare" => assert!(now.status.refused || mode == Mode::Idle, "{at}"),
                        _ => {
                            let next = requested(mode, name).filter(|_| name != "reset" || inside(&place));
                            assert_eq!(now.status.refused, next.is_none(), "{at}");
                            mode = next.unwrap_or(mode);
                            put = name == "reset" && next.is_some();
                        }
                    }
                    if put {
                        for (axis, &position) in last.axes.iter_mut().zip(&place) {
                            axis.position = position;
                        }
                        (velocity, started) = ([0.0; D], false);
                        // A force has to be read again; the rest is forgiven.
                        [force_owed, position_owed, rate_owed, clock_owed] = [Owed::default(); 4];
                    }
                    if !now.status.refused && name == "tare" {
                        // A new bias is checked by the forces that follow.
                        assert!(arm.bias().iter().all(|bias| bias.is_finite()), "{at}");
                    }

                    // Trips, each axis by itself.
                    let weight: [f64; D] = settings
                        .conditioning
                        .gravity
                        .map(|gravity| f64::from(settings.conditioning.tool_mass) * f64::from(gravity));
                    let known_bias = if name == "tare" { arm.bias() } else { bias };
                    let (mut trips, mut near) = (false, false);
                    for i in 0..D {
                        let level = f64::from(settings.axes[i].trip_force);
                        let force = f64::from(measured_force[i]);
                        if force_age <= 4 && force.is_finite() {
                            let force = force.clamp(-1e9, 1e9);
                            let seen = (force - f64::from(known_bias[i]) - weight[i]).abs();
                            trips |= seen > level;
                            near |= (seen - level).abs() <= 1e-4 * (seen + level);
                        }
                        let tracking = f64::from(settings.axes[i].tracking);
                        if let Some(measured) = measured_position.filter(|measured| measured[i].is_finite()) {
                            let gap = (f64::from(measured[i]) - f64::from(last.axes[i].position)).abs();
                            trips |= gap > tracking;
                            near |= (gap - tracking).abs() <= 1e-5;
                        }
                    }
                    if !near {
                        let tripped = now.status.force_tripped || now.status.tracking_tripped;
                        assert_eq!(tripped, trips, "{at}: {now:?}");
                    }
                    if now.status.force_tripped || now.status.tracking_tripped {
                        mode = if mode == Mode::Fault { Mode::Fault } else { Mode::Stop };
                    }
                    started |= mode == Mode::Run;

                    // Time and bad inputs, by the table of the docs.
                    let longest = f64::from(settings.timing.longest_step);
                    let wide = f64::from(dt);
                    let bad_time = !(wide.is_finite() && wide >= 1e-6 * (1.0 - 1e-7));
                    let h = if bad_time { 0.0 } else { wide.min(longest) };
                    assert_eq!(
                        (now.status.bad_time, now.status.long_time),
                        (bad_time, !bad_time && wide > longest),
                        "{at}"
                    );
                    let bad_force = force_age > 4 || measured_force.iter().any(|force| !force.is_finite());
                    let bad_position = measured_position.is_some_and(|all| all.iter().any(|at| !at.is_finite()));
                    let bad_rate = !rate.is_finite();
                    assert_eq!(now.status.bad_force, bad_force, "{at}");
                    assert_eq!(now.status.bad_input, bad_position || bad_rate, "{at}");
                    let hold = f64::from(settings.timing.hold);
                    let moving = mode != Mode::Idle && mode != Mode::Fault;
                    for (owed, bad) in
                        [(&mut force_owed, bad_force), (&mut position_owed, bad_position), (&mut rate_owed, bad_rate)]
                    {
                        if bad {
                            owed.weigh(h, 0.0, hold, h)
                        } else {
                            owed.weigh(0.0, h, hold, h)
                        }
                        if mode == Mode::Idle {
                            *owed = Owed::default();
                        }
                    }
                    let clock_bad = if bad_time { 1.0 } else { (wide / longest - 1.0).clamp(0.0, 1.0) };
                    let clock_good = f64::from(u8::from(clock_bad == 0.0));
                    clock_owed.weigh(clock_bad, clock_good, 20.0, h);
                    if mode == Mode::Idle {
                        clock_owed = Owed::default();
                    }
                    let ramp = f64::from(settings.timing.ramp);
                    let all = [force_owed, position_owed, rate_owed, clock_owed];
                    if moving {
                        let overdue = all.iter().any(|owed| owed.lost_for > ramp + 3.0 * longest);
                        let dead = bad_time && clock_owed.most > 20.5;
                        assert!(now.mode == Mode::Fault || !(overdue || dead), "{at}: no fault; {now:?}");
                    }
                    if now.mode == Mode::Fault && mode != Mode::Fault {
                        // Nothing but a lost input makes a fault; a force that was never read is lost.
                        assert!(moving, "{at}");
                        assert!(now.status.lost(), "{at}");
                    } else {
                        assert_eq!(now.mode, mode, "{at}: {now:?}");
                    }

                    // Positions, and what follows from two of them.
                    assert!(
                        (0.0..=1.0).contains(&now.rate) && (0.0..=1.0).contains(&now.phase) && now.energy.is_finite()
                    );
                    assert!(put || now.phase <= last.phase, "{at}");
                    for i in 0..D {
                        let (axis, limits) = (&now.axes[i], &settings.axes[i].limits);
                        let all = [axis.position, axis.velocity, axis.stiffness, axis.damping, axis.offset, axis.force];
                        assert!(all.iter().all(|value| value.is_finite()), "{at}: {axis:?}");
                        let [min, max] = limits.position;
                        assert!(axis.position >= min && axis.position <= max, "{at}: {axis:?}");
                        assert!(axis.offset.abs() <= limits.offset, "{at}: {axis:?}");
                        let moved = f64::from(axis.position) - f64::from(last.axes[i].position);
                        if h == 0.0 {
                            assert_eq!((moved, axis.velocity), (0.0, 0.0), "{at}");
                            velocity[i] = 0.0;
                            continue;
                        }
                        // A position below a meter is rounded at both ends of the step, and where it is summed.
                        let slack = 8.0 * f64::from($float::EPSILON) / h + 1e-12;
                        let speed = moved / h;
                        assert!(
                            speed.abs() <= f64::from(limits.velocity) * (1.0 + 1e-5) + slack,
                            "{at}: {speed} {limits:?}"
                        );
                        let change = (f64::from(axis.velocity) - velocity[i]).abs();
                        let most = f64::from(limits.acceleration) * h;
                        assert!(
                            change <= most * (1.0 + 1e-5) + 4.0 * f64::from($float::EPSILON),
                            "{at}: {change} {most}"
                        );
                        assert!(
                            (speed - f64::from(axis.velocity)).abs() <= slack + 1e-5 * speed.abs(),
                            "{at}: {speed} {axis:?}"
                        );
                        velocity[i] = f64::from(axis.velocity);
                        // What has not started does not move, and a fault that is at rest stays: but for the rounding of
                        // a position below a meter that is said relative to another goal.
                        let resting = !started
                            || now.mode == Mode::Fault
                                && last.mode == Mode::Fault
                                && last.rate == 0.0
                                && last.axes[i].velocity == 0.0;
                        assert!(
                            !resting || moved.abs() <= f64::from($float::EPSILON),
                            "{at}: moved {moved} {now:?} after {last:?}"
                        );
                    }
                    seen[now.mode as usize] += 1;
                    last = now;
                }
                seen
            }

            #[test]
            fn no_promise_breaks() {
                let updates = std::env::var("HPF_CAMPAIGN_UPDATES").map_or(UPDATES, |text| text.parse().unwrap());
                let share = updates / 7;
                let all = [
                    attack::<1>(share, 1),
                    attack::<2>(share, 2),
                    attack::<3>(share, 3),
                    attack::<4>(share, 4),
                    attack::<5>(share, 5),
                    attack::<6>(share, 6),
                    attack::<7>(share, 7),
                ];
                println!("Idle, Run, Hold, Stop, Fault for 1 to 7 axes: {all:?}");
                for seen in all {
                    assert!(seen.iter().all(|&count| count > share / 500), "{seen:?}");
                }
            }
        }
    };
}

adversary!(single_precision, f32);
adversary!(double_precision, f64);
