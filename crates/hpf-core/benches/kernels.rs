//! What a step costs, in single and in double precision: `cargo bench -p hpf-core`.

use core::hint::black_box;

use criterion::Criterion;
use hpf_core::admittance::step_offset;
use hpf_core::{AxisPrimitives, Basis, Gain, HybridPrimitive, Movement, Phase, Real, Transition};

const N: usize = 20;

fn basis<T: Real>() -> Basis<T, [T; N]> {
    Basis::equally_spaced(T::of(4.605_17), T::of(0.6), [T::ZERO; N], [T::ZERO; N]).unwrap()
}

fn skill<T: Real>() -> HybridPrimitive<T, [T; N], 2> {
    let list = |scale: f64, offset: f64| core::array::from_fn(|i| T::of(offset + scale * (i as f64).sin()));
    let axis = AxisPrimitives {
        movement: Movement::new(T::ZERO, T::ONE, T::of(25.0), T::ONE, list(50.0, 0.0)).unwrap(),
        stiffness: Gain::new(T::of(30.0), T::of(400.0), list(150.0, 200.0)).unwrap(),
        damping: Gain::new(T::of(10.0), T::of(100.0), list(30.0, 50.0)).unwrap(),
    };
    HybridPrimitive::new(Phase::new(T::of(2.0), T::of(4.605_17)).unwrap(), [basis(); 3], [axis; 2]).unwrap()
}

/// A thousand phases along a movement: the cost of an exponential depends on its argument.
fn phases<T: Real>() -> impl Iterator<Item = T> {
    (0..1000).map(|i| T::of((-4.605_17e-3 * f64::from(i)).exp())).collect::<Vec<T>>().into_iter().cycle()
}

fn kernels<T: Real>(criterion: &mut Criterion, scalar: &str) {
    let skill = skill::<T>();
    let dt = T::of(1e-3);

    let (basis, mut along) = (basis::<T>(), phases::<T>());
    let movements = skill.axes().each_ref().map(|axis| axis.movement.weights());
    criterion.bench_function(&format!("{scalar}/basis mix, 20 functions, 1 list"), |bencher| {
        bencher.iter(|| basis.mix(along.next().unwrap(), [movements[0]]));
    });

    criterion.bench_function(&format!("{scalar}/movement step, 2 axes x 20 functions"), |bencher| {
        let mut states = skill.axes().each_ref().map(|axis| axis.movement.initial_state());
        bencher.iter(|| {
            let s = along.next().unwrap();
            let mixed = basis.mix(s, movements);
            for ((state, axis), mixed) in states.iter_mut().zip(skill.axes()).zip(mixed) {
                let transition = Transition::new(axis.movement.alpha(), black_box(dt));
                transition.apply(state, axis.movement.goal(), axis.movement.forcing(s, mixed));
            }
            states
        });
    });

    criterion.bench_function(&format!("{scalar}/skill step, 2 axes x 20 functions x 3 primitives"), |bencher| {
        let mut state = skill.initial_state();
        let mut along = phases::<T>();
        bencher.iter(|| {
            state.phase = along.next().unwrap();
            skill.step(&mut state, black_box([T::of(5.0); 2]), black_box(T::ONE), black_box(dt))
        });
    });

    criterion.bench_function(&format!("{scalar}/offset step"), |bencher| {
        let mut offset = T::ZERO;
        let (stiffness, damping, force) = black_box((T::of(100.0), T::of(50.0), T::of(10.0)));
        bencher.iter(|| {
            offset = step_offset(offset, stiffness, damping, force, black_box(dt));
            offset
        });
    });
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    kernels::<f64>(&mut criterion, "f64");
    kernels::<f32>(&mut criterion, "f32");
    criterion.final_summary();
}
