//! `trajectory.csv` against the continuous-time equations, solved from `policy.json` and the numbers of the task alone.

use hpf_sim::Policy;

use crate::solver::{Load, beam, distance, moving_load, solve, swing, tip_load};
use crate::support::{Columns, expect, folder, read, task};

/// The largest distance of each axis' tool in the files from the solution of the equations [m].
fn distances(name: &str, load: &Load) -> Vec<f64> {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task(name), "--quiet", "--out", "run"]);
    let policy = Policy::parse(&read(folder.path().join("run/policy.json"))).unwrap();
    let trajectory = Columns::read(folder.path().join("run/trajectory.csv"));
    let distances = policy.axes.iter().map(|axis| {
        let position = trajectory.column(&format!("{}_position_m", axis.name));
        let found = distance(&position, &solve(&policy, axis, load, 500, 10), 2);
        println!("{name}, axis {}: {found:.1e} m from the continuous equations", axis.name);
        found
    });
    distances.collect()
}

#[test]
fn the_cantilever_tables_hold_the_solution_of_the_equations() {
    for (name, stiffness) in
        [("cantilever.toml", tip_load as fn(f64) -> f64), ("cantilever_moving_load.toml", moving_load)]
    {
        // The error of a step of 10 ms, measured 2.3e-7 and 2.9e-7 m.
        assert!(distances(name, &beam(stiffness)).iter().all(|distance| *distance < 1e-6));
    }
}

#[test]
fn the_via_point_table_holds_the_solution_of_the_equations() {
    // The error of a step of 10 ms: 0.016 mm of a metre at the largest stiffness that is learned.
    assert!(distances("via_point.toml", &swing()).iter().all(|distance| *distance < 2.5e-5));
}
