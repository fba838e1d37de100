//! Wrenches between frames and points, and the weight of a tool at any orientation.

use hpf_core::conditioning::TareWindow;
use hpf_core::rotation::{Quaternion, left_jacobian, times};
use hpf_core::wrench::{ToolLoad, Wrench, WrenchSensor};

const GRAVITY: [f64; 3] = [0.3, -0.2, -9.8]; // a base that does not stand level

fn gap(a: &Wrench<f64>, b: &Wrench<f64>) -> f64 {
    a.numbers().iter().zip(b.numbers()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn power_is_the_same_about_every_point_and_in_every_frame() {
    let wrench: Wrench<f64> = Wrench::of([3.0, -2.0, 7.0, 0.4, 0.9, -1.3]);
    let (velocity, turning) = ([0.2, 0.1, -0.4], [1.0, -2.0, 0.5]);
    let arm = [0.1, 0.25, -0.3];
    // The new point is at -arm of the old one: v' = v + w x (-arm).
    let cross = hpf_core::rotation::cross(turning, arm);
    let moved = [0, 1, 2].map(|i| velocity[i] - cross[i]);
    let there = wrench.about(arm);
    assert!((there.power(moved, turning) - wrench.power(velocity, turning)).abs() < 1e-14);
    let q = Quaternion::exp([0.7, -1.1, 2.0]);
    let turned = wrench.turned(&q);
    assert!((turned.power(q.turn(velocity), q.turn(turning)) - wrench.power(velocity, turning)).abs() < 1e-14);
    assert!(gap(&turned.turned_back(&q), &wrench) < 1e-14);
    assert!(gap(&there.about(arm.map(|part: f64| -part)), &wrench) < 1e-15);
}

#[test]
fn a_weight_does_the_work_that_lifting_it_takes() {
    // m g . (path of the center) while the sensor turns about its own origin, by small steps.
    let (mass, center) = (1.7, [0.02, -0.05, 0.12]);
    let load = ToolLoad::new(mass, center).unwrap();
    let path = |t: f64| [0.4 * t, 1.0 - t * t, 2.0 * t];
    let rate = |t: f64| [0.4, -2.0 * t, 2.0];
    let steps = 2000;
    let dt = 1.0 / f64::from(steps);
    let mut work = 0.0;
    for i in 0..steps {
        let t = (f64::from(i) + 0.5) * dt;
        let q = Quaternion::exp(path(t));
        let base = load.weight(&q, GRAVITY).turned(&q);
        work += base.power([0.0; 3], times(&left_jacobian(path(t)), rate(t))) * dt;
    }
    let height = |t: f64| {
        let at = Quaternion::exp(path(t)).turn(center);
        (0..3).map(|i| GRAVITY[i] * at[i]).sum::<f64>()
    };
    let expected = mass * (height(1.0) - height(0.0));
    assert!((work - expected).abs() < 1e-6, "{work} {expected}"); // midpoint rule: dt^2 = 2.5e-7
}

#[test]
fn a_tare_at_one_orientation_holds_at_every_other() {
    let load = ToolLoad::new(0.8, [0.01, 0.03, 0.1]).unwrap();
    let drift = Wrench::of([0.5, -1.0, 2.0, 0.02, -0.03, 0.01]);
    let reading = |q: &Quaternion<f64>, touch: &Wrench<f64>| {
        let weight = load.weight(q, GRAVITY).numbers();
        let (drift, touch) = (drift.numbers(), touch.turned_back(q).numbers());
        Wrench::of(core::array::from_fn(|i| weight[i] + drift[i] + touch[i]))
    };
    let mut sensor = WrenchSensor { load, bias: Wrench::NONE };
    let first = Quaternion::exp([0.2, -0.9, 1.4]);
    // The window of the controller's tare takes the six numbers.
    let mut window = TareWindow::<f64, 6>::default();
    for _ in 0..1000 {
        let compensated = sensor.compensated(&reading(&first, &Wrench::NONE), &first, GRAVITY);
        window.observe(compensated.numbers(), [50.0; 6], 1e-3);
    }
    sensor.tare(&Wrench::of(window.mean().expect("a reading that stands still")));
    let touch = Wrench::of([4.0, 0.0, -3.0, 0.1, 0.2, 0.3]);
    for i in 0..50 {
        let q = Quaternion::exp([0.1 * f64::from(i), 0.05 * f64::from(i), -0.07 * f64::from(i)]);
        let found = sensor.compensated(&reading(&q, &touch), &q, GRAVITY).turned(&q);
        assert!(gap(&found, &touch) < 1e-13, "{found:?}");
    }
}

#[test]
fn tares_add_up() {
    let mut sensor = WrenchSensor { load: ToolLoad::new(0.0, [0.0; 3]).unwrap(), bias: Wrench::NONE };
    sensor.tare(&Wrench::of([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    sensor.tare(&Wrench::of([1.0; 6]));
    assert_eq!(sensor.bias.numbers(), [2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
}

#[test]
fn a_load_that_cannot_be_is_refused_by_name() {
    let refused = |mass, center| ToolLoad::new(mass, center).unwrap_err().to_string();
    assert_eq!(refused(-1.0, [0.0; 3]), "tool.mass must lie in [0, 1000000000], not -1");
    assert_eq!(refused(1.0, [0.0, f64::NAN, 0.0]), "tool.center is not a finite number");
}
