//! Tool and contact in the loop through a measured force, held against a simulation in time that shares no formula with
//! the certificate: law and robot are integrated in small steps, readings are kept in a list.

use core::f64::consts::{PI, TAU};

use hpf_core::conditioning::ForceConditioning;
use hpf_core::controller::{Controller, Input, Request, Settings};
use hpf_core::limits::Limits;
use hpf_core::passivity::{Case as Limit, Contact, ForceLoop, Load, Sampling, contact_stiffness_limit};
use hpf_core::{AxisPrimitives, Basis, ConfigError, Damping, Gain, HybridPrimitive, Law, Movement, Phase};

const DT: f64 = 1e-3;
const STIFFNESS: f64 = 200.0;
const DAMPING: f64 = 50.0;

/// What is simulated: the law's mass, if it has one, and its loop.
#[derive(Clone, Copy, Debug)]
struct Case {
    mass: Option<f64>,
    stiffness: f64,
    sampling: Sampling,
}

impl Case {
    fn certificate(&self) -> ForceLoop {
        ForceLoop::new(self.mass, self.stiffness, DAMPING, &self.sampling).unwrap()
    }

    /// Whether a disturbance dies out with this load.
    fn settles(&self, load: &Load) -> bool {
        const TICKS: usize = 4800;
        const PARTS: usize = 4;
        let Sampling { dt, delay, cutoff, lag } = self.sampling;
        let share = cutoff.map_or(1.0, |cutoff: f64| 1.0 - (-TAU * cutoff * dt).exp());
        let part = dt / PARTS as f64;
        let (mut offset, mut speed) = (0.0_f64, 0.0_f64);
        let (mut position, mut velocity) = (0.0_f64, 0.0_f64);
        let (mut block, mut speed_of_block) = (0.0_f64, 0.0_f64);
        let (mut readings, mut filtered) = (vec![0.0_f64; 16], 0.0_f64);
        let mut largest = [0.0_f64; 6];
        for tick in 0..TICKS {
            let age = delay / dt;
            let (whole, rest) = ((age + 1e-9).floor() as usize, (age - (age + 1e-9).floor()).max(0.0));
            let last = readings.len() - 1;
            let delayed = (1.0 - rest) * readings[last - whole] + rest * readings[last - whole - 1];
            // A push of short duration at the start excites what there is.
            filtered += share * (delayed + if tick < 3 { 1.0 } else { 0.0 } - filtered);
            let before = offset;
            for _ in 0..PARTS {
                let rate = |e: f64, v: f64| match self.mass {
                    Some(mass) => (v, (filtered - DAMPING * v - self.stiffness * e) / mass),
                    None => ((filtered - self.stiffness * e) / DAMPING, 0.0),
                };
                (offset, speed) = runge_kutta(offset, speed, part, |e, v, _| rate(e, v));
            }
            let old = velocity;
            // The mass behind the spring meets a tool that moves in straight lines or late.
            if let Some(mass) = load.behind {
                let fine = 3 * PARTS;
                for i in 0..fine {
                    let start = (i as f64) / fine as f64;
                    let h = dt / fine as f64;
                    let slope = (offset - before) / dt;
                    let now = |share: f64| {
                        let t = dt * start + share * h;
                        if lag > 0.0 {
                            // y = u - T v, v relaxes to the slope of the command.
                            let v = slope + (velocity - slope) * (-t / lag).exp();
                            (before + slope * t - lag * v, v)
                        } else {
                            (before + slope * t, slope)
                        }
                    };
                    (block, speed_of_block) = runge_kutta(block, speed_of_block, h, |x, v, share| {
                        let (y, w) = now(share);
                        (v, (load.stiffness * (y - x) + load.damping * (w - v)) / mass)
                    });
                }
            }
            if lag > 0.0 {
                for i in 0..PARTS {
                    let command = |share: f64| before + (offset - before) * (i as f64 + share) / PARTS as f64;
                    (position, _) = runge_kutta(position, 0.0, part, |y, _, share| ((command(share) - y) / lag, 0.0));
                }
                velocity = (offset - position) / lag;
            } else {
                (position, velocity) = (offset, (offset - before) / dt);
            }
            let acceleration = (velocity - old) / dt;
            let (s, rate) = (position - block, velocity - speed_of_block);
            readings.push(-(load.stiffness * s + load.damping * rate + load.mass * acceleration));
            let block = &mut largest[tick * 6 / TICKS];
            *block = block.max(offset.abs());
            if offset.abs() > 1e6 {
                return false;
            }
        }
        largest[5] <= 1.0001 * largest[2]
    }
}

fn runge_kutta(x: f64, v: f64, h: f64, rate: impl Fn(f64, f64, f64) -> (f64, f64)) -> (f64, f64) {
    let a = rate(x, v, 0.0);
    let b = rate(x + 0.5 * h * a.0, v + 0.5 * h * a.1, 0.5);
    let c = rate(x + 0.5 * h * b.0, v + 0.5 * h * b.1, 0.5);
    let d = rate(x + h * c.0, v + h * c.1, 1.0);
    (x + h / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0), v + h / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1))
}

/// Both orders, whole and broken delays, with and without lag and filter.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for mass in [None, Some(2.0), Some(0.2)] {
        for delay in [0.0, 1.0, 2.5, 5.0] {
            for lag in [0.0, 5e-3] {
                for cutoff in [None, Some(30.0)] {
                    let sampling = Sampling { dt: DT, delay: delay * DT, cutoff, lag };
                    cases.push(Case { mass, stiffness: STIFFNESS, sampling });
                }
            }
        }
    }
    cases
}

#[test]
fn the_stiffness_limit_is_that_of_a_simulation_in_time() {
    let mut found = [0; 4];
    for case in cases() {
        for tool in [0.0, 0.02] {
            for mass in [0.0, 0.2] {
                for damping in [0.0, 5.0] {
                    let (limit, limited) = case.certificate().stiffness_limit(&Contact { tool, mass, damping });
                    let load = match limited {
                        Limit::FreeAir => Load { mass: tool, ..Load::default() },
                        Limit::Carried => Load { mass: tool + mass, damping, ..Load::default() },
                        Limit::Behind => Load { mass: tool, damping, stiffness: 0.0, behind: Some(mass) },
                    };
                    let at = |stiffness: f64| case.settles(&Load { stiffness, ..load });
                    if limit == 0.0 {
                        found[3] += 1;
                        assert!(!at(1.0), "{case:?} {load:?}");
                        continue;
                    }
                    found[limited as usize] += 1;
                    for share in [0.3, 0.97] {
                        assert!(at(share * limit), "{case:?} {load:?}: not stable at {share} of {limit}");
                    }
                    assert!(!at(1.03 * limit), "{case:?} {load:?}: stable beyond {limit}");
                }
            }
        }
    }
    assert!(found[0] == 0 && found[1..].iter().all(|&count| count > 0), "{found:?}");
}

#[test]
fn the_tool_mass_limit_is_that_of_a_simulation_in_time() {
    for case in cases() {
        let (certificate, at) = (case.certificate(), |mass| case.settles(&Load { mass, ..Load::default() }));
        let limit = certificate.tool_mass_limit();
        assert!(limit >= certificate.safe_tool_mass() * (1.0 - 1e-9), "{case:?} {limit}");
        assert!(at(0.97 * limit) && !at(1.03 * limit), "{case:?} {limit}");
        assert!(certificate.is_stable(&Load { mass: 0.999 * limit, ..Load::default() }), "{case:?} {limit}");
        assert!(!certificate.is_stable(&Load { mass: 1.001 * limit, ..Load::default() }), "{case:?} {limit}");
    }
}

/// Without spring, mass, lag and filter the loops are polynomials whose roots can be written down.
#[test]
fn the_limits_have_their_closed_forms() {
    for steps in [0.0, 1.0, 2.0, 5.0, 20.0, 400.0] {
        let sampling = Sampling { dt: DT, delay: steps * DT, cutoff: None, lag: 0.0 };
        let bare = ForceLoop::new(None, 0.0, DAMPING, &sampling).unwrap();
        // z - 1 + (K h/d) z^-n: a root at exp(i pi/(2 n + 1)).
        let stiffest = 2.0 * DAMPING / DT * (PI / (2.0 * (2.0 * steps + 1.0))).sin();
        let limit = bare.stiffness_limit(&Contact::default()).0;
        assert!((limit / stiffest - 1.0).abs() < 1e-9, "{steps}: {limit} {stiffest}");
        assert!((limit / contact_stiffness_limit(DAMPING, steps * DT, DT) - 1.0).abs() < 1e-9);
    }
    for (steps, expected) in [(0.0, 0.5), (1.0, 2.0 * (0.3 * PI).sin() - 1.0), (2.0, 0.5)] {
        // z^(n+2) = r (1 - z), r = M/(d h): a root at exp(i (4j - 1) pi/(2n + 3)) for r = 1/(2 sin of half of it).
        let sampling = Sampling { dt: DT, delay: steps * DT, cutoff: None, lag: 0.0 };
        let limit = ForceLoop::new(None, 0.0, DAMPING, &sampling).unwrap().tool_mass_limit();
        assert!((limit / (DAMPING * DT) - expected).abs() < 1e-9, "{steps}: {limit}");
    }
}

/// A little mass behind the spring costs far more than its share: nearly `1/(1/(d w) + 1/(m w^2))`, `w = pi/(2 T)`.
#[test]
fn fifty_grams_behind_the_contact_lower_its_limit_threefold() {
    let sampling = Sampling { dt: DT, delay: DT, cutoff: None, lag: 0.0 };
    let certificate = ForceLoop::new(None, STIFFNESS, 100.0, &sampling).unwrap();
    let limit = |mass| certificate.stiffness_limit(&Contact { mass, ..Contact::default() });
    let ((bare, _), (heavy, limited)) = (limit(0.0), limit(0.05));
    assert!(limited == Limit::Behind && (2.7..3.0).contains(&(bare / heavy)), "{bare} {heavy}");
    let w = PI / (2.0 * 1.5 * DT);
    assert!((heavy * (1.0 / (100.0 * w) + 1.0 / (0.05 * w * w)) - 1.0).abs() < 0.02, "{heavy}");
}

#[test]
fn the_safe_tool_mass_is_safe_at_every_delay_and_lag() {
    for mass in [None, Some(0.05), Some(0.5), Some(5.0)] {
        for stiffness in [0.0, 30.0, 4000.0] {
            for damping in [5.0, 50.0] {
                for cutoff in [None, Some(5.0), Some(100.0)] {
                    for (delay, lag) in [(0.0, 0.0), (1.0, 0.0), (2.0, 0.01), (3.7, 0.0), (10.0, 0.002), (50.0, 0.0)] {
                        let sampling = Sampling { dt: DT, delay: delay * DT, cutoff, lag };
                        let certificate = ForceLoop::new(mass, stiffness, damping, &sampling).unwrap();
                        let tool = certificate.safe_tool_mass();
                        let load = Load { mass: 0.999 * tool, ..Load::default() };
                        assert!(certificate.is_stable(&load), "{mass:?} {stiffness} {damping} {sampling:?}: {tool}");
                        assert!(certificate.tool_mass_limit() >= 0.999 * tool);
                    }
                }
            }
        }
    }
}

/// The certificate's filter is the controller's.
#[test]
fn the_filter_is_that_of_the_conditioning() {
    let cutoff = Some(30.0);
    let conditioning = ForceConditioning { tool_mass: 0.0, gravity: [0.0], cutoff, dead_zone: [0.0] };
    let [through] = conditioning.step(&mut Default::default(), [1.0], DT);
    let sampling = Sampling { dt: DT, delay: 0.0, cutoff, lag: 0.0 };
    let tool = ForceLoop::new(None, 100.0, DAMPING, &sampling).unwrap().safe_tool_mass();
    assert!((tool / (0.5 * DAMPING * DT * (2.0 - through) / through) - 1.0).abs() < 1e-12);
}

#[test]
fn loops_that_cannot_be_are_refused() {
    let good = Sampling { dt: DT, delay: DT, cutoff: Some(30.0), lag: 0.01 };
    assert!(ForceLoop::new(Some(1.0), 0.0, 10.0, &good).is_ok());
    let refused = [
        ForceLoop::new(None, 0.0, 0.0, &good),
        ForceLoop::new(None, -1.0, 10.0, &good),
        ForceLoop::new(Some(0.0), 0.0, 10.0, &good),
        ForceLoop::new(None, 0.0, 10.0, &Sampling { dt: 0.0, ..good }),
        ForceLoop::new(None, 0.0, 10.0, &Sampling { delay: -DT, ..good }),
        ForceLoop::new(None, 0.0, 10.0, &Sampling { delay: 1001.0 * DT, ..good }),
        ForceLoop::new(None, 0.0, 10.0, &Sampling { delay: f64::NAN, ..good }),
        ForceLoop::new(None, 0.0, 10.0, &Sampling { cutoff: Some(0.0), ..good }),
        ForceLoop::new(None, 0.0, 10.0, &Sampling { lag: -0.1, ..good }),
    ];
    assert!(refused.iter().all(Result::is_err), "{refused:?}");
    assert_eq!(refused[0], Err(ConfigError::NotPositive { field: "damping", value: 0.0 }));
}

/// The real controller with a tool behind its sensor in free air: what it calls heavy swings, what it does not is still.
#[test]
fn the_controller_says_which_tool_may_swing() {
    let swing = |law: Law<f64>, cutoff: Option<f64>, tool_mass: f64, delay: usize| {
        let phase = Phase::new(1.0, 4.6).unwrap();
        let basis = Basis::equally_spaced(phase.decay(), 0.6, [0.0; 5], [0.0; 5]).unwrap();
        let axis = AxisPrimitives {
            movement: Movement::new(0.0, 0.3, 25.0, 0.3, [0.0; 5]).unwrap(),
            stiffness: Gain::new(STIFFNESS, STIFFNESS, [STIFFNESS; 5]).unwrap(),
            damping: Gain::new(DAMPING, DAMPING, [DAMPING; 5]).unwrap(),
            law,
        };
        let limits = Limits { force: 40.0, offset: 0.1, velocity: 0.5, acceleration: 1000.0, position: [-0.2, 0.6] };
        let mut settings = Settings::compliant([limits]);
        (settings.conditioning.tool_mass, settings.conditioning.cutoff) = (tool_mass, cutoff);
        let skill = HybridPrimitive::new(phase, [basis; 3], [axis]).unwrap();
        let mut arm = Controller::new(skill, settings, [0.0]).unwrap();
        let (mut readings, mut velocity) = ([0.0; 8], 0.0);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for tick in 0..3000 {
            let request = (tick == 0).then_some(Request::Start);
            let measured_force = [readings[delay]];
            let input = Input { measured_force, force_age: 0, measured_position: None, rate: 1.0, request };
            let [axis] = arm.update(&input, DT).axes;
            readings.rotate_right(1);
            readings[0] = -tool_mass * (axis.velocity - velocity) / DT;
            velocity = axis.velocity;
            if tick >= 2500 {
                (low, high) = (low.min(axis.position), high.max(axis.position));
            }
        }
        (arm.heavy_tool(DT)[0], high - low)
    };
    let second = |mass| Law::SecondOrder { mass, damping: Damping::Primitive };
    for delay in 0..=5 {
        let still = [
            (Law::FirstOrder, None, 0.024),
            (Law::FirstOrder, Some(10.0), 0.5),
            (second(0.5), None, 0.49),
            (second(1.0), Some(30.0), 0.9),
        ];
        for (law, cutoff, tool) in still {
            let (heavy, swing) = swing(law, cutoff, tool, delay);
            assert!(!heavy && swing < 1e-4, "{law:?} {cutoff:?} {tool} kg {delay}: {heavy} {swing}");
        }
        let swinging = [(Law::FirstOrder, None, 0.5), (Law::FirstOrder, Some(100.0), 0.5), (second(0.1), None, 0.5)];
        for (law, cutoff, tool) in swinging {
            let (heavy, swing) = swing(law, cutoff, tool, delay);
            assert!(heavy && swing > 1e-4, "{law:?} {cutoff:?} {tool} kg {delay}: {heavy} {swing}");
        }
    }
}
