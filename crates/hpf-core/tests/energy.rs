//! What a controller with a tank may give: `sum f dx >= -(capacity - reserve)` from rest, by this test's own sums.

use crate::support::{Family, Kind, N, input};
use hpf_core::controller::{Compliance, Controller, Output, Request, Settings};
use hpf_core::limits::Limits;
use hpf_core::passivity::EnergyTank;
use hpf_core::{AxisPrimitives, Basis, Damping, Gain, HybridPrimitive, Law, Movement, Phase, Real};

/// Limits that nothing here reaches.
const WIDE: Limits<f64> =
    Limits { force: 100.0, offset: 5.0, velocity: 100.0, acceleration: 1e6, position: [-20.0, 20.0] };

const LAWS: [Law<f64>; 3] = [
    Law::FirstOrder,
    Law::SecondOrder { mass: 2.0, damping: Damping::Primitive },
    Law::SecondOrder { mass: 0.3, damping: Damping::Ratio { ratio: 0.3, floor: 1.0 } },
];

const COMPLIANCES: [Compliance<f64>; 4] =
    [Compliance::Compliant, Compliance::Press(20.0), Compliance::Press(40.0), Compliance::Press(-40.0)];

const STEPS: [f64; 3] = [1e-3, 2e-3, 1e-2];

/// A skill of 1.5 s under `law`.
fn skill<const D: usize>(law: Law<f64>) -> HybridPrimitive<f64, [f64; N], D> {
    crate::support::skill(Kind { family: Family::Time, law }, 1.5)
}

fn settings<const D: usize>(compliance: Compliance<f64>, tank: EnergyTank<f64>) -> Settings<f64, D> {
    let mut settings = Settings::compliant([WIDE; D]);
    for axis in &mut settings.axes {
        (axis.compliance, axis.trip_force) = (compliance, 1e6);
    }
    settings.tank = Some(tank);
    settings
}

fn tank(capacity: f64, reserve: f64, refill: f64) -> EnergyTank<f64> {
    EnergyTank::new(capacity, reserve, refill, 1e3).unwrap()
}

/// A controller that has just started, and the sum of `f dx` over all axes since then.
struct Books<const D: usize> {
    controller: Controller<f64, [f64; N], D>,
    dt: f64,
    work: f64,
    least: f64,
    hits: usize,
}

impl<const D: usize> Books<D> {
    fn new(skill: HybridPrimitive<f64, [f64; N], D>, settings: Settings<f64, D>, dt: f64) -> Self {
        let mut controller = Controller::new(skill, settings, [0.0; D]).unwrap();
        let mut first = input([0.0; D]);
        first.request = Some(Request::Start);
        controller.update(&first, dt);
        Self { controller, dt, work: 0.0, least: 0.0, hits: 0 }
    }

    fn step(&mut self, force: [f64; D]) -> Output<f64, D> {
        let before = self.controller.output();
        let output = self.controller.update(&input(force), self.dt);
        for (axis, before) in output.axes.iter().zip(&before.axes) {
            self.work += axis.force * (axis.position - before.position);
            self.hits += usize::from(axis.hits.any_motion());
        }
        self.least = self.least.min(self.work);
        output
    }
}

/// A number in [0, 1) that looks like chance.
fn chance(i: usize) -> f64 {
    let mut z = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z >> 11) as f64 / (1_u64 << 53) as f64
}

/// The force [N] at a step, from the set-point [N] and from what the environment sees of the controller.
type Taker = fn(usize, f64, &Output<f64, 1>) -> f64;

/// Environments that take what they can get.
const TAKERS: [Taker; 6] = [
    // Leans against the set-point while there is energy, then lets go.
    |_, press, last| if last.energy > 0.0 { -0.8 * press } else { 0.0 },
    // The same, but lets itself be pressed harder and harder.
    |i, press, last| if last.energy > 0.0 { -press * (0.5 + 0.5 * chance(i)) } else { press },
    // Always against the motion.
    |_, _, last| -20.0 * last.axes[0].velocity.signum(),
    // Lets the soft tool be pulled out, and takes back what the stiff one gives.
    |i, _, last| if i % 700 < 350 { 8.0 } else { 0.9 * last.axes[0].stiffness * last.axes[0].offset },
    // A surface that swings.
    |i, press, last| {
        let surface = 0.05 * press.signum() * (1.0 + (i as f64 * 0.02).sin());
        let depth = (last.axes[0].position - surface) * press.signum();
        -500.0 * depth.max(0.0) * press.signum()
    },
    // Anything.
    |i, _, _| 60.0 * (chance(i / 7) - 0.5),
];

#[test]
fn the_environment_never_gets_more_than_the_tank_can_spend() {
    for law in LAWS {
        for compliance in COMPLIANCES {
            for (capacity, reserve, refill) in [(0.01, 0.0, 1.0), (0.1, 0.02, 0.5), (0.1, 0.0, 1.0), (0.5, 0.1, 0.9)] {
                for dt in STEPS {
                    for (taker, force) in TAKERS.iter().enumerate() {
                        let tank = tank(capacity, reserve, refill);
                        let mut books = Books::new(skill(law), settings(compliance, tank), dt);
                        let press = if let Compliance::Press(press) = compliance { press } else { 20.0 };
                        for i in 0..3000 {
                            let last = books.controller.output();
                            let output = books.step([force(i, press, &last)]);
                            assert!(output.energy >= reserve - 1e-12, "{output:?}");
                        }
                        let case = format!("{law:?}, {compliance:?}, {capacity} J, dt {dt}, taker {taker}");
                        assert_eq!(books.hits, 0, "{case}");
                        assert!(books.least >= -(capacity - reserve) - 1e-9, "{} J: {case}", books.least);
                    }
                }
            }
        }
    }
}

#[test]
fn several_pressing_axes_share_one_tank() {
    for law in LAWS {
        for dt in STEPS {
            let settings = settings(Compliance::Press(30.0), tank(0.1, 0.0, 1.0));
            let mut books = Books::<3>::new(skill(law), settings, dt);
            for i in 0..3000 {
                let last = books.controller.output();
                books.step(core::array::from_fn(|axis| match axis {
                    0 => -24.0,
                    1 => -20.0 * last.axes[axis].velocity.signum(),
                    _ => 60.0 * (chance(i / 5) - 0.5),
                }));
            }
            assert_eq!(books.hits, 0);
            assert!(books.least >= -0.1 - 1e-9, "{} J: {law:?}, dt {dt}", books.least);
        }
    }
}

#[test]
fn new_settings_in_flight_make_no_energy() {
    for law in LAWS {
        for dt in STEPS {
            for (capacity, reserve) in [(0.01, 0.0), (0.1, 0.02), (0.5, 0.0)] {
                let tank = tank(capacity, reserve, 0.9);
                let mut books = Books::new(skill(law), settings(COMPLIANCES[0], tank), dt);
                for i in 0..4000 {
                    if i % 13 == 0 {
                        let compliance = COMPLIANCES[i / 13 % COMPLIANCES.len()];
                        books.controller.set(settings(compliance, tank)).unwrap();
                    }
                    let last = books.controller.output();
                    let output = books.step([TAKERS[i / 500 % TAKERS.len()](i, 20.0, &last)]);
                    assert!(output.energy >= reserve - 1e-12, "{output:?}");
                }
                assert_eq!(books.hits, 0);
                let least = books.least;
                assert!(least >= -(capacity - reserve) - 1e-9, "{least} J: {law:?}, {capacity} J, dt {dt}");
            }
        }
    }
}

/// A tool that is to stay at zero.
fn still(law: Law<f64>) -> HybridPrimitive<f64, [f64; N], 1> {
    let basis = Basis::equally_spaced(4.605_17, 0.6, [0.0; N], [0.0; N]).unwrap();
    let axis = AxisPrimitives {
        movement: Movement::new(0.0, 0.0, 25.0, 0.0, [0.0; N]).unwrap(),
        stiffness: Gain::new(30.0, 400.0, [100.0; N]).unwrap(),
        damping: Gain::new(10.0, 100.0, [40.0; N]).unwrap(),
        law,
    };
    HybridPrimitive::new(Phase::new(1.0, 4.605_17).unwrap(), [basis; 3], [axis]).unwrap()
}

/// What a contact has seen.
#[derive(Debug)]
struct Contact {
    /// Changes of the velocity by more than 20 mm/s from one step to the next, against the change before.
    reversals: usize,
    /// The force at the end, and its spread over the second half [N].
    force: f64,
    spread: f64,
}

/// Presses with 20 N for 20 s on a surface of 2 kN/m at `surface` [m], a function of time.
fn on_a_surface(law: Law<f64>, capacity: f64, empty: bool, dt: f64, surface: impl Fn(f64) -> f64) -> Contact {
    let full = settings::<1>(Compliance::Press(20.0), tank(capacity, 0.0, 0.9));
    let mut first = full;
    if empty {
        // A tank that is added later starts empty.
        (first.tank, first.axes[0].compliance) = (None, Compliance::Compliant);
    }
    let mut books = Books::new(still(law), first, dt);
    books.controller.set(full).unwrap();
    let promised = if empty { 0.0 } else { -capacity };
    assert_eq!(books.controller.output().energy == 0.0, empty);
    let mut contact = Contact { reversals: 0, force: 0.0, spread: 0.0 };
    let (mut last, mut sign, mut position) = (0.0, 0.0, 0.0_f64);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..(20.0 / dt) as usize {
        let time = i as f64 * dt;
        contact.force = 2000.0 * (position - surface(time)).max(0.0);
        let axis = books.step([-contact.force]).axes[0];
        position = axis.position;
        let change = axis.velocity - last;
        last = axis.velocity;
        // The first contact from free flight is a shock by any law.
        contact.reversals += usize::from(time > 1.0 && change.abs() > 0.02 && change * sign < 0.0);
        if time > 10.0 {
            (least, most) = (least.min(contact.force), most.max(contact.force));
        }
        if change != 0.0 {
            sign = change;
        }
    }
    contact.spread = most - least;
    assert!(books.least >= promised - 1e-9, "{} J", books.least);
    contact
}

#[test]
fn a_set_point_is_throttled_and_not_switched() {
    for law in [LAWS[0], LAWS[1]] {
        for dt in [1.25e-4, 1e-3, 2e-3, 1e-2] {
            for capacity in [0.01, 0.05, 0.2, 1.0] {
                for (swing, place) in [(0.0, 0.0), (0.0, 0.02), (1e-3, 0.0), (2e-3, 0.01), (1e-2, 0.0), (5e-2, 0.0)] {
                    let surface = |time: f64| place + swing * (core::f64::consts::PI * time).sin();
                    let contact = on_a_surface(law, capacity, false, dt, surface);
                    let case = format!("{contact:?}: {law:?}, dt {dt}, {capacity} J, {swing} m at {place} m");
                    assert_eq!(contact.reversals, 0, "{case}");
                    assert!(swing > 0.0 || contact.spread < 1e-3, "{case}");
                }
                // An empty tank, pushed back by 4 mm at the start.
                let contact = on_a_surface(law, capacity, true, dt, |_| -0.004);
                let case = format!("{contact:?}: {law:?}, dt {dt}, {capacity} J, empty");
                assert!(contact.reversals == 0 && contact.spread < 1e-3 && contact.force < 8.0, "{case}");
            }
        }
    }
}

#[test]
fn a_full_tank_presses_with_all_of_the_set_point() {
    for law in [LAWS[0], LAWS[1]] {
        let contact = on_a_surface(law, 1.0, false, 1e-3, |_| 0.0);
        assert!((contact.force - 20.0 * 2000.0 / 2100.0).abs() < 1e-6, "{contact:?}");
    }
}

#[test]
fn limits_of_motion_come_first_and_the_books_say_what_they_cost() {
    let limits = Limits { force: 50.0, offset: 0.1, velocity: 0.5, acceleration: 10.0, position: [-0.2, 0.4] };
    let (mut hits, mut overdrawn) = (0, 0.0_f64);
    for law in LAWS {
        for compliance in COMPLIANCES {
            for (capacity, reserve) in [(0.01, 0.0), (0.1, 0.02), (0.5, 0.1)] {
                for dt in STEPS {
                    for force in TAKERS {
                        let mut tight = settings::<1>(compliance, tank(capacity, reserve, 0.9));
                        tight.axes[0].limits = limits;
                        let mut books = Books::new(skill(law), tight, dt);
                        for i in 0..2000 {
                            let last = books.controller.output();
                            let before = books.hits;
                            let output = books.step([force(i, 20.0, &last)]);
                            // The promise with what is left in place of the reserve, whatever was cut.
                            let promised = -(capacity - output.energy) - 1e-9;
                            assert!(books.work >= promised, "{} J: {law:?}, {compliance:?}, dt {dt}", books.work);
                            // What a limit has overdrawn comes back before anything is spent again.
                            if books.hits == before && last.energy < reserve {
                                assert!(output.energy >= last.energy - 1e-12, "{output:?} after {last:?}");
                            }
                        }
                        hits += books.hits;
                        overdrawn = overdrawn.max(-(capacity - reserve) - books.least);
                    }
                }
            }
        }
    }
    println!("{hits} steps were cut; the most that cuts have cost is {overdrawn:.3} J");
    assert!(hits > 100_000, "{hits}");
}

#[test]
fn a_debt_goes_with_its_tank() {
    let limits = Limits { force: 50.0, offset: 0.1, velocity: 0.5, acceleration: 10.0, position: [-0.2, 0.4] };
    let mut indebted = 0;
    for law in LAWS {
        for force in TAKERS {
            let mut tight = settings::<1>(Compliance::Compliant, tank(0.01, 0.0, 0.9));
            tight.axes[0].limits = limits;
            let mut books = Books::new(skill(law), tight, 1e-2);
            for i in 0..2000 {
                let last = books.controller.output();
                if books.step([force(i, 20.0, &last)]).energy < 0.0 {
                    indebted += 1;
                    break;
                }
            }
            books.controller.set(Settings { tank: None, ..tight }).unwrap();
            assert_eq!(books.controller.output().energy, 0.0);
            assert_eq!(books.step([5.0]).energy, 0.0);
            // A tank that is added later starts empty.
            books.controller.set(tight).unwrap();
            assert_eq!(books.controller.output().energy, 0.0);
        }
    }
    assert!(indebted > 2, "{indebted}");
}

/// Forces against the path take all that the tank can spend; rounded, a little more. A set-point that comes then, on an
/// axis at rest, moves it no further than it would with a full tank.
fn a_set_point_never_acts_with_more_than_itself<T: Real + PartialOrd>() {
    let mut state = 1_u64;
    let mut random = |low: f64, high: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let limits = Limits {
        force: T::of(100.0),
        offset: T::of(50.0),
        velocity: T::of(1e4),
        acceleration: T::of(1e8),
        position: [T::of(-1e3), T::of(1e3)],
    };
    for trial in 0..2000 {
        let dt = random(0.05, 0.6);
        let mut settings = Settings::<T, 2>::compliant([limits; 2]);
        settings.axes.iter_mut().for_each(|axis| axis.trip_force = T::of(1e6));
        settings.axes[1].compliance = Compliance::Rigid;
        settings.tank = Some(EnergyTank::new(T::of(random(0.01, 0.1)), T::of(0.01), T::ONE, T::of(1e3)).unwrap());
        (settings.timing.longest_step, settings.timing.ramp) = (T::ONE, T::of(0.02));
        let law = LAWS[trial % LAWS.len()];
        let skill = crate::support::skill::<T, 2>(Kind { family: Family::Time, law }, 20.0);
        let mut controller = Controller::new(skill, settings, [T::ZERO; 2]).unwrap();
        let mut now = input([-90.0, 0.0]);
        now.request = Some(Request::Start);
        for _ in 0..4 {
            controller.update(&now, T::of(dt));
            now.request = None;
        }
        settings.axes[1].compliance = Compliance::Press(T::of(random(-90.0, 90.0)));
        controller.set(settings).unwrap();
        for _ in 0..4 {
            let offset = controller.update(&now, T::of(dt)).axes[1].offset.to_f64();
            // At the least stiffness of the skill, and with the inertia of the least damped law.
            assert!(offset.abs() < 2.0 * 90.0 / 30.0, "trial {trial}: {offset} m");
        }
    }
}

#[test]
fn a_set_point_never_acts_with_more_than_itself_where_nothing_is_left() {
    a_set_point_never_acts_with_more_than_itself::<f64>();
    a_set_point_never_acts_with_more_than_itself::<f32>();
}
