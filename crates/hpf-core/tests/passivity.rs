//! The energy books, the guard and the certificates.

use hpf_core::admittance::{Inertial, OffsetMotion, step_offset};
use hpf_core::passivity::{
    EnergyTank, Stored, contact_stiffness_limit, first_order_fails_at, inertial_decay, kinetic_energy, largest_offset,
    spring_energy, switched_energy,
};
use proptest::collection::vec;
use proptest::prelude::*;

const DT: f64 = 1e-3;
const DAMPING: f64 = 10.0;
const MASS: f64 = 0.5;

/// A tool of first or second order with its tank, if it has one, and the work that the environment has done on it.
#[derive(Clone, Copy)]
struct Tool {
    law: Option<Inertial<f64>>,
    tank: Option<EnergyTank<f64>>,
    energy: Stored<f64>,
    stiffness: f64,
    motion: OffsetMotion<f64>,
    work: f64,
    least_work: f64,
}

impl Tool {
    fn new(inertial: bool, tank: Option<EnergyTank<f64>>) -> Self {
        Self {
            law: inertial.then(|| Inertial::new(MASS, 400.0, 100.0, DT).unwrap()),
            tank,
            energy: Stored::new(tank.map_or(0.0, |tank| tank.capacity())),
            stiffness: 30.0,
            motion: OffsetMotion { offset: 0.0, velocity: 0.0 },
            work: 0.0,
            least_work: 0.0,
        }
    }

    fn stored(&self) -> f64 {
        let mass = self.law.map_or(0.0, |law| law.mass());
        spring_energy(self.stiffness, self.motion.offset) + kinetic_energy(mass, self.motion.velocity)
    }

    /// One step; returns what it has dissipated.
    fn step(&mut self, force: f64, wanted: f64, damping: f64) -> f64 {
        self.stiffness = match self.tank {
            Some(tank) => tank.stiffness(&mut self.energy, self.stiffness, wanted, self.motion.offset, DT),
            None => wanted,
        };
        let (before, stored) = (self.motion.offset, self.stored());
        match self.law {
            Some(law) => law.step(&mut self.motion, self.stiffness, damping, force, DT),
            None => self.motion.offset = step_offset(before, self.stiffness, damping, force, DT),
        }
        let work = force * (self.motion.offset - before);
        let dissipated = work - (self.stored() - stored);
        if let Some(tank) = self.tank {
            tank.book(&mut self.energy, dissipated);
        }
        self.work += work;
        self.least_work = self.least_work.min(self.work);
        dissipated
    }
}

fn tank(capacity: f64) -> EnergyTank<f64> {
    EnergyTank::new(capacity, 0.0, 1.0, 1e9).unwrap()
}

/// Pulls the soft tool out, has it stiffened, lets it push back against just less than it can give, and again.
fn pump(tool: &mut Tool, cycles: usize) {
    for _ in 0..cycles {
        for _ in 0..2000 {
            tool.step(3.0, 30.0, DAMPING);
        }
        for _ in 0..2000 {
            let force = 0.9 * tool.stiffness * tool.motion.offset;
            tool.step(force, 400.0, DAMPING);
        }
    }
}

#[test]
fn the_tank_stops_a_pump() {
    for inertial in [false, true] {
        let mut free = Tool::new(inertial, None);
        pump(&mut free, 6);
        assert!(free.work < -5.0, "{}", free.work); // each cycle gives 0.9 k e^2/2 for an input of k e^2/2 of the soft one
        let mut guarded = Tool::new(inertial, Some(tank(0.2)));
        pump(&mut guarded, 200);
        assert!(guarded.least_work >= -0.2, "{}", guarded.least_work);
    }
}

#[test]
fn one_stiffness_cycle_at_a_decimetre_makes_nearly_two_joules() {
    // Pulled out soft, stiffened in place, taken back slowly: (400 - 30) 0.1^2/2 = 1.85 J, less what damping takes.
    let mut tool = Tool::new(false, None);
    for _ in 0..100_000 {
        let force = 30.0 * 0.1 * (tool.motion.offset / 0.1 + 0.01).min(1.0); // always slightly more than the spring
        tool.step(force, 30.0, DAMPING);
    }
    for i in 0..100_000_i32 {
        let wanted = 30.0 + 370.0 * f64::from(i) / 1e5;
        tool.step(wanted * tool.motion.offset, wanted, DAMPING); // held in place
    }
    for _ in 0..400_000 {
        tool.step(0.999 * 400.0 * tool.motion.offset, 400.0, DAMPING);
    }
    assert!((-1.85..-1.80).contains(&tool.work), "{}", tool.work);
    assert!((switched_energy((0..=100).map(|i| 30.0 + 3.7 * f64::from(i)), 0.1) - 1.85).abs() < 1e-12);
}

fn adversary() -> impl Strategy<Value = Vec<(f64, f64, f64, usize)>> {
    let force = prop_oneof![-100.0..100.0_f64, Just(0.0), Just(1e3), Just(-1e3)];
    vec((force, 30.0..400.0_f64, 10.0..100.0_f64, 1..200_usize), 1..60)
}

proptest! {
    #[test]
    fn a_tool_with_a_tank_never_gives_more_than_it_held(
        inertial: bool, capacity in 0.01..2.0_f64, reserve in 0.0..1.0_f64, refill in 0.0..=1.0_f64,
        power in 0.1..1e3_f64, sequence in adversary(),
    ) {
        let reserve = reserve * capacity;
        let mut tool = Tool::new(inertial, Some(EnergyTank::new(capacity, reserve, refill, power).unwrap()));
        let mut put_in = 0.0_f64;
        for (force, stiffness, damping, times) in sequence {
            for _ in 0..times {
                tool.step(force, stiffness, damping);
                put_in = put_in.max(tool.work.abs());
                // Sums of 10^4 terms of up to `put_in` joules, each rounded at 1e-16.
                let slack = 1e-12 * (1.0 + put_in);
                prop_assert!(tool.work >= -(capacity - reserve) - slack, "{} J", tool.work);
                let energy = tool.energy.level();
                prop_assert!(energy >= reserve.min(capacity) - slack && energy <= capacity);
            }
        }
    }

    #[test]
    fn held_gains_only_dissipate(
        inertial: bool, k in 30.0..400.0_f64, d in 0.0..100.0_f64, force in vec(-100.0..100.0_f64, 1..60),
    ) {
        let mut tool = Tool { stiffness: k, ..Tool::new(inertial, None) };
        for force in force {
            let dissipated = tool.step(force, k, d.max(if inertial { 0.0 } else { 1.0 }));
            prop_assert!(dissipated >= -1e-12, "{dissipated:e} J"); // differences of energies of up to 1e3 J
        }
    }

    #[test]
    fn the_least_energy_of_the_certificate_is_sharp(steps in vec((30.0..400.0_f64, 10.0..100.0_f64), 2..40)) {
        // What the certificate passes, no pump gets energy out of: tried with greedy releases after every step.
        let dt = 0.1;
        if first_order_fails_at(steps.iter().copied(), dt).is_none() {
            for pull in 1..steps.len() {
                let (mut offset, mut work) = (0.0_f64, 0.0_f64);
                for (i, &(k, d)) in steps.iter().enumerate() {
                    let force = if i < pull { 20.0 } else { 0.5 * k * offset };
                    let next = step_offset(offset, k, d, force, dt);
                    work += force * (next - offset);
                    offset = next;
                    prop_assert!(work >= -1e-12, "{work} J at step {i}");
                }
            }
        }
    }
}

/// Stiffness from 30 N/m to 400 N/m, linear over [2.5 s, 5 s].
fn ramp(damping: f64, dt: f64) -> impl Iterator<Item = (f64, f64)> {
    let steps = (5.0 / dt) as usize;
    (0..steps).map(move |i| (30.0 + 370.0 * (((i as f64 + 0.5) * dt - 2.5) / 2.5).max(0.0), damping))
}

#[test]
fn the_certificate_says_when_a_ramp_stops_being_passive() {
    for (damping, time) in [(10.0, 2.94), (50.0, 3.59), (100.0, 4.19)] {
        let found = first_order_fails_at(ramp(damping, 1e-3), 1e-3).unwrap();
        assert!((found - time).abs() < 0.01, "{found} s for d = {damping}");
    }
    assert_eq!(first_order_fails_at(vec![(100.0, 50.0); 100_000], 1e-3), None);
}

#[test]
fn the_certificate_is_the_riccati_equation() {
    // p' = -(k - p)^2/(2 d) by midpoint steps of 1 us from p = 2 d/h, for d = 10.
    let (d, h) = (10.0, 1e-5);
    let (mut p, mut t) = (2.0 * d / 0.1 + 30.0, 0.1); // constant gains so far: q = 2 d/t
    while p >= 0.0 {
        let k = 30.0 + 370.0 * ((t + 0.5 * h - 2.5_f64) / 2.5).max(0.0);
        let slope = |p: f64| -(k - p) * (k - p) / (2.0 * d);
        p += h * slope(p + 0.5 * h * slope(p));
        t += h;
    }
    let found = first_order_fails_at(ramp(d, 1e-3), 1e-3).unwrap();
    assert!((found - t).abs() < 2e-3, "{found} {t}");
}

#[test]
fn a_slow_rise_with_enough_damping_is_proved_stable_with_inertia() {
    let rise = |slope: f64| (0..1000).map(move |i| (100.0 + slope * f64::from(i) * DT, 50.0));
    // a = d/m = 25 allows k' <= 2 a k = 5000 N/(m s).
    assert_eq!(inertial_decay(rise(4900.0), 2.0, DT), Some(25.0));
    assert_eq!(inertial_decay(rise(5100.0), 2.0, DT), None);
    // Falling damping helps: room = 2 k - d'. Rising damping hurts.
    let with = |slope: f64| (0..10).map(move |i| (100.0, 50.0 + slope * f64::from(i) * DT));
    assert!(inertial_decay(with(-1e3), 2.0, DT).is_some());
    assert!(inertial_decay(with(1e3), 2.0, DT).is_none());
}

#[test]
fn a_mass_does_not_keep_a_schedule_from_giving_energy() {
    // Pressed while soft, let go while stiff: what the first-order test refuses, a tool with inertia gives as well.
    let (mass, damping) = (0.5, 1.0);
    let gains: Vec<(f64, f64)> = (0..4000).map(|i| (if i < 2000 { 30.0 } else { 400.0 }, damping)).collect();
    assert_eq!(first_order_fails_at(gains.iter().copied(), DT), Some(2001.0 * DT));
    let law = Inertial::new(mass, 400.0, damping, DT).unwrap();
    let mut motion = OffsetMotion { offset: 0.0, velocity: 0.0 };
    let mut work = 0.0;
    for (i, &(stiffness, _)) in gains.iter().enumerate() {
        // To 0.1 m and back, half a cosine each in two seconds; the force is that of the law.
        let (w, t) = (core::f64::consts::FRAC_PI_2, (i as f64 + 0.5) * DT);
        let [e, v, a] = [0.05 * (1.0 - (w * t).cos()), 0.05 * w * (w * t).sin(), 0.05 * w * w * (w * t).cos()];
        let (force, before) = (mass * a + damping * v + stiffness * e, motion.offset);
        law.step(&mut motion, stiffness, damping, force, DT);
        work += force * (motion.offset - before);
    }
    // 0.15 J in, 2 J out, less what damping takes: int v^2 = 0.05^2 w^2 2 s.
    assert!((work - (0.15 - 2.0 + 0.0123)).abs() < 0.01, "{work}");
}

#[test]
fn every_refusal_names_its_culprit() {
    let refused = |capacity, reserve, refill, power| {
        EnergyTank::<f64>::new(capacity, reserve, refill, power).unwrap_err().to_string()
    };
    assert_eq!(refused(0.0, 0.0, 1.0, 1.0), "tank.capacity must be positive, not 0");
    assert_eq!(refused(1.0, 2.0, 1.0, 1.0), "tank.reserve must lie in [0, 1], not 2");
    assert_eq!(refused(1.0, 0.0, 1.5, 1.0), "tank.refill must lie in [0, 1], not 1.5");
    assert_eq!(refused(1.0, 0.0, 1.0, f64::NAN), "tank.power is not a finite number");
}

/// Whether an offset dies out on a contact whose force comes `late` steps late, between steps interpolated.
fn is_stable_on(contact: f64, stiffness: f64, damping: f64, late: f64) -> bool {
    let (whole, part) = (late.floor() as usize, late.fract());
    let mut past = vec![0.01; whole + 2];
    for _ in 0..40_000 {
        let delayed = (1.0 - part) * past[past.len() - 1 - whole] + part * past[past.len() - 2 - whole];
        let next = step_offset(past[past.len() - 1], stiffness, damping, -contact * delayed, DT);
        past.remove(0);
        past.push(next);
        if next.abs() > 1.0 {
            return false;
        }
    }
    past.iter().all(|offset| offset.abs() < 1e-4)
}

#[test]
fn the_contact_limit_separates_stable_from_unstable_for_whole_steps_of_delay() {
    for steps in [0.0, 1.0, 2.0, 5.0] {
        let limit = contact_stiffness_limit(DAMPING, steps * DT, DT);
        // A stiffness so small that it moves the limit by less than 1e-6 of itself.
        assert!(is_stable_on(0.99 * limit, 1e-3, DAMPING, steps), "{steps}");
        assert!(!is_stable_on(1.01 * limit, 1e-3, DAMPING, steps), "{steps}");
    }
}

#[test]
fn the_contact_limit_is_cautious_between_steps_and_for_a_stiff_tool() {
    for steps in [0.1, 0.5, 0.9, 1.3, 1.5, 1.8, 4.5] {
        for stiffness in [1e-3, 400.0] {
            let limit = contact_stiffness_limit(DAMPING, steps * DT, DT);
            assert!(is_stable_on(0.99 * limit, stiffness, DAMPING, steps), "{steps} {stiffness}");
        }
    }
}

#[test]
fn the_contact_limit_of_long_delays_is_that_of_the_continuous_law() {
    let (delay, continuous) = (0.1, |delay: f64| core::f64::consts::FRAC_PI_2 * DAMPING / (delay + 0.5 * DT));
    assert!((contact_stiffness_limit(DAMPING, delay, DT) / continuous(delay) - 1.0).abs() < 1e-4);
    assert!(contact_stiffness_limit(DAMPING, DT, DT) < continuous(DT));
}

proptest! {
    #[test]
    fn no_force_within_its_bound_leads_beyond_the_largest_offset(
        steps in vec((30.0_f64..400.0, 5.0_f64..100.0, -20.0_f64..20.0), 1..300),
    ) {
        let largest = largest_offset(steps.iter().map(|&(k, d, _)| (k, d)), 20.0, DT);
        prop_assert!(largest <= 20.0 / 30.0);
        let mut offset = 0.0;
        for &(stiffness, damping, force) in &steps {
            offset = step_offset(offset, stiffness, damping, force, DT);
            prop_assert!(offset.abs() <= largest * (1.0 + 1e-12));
        }
    }
}

/// Each step spends less than the last digit of the energy that is left.
#[test]
fn what_a_slow_motion_spends_is_booked_in_single_precision_too() {
    let books = |capacity: f32, steps: u32| {
        let tank = EnergyTank::new(capacity, 0.0, 1.0, 100.0).unwrap();
        let mut energy = tank.full();
        let spend = 0.9 * f64::from(capacity) / f64::from(steps);
        (0..steps).for_each(|_| tank.book(&mut energy, -spend as f32));
        f64::from(capacity - energy.level()) / (0.9 * f64::from(capacity))
    };
    for (capacity, steps) in [(4.1, 1000), (4.1, 20_000_000), (0.5, 20_000_000), (1e6, 20_000_000)] {
        let share = books(capacity, steps);
        assert!((share - 1.0).abs() < 1e-5, "{share} of what was spent is booked, {capacity} J in {steps} steps");
    }
}
