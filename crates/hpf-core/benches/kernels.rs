//! What a step costs, in single and in double precision: `cargo bench -p hpf-core`.

mod common;

use core::hint::black_box;

use common::{Family, basis, controller, input, skill};
use criterion::Criterion;
use hpf_core::admittance::{Inertial, OffsetMotion, step_coupled, step_offset};
use hpf_core::orientation::{step_rotation, step_rotation_coupled};
use hpf_core::{Real, Symmetric, Transition};

/// A thousand phases along a movement: the cost of an exponential depends on its argument.
fn phases<T: Real>() -> impl Iterator<Item = T> {
    (0..1000).map(|i| T::of((-4.605_17e-3 * f64::from(i)).exp())).collect::<Vec<T>>().into_iter().cycle()
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
                // By reference: returning it would be timed as another copy.
                black_box(&arm.update(black_box(&input), black_box(dt)));
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

/// Offsets of three axes with directions, and of an orientation.
fn directions<T: Real>(criterion: &mut Criterion, scalar: &str) {
    let matrix = |numbers: [f64; 6]| Symmetric::of(numbers.map(T::of));
    let stiffness = matrix([123.0, 150.5, 52.6, 298.0, 44.2, 129.0]);
    let damping = matrix([58.0, -4.9, 43.6, 37.3, 7.3, 54.6]);
    let (force, dt) = ([1.0, -2.0, 0.5].map(T::of), T::of(1e-3));

    criterion.bench_function(&format!("{scalar}/offset step, 3 axes with directions"), |bencher| {
        let mut offset = [T::ZERO; 3];
        bencher.iter(|| {
            offset = step_coupled(offset, black_box(&stiffness), black_box(&damping), force, black_box(dt));
            offset
        });
    });

    criterion.bench_function(&format!("{scalar}/rotation step"), |bencher| {
        let mut offset = [T::ZERO; 3];
        let (stiffness, damping) = black_box(([20.0, 5.0, 10.0].map(T::of), [2.0, 1.0, 1.5].map(T::of)));
        bencher.iter(|| {
            offset = step_rotation(offset, stiffness, damping, force, black_box(dt)).offset;
            offset
        });
    });

    criterion.bench_function(&format!("{scalar}/rotation step with directions"), |bencher| {
        let mut offset = [T::ZERO; 3];
        bencher.iter(|| {
            offset =
                step_rotation_coupled(offset, black_box(&stiffness), black_box(&damping), force, black_box(dt)).offset;
            offset
        });
    });
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    kernels::<f64>(&mut criterion, "f64");
    kernels::<f32>(&mut criterion, "f32");
    directions::<f64>(&mut criterion, "f64");
    directions::<f32>(&mut criterion, "f32");
    criterion.final_summary();
}
