//! A skill and settings that the tests of the controller share.
#![allow(dead_code, reason = "each test binary uses a part of it")]

use hpf_core::controller::{Controller, Input, Output, Request, Settings};
use hpf_core::limits::Limits;
use hpf_core::{AxisPrimitives, Basis, Damping, Gain, HybridPrimitive, Law, Movement, Phase, Real};

pub const N: usize = 8;
pub const DT: f64 = 1e-3;

/// The two families of basis functions.
#[derive(Clone, Copy, Debug)]
pub enum Family {
    Phase,
    Time,
}

impl Family {
    pub const ALL: [Self; 2] = [Self::Phase, Self::Time];
}

/// Of what kind a skill is.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub family: Family,
    pub law: Law<f64>,
}

impl From<Family> for Kind {
    fn from(family: Family) -> Self {
        Self { family, law: Law::FirstOrder }
    }
}

pub fn skill<T: Real, const D: usize>(kind: impl Into<Kind>, duration: f64) -> HybridPrimitive<T, [T; N], D> {
    let Kind { family, law } = kind.into();
    let law = match law {
        Law::FirstOrder => Law::FirstOrder,
        Law::SecondOrder { mass, damping } => Law::SecondOrder {
            mass: T::of(mass),
            damping: match damping {
                Damping::Primitive => Damping::Primitive,
                Damping::Ratio { ratio, floor } => Damping::Ratio { ratio: T::of(ratio), floor: T::of(floor) },
            },
        },
    };
    let decay = T::of(4.605_17);
    let (overlap, room) = (T::of(0.6), [T::ZERO; N]);
    let basis = match family {
        Family::Phase => Basis::equally_spaced(decay, overlap, room, room).unwrap(),
        Family::Time => Basis::equally_spaced_in_time(decay, overlap, room, room).unwrap(),
    };
    let list = |f: &dyn Fn(f64) -> f64| core::array::from_fn(|i| T::of(f(i as f64 / (N - 1) as f64)));
    let axes = core::array::from_fn(|axis| {
        let goal = 0.3 - 0.1 * axis as f64;
        AxisPrimitives {
            movement: Movement::new(
                T::ZERO,
                T::of(goal),
                T::of(25.0),
                T::of(goal),
                list(&|t| 60.0 * (6.0 * t + axis as f64).sin()),
            )
            .unwrap(),
            stiffness: Gain::new(T::of(30.0), T::of(400.0), list(&|t| 60.0 + 300.0 * t * t)).unwrap(),
            damping: Gain::new(T::of(10.0), T::of(100.0), list(&|t| 30.0 + 40.0 * t)).unwrap(),
            law,
        }
    });
    HybridPrimitive::new(Phase::new(T::of(duration), decay).unwrap(), [basis; 3], axes).unwrap()
}

pub fn settings<T: Real + PartialOrd, const D: usize>() -> Settings<T, D> {
    let limits = Limits {
        force: T::of(50.0),
        offset: T::of(0.15),
        velocity: T::of(0.8),
        acceleration: T::of(20.0),
        position: [T::of(-0.4), T::of(0.5)],
    };
    let mut settings = Settings::compliant([limits; D]);
    for axis in &mut settings.axes {
        (axis.trip_force, axis.tracking) = (T::of(80.0), T::of(0.05));
    }
    settings.timing.ramp = T::of(0.1);
    settings
}

pub fn input<T: Real, const D: usize>(force: [f64; D]) -> Input<T, D> {
    Input { measured_force: force.map(T::of), force_age: 0, measured_position: None, rate: T::ONE, request: None }
}

/// A controller and the shortest ways to drive it.
pub struct Rig<T, const D: usize> {
    pub controller: Controller<T, [T; N], D>,
    pub input: Input<T, D>,
    pub dt: f64,
}

impl<T: Real + PartialOrd, const D: usize> Rig<T, D> {
    pub fn new(kind: impl Into<Kind>, settings: Settings<T, D>, duration: f64) -> Self {
        let controller = Controller::new(skill(kind, duration), settings, [T::ZERO; D]).unwrap();
        Self { controller, input: input([0.0; D]), dt: DT }
    }

    pub fn started(kind: impl Into<Kind>, settings: Settings<T, D>, duration: f64) -> Self {
        let mut rig = Self::new(kind, settings, duration);
        rig.ask(Request::Start);
        rig
    }

    pub fn step(&mut self) -> Output<T, D> {
        self.controller.update(&self.input, T::of(self.dt))
    }

    pub fn ask(&mut self, request: Request<T, D>) -> Output<T, D> {
        self.input.request = Some(request);
        let output = self.step();
        self.input.request = None;
        output
    }

    pub fn run(&mut self, seconds: f64) -> Output<T, D> {
        for _ in 1..(seconds / self.dt).round() as usize {
            self.step();
        }
        self.step()
    }
}
