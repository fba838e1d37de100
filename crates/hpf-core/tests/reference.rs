//! Stored numbers of another implementation of the same equations; `data/README.md` says whose and how they were made.

use hpf_core::{AxisPrimitives, Basis, Gain, HybridPrimitive, Law, Movement, Phase, Real};
use serde_json::Value;

const N: usize = 20;

fn constants() -> Value {
    serde_json::from_str(include_str!("data/reference.json")).unwrap()
}

fn list(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn table(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect()
}

fn basis(constants: &Value) -> Basis<f64, Vec<f64>> {
    let number = |name: &str| constants[name].as_f64().unwrap();
    Basis::equally_spaced(number("decay"), number("overlap"), vec![0.0; N], vec![0.0; N]).unwrap()
}

#[test]
fn centers_and_widths_agree() {
    let constants = constants();
    let basis = basis(&constants);
    for (ours, theirs) in basis.centers().iter().zip(list(&constants["centers"])) {
        assert!((ours - theirs).abs() < 1e-15, "{ours} {theirs}");
    }
    for (ours, theirs) in basis.widths().iter().zip(list(&constants["widths"])) {
        // Relative: the difference of two close centers, squared.
        assert!((ours / theirs - 1.0).abs() < 1e-13, "{ours} {theirs}");
    }
}

#[test]
fn features_and_forcing_agree() {
    let constants = constants();
    let basis = basis(&constants);
    let phase = Phase::new(1.0, constants["decay"].as_f64().unwrap()).unwrap();
    let mut features = [0.0; N];
    for row in table(include_str!("data/features.csv")) {
        let s = phase.at(row[0]).s;
        basis.features_into(s, &mut features);
        for (phi, theirs) in features.iter().zip(&row[1..]) {
            assert!((s * phi - theirs).abs() < 1e-12, "{phi} {theirs} at {}", row[0]);
        }
        for weights in constants["weights"].as_array().unwrap().iter().map(list) {
            let theirs: f64 = weights.iter().zip(&row[1..]).map(|(w, feature)| w * feature).sum();
            let movement = Movement::new(0.0, 1.0, 25.0, 1.0, weights).unwrap();
            let [mixed] = basis.mix(s, [movement.weights()]);
            // Weights are as large as 2e3: 1e-12 of that.
            assert!((movement.forcing(s, mixed) - theirs).abs() < 2e-9, "{mixed} {theirs} at {}", row[0]);
        }
    }
}

#[test]
fn stored_centers_and_widths_make_the_same_basis() {
    let constants = constants();
    let stored = Basis::new(list(&constants["centers"]), list(&constants["widths"])).unwrap();
    let [ours] = basis(&constants).mix(0.3, [&list(&constants["weights"][0])]);
    let [theirs] = stored.mix(0.3, [&list(&constants["weights"][0])]);
    assert!((ours - theirs).abs() < 1e-11, "{ours} {theirs}"); // 1e-13 in the widths, weights of 300
}

/// One of the stored cases, walked axis by axis through the whole skill.
struct Case {
    duration: f64,
    goal: &'static str,
    rollout: &'static str,
}

const CASES: [Case; 3] = [
    Case { duration: 1.0, goal: "goal", rollout: include_str!("data/rollout_demo_goal.csv") },
    Case { duration: 1.0, goal: "new_goal", rollout: include_str!("data/rollout_new_goal.csv") },
    Case { duration: 2.0, goal: "goal", rollout: include_str!("data/rollout_tau2.csv") },
];

/// Positions and velocities `[y0, y1, y0', y1']` at every stored time stamp but the first, `finer` steps to each.
fn rollout<T: Real>(case: &Case, finer: usize) -> Vec<[f64; 4]> {
    let constants = constants();
    let narrow = |values: Vec<f64>| values.into_iter().map(T::of).collect::<Vec<T>>();
    let number = |name: &str| T::of(constants[name].as_f64().unwrap());
    let basis =
        || Basis::equally_spaced(number("decay"), number("overlap"), vec![T::ZERO; N], vec![T::ZERO; N]).unwrap();
    let axes = [0, 1].map(|i| {
        let at = |name: &str| T::of(constants[name][i].as_f64().unwrap());
        AxisPrimitives {
            movement: Movement::new(
                at("start"),
                at(case.goal),
                number("alpha"),
                T::ONE,
                narrow(list(&constants["weights"][i])),
            )
            .unwrap(),
            stiffness: Gain::new(T::ONE, T::ONE, vec![T::ONE; N]).unwrap(),
            damping: Gain::new(T::ONE, T::ONE, vec![T::ONE; N]).unwrap(),
            law: Law::FirstOrder,
        }
    });
    let phase = Phase::new(T::of(case.duration), number("decay")).unwrap();
    let skill = HybridPrimitive::new(phase, [basis(), basis(), basis()], axes).unwrap();
    let samples = (case.duration * 256.0) as usize;
    let dt = T::of(1.0 / 256.0 / finer as f64);
    let mut state = skill.initial_state();
    (0..samples)
        .map(|_| {
            let mut commands = skill.step(&mut state, [T::ZERO; 2], T::ONE, dt);
            for _ in 1..finer {
                commands = skill.step(&mut state, [T::ZERO; 2], T::ONE, dt);
            }
            let [x, y] = commands;
            [x.position, y.position, x.velocity, y.velocity].map(T::to_f64)
        })
        .collect()
}

/// The largest distance of positions and of velocities.
fn distance(ours: &[[f64; 4]], theirs: &[[f64; 4]]) -> [f64; 2] {
    assert_eq!(ours.len(), theirs.len());
    let gap = |columns: [usize; 2]| {
        let gaps = ours.iter().zip(theirs).flat_map(|(a, b)| columns.map(|i| (a[i] - b[i]).abs()));
        gaps.fold(0.0, f64::max)
    };
    [gap([0, 1]), gap([2, 3])]
}

#[test]
fn rollouts_converge_to_the_exact_solution_in_second_order() {
    for case in &CASES {
        let theirs: Vec<[f64; 4]> =
            table(case.rollout).into_iter().skip(1).map(|row| row[1..].try_into().unwrap()).collect();
        let errors = [1, 2, 4, 8].map(|finer| distance(&rollout::<f64>(case, finer), &theirs));
        // Measured at dt = 2^-8 s: 3.0e-5 m and 2.0e-3 m/s in one second, an eighth of the velocity's and a quarter
        // of the position's in two, for |F| up to 156 and speeds up to 5.6 m/s.
        let [position, velocity] = errors[0];
        let seconds = case.duration;
        assert!(position * seconds.powi(2) < 3.1e-5 && velocity * seconds.powi(3) < 2.1e-3, "{errors:?}");
        for pair in errors.windows(2) {
            for (coarse, fine) in pair[0].iter().zip(pair[1]) {
                assert!((coarse / fine / 4.0 - 1.0).abs() < 0.05, "{errors:?}");
            }
        }
    }
}

#[test]
fn single_precision_is_close_to_double() {
    for case in &CASES {
        let gap = distance(&rollout::<f32>(case, 1), &rollout::<f64>(case, 1));
        // Measured: 4.8e-6 m and 2.9e-5 m/s over the 512 steps of two seconds, a fifth and a quarter of that over 256.
        // The integration error at this step, 3e-5 m and 2e-3 m/s in one second, hides it.
        assert!(gap[0] < 6e-6 && gap[1] < 4e-5, "{gap:?}");
    }
}
