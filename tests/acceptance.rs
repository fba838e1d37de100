//! What the shipped tasks promise, for every seed from 1 to 10, within 12 000 motions: here for the first of them, in
//! `.ci/long` for all.
//!
//! `HPF_SEEDS=10 cargo test --release --test e2e acceptance -- --nocapture` prints every measure.

use core::ops::RangeInclusive;
use std::env;

use serde_json::Value;

use crate::support::{Columns, expect, folder, json, metric, task};

/// As many as `HPF_SEEDS` says.
fn seeds() -> RangeInclusive<u32> {
    1..=env::var("HPF_SEEDS").map_or(2, |count| count.parse().expect("HPF_SEEDS is a number"))
}

/// Learns a shipped task with every seed; hands over each summary and trajectory, and prints the table of measures.
fn each_seed(name: &str, check: impl Fn(&Value, &Columns)) {
    let folder = folder();
    let mut summaries = Vec::new();
    for seed in seeds() {
        let out = seed.to_string();
        expect(0, folder.path(), &["learn", &task(name), "--quiet", "--seed", &out, "--out", &out]);
        let summary = json(folder.path().join(&out).join("summary.json"));
        assert!(summary["rollouts_total"].as_u64().unwrap() <= 12_000);
        assert_eq!(summary["rejected_rollouts"], 0);
        check(&summary, &Columns::read(folder.path().join(&out).join("trajectory.csv")));
        summaries.push(summary);
    }
    let mut table = format!("{name}, {} seeds, {} motions each\n", summaries.len(), summaries[0]["rollouts_total"]);
    for measure in summaries[0]["metrics"].as_array().unwrap() {
        let name = measure["name"].as_str().unwrap();
        let mut values: Vec<f64> = summaries.iter().map(|summary| metric(summary, name)).collect();
        values.sort_by(f64::total_cmp);
        let (half, last) = (values.len() / 2, values.len() - 1);
        let median = 0.5 * (values[half] + values[last - half]);
        table += &format!(
            "  {name:<18} smallest {:<12.4e} median {median:<12.4e} largest {:<12.4e} {}\n",
            values[0],
            values[last],
            measure["unit"].as_str().unwrap()
        );
    }
    println!("{table}");
}

fn all_within(values: &[f64], bounds: RangeInclusive<f64>) -> bool {
    // A rounded sum of a partition of unity may pass a bound by its last bits.
    values.iter().all(|value| *value >= bounds.start() * (1.0 - 1e-12) && *value <= bounds.end() * (1.0 + 1e-12))
}

fn cantilever(name: &str) {
    each_seed(name, |summary, trajectory| {
        // Of the movement: the rest time has a measure of its own.
        let movement = &trajectory.column("deviation_m")[..=500];
        let worst = movement.iter().fold(0.0, |most: f64, deviation| most.max(deviation.abs()));
        assert!(worst <= 0.02e-3, "deviation {worst}");
        assert_eq!(worst, metric(summary, "max_deviation"));
        assert!(trajectory.column("contact_force_n").iter().all(|force| *force > 0.0), "contact is lost");
        assert!(metric(summary, "max_force_error") <= 0.2);
        assert!(metric(summary, "max_rest_error") <= 2e-3);
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
        assert!(metric(summary, "max_rest_error") <= 2e-3);
        // 0.70 without the price of rest; stiffness that rises to its bound before the end is most of the rest.
        assert!(summary["cost"]["final"]["total"].as_f64().unwrap() <= 1.1);
        for axis in ["x", "y"] {
            let stiffness = trajectory.column(&format!("{axis}_stiffness_n_m"));
            assert!(all_within(&stiffness, 30.0..=400.0));
            assert!(all_within(&trajectory.column(&format!("{axis}_damping_n_s_m")), 10.0..=100.0));
            // The paper's Figure 5: softer throughout the first second than at the via point (2.5 s) and at the end.
            let first_second = stiffness[..=100].iter().copied().fold(0.0, f64::max);
            let (via, end) = (stiffness[250], stiffness[500]);
            assert!(first_second < via && first_second < end, "{axis}: {first_second}, then {via} and {end}");
            let peak = (150..350).max_by(|i, j| stiffness[*i].total_cmp(&stiffness[*j])).unwrap();
            assert!((200..250).contains(&peak), "{axis}: stiffness peaks at {} s", peak as f64 / 100.0);
            // The paper's Figure 6 shows damping rising late; here it falls, which docs/reproduction.md says.
            let damping = trajectory.column(&format!("{axis}_damping_n_s_m"));
            let late = damping[350..=500].iter().copied().fold(0.0, f64::max);
            // Rest is paid for by a little of it: measured up to 12.9 N s/m, 11.9 without its price.
            assert!(late < 14.0 && late < damping[..250].iter().copied().fold(0.0, f64::max), "{axis}: {late}");
        }
    });
}

#[test]
fn the_smallest_task_meets_its_target() {
    each_seed("reach.toml", |summary, _| assert!(metric(summary, "max_goal_error") <= 5e-3));
}
