//! Where the stiffness and damping of each axis come from, and their fits.

use super::error::ImitationError;
use super::force;
use super::gains::{self, Bounds, DampingFrom, Identified, StiffnessFrom};
use super::imitation::Work;
use super::path::{AlignedAxis, mean};
use crate::policy::GainPolicy;
use crate::task::Unit;

impl Work<'_> {
    /// The signal that `pick` takes of axis `a` in every recording.
    pub fn signal<'s>(
        &'s self,
        a: usize,
        pick: impl Fn(&'s AlignedAxis) -> Option<&'s [f64]>,
        endings: [&str; 2],
        purpose: &'static str,
    ) -> Result<Vec<&'s [f64]>, ImitationError> {
        let of = |(demonstration, axis)| {
            pick(axis).ok_or_else(|| {
                let ending = endings[usize::from(self.task.axis[a].unit == Unit::Rad)];
                let column = format!("{}_{ending}", self.name(a));
                ImitationError::Missing { demonstration, axis: self.name(a), column, purpose }
            })
        };
        self.axes(a).enumerate().map(of).collect()
    }

    /// Where the stiffness of axis `a` comes from, by what it has.
    fn stiffness_source(&self, a: usize) -> StiffnessFrom {
        self.options.stiffness.unwrap_or_else(|| {
            if self.axes(a).all(|axis| axis.stiffness.is_some()) {
                StiffnessFrom::Columns
            } else if self.axes(a).all(|axis| axis.emg.is_some()) {
                StiffnessFrom::Emg
            } else if self.recordings.len() > 1 {
                StiffnessFrom::Spread
            } else {
                StiffnessFrom::Constant
            }
        })
    }

    /// Where the damping of axis `a` comes from, by what it has.
    fn damping_source(&self, a: usize) -> DampingFrom {
        self.options.damping.unwrap_or_else(|| {
            if self.axes(a).all(|axis| axis.damping.is_some()) {
                DampingFrom::Columns
            } else if self.stiffness_source(a) == StiffnessFrom::Force {
                DampingFrom::Force
            } else {
                DampingFrom::Constant
            }
        })
    }

    fn bounds(&self, a: usize) -> [Bounds; 2] {
        [&self.task.stiffness, &self.task.damping].map(|gain| Bounds { min: gain.min.of(a), max: gain.max.of(a) })
    }

    /// What the force of axis `a` says, where it is asked.
    pub fn identified(&mut self, a: usize) -> Result<Option<Identified>, ImitationError> {
        if self.stiffness_source(a) != StiffnessFrom::Force && self.damping_source(a) != DampingFrom::Force {
            return Ok(None);
        }
        self.signal(a, |axis| axis.force.as_deref(), ["force_n", "torque_nm"], "gains from force")?;
        if self.recordings.len() < 2 && self.axes(a).any(|axis| axis.reference.is_none()) {
            return Err(ImitationError::NoReference { axis: self.name(a) });
        }
        let steps = self.task.steps();
        let window = self.options.window.map_or(0.1, |window| window / self.task.duration);
        let half = ((0.5 * window * steps as f64).round() as usize).max(1);
        let [stiffness, damping] = self.bounds(a);
        let has_reference = self.axes(a).all(|axis| axis.reference.is_some());
        if has_reference && let Some(read) = force::look(&self.recordings, a, half) {
            self.correct(a, &read, [stiffness, damping]);
        }
        let found = gains::from_force(&self.recordings, a, half, stiffness, damping);
        let says = found.iter().flatten().count();
        if says == 0 {
            let reason = "the recorded force determines no stiffness and damping: the tool has to leave its reference, \
                          and at changing speed";
            return Err(ImitationError::Uninformative { axis: self.name(a), reason });
        }
        if says < found.len() {
            let share = 100.0 * says as f64 / found.len() as f64;
            let name = self.name(a);
            self.notes.push(format!(
                "axis `{name}`: the force determines the gains over {share:.0} % of the movement; elsewhere they go on from there"
            ));
        }
        Ok(Some(found))
    }

    /// Takes rest level and sign of the force of axis `a` out, and notes gains beyond their bounds.
    fn correct(&mut self, a: usize, read: &force::Read, bounds: [Bounds; 2]) {
        let (name, rest, sign) = (self.name(a), read.rest, if read.is_turned { -1.0 } else { 1.0 });
        let unit = if self.task.axis[a].unit == Unit::M { "N" } else { "N m" };
        if rest != 0.0 {
            self.notes.push(format!(
                "axis `{name}`: the recorded force has a rest level of {rest:.3} {unit}, which is taken out of it"
            ));
        }
        if read.is_turned {
            self.notes.push(format!(
                "axis `{name}`: the recorded force points the other way, that of the tool on the environment: its sign is \
                 turned"
            ));
        }
        for axis in self.recordings.iter_mut().map(|recording| &mut recording.axes[a]) {
            if let Some(force) = &mut axis.force {
                force.iter_mut().for_each(|f| *f = sign * (*f - rest));
            }
        }
        for ((what, values), Bounds { min, max }) in ["stiffness", "damping"].into_iter().zip(read.gains).zip(bounds) {
            let [low, high] = values;
            if high > 1.02 * max || low < 0.98 * min {
                self.notes.push(format!(
                    "axis `{name}`: the force says {what} from {low:.4} to {high:.4}, which is held within its bounds, {min} \
                     to {max}"
                ));
            }
        }
    }

    /// Fits the stiffness of axis `a` into `gain`.
    pub fn stiffness(
        &mut self,
        a: usize,
        identified: Option<&Identified>,
        gain: &mut GainPolicy,
    ) -> Result<StiffnessFrom, ImitationError> {
        let source = self.stiffness_source(a);
        let bounds = self.bounds(a)[0];
        let uninformative = |reason| ImitationError::Uninformative { axis: self.name(a), reason };
        let profile = match source {
            StiffnessFrom::Constant => return Ok(source),
            StiffnessFrom::Columns => {
                let endings = ["stiffness_n_m", "stiffness_nm_rad"];
                let recorded = self.signal(a, |axis| axis.stiffness.as_deref(), endings, "stiffness from columns")?;
                let profile = all(&mean(recorded.iter().copied()));
                let note = outside(&self.name(a), "stiffness", &recorded, bounds);
                self.notes.extend(note);
                profile
            }
            StiffnessFrom::Spread => {
                if self.recordings.len() < 2 {
                    return Err(ImitationError::OneDemonstration);
                }
                let paths: Vec<&[f64]> = self.axes(a).map(|axis| axis.path.as_slice()).collect();
                let reason = "the demonstrations spread alike everywhere, which says nothing about stiffness; \
                              take it from elsewhere, such as constant";
                match gains::from_spread(&paths, bounds) {
                    Some(profile) => all(&profile),
                    // Nobody asked for the spread: an axis that it says nothing about keeps the initial value.
                    None if self.options.stiffness.is_none() => {
                        let name = self.name(a);
                        self.notes.push(format!(
                            "axis `{name}`: the demonstrations spread alike everywhere, which says nothing about its \
                             stiffness: it is constant"
                        ));
                        return Ok(StiffnessFrom::Constant);
                    }
                    None => return Err(uninformative(reason)),
                }
            }
            StiffnessFrom::Emg => {
                let activity = self.signal(a, |axis| axis.emg.as_deref(), ["emg"; 2], "stiffness from emg")?;
                let reason = "the muscle activity is zero throughout";
                all(&gains::from_emg(&activity, bounds).ok_or_else(|| uninformative(reason))?)
            }
            StiffnessFrom::Force => {
                let identified = identified.expect("force was asked before stiffness");
                identified.iter().map(|found| found.map(|(k, _)| k)).collect()
            }
        };
        gain.weights = self.fit(a, 0, &profile, bounds)?;
        Ok(source)
    }

    /// Fits the damping of axis `a` into `gain`, `stiffness` being fitted.
    pub fn damping(
        &mut self,
        a: usize,
        identified: Option<&Identified>,
        stiffness: &GainPolicy,
        gain: &mut GainPolicy,
    ) -> Result<DampingFrom, ImitationError> {
        let source = self.damping_source(a);
        let bounds = self.bounds(a)[1];
        let profile = match source {
            DampingFrom::Constant => return Ok(source),
            DampingFrom::Columns => {
                let endings = ["damping_n_s_m", "damping_nm_s_rad"];
                let recorded = self.signal(a, |axis| axis.damping.as_deref(), endings, "damping from columns")?;
                let profile = all(&mean(recorded.iter().copied()));
                let note = outside(&self.name(a), "damping", &recorded, bounds);
                self.notes.extend(note);
                profile
            }
            DampingFrom::Force => {
                let identified = identified.expect("force was asked before damping");
                identified.iter().map(|found| found.map(|(_, d)| d)).collect()
            }
            DampingFrom::Ratio => {
                let table = &self.profiles[0];
                let mix = |row: &[f64]| row.iter().zip(&stiffness.weights).map(|(phi, w)| phi * w).sum();
                let profile: Vec<f64> = table.features.chunks_exact(table.count).map(mix).collect();
                let critical = gains::from_ratio(&profile, self.options.damping_ratio, self.options.mass);
                let note = outside(&self.name(a), "damping", &[&critical], bounds);
                self.notes.extend(note);
                all(&critical)
            }
        };
        gain.weights = self.fit(a, 1, &profile, bounds)?;
        Ok(source)
    }

    fn fit(&self, a: usize, which: usize, profile: &[Option<f64>], bounds: Bounds) -> Result<Vec<f64>, ImitationError> {
        let fitted = self.profiles[which].gain(profile, bounds);
        fitted.map_err(|reason| ImitationError::Fit { axis: self.name(a), reason })
    }
}

fn all(values: &[f64]) -> Vec<Option<f64>> {
    values.iter().copied().map(Some).collect()
}

/// A note of a profile that leaves its bounds.
fn outside(axis: &str, name: &str, profiles: &[&[f64]], bounds: Bounds) -> Option<String> {
    let values = profiles.iter().copied().flatten();
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    // A mixture of weights at a bound may pass it by a rounding.
    let margin = 1e-9 * bounds.max;
    let is_outside = low < bounds.min - margin || high > bounds.max + margin;
    let Bounds { min, max } = bounds;
    is_outside
        .then(|| format!("axis `{axis}`: {name} from {low:.4} to {high:.4} is held within its bounds, {min} to {max}"))
}
