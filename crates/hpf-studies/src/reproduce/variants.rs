//! What comes out where something is done otherwise than the shipped tasks do it.

use super::claims::{Claim, claim, number};
use super::study::{Study, Variant};
use super::words::Worst;
use hpf::trial::Trial;

/// The shipped tasks and what is beside them.
pub fn variants(study: &Study) -> Vec<Claim> {
    let metric = |variant, name| study.metric(variant, name);
    let total = |variant| study.spread(variant, |trial: &Trial| trial.summary.last.0);
    let cost = |variant| number("cost", "", total(variant), Worst::Largest);
    let deviation = |variant| number("deviation at most", "m", metric(variant, "max_deviation"), Worst::Largest);
    let force = |variant| number("force off by at most", "N", metric(variant, "max_force_error"), Worst::Largest);
    let motions = |variant| {
        number("after", "motions", study.spread(variant, |trial: &Trial| trial.summary.rollouts as f64), Worst::Largest)
    };
    let moved = Variant::MovingLoad;
    let bare = Variant::NoForceTerm;
    let signals = Variant::Signals;
    vec![
        claim("Task 1", "as shipped", vec![cost(Variant::ViaPoint), motions(Variant::ViaPoint)], None, ""),
        claim(
            "Task 1",
            "PI2 as the paper writes it: noise at every step, exp(-S/lambda), the full sum",
            vec![cost(Variant::PaperPi2), motions(Variant::PaperPi2)],
            None,
            "lambda = 0.1 and the scale of the noise are ours; it learns, more slowly",
        ),
        claim(
            "Task 1",
            "learned from signals (`method = \"gauss-newton\"`)",
            vec![
                cost(signals),
                motions(signals),
                number("stiffness up to", "N/m", metric(signals, "stiffness_max"), Worst::Largest),
                number("damping up to", "N s/m", metric(signals, "damping_max"), Worst::Largest),
            ],
            None,
            "the movement leads a force that it knows in advance, and gains only cost: the stiffness of Figure 5 is where the \
             search stands, not where the cost is least",
        ),
        claim("Task 2", "as shipped", vec![deviation(Variant::Cantilever), force(Variant::Cantilever)], None, ""),
        claim(
            "Task 2",
            "without the cost of the contact force, which the paper does not have",
            vec![deviation(bare), force(bare)],
            None,
            "near the clamp the beam is so stiff that a force error hides in micrometres",
        ),
        claim(
            "Task 2",
            "on the physical curve, a load where the tool is (`tasks/cantilever_moving_load.toml`)",
            vec![deviation(moved), force(moved)],
            None,
            "it is learned as well as the paper's",
        ),
    ]
}
