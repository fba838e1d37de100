//! The skill and the controller that every measurement of cost runs.

use hpf_core::controller::{Controller, Input, Request, Settings};
use hpf_core::limits::Limits;
use hpf_core::passivity::EnergyTank;
use hpf_core::{AxisPrimitives, Basis, Gain, HybridPrimitive, Law, Movement, Phase, Real};

pub const N: usize = 20;

/// The two families of basis functions.
#[derive(Clone, Copy, Debug)]
pub enum Family {
    Phase,
    Time,
}

pub fn basis<T: Real>(family: Family) -> Basis<T, [T; N]> {
    let (decay, overlap, room) = (T::of(4.605_17), T::of(0.6), [T::ZERO; N]);
    match family {
        Family::Phase => Basis::equally_spaced(decay, overlap, room, room),
        Family::Time => Basis::equally_spaced_in_time(decay, overlap, room, room),
    }
    .unwrap()
}

pub fn skill<T: Real, const D: usize>(family: Family) -> HybridPrimitive<T, [T; N], D> {
    let list = |scale: f64, offset: f64| core::array::from_fn(|i| T::of(offset + scale * (i as f64).sin()));
    let axis = AxisPrimitives {
        movement: Movement::new(T::ZERO, T::ONE, T::of(25.0), T::ONE, list(50.0, 0.0)).unwrap(),
        stiffness: Gain::new(T::of(30.0), T::of(400.0), list(150.0, 200.0)).unwrap(),
        damping: Gain::new(T::of(10.0), T::of(100.0), list(30.0, 50.0)).unwrap(),
        law: Law::FirstOrder,
    };
    HybridPrimitive::new(Phase::new(T::of(2.0), T::of(4.605_17)).unwrap(), [basis(family); 3], [axis; D]).unwrap()
}

/// A controller in full swing, first order, with tank and filter on, far from every limit.
pub fn controller<T: Real + PartialOrd, const D: usize>(family: Family) -> Controller<T, [T; N], D> {
    let limits = Limits {
        force: T::of(50.0),
        offset: T::of(0.3),
        velocity: T::of(5.0),
        acceleration: T::of(500.0),
        position: [T::of(-10.0), T::of(10.0)],
    };
    let mut settings = Settings::compliant([limits; D]);
    settings.conditioning.cutoff = Some(T::of(100.0));
    settings.conditioning.dead_zone = [T::of(0.5); D];
    settings.tank = Some(EnergyTank::new(T::of(10.0), T::ZERO, T::ONE, T::of(1e3)).unwrap());
    let mut controller = Controller::new(skill(family), settings, [T::ZERO; D]).unwrap();
    let request = Some(Request::Start);
    controller.update(&Input { request, ..input() }, T::of(1e-3));
    controller
}

pub fn input<T: Real, const D: usize>() -> Input<T, D> {
    Input { measured_force: [T::of(5.0); D], force_age: 0, measured_position: None, rate: T::ONE, request: None }
}
