//! The energy at the physical port, on a robot that lags and a force that is late and biased. The true work is this
//! test's own sum of true force times true displacement, over steps far finer than the controller's.

use crate::support::{Family, Kind, skill};
use hpf_core::controller::{Compliance, Controller, Input, Mode, Output, Request, Settings};
use hpf_core::limits::Limits;
use hpf_core::passivity::{EnergyTank, Port};
use hpf_core::{Damping, Law};

const DT: f64 = 1e-3;
const FINE: usize = 20;
const CAPACITY: f64 = 0.5;
const RESERVE: f64 = 0.1;
const TRIP: f64 = 80.0;

/// Half a kilogram behind the sensor.
const CHATTER: Environment =
    Environment::Block { mass: 0.5, stiffness: 10_000.0, damping: 5.0, ground: 0.0, position: 1e-3, velocity: 0.0 };

/// What the tool meets.
#[derive(Clone, Copy, Debug)]
enum Environment {
    /// A surface of `stiffness` [N/m] about `place` [m] that swings by `swing` [m] at 1 Hz.
    Surface { stiffness: f64, place: f64, swing: f64 },
    /// A mass on a spring and damper to the tool, and on a spring to the ground.
    Block { mass: f64, stiffness: f64, damping: f64, ground: f64, position: f64, velocity: f64 },
    /// A push of `force` [N], alone.
    Push { force: f64, hertz: f64 },
    /// `force` [N] that turns against the motion once it has helped: late readings say that it still helps.
    Turncoat { force: f64, patience: usize, since: usize, sign: f64 },
    /// `force` [N] against every motion of the tool.
    Brake { force: f64 },
    /// The same with `brake` [N] until `at` [s], then a push of `push` [N] that swings once in four seconds.
    Exhaust { brake: f64, push: f64, at: f64 },
}

impl Environment {
    /// The force on a tool at `x` moving at `v` [N], `h` [s] later.
    fn force(&mut self, x: f64, v: f64, time: f64, h: f64) -> f64 {
        match self {
            Self::Surface { stiffness, place, swing } => {
                let surface = *place + *swing * (core::f64::consts::TAU * time).sin();
                -*stiffness * (x - surface).max(0.0)
            }
            Self::Block { mass, stiffness, damping, ground, position, velocity } => {
                let force = *stiffness * (*position - x) + *damping * (*velocity - v);
                *velocity -= (force + *ground * *position) / *mass * h;
                *position += *velocity * h;
                force
            }
            Self::Push { force, hertz } => *force * (core::f64::consts::TAU * *hertz * time).sin(),
            Self::Turncoat { force, sign, .. } => *force * *sign,
            Self::Brake { force } => -*force * (v / 1e-3).clamp(-1.0, 1.0),
            Self::Exhaust { brake, push, at } => {
                let turn = core::f64::consts::FRAC_PI_2 * (time - *at);
                if time < *at { -*brake * (v / 1e-3).clamp(-1.0, 1.0) } else { *push * turn.sin() }
            }
        }
    }

    /// Once a step.
    fn think(&mut self, output: &Output<f64, 1>) {
        if let Self::Turncoat { patience, since, sign, .. } = self {
            *since += 1;
            // It has pushed for a while, the controller moves: against it.
            if *since > *patience && output.axes[0].velocity * *sign > 0.0 {
                (*since, *sign) = (0, -*sign);
            }
        }
    }
}

const LAWS: [Law<f64>; 2] = [Law::FirstOrder, Law::SecondOrder { mass: 1.0, damping: Damping::Primitive }];

fn settings(compliance: Compliance<f64>, port: Option<Port<f64, 1>>) -> Settings<f64, 1> {
    let limits = Limits { force: 50.0, offset: 0.4, velocity: 2.0, acceleration: 200.0, position: [-1.0, 1.0] };
    let mut settings = Settings::compliant([limits]);
    settings.axes[0].compliance = compliance;
    (settings.axes[0].trip_force, settings.axes[0].tracking) = (TRIP, 10.0);
    settings.tank = Some(EnergyTank::new(CAPACITY, RESERVE, 0.9, 1e3).unwrap());
    settings.port = port;
    settings
}

/// The sensor and the robot.
#[derive(Clone, Copy, Debug)]
struct Plant {
    /// The robot's time constant [s].
    lag: f64,
    /// The delay of the force [steps].
    delay: usize,
    bias: f64,
}

/// What has come of a run.
#[derive(Debug)]
struct Found {
    /// The least true work of the environment since the start [J].
    least: f64,
    work: f64,
    /// The least energy in the tank's books of commands, and in those of the port [J].
    energy: f64,
    port_energy: f64,
    /// The largest true force [N], and how far the tool has travelled [m].
    force: f64,
    travelled: f64,
    last: Output<f64, 1>,
}

fn run(law: Law<f64>, settings: Settings<f64, 1>, plant: Plant, mut environment: Environment, seconds: f64) -> Found {
    let mut controller = Controller::new(skill(Kind { family: Family::Time, law }, 2.0), settings, [0.0]).unwrap();
    let mut found = Found {
        least: 0.0,
        work: 0.0,
        energy: f64::MAX,
        port_energy: f64::MAX,
        force: 0.0,
        travelled: 0.0,
        last: controller.output(),
    };
    let (mut x, mut v) = (0.0_f64, 0.0_f64);
    let h = DT / FINE as f64;
    let mut force = environment.force(x, v, 0.0, h);
    let mut seen = vec![force; plant.delay + 1];
    for i in 0..(seconds / DT) as usize {
        seen.rotate_right(1);
        seen[0] = force;
        let input = Input {
            measured_force: [seen[plant.delay] + plant.bias],
            force_age: 0,
            measured_position: Some([x]),
            rate: 1.0,
            request: (i == 0).then_some(Request::Start),
        };
        let output = controller.update(&input, DT);
        environment.think(&output);
        for fine in 0..FINE {
            let gap = output.axes[0].position - x;
            let moved = if plant.lag > 0.0 { gap * -(-h / plant.lag).exp_m1() } else { gap / (FINE - fine) as f64 };
            (x, v) = (x + moved, moved / h);
            let next = environment.force(x, v, i as f64 * DT + fine as f64 * h, h);
            found.work += 0.5 * (force + next) * moved;
            found.travelled += moved.abs();
            force = next;
            found.least = found.least.min(found.work);
            found.force = found.force.max(force.abs());
        }
        found.energy = found.energy.min(output.energy);
        found.port_energy = found.port_energy.min(output.port_energy);
        found.last = output;
    }
    found
}

fn environments() -> Vec<Environment> {
    let block = |mass, stiffness, damping, ground, position| Environment::Block {
        mass,
        stiffness,
        damping,
        ground,
        position,
        velocity: 0.0,
    };
    let mut all = vec![
        Environment::Surface { stiffness: 500.0, place: 0.05, swing: 0.0 },
        Environment::Surface { stiffness: 2000.0, place: 0.1, swing: 0.0 },
        Environment::Surface { stiffness: 1000.0, place: 0.05, swing: 0.02 },
        block(0.5, 3000.0, 5.0, 0.0, 0.02),
        block(0.5, 3000.0, 20.0, 200.0, 0.02),
        block(2.0, 1000.0, 2.0, 100.0, 0.04),
        Environment::Push { force: 30.0, hertz: 1.0 },
        Environment::Push { force: 30.0, hertz: 10.0 },
        Environment::Push { force: 30.0, hertz: 60.0 },
        Environment::Brake { force: 20.0 },
        CHATTER,
    ];
    all.extend([1, 3, 8, 20, 100].map(|patience| Environment::Turncoat { force: 30.0, patience, since: 0, sign: 1.0 }));
    all
}

/// A robot that follows evenly over a step, or lags; a force that is late by up to 5 steps and 2 N off.
const PLANTS: [Plant; 8] = [
    Plant { lag: 0.0, delay: 0, bias: 0.0 },
    Plant { lag: 0.0, delay: 2, bias: 2.0 },
    Plant { lag: 5e-3, delay: 0, bias: 2.0 },
    Plant { lag: 5e-3, delay: 1, bias: 0.0 },
    Plant { lag: 5e-3, delay: 3, bias: -2.0 },
    Plant { lag: 5e-3, delay: 4, bias: 2.0 },
    Plant { lag: 5e-3, delay: 5, bias: 2.0 },
    Plant { lag: 0.02, delay: 5, bias: -2.0 },
];

/// A robot that closes its gap only in the steps that tell no time, against a force that is there only then: what is
/// read in them is booked like any other reading.
#[test]
fn steps_of_no_time_are_booked() {
    for (delay, every) in [(0, 5), (3, 5), (0, 2)] {
        let settings = settings(Compliance::Compliant, Some(Port { force_delay: delay as u32, force_bias: [0.0] }));
        let kind = Kind { family: Family::Time, law: Law::FirstOrder };
        let mut controller = Controller::new(skill(kind, 2.0), settings, [0.0]).unwrap();
        let (mut x, mut work, mut least, mut travelled) = (0.0, 0.0, 0.0_f64, 0.0);
        let mut seen = vec![0.0; delay + 1];
        let mut force = 0.0;
        for n in 0..30_000 {
            seen.rotate_right(1);
            seen[0] = force;
            let input = Input {
                measured_force: [seen[delay]],
                force_age: 0,
                measured_position: Some([x]),
                rate: 1.0,
                request: (n == 0).then_some(Request::Start),
            };
            let dt = if n % every == every - 1 { [0.0, f64::NAN, -1.0][n / every % 3] } else { DT };
            let output = controller.update(&input, dt);
            let position = output.axes[0].position;
            let moved = if n % every == every - 1 { position - x } else { 0.0 };
            let swing = 30.0 * (n as f64 * 0.004).sin();
            let next = if n % every == every - 2 { -0.98 * TRIP * (position - x).signum() } else { swing };
            work += moved * if moved == 0.0 { 0.0 } else { force };
            (x, force) = (x + moved, next);
            travelled += f64::abs(moved);
            least = least.min(work);
        }
        assert!(least >= -CAPACITY - 1e-9, "{least} J with a delay of {delay}, every {every}th step");
        assert!(travelled > 1e-3, "{travelled} m");
    }
}

/// The port as the plant is.
fn declared(plant: Plant) -> Option<Port<f64, 1>> {
    Some(Port { force_delay: plant.delay as u32, force_bias: [plant.bias.abs()] })
}

#[test]
fn the_port_gives_no_more_than_the_tank_holds() {
    let (mut runs, mut broken) = (0, 0);
    for law in LAWS {
        for compliance in [Compliance::Compliant, Compliance::Press(20.0), Compliance::Rigid] {
            for environment in environments() {
                for plant in PLANTS {
                    let found = run(law, settings(compliance, declared(plant)), plant, environment, 4.0);
                    let case = format!("{law:?}, {compliance:?}, {environment:?}, {plant:?}: {found:?}");
                    assert!(found.force <= TRIP, "{case}");
                    assert!(found.least >= -CAPACITY - 1e-3, "{case}");
                    let without = run(law, settings(compliance, None), plant, environment, 4.0);
                    runs += 1;
                    broken += usize::from(without.least < -CAPACITY);
                }
            }
        }
    }
    println!("{broken} of {runs} runs break the bound without the port, none with it");
    assert!(3 * broken > runs, "{broken} of {runs}");
}

#[test]
fn a_chattering_block_is_paid_for() {
    // Books of commands see nothing of it: most is still in the tank while the block takes joules.
    let block = CHATTER;
    let plant = Plant { lag: 5e-3, delay: 5, bias: 0.0 };
    let blind = run(LAWS[0], settings(Compliance::Compliant, None), plant, block, 10.0);
    assert!(blind.least < -100.0 && blind.energy > 0.5 * CAPACITY, "{blind:?}");
    let seen = run(LAWS[0], settings(Compliance::Compliant, declared(plant)), plant, block, 10.0);
    assert!(seen.least >= -CAPACITY - 1e-3 && seen.force <= TRIP, "{seen:?}");
}

#[test]
fn a_delay_and_a_bias_that_are_less_than_declared_keep_the_bound() {
    let port = Some(Port { force_delay: 5, force_bias: [2.0] });
    for environment in environments() {
        for delay in [0, 2, 4] {
            for bias in [-1.0, 0.0, 2.0] {
                let plant = Plant { lag: 5e-3, delay, bias };
                let found = run(LAWS[0], settings(Compliance::Press(20.0), port), plant, environment, 4.0);
                assert!(found.least >= -CAPACITY - 1e-3, "{environment:?}, {plant:?}: {found:?}");
            }
        }
    }
}

#[test]
fn a_tool_that_may_not_spend_can_still_be_pushed() {
    let plant = Plant { lag: 5e-3, delay: 2, bias: 0.0 };
    let environment = Environment::Exhaust { brake: 20.0, push: 20.0, at: 6.0 };
    let found = run(LAWS[0], settings(Compliance::Compliant, declared(plant)), plant, environment, 12.0);
    assert!(found.port_energy < RESERVE, "{found:?}");
    assert!(found.work > 1.0 && found.travelled > 0.1, "{found:?}");
}

#[test]
fn without_a_measured_position_nothing_moves_and_nonsense_is_refused() {
    let port = Port { force_delay: 2, force_bias: [0.5] };
    let good = settings(Compliance::Compliant, Some(port));
    let mut controller = Controller::new(skill::<f64, 1>(Family::Time, 2.0), good, [0.1]).unwrap();
    let mut input = crate::support::input([10.0]);
    input.request = Some(Request::Start);
    for _ in 0..500 {
        let output = controller.update(&input, DT);
        assert_eq!((output.axes[0].position, output.port_energy), (0.1, CAPACITY));
        input.request = None;
    }
    for (port, text) in [
        (Port { force_delay: 7, ..port }, "port.force_delay must lie in [0, 6], not 7"),
        (Port { force_bias: [-1.0], ..port }, "port.force_bias must lie in [0, 1000000000], not -1"),
        (Port { force_bias: [f64::NAN], ..port }, "port.force_bias is not a finite number"),
    ] {
        let refusal = controller.set(Settings { port: Some(port), ..good }).unwrap_err();
        assert_eq!(refusal.to_string(), text);
    }
    let refusal = controller.set(Settings { tank: None, ..good }).unwrap_err();
    assert_eq!(refusal.to_string(), "tank.capacity of a port must be positive, not 0");
    // One that is added later starts empty, like a tank.
    controller.set(Settings { port: None, ..good }).unwrap();
    controller.set(good).unwrap();
    assert_eq!(controller.update(&input, DT).port_energy, 0.0);
}

#[test]
fn what_has_not_started_stays_where_it_is_wherever_the_robot_is() {
    let port = Port { force_delay: 2, force_bias: [0.5] };
    // A stop, a force above its trip level, and a start that trips in its own step.
    for (request, force) in [(Request::Stop, 0.0), (Request::Tare, 1.5 * TRIP), (Request::Start, 1.5 * TRIP)] {
        let good = settings(Compliance::Compliant, Some(port));
        let skill = skill::<f64, 1>(Kind { family: Family::Time, law: LAWS[0] }, 2.0);
        let mut controller = Controller::new(skill, good, [0.1]).unwrap();
        let mut input = crate::support::input([force]);
        (input.request, input.measured_position) = (Some(request), Some([0.06]));
        for _ in 0..500 {
            let output = controller.update(&input, DT);
            assert_eq!((output.axes[0].position, output.mode), (0.1, Mode::Stop), "{request:?}");
            input.request = None;
        }
    }
}
