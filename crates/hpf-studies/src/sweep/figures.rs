//! The figures of a sweep: cost over the motions made, and every measure by setting.

use std::path::Path;

use hpf::failure::Failure;
use hpf::figure::{self, Drawing, Format, Group, Measure, Member};

use super::outcome::{Outcome, Sample};
use super::plan::{Plan, Setting};

/// Draws the figures of the finished runs into `folder`; returns their file names.
///
/// # Errors
/// [`Failure::Work`] that names a figure that could not be drawn.
pub fn draw(plan: &Plan, outcome: &Outcome<'_>, folder: &Path) -> Result<Vec<String>, Failure> {
    let groups = groups(plan, outcome);
    let varied = plan.factors.iter().map(|factor| factor.key.as_str()).collect::<Vec<_>>().join(" / ");
    let drawings = [
        Drawing::new("cost", || figure::sweep_cost(&groups)),
        Drawing::new("metrics", || figure::sweep_measures(&groups, &varied)),
    ];
    figure::draw(&drawings, &plan.task, Format::Png, folder)
}

/// The finished runs by setting, as figures want them.
fn groups(plan: &Plan, outcome: &Outcome<'_>) -> Vec<Group> {
    let member = |sample: &Sample| Member {
        costs: sample.learning.iter().map(|row| (row.rollouts as f64, row.total)).collect(),
        measures: measures(sample),
    };
    let settings = plan.settings.iter().enumerate();
    let group = |(index, setting): (usize, &Setting)| Group {
        name: plan.label(setting),
        short: plan.short_name(setting),
        members: outcome.of_setting(index).map(member).collect(),
    };
    settings.map(group).collect()
}

/// The cost, and every measure but those that repeat it or only say where the gains went.
fn measures(sample: &Sample) -> Vec<Measure> {
    let target = sample.metrics().find(|metric| metric.0 == "max_cost").and_then(|metric| metric.3);
    let cost = Measure { name: "cost".into(), unit: String::new(), value: sample.total(), target };
    let is_shown = |name: &str| name != "max_cost" && !name.starts_with("stiffness") && !name.starts_with("damping");
    let others = sample.metrics().filter(|metric| is_shown(metric.0)).map(|(name, unit, value, target)| Measure {
        name: name.into(),
        unit: unit.into(),
        value,
        target,
    });
    [cost].into_iter().chain(others).collect()
}
