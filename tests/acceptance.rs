//! What the shipped tasks promise, for every seed from 1 to 10, within 12 000 motions.

use std::ops::RangeInclusive;

use serde_json::Value;

use crate::support::{Columns, expect, folder, json, metric, task};

const SEEDS: RangeInclusive<u32> = 1..=10;

/// Learns a shipped task with every seed; hands over each summary and trajectory.
fn each_seed(name: &str, check: impl Fn(&Value, &Columns)) {
    let folder = folder();
    for seed in SEEDS {
        let out = seed.to_string();
        expect(0, folder.path(), &["learn", &task(name), "--quiet", "--seed", &out, "--out", &out]);
        let summary = json(folder.path().join(&out).join("summary.json"));
        assert!(summary["rollouts_total"].as_u64().unwrap() <= 12_000);
        assert_eq!(summary["rejected_rollouts"], 0);
        check(&summary, &Columns::read(folder.path().join(&out).join("trajectory.csv")));
    }
}

fn all_within(values: &[f64], bounds: RangeInclusive<f64>) -> bool {
    // A rounded sum of a partition of unity may pass a bound by its last bits.
    values.iter().all(|value| *value >= bounds.start() * (1.0 - 1e-12) && *value <= bounds.end() * (1.0 + 1e-12))
}

fn cantilever(name: &str) {
    each_seed(name, |summary, trajectory| {
        let worst = trajectory.column("deviation_m").iter().fold(0.0, |most: f64, deviation| most.max(deviation.abs()));
        assert!(worst <= 0.02e-3, "deviation {worst}");
        assert_eq!(worst, metric(summary, "max_deviation"));
        assert!(trajectory.column("contact_force_n").iter().all(|force| *force > 0.0), "contact is lost");
        assert!(metric(summary, "max_force_error") <= 0.2);
        assert!(all_within(&trajectory.column("y_stiffness_n_m"), 30.0..=400.0));
        assert!(all_within(&trajectory.column("y_damping_n_s_m"), 10.0..=100.0));
    });
}

#[test]
fn the_cantilever_on_the_papers_curve_is_followed_within_a_fiftieth_of_a_millimetre() {
    cantilever("cantilever.toml");
}

#[test]
fn the_cantilever_on_the_physical_curve_is_followed_within_a_fiftieth_of_a_millimetre() {
    cantilever("cantilever_moving_load.toml");
}

#[test]
fn the_via_point_is_met_softly_first_and_stiffly_where_it_matters() {
    each_seed("via_point.toml", |summary, trajectory| {
        assert!(metric(summary, "max_via_error") <= 0.5e-3);
        assert!(metric(summary, "max_goal_error") <= 0.7e-3);
        assert!(metric(summary, "max_end_speed") <= 0.05);
        assert!(summary["cost"]["final"]["total"].as_f64().unwrap() <= 0.70);
        for axis in ["x", "y"] {
            let stiffness = trajectory.column(&format!("{axis}_stiffness_n_m"));
            assert!(all_within(&stiffness, 30.0..=400.0));
            assert!(all_within(&trajectory.column(&format!("{axis}_damping_n_s_m")), 10.0..=100.0));
            // The paper's Figure 5: softer throughout the first second than at the via point (2.5 s) and at the end.
            let first_second = stiffness[..=100].iter().copied().fold(0.0, f64::max);
            let mean = stiffness[..=100].iter().sum::<f64>() / 101.0;
            assert!(mean < stiffness[250] && mean < stiffness[500], "{axis}: {mean} {first_second} {} {}", stiffness[250], stiffness[500]);
        }
    });
}

#[test]
fn the_smallest_task_meets_its_target() {
    each_seed("reach.toml", |summary, _| assert!(metric(summary, "max_goal_error") <= 5e-3));
}
