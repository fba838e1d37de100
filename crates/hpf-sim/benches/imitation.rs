//! `cargo bench -p hpf-sim --bench imitation`: fitting a policy to one demonstration.

use core::f64::consts::PI;
use core::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use hpf_sim::demonstration::{Fit, Outline};
use hpf_sim::{Demonstration, Imitation, Task};

fn benches(criterion: &mut Criterion) {
    let rows: String = (0..500)
        .map(|i| {
            let t = f64::from(i) / 499.0;
            let s = t * t * t * (10.0 - t * (15.0 - 6.0 * t));
            format!(
                "{},{},{}\n",
                5.0 * t,
                0.1 + s + 0.25 * (PI * s).sin().powi(2),
                -0.5 * s + 0.4 * (2.0 * PI * s).sin()
            )
        })
        .collect();
    let text = format!("time_s,x_m,y_m\n{rows}");
    let demonstrations = [Demonstration::parse(&text).expect("the table is right")];
    let outline = Outline { via_points: 0, ..Outline::default() };
    let task = Task::parse(&outline.write(&demonstrations)).expect("the task is right");
    let mut group = criterion.benchmark_group("500 samples, 2 axes, 20 functions");
    for (name, fit) in [("ridge", Fit::Ridge), ("locally weighted", Fit::LocallyWeighted)] {
        let imitation = Imitation { fit, ..Imitation::default() };
        group.bench_function(name, |bencher| {
            bencher.iter(|| imitation.of(black_box(&demonstrations), &task).expect("the demonstration is right"));
        });
    }
    group.bench_function("reading the table", |bencher| {
        bencher.iter(|| Demonstration::parse(black_box(&text)).expect("the table is right"));
    });
    group.finish();
}

criterion_group!(imitation, benches);
criterion_main!(imitation);
