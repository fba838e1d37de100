//! A campaign of faults: everything that can come in, in random order, from a fixed seed.
//!
//! A million updates in each precision; `HPF_CAMPAIGN_UPDATES=10000000` asks for more.

use crate::support::{Family, N, skill};
use hpf_core::conditioning::ForceConditioning;
use hpf_core::controller::{AxisSettings, Compliance, Controller, Input, Mode, Output, Request, Settings, Timing};
use hpf_core::limits::Limits;
use hpf_core::passivity::{EnergyTank, Port};
use hpf_core::{Damping, Law};

const UPDATES: u64 = 1_000_000;
const AXES: usize = 2;

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

macro_rules! campaign {
    ($name:ident, $float:ident, $slack:expr) => {
        mod $name {
            use super::*;

            type Arm = Controller<$float, [$float; N], AXES>;

            /// Usually `lo..hi`, now and then anything that a broken driver hands over.
            fn nasty(dice: &mut Dice, lo: f64, hi: f64) -> $float {
                const WORST: [$float; 10] = [
                    $float::NAN,
                    $float::INFINITY,
                    $float::NEG_INFINITY,
                    $float::MAX,
                    $float::MIN,
                    $float::MIN_POSITIVE,
                    $float::MIN_POSITIVE / 1024.0, // denormal
                    0.0,
                    -0.0,
                    -1.0,
                ];
                match dice.next() % 200 {
                    0 => $float::from_bits(dice.next() as _),
                    1 => WORST[dice.next() as usize % WORST.len()],
                    _ => dice.within(lo, hi) as $float,
                }
            }

            fn settings(dice: &mut Dice) -> Settings<$float, AXES> {
                let axes = core::array::from_fn(|_| {
                    let compliance = match dice.next() % 4 {
                        0 => Compliance::Rigid,
                        1 => Compliance::Press(nasty(dice, -20.0, 20.0)),
                        _ => Compliance::Compliant,
                    };
                    let limits = Limits {
                        force: nasty(dice, 20.0, 100.0),
                        offset: nasty(dice, 0.02, 0.3),
                        velocity: nasty(dice, 0.05, 2.0),
                        acceleration: nasty(dice, 0.5, 50.0),
                        position: [nasty(dice, -0.8, -0.1), nasty(dice, 0.31, 0.8)],
                    };
                    let (trip_force, tracking) = (nasty(dice, 80.0, 150.0), nasty(dice, 0.01, 0.1));
                    AxisSettings { compliance, limits, trip_force, tracking }
                });
                let tank = (!dice.one_in(4))
                    .then(|| {
                        EnergyTank::new(nasty(dice, 0.1, 3.0), 0.05, nasty(dice, 0.0, 1.0), nasty(dice, 1.0, 100.0))
                            .ok()
                    })
                    .flatten();
                // Seldom, because it ties a tool to a robot that is not here.
                let port = dice
                    .one_in(8)
                    .then(|| Port { force_delay: (dice.next() % 8) as u32, force_bias: [nasty(dice, 0.0, 2.0); AXES] });
                Settings {
                    axes,
                    conditioning: ForceConditioning {
                        tool_mass: nasty(dice, 0.0, 1.0),
                        gravity: [nasty(dice, -9.81, 0.0), 0.0],
                        cutoff: dice.one_in(2).then(|| nasty(dice, 5.0, 500.0)),
                        dead_zone: [nasty(dice, 0.0, 3.0); 2],
                    },
                    tank,
                    port,
                    timing: Timing {
                        longest_step: nasty(dice, 0.002, 0.02),
                        ramp: nasty(dice, 0.01, 0.5),
                        hold: nasty(dice, 0.0, 0.05),
                        oldest_force: (dice.next() % 6) as u32,
                    },
                }
            }

            fn law(dice: &mut Dice) -> Law<$float> {
                let damping = if dice.one_in(2) {
                    Damping::Primitive
                } else {
                    Damping::Ratio { ratio: nasty(dice, 0.1, 2.0), floor: nasty(dice, 1.0, 20.0) }
                };
                if dice.one_in(2) {
                    Law::FirstOrder
                } else {
                    Law::SecondOrder { mass: nasty(dice, 0.05, 10.0), damping }
                }
            }

            fn arm(dice: &mut Dice) -> Arm {
                loop {
                    let position = [nasty(dice, -0.1, 0.3), nasty(dice, -0.1, 0.3)];
                    let family = Family::ALL[usize::from(dice.one_in(2))];
                    let skill = skill(family, dice.within(0.3, 5.0)).with_laws([law(dice), law(dice)]);
                    if let Ok(arm) = skill.and_then(|skill| Controller::new(skill, settings(dice), position)) {
                        return arm;
                    }
                }
            }

            fn input(dice: &mut Dice, force: [f64; AXES], last: &Output<$float, AXES>) -> Input<$float, AXES> {
                let pair = |dice: &mut Dice| [nasty(dice, -0.3, 0.5), nasty(dice, -0.3, 0.5)];
                // Latched modes would swallow the campaign: most of it is to be spent in motion.
                let request = match (dice.next() % 1000, last.mode) {
                    (0..=1, _) => Some(Request::Hold),
                    (2, _) => Some(Request::Resume),
                    (3, _) if dice.one_in(4) => Some(Request::Stop),
                    (4..=5, _) => Some(Request::Goal(pair(dice))),
                    (6, _) => Some(Request::Tare),
                    (7, _) | (8..=100, Mode::Stop | Mode::Fault) => Some(Request::Reset(pair(dice))),
                    (8, _) | (9..=100, Mode::Idle) => Some(Request::Start),
                    _ => None,
                };
                Input {
                    measured_force: force.map(|force| nasty(dice, force - 1.0, force + 1.0)),
                    force_age: if dice.one_in(2000) { dice.next() as u32 } else { (dice.next() % 4) as u32 },
                    measured_position: dice.one_in(3).then(|| {
                        last.axes
                            .map(|axis| nasty(dice, f64::from(axis.position) - 5e-3, f64::from(axis.position) + 5e-3))
                    }),
                    rate: if dice.one_in(20) { nasty(dice, 0.0, 1.0) } else { 1.0 },
                    request,
                }
            }

            /// What must hold between two consecutive outputs.
            fn check(arm: &Arm, last: &Output<$float, AXES>, now: &Output<$float, AXES>, dt: f64, put: bool) {
                let settings = arm.settings();
                assert!((0.0..=1.0).contains(&now.phase) && (0.0..=1.0).contains(&now.rate) && now.energy.is_finite());
                assert!(now.port_energy.is_finite());
                assert!(put || now.phase <= last.phase);
                assert!(now.mode == Mode::Fault || last.mode != Mode::Fault || put, "a fault is latched");
                assert!(now.mode != Mode::Run || !matches!(last.mode, Mode::Stop), "a stop is latched");
                for ((axis, last), settings) in now.axes.iter().zip(&last.axes).zip(&settings.axes) {
                    let all = [axis.position, axis.velocity, axis.stiffness, axis.damping, axis.offset, axis.force];
                    assert!(all.iter().all(|value| value.is_finite()), "{axis:?}");
                    let limits = &settings.limits;
                    let [min, max] = limits.position;
                    assert!(axis.position >= min && axis.position <= max, "{axis:?} outside {limits:?}");
                    assert!(axis.offset.abs() <= limits.offset, "{axis:?} outside {limits:?}");
                    assert!(axis.force.abs() <= limits.force || dt == 0.0, "{axis:?} outside {limits:?}"); // or repeated
                    assert!(axis.velocity.abs() <= limits.velocity, "{axis:?} outside {limits:?}");
                    assert!((29.99..=400.01).contains(&axis.stiffness) && axis.damping > 0.99, "{axis:?}");
                    let change = f64::from(axis.velocity - last.velocity).abs();
                    let allowed = f64::from(limits.acceleration) * dt;
                    assert!(change <= allowed * (1.0 + $slack) + 4.0 * $slack, "{axis:?} after {last:?} in {dt} s");
                    // Positions below a metre round at half an epsilon each; the wall may round once more.
                    let moved = f64::from(axis.position) - f64::from(last.position);
                    let wanted = f64::from(axis.velocity) * dt;
                    assert!(
                        (moved - wanted).abs() <= 20.0 * $slack + 1e-3 * wanted.abs(),
                        "{axis:?} after {last:?} in {dt} s"
                    );
                }
            }

            #[test]
            fn outputs_stay_finite_and_within_every_limit_and_energy_is_never_made() {
                let updates = std::env::var("HPF_CAMPAIGN_UPDATES").map_or(UPDATES, |text| text.parse().unwrap());
                let mut dice = Dice(2024);
                let mut arm = arm(&mut dice);
                let mut force = [0.0; AXES];
                let mut seen = [0_u64; 5];
                let (mut changed, mut guarded) = (0_u64, 0_u64);
                // Energy since the last reset: what there was, the work done since, the steps it took.
                let mut books: Option<(f64, f64, f64)> = None;
                for update in 0..updates {
                    if dice.one_in(20_000) {
                        arm = super::$name::arm(&mut dice);
                        books = None;
                    }
                    if dice.one_in(500) {
                        let had = arm.settings().tank.is_some();
                        let before = *arm.settings();
                        let accepted = arm.set(settings(&mut dice)).is_ok();
                        changed += u64::from(accepted);
                        assert!(accepted || *arm.settings() == before);
                        if accepted && !(had && arm.settings().tank.is_some()) {
                            books = None;
                        }
                    }
                    if dice.one_in(100) {
                        force = [dice.within(-60.0, 60.0), dice.within(-60.0, 60.0)];
                    }
                    let mut last = arm.output();
                    let dt = if dice.one_in(50) { nasty(&mut dice, -1e-3, 0.05) } else { nasty(&mut dice, 5e-4, 2e-3) };
                    let input = input(&mut dice, force, &last);
                    let now = arm.update(&input, dt);
                    let dt = if dt.is_finite() && dt >= 1e-6 {
                        f64::from(dt.min(arm.settings().timing.longest_step))
                    } else {
                        0.0
                    };

                    // A reset that was not refused puts the last command where it says, at rest.
                    let put = match input.request {
                        Some(Request::Reset(position)) if !now.status.refused => {
                            for (axis, position) in last.axes.iter_mut().zip(position) {
                                (axis.position, axis.velocity, axis.offset) = (position, 0.0, 0.0);
                            }
                            true
                        }
                        _ => false,
                    };
                    if dt == 0.0 {
                        // The command stands still, and says so.
                        assert!(now.status.bad_time);
                        for axis in &mut last.axes {
                            axis.velocity = 0.0;
                        }
                        if !put {
                            assert_eq!((now.axes, now.phase, now.rate), (last.axes, last.phase, 0.0));
                        }
                    }
                    check(&arm, &last, &now, dt, put);
                    seen[now.mode as usize] += 1;

                    let stored: f64 = now
                        .axes
                        .iter()
                        .map(|axis| 0.5 * f64::from(axis.stiffness) * f64::from(axis.offset).powi(2))
                        .sum();
                    let work: f64 =
                        now.axes.iter().map(|axis| f64::from(axis.force) * f64::from(axis.velocity) * dt).sum();
                    if let Some(tank) = arm.settings().tank {
                        assert!(now.energy <= tank.capacity());
                        if put {
                            books = Some((f64::from(tank.capacity()), 0.0, 0.0));
                        }
                        if let Some((start, sum, steps)) = &mut books {
                            guarded += 1;
                            *sum += work;
                            *steps += 1.0;
                            // Each step rounds energies of some ten joules, or of a huge tank, a few times.
                            let slack = 100.0 * $slack * (10.0 + *steps) * (*start / 10.0).max(1.0);
                            let now = f64::from(now.energy) + stored;
                            assert!(
                                now <= *start + *sum + slack,
                                "{now} J of {start} J and {sum} J at update {update}"
                            );
                        }
                    }
                }
                println!(
                    "Idle, Run, Hold, Stop, Fault: {seen:?}; {changed} settings; books over {guarded}; {:?}",
                    arm.counters()
                );
                assert!(seen.iter().all(|&count| count > updates / 100), "{seen:?}");
                assert!(changed > updates / 5_000 && guarded > updates / 4);
            }
        }
    };
}

campaign!(single_precision, f32, 6e-8);
campaign!(double_precision, f64, 1.1e-16);
