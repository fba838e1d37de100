//! A policy that learning starts from: one that was demonstrated, or learned before.

use hpf_core::ConfigError;

use crate::policy::Policy;
use crate::task::Task;

/// Why learning cannot start from a policy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StartError {
    /// It does not fit the task: every difference, each with both sides.
    #[error("the policy does not fit the task: {}", .0.join("; "))]
    Differs(Vec<String>),
    /// The task's numbers are refused.
    #[error(transparent)]
    Task(#[from] ConfigError),
}

/// Numbers of a policy and a task that agree to this share are the same: both are made by the same formulas.
const SAME: f64 = 1e-9;

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

impl Policy {
    /// The policy with the weights of `self` and everything else as `task` says.
    ///
    /// Weights carry over to another start, goal, duration or rate, as a movement primitive does. Axes, phase, spring
    /// factor, bases and the kind of scaling must be the same, and weights of gains within the task's bounds.
    ///
    /// # Errors
    /// [`StartError`] that names every difference.
    pub fn carried_to(&self, task: &Task) -> Result<Self, StartError> {
        let start = Self::initial(task)?;
        let names = |policy: &Self| policy.axes.iter().map(|axis| axis.name.clone()).collect::<Vec<_>>();
        let (mine, wanted) = (names(self), names(&start));
        if mine != wanted {
            let difference = format!("axes {} for {}", mine.join(", "), wanted.join(", "));
            return Err(StartError::Differs(vec![difference]));
        }
        let mut found = Vec::new();
        let mut compare = |what: String, mine: f64, wanted: f64| {
            if !is_same(mine, wanted) {
                found.push(format!("{what} {mine} for {wanted}"));
            }
        };
        compare("phase decay".into(), self.phase.decay, start.phase.decay);
        for (mine, wanted) in self.axes.iter().zip(&start.axes) {
            let name = &mine.name;
            compare(format!("axis `{name}`: alpha"), mine.movement.alpha, wanted.movement.alpha);
            // The same amplitude, or the same multiple of the way to the goal.
            let per_travel = |axis: &crate::AxisPolicy| axis.movement.forcing_scale / (axis.goal - axis.start);
            if !is_same(per_travel(mine), per_travel(wanted)) {
                compare(
                    format!("axis `{name}`: forcing scale"),
                    mine.movement.forcing_scale,
                    wanted.movement.forcing_scale,
                );
            }
        }
        for (mine, wanted) in self.axes.iter().zip(&start.axes) {
            let name = &mine.name;
            if mine.unit != wanted.unit {
                found.push(format!("axis `{name}`: another unit"));
            }
            let movement =
                [&mine.movement.centers, &mine.movement.widths, &wanted.movement.centers, &wanted.movement.widths];
            let gain = |gain: fn(&crate::AxisPolicy) -> &crate::GainPolicy| {
                let (mine, wanted) = (gain(mine), gain(wanted));
                [&mine.centers, &mine.widths, &wanted.centers, &wanted.widths]
            };
            for (primitive, mine, wanted) in [
                ("movement", mine.movement.family, wanted.movement.family),
                ("stiffness", mine.stiffness.family, wanted.stiffness.family),
                ("damping", mine.damping.family, wanted.damping.family),
            ] {
                if core::mem::discriminant(&mine) != core::mem::discriminant(&wanted) {
                    found.push(format!("axis `{name}`: another family of the basis of {primitive}"));
                }
            }
            let lists = [
                ("movement", movement),
                ("stiffness", gain(|axis| &axis.stiffness)),
                ("damping", gain(|axis| &axis.damping)),
            ];
            for (primitive, [centers, widths, wanted_centers, wanted_widths]) in lists {
                if centers.len() != wanted_centers.len() {
                    let (mine, wanted) = (centers.len(), wanted_centers.len());
                    found.push(format!("axis `{name}`: {mine} basis functions of {primitive} for {wanted}"));
                } else if !centers.iter().zip(wanted_centers).all(|(a, b)| is_same(*a, *b)) {
                    found.push(format!("axis `{name}`: other centers of the basis of {primitive}"));
                } else if !widths.iter().zip(wanted_widths).all(|(a, b)| is_same(*a, *b)) {
                    found
                        .push(format!("axis `{name}`: other widths of the basis of {primitive}, from another overlap"));
                }
            }
            for (primitive, mine, wanted) in
                [("stiffness", &mine.stiffness, &wanted.stiffness), ("damping", &mine.damping, &wanted.damping)]
            {
                let outside = mine.weights.iter().find(|weight| !(wanted.min..=wanted.max).contains(weight));
                if let Some(weight) = outside {
                    let (min, max) = (wanted.min, wanted.max);
                    found.push(format!("axis `{name}`: {primitive} {weight} for bounds {min} to {max}"));
                }
            }
        }
        if found.is_empty() {
            Ok(start.with_weights(&self.weights()).expect("no difference in size was found"))
        } else {
            Err(StartError::Differs(found))
        }
    }
}
