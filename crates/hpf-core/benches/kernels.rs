//! What a step costs, in single and in double precision: `cargo bench -p hpf-core`.

use core::hint::black_box;

use criterion::Criterion;
use hpf_core::admittance::{Inertial, OffsetMotion, step_offset};
use hpf_core::controller::{Controller, Input, Request, Settings};
use hpf_core::limits::Limits;
use hpf_core::passivity::EnergyTank;
use hpf_core::{AxisPrimitives, Basis, Gain, HybridPrimitive, Movement, Phase, Real, Transition};

const N: usize = 20;

/// The two families of basis functions.
#[derive(Clone, Copy, Debug)]
enum Family {
    Phase,
    Time,
}

fn basis<T: Real>(family: Family) -> Basis<T, [T; N]> {
    let (decay, overlap, room) = (T::of(4.605_17), T::of(0.6), [T::ZERO; N]);
    match family {
        Family::Phase => Basis::equally_spaced(decay, overlap, room, room),
        Family::Time => Basis::equally_spaced_in_time(decay, overlap, room, room),
    }
    .unwrap()
}

fn skill<T: Real, const D: usize>(family: Family) -> HybridPrimitive<T, [T; N], D> {
    let list = |scale: f64, offset: f64| core::array::from_fn(|i| T::of(offset + scale * (i as f64).sin()));
    let axis = AxisPrimitives {
        movement: Movement::new(T::ZERO, T::ONE, T::of(25.0), T::ONE, list(50.0, 0.0)).unwrap(),
        stiffness: Gain::new(T::of(30.0), T::of(400.0), list(150.0, 200.0)).unwrap(),
        damping: Gain::new(T::of(10.0), T::of(100.0), list(30.0, 50.0)).unwrap(),
    };
    HybridPrimitive::new(Phase::new(T::of(2.0), T::of(4.605_17)).unwrap(), [basis(family); 3], [axis; D]).unwrap()
}

/// A thousand phases along a movement: the cost of an exponential depends on its argument.
fn phases<T: Real>() -> impl Iterator<Item = T> {
    (0..1000).map(|i| T::of((-4.605_17e-3 * f64::from(i)).exp())).collect::<Vec<T>>().into_iter().cycle()
}

/// A controller in full swing, first order, with tank and filter on, far from every limit.
fn controller<T: Real + PartialOrd, const D: usize>(family: Family) -> Controller<T, [T; N], D> {
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

fn input<T: Real, const D: usize>() -> Input<T, D> {
    Input { measured_force: [T::of(5.0); D], force_age: 0, measured_position: None, rate: T::ONE, request: None }
}

/// One update along the first two seconds of a movement, then again.
fn updates<T: Real + PartialOrd, const D: usize>(criterion: &mut Criterion, scalar: &str, family: Family) {
    criterion.bench_function(
        &format!("{scalar}/{family:?}/controller update, {D} axes x 20 functions x 3"),
        |bencher| {
            let start = controller::<T, D>(family);
            let (mut arm, mut tick, input, dt) = (start, 0, input(), T::of(1e-3));
            bencher.iter(|| {
                tick += 1;
                if tick == 2000 {
                    (arm, tick) = (start, 0);
                }
                arm.update(black_box(&input), black_box(dt)).axes
            });
        },
    );
}

fn families<T: Real + PartialOrd>(criterion: &mut Criterion, scalar: &str, family: Family) {
    let dt = T::of(1e-3);
    let skill = skill::<T, 2>(family);
    let (basis, mut along) = (basis::<T>(family), phases::<T>());
    let movements = skill.axes().each_ref().map(|axis| axis.movement.weights());
    criterion.bench_function(&format!("{scalar}/{family:?}/basis mix, 20 functions, 1 list"), |bencher| {
        bencher.iter(|| basis.mix(along.next().unwrap(), [movements[0]]));
    });

    criterion.bench_function(&format!("{scalar}/{family:?}/movement step, 2 axes x 20 functions"), |bencher| {
        let mut states = skill.axes().each_ref().map(|axis| axis.movement.initial_state());
        bencher.iter(|| {
            let s = along.next().unwrap();
            let mixed = basis.mix(s, movements);
            let transition = Transition::new(skill.axes()[0].movement.alpha(), black_box(dt));
            for ((state, axis), mixed) in states.iter_mut().zip(skill.axes()).zip(mixed) {
                transition.apply(state, axis.movement.goal(), axis.movement.forcing(s, mixed));
            }
            states
        });
    });

    criterion.bench_function(&format!("{scalar}/{family:?}/skill step, 2 axes x 20 functions x 3"), |bencher| {
        let mut state = skill.initial_state();
        let mut along = phases::<T>();
        bencher.iter(|| {
            state.phase = along.next().unwrap();
            skill.step(&mut state, black_box([T::of(5.0); 2]), black_box(T::ONE), black_box(dt))
        });
    });

    updates::<T, 2>(criterion, scalar, family);
    updates::<T, 6>(criterion, scalar, family);
}

fn kernels<T: Real + PartialOrd>(criterion: &mut Criterion, scalar: &str) {
    for family in [Family::Phase, Family::Time] {
        families::<T>(criterion, scalar, family);
    }
    let dt = T::of(1e-3);

    criterion.bench_function(&format!("{scalar}/offset step"), |bencher| {
        let mut offset = T::ZERO;
        let (stiffness, damping, force) = black_box((T::of(100.0), T::of(50.0), T::of(10.0)));
        bencher.iter(|| {
            offset = step_offset(offset, stiffness, damping, force, black_box(dt));
            offset
        });
    });

    criterion.bench_function(&format!("{scalar}/offset step with inertia"), |bencher| {
        let law = Inertial::new(T::of(2.0), T::of(400.0), T::of(100.0), T::of(0.01)).unwrap();
        let mut motion = OffsetMotion { offset: T::ZERO, velocity: T::ZERO };
        let (stiffness, damping, force) = black_box((T::of(100.0), T::of(50.0), T::of(10.0)));
        bencher.iter(|| {
            law.step(&mut motion, stiffness, damping, force, black_box(dt));
            motion
        });
    });
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    kernels::<f64>(&mut criterion, "f64");
    kernels::<f32>(&mut criterion, "f32");
    criterion.final_summary();
}
