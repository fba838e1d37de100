//! The figures of the paper, by their numbers, and what spreads over seeds.

use super::study::{Study, Variant};
use hpf::figure::{Drawing, Group, Member, figures as of_run, sweep_cost};
use hpf::trial::Trial;

/// Number in the paper, name among the figures of a run, and whose run.
const NUMBERED: [(usize, &str, Variant); 11] = [
    (2, "disturbance", Variant::ViaPoint),
    (3, "cost", Variant::ViaPoint),
    (4, "path", Variant::ViaPoint),
    (5, "stiffness", Variant::ViaPoint),
    (6, "damping", Variant::ViaPoint),
    (7, "beam", Variant::Cantilever),
    (8, "cost", Variant::Cantilever),
    (9, "stiffness", Variant::Cantilever),
    (10, "damping", Variant::Cantilever),
    (11, "path", Variant::Cantilever),
    (12, "deviation", Variant::Cantilever),
];

/// The paper's figures and the contact force, from the first seed.
pub fn of_first_seed(study: &Study) -> Vec<Drawing<'_>> {
    let of = |variant: Variant, name: &str, file: String| {
        let drawings = of_run(&study.first(variant).1.run);
        let found = drawings.into_iter().find(|drawing| drawing.name == name);
        found.map(|drawing| Drawing { name: file, ..drawing })
    };
    let numbered =
        NUMBERED.iter().filter_map(|(number, name, variant)| of(*variant, name, format!("figure_{number:02}_{name}")));
    let mut drawings: Vec<Drawing<'_>> = numbered.collect();
    drawings.extend(of(Variant::Cantilever, "contact_force", "more_contact_force".into()));
    drawings
}

/// The cost over all seeds.
pub fn over_seeds(study: &Study) -> Vec<Drawing<'_>> {
    let seeds = |shown: &'static [(Variant, &'static str)]| {
        move || {
            let group = |(variant, name): &(Variant, &str)| Group {
                name: (*name).to_owned(),
                short: (*name).to_owned(),
                members: study.of(*variant).map(member).collect(),
            };
            sweep_cost(&shown.iter().map(group).collect::<Vec<_>>())
        }
    };
    let first = seeds(&[
        (Variant::ViaPoint, "PI2, as shipped"),
        (Variant::PaperPi2, "PI2, as written, no rest"),
        (Variant::Signals, "from signals, no rest"),
    ]);
    let second = seeds(&[(Variant::Cantilever, "paper's curve"), (Variant::MovingLoad, "physical curve")]);
    vec![Drawing::new("more_cost_task_1", first), Drawing::new("more_cost_task_2", second)]
}

fn member(trial: &Trial) -> Member {
    let costs = trial.run.learning.iter().map(|row| (row.rollouts as f64, row.total)).collect();
    Member { costs, measures: Vec::new() }
}
