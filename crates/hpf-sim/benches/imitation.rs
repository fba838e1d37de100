//! `cargo bench -p hpf-sim --bench imitation`: fitting a policy to one demonstration.

use core::f64::consts::PI;
use core::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use hpf_sim::demonstration::{Fit, Outline, RecordedAxis};
use hpf_sim::task::Unit;
use hpf_sim::{Demonstration, Imitation, Task};

fn benches(criterion: &mut Criterion) {
    let share = |i: i32| f64::from(i) / 499.0;
    let smooth = |t: f64| t * t * t * (10.0 - t * (15.0 - 6.0 * t));
    let axis = |name: &str, path: &dyn Fn(f64) -> f64| RecordedAxis {
        name: name.into(),
        unit: Unit::M,
        position: (0..500).map(|i| path(smooth(share(i)))).collect(),
        reference: None,
        stiffness: None,
        damping: None,
        force: None,
        emg: None,
    };
    let x = axis("x", &|s| 0.1 + s + 0.25 * (PI * s).sin().powi(2));
    let y = axis("y", &|s| -0.5 * s + 0.4 * (2.0 * PI * s).sin());
    let demonstrations = [Demonstration { time: (0..500).map(|i| 5.0 * share(i)).collect(), axes: vec![x, y] }];
    let outline = Outline { via_points: 0, ..Outline::default() };
    let task = Task::parse(&outline.write(&demonstrations)).expect("the task is right");
    let mut group = criterion.benchmark_group("500 samples, 2 axes, 20 functions");
    for (name, fit) in [("ridge", Fit::Ridge), ("locally weighted", Fit::LocallyWeighted)] {
        let imitation = Imitation { fit, ..Imitation::default() };
        group.bench_function(name, |bencher| {
            bencher.iter(|| imitation.of(black_box(&demonstrations), &task).expect("the demonstration is right"));
        });
    }
    group.finish();
}

criterion_group!(imitation, benches);
criterion_main!(imitation);
