//! The signals of a rollout: their squares are its cost, term by term nothing left out.

use hpf_learn::{Cost, Parameters, Problem};
use hpf_sim::{Policy, Simulation, Task};

const TASKS: [(&str, &str); 4] = [
    ("via_point", include_str!("../../../tasks/via_point.toml")),
    ("cantilever", include_str!("../../../tasks/cantilever.toml")),
    ("cantilever_moving_load", include_str!("../../../tasks/cantilever_moving_load.toml")),
    ("reach", include_str!("../../../tasks/reach.toml")),
];

/// Numbers in [-1, 1) that depend on `index` alone.
fn scatter(index: usize) -> f64 {
    let mixed = (index as u64).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[test]
fn squares_of_the_signals_and_the_price_of_the_weights_are_the_cost() {
    for (name, text) in TASKS {
        let task = Task::parse(text).unwrap();
        let policy = Policy::initial(&task).unwrap();
        let simulation = Simulation::new(&task, &policy).unwrap();
        let model = simulation.signals().expect("a simulation measures its signals");
        let mut trace = simulation.workspace();
        for draw in 0..10 {
            let mut weights = policy.weights();
            let mut start = 0;
            for block in simulation.blocks() {
                for weight in &mut weights[start..start + block.count] {
                    start += 1;
                    *weight = (*weight + 2.0 * block.noise * scatter(1000 * draw + start)).clamp(block.min, block.max);
                }
            }
            let (mut cost, mut signals) = (Cost::default(), Vec::new());
            simulation.measure(Parameters::Constant(&weights), &mut trace, &mut cost, &mut signals);
            let mut total = 0.5 * signals.iter().map(|rho| rho * rho).sum::<f64>();
            start = 0;
            for (block, price) in simulation.blocks().iter().zip(&model.price) {
                let own = &weights[start..start + block.count];
                for (row, weight) in price.chunks_exact(block.count).zip(own) {
                    total += 0.5 * weight * row.iter().zip(own).map(|(q, w)| q * w).sum::<f64>();
                }
                start += block.count;
            }
            // Two sums of some thousand squares, in another order.
            assert!((total - cost.total()).abs() < 1e-12 * total, "{name}: {total} {}", cost.total());
            assert_eq!(signals.len(), model.groups.last().unwrap().signals.end);
            assert_eq!(weights.len(), model.groups.last().unwrap().parameters.end);
        }
    }
}

#[test]
fn an_axis_answers_for_its_own_signals() {
    let task = Task::parse(TASKS[0].1).unwrap();
    let policy = Policy::initial(&task).unwrap();
    let simulation = Simulation::new(&task, &policy).unwrap();
    let model = simulation.signals().unwrap();
    let measured = |weights: &[f64]| {
        let (mut cost, mut signals) = (Cost::default(), Vec::new());
        simulation.measure(Parameters::Constant(weights), &mut simulation.workspace(), &mut cost, &mut signals);
        signals
    };
    let before = measured(&policy.weights());
    for (a, group) in model.groups.iter().enumerate() {
        let mut weights = policy.weights();
        weights[group.parameters.clone()].iter_mut().for_each(|w| *w += 1.0);
        let after = measured(&weights);
        for (b, other) in model.groups.iter().enumerate() {
            assert_eq!(a == b, before[other.signals.clone()] != after[other.signals.clone()], "axis {a} on axis {b}");
        }
    }
}
