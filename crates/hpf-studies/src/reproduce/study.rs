//! What is learned for the comparison: the shipped tasks and some variants, each with every seed.

use hpf::failure::{Failure, in_text};
use hpf::files::LoadedTask;
use hpf::overrides;
use hpf::statistics::Spread;
use hpf::trial::{Broken, Prepared, Trial};
use hpf_sim::cost::Term;
use hpf_sim::environment::{Cantilever, Contact};
use hpf_sim::task::Task;
use hpf_sim::{Policy, Simulation};

use crate::many::{StudyWatch, learn_each};

const VIA_POINT: &str = include_str!("../../shipped/tasks/via_point.toml");
const CANTILEVER: &str = include_str!("../../shipped/tasks/cantilever.toml");
const MOVING_LOAD: &str = include_str!("../../shipped/tasks/cantilever_moving_load.toml");
const CONSTANT_FORCE: &str = include_str!("constant_force.toml");

/// A way to learn a task of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Task 1.
    ViaPoint,
    /// Task 2 on the paper's curve.
    Cantilever,
    /// Task 2 on the physical curve.
    MovingLoad,
    /// Task 2 without the cost of the contact force, which the paper does not have.
    NoForceTerm,
    /// Task 1, PI2 as the paper writes it down.
    PaperPi2,
    /// Task 1, learned from signals.
    Signals,
}

impl Variant {
    /// All, those that take longest first.
    pub const ALL: [Self; 6] =
        [Self::PaperPi2, Self::ViaPoint, Self::Cantilever, Self::MovingLoad, Self::NoForceTerm, Self::Signals];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::ViaPoint => "via_point",
            Self::Cantilever => "cantilever",
            Self::MovingLoad => "cantilever_moving_load",
            Self::NoForceTerm => "cantilever_no_force_term",
            Self::PaperPi2 => "via_point_paper_pi2",
            Self::Signals => "via_point_signals",
        }
    }

    /// Whether it is a shipped task as it is, whose targets are to be met.
    pub fn is_shipped(self) -> bool {
        self.changes().is_empty()
    }

    /// What it changes in its task.
    pub fn changes(self) -> &'static [&'static str] {
        match self {
            Self::ViaPoint | Self::Cantilever | Self::MovingLoad => &[],
            Self::NoForceTerm => &["cost.contact_force=0"],
            Self::PaperPi2 => {
                &["learning.preset=paper", "learning.noise={ movement = 40.0, stiffness = 80.0, damping = 20.0 }"]
            }
            Self::Signals => &["learning.method=gauss-newton", "learning.max_rollouts=200", "cost.rest=0"],
        }
    }

    fn task(self) -> (&'static str, &'static str) {
        match self {
            Self::ViaPoint | Self::PaperPi2 | Self::Signals => ("tasks/via_point.toml", VIA_POINT),
            Self::Cantilever | Self::NoForceTerm => ("tasks/cantilever.toml", CANTILEVER),
            Self::MovingLoad => ("tasks/cantilever_moving_load.toml", MOVING_LOAD),
        }
    }
}

/// A task of the program itself, with changes.
fn embedded((name, text): (&str, &str), changes: &[String]) -> Result<LoadedTask, Failure> {
    let text = overrides::apply(text, changes)?;
    let task = Task::parse(&text).map_err(in_text(name))?;
    Ok(LoadedTask { task, text, notes: Vec::new() })
}

/// Every variant, learned with every seed.
pub struct Study {
    /// Seeds, in order.
    pub seeds: Vec<u64>,
    /// For each of [`Variant::ALL`], a trial per seed.
    trials: Vec<Vec<(Prepared, Trial)>>,
}

impl Study {
    /// Learns all of it.
    ///
    /// # Errors
    /// [`Failure::Work`] where a run fails; `None` where `watch` asked to end.
    pub fn learn(seeds: Vec<u64>, watch: &dyn StudyWatch) -> Result<Option<Self>, Failure> {
        let mut jobs = Vec::new();
        for variant in Variant::ALL {
            for seed in &seeds {
                let seed = format!("learning.seed={seed}");
                let changes: Vec<String> =
                    variant.changes().iter().copied().chain([seed.as_str()]).map(str::to_owned).collect();
                jobs.push(Prepared::own(embedded(variant.task(), &changes)?)?);
            }
        }
        let results = learn_each("reproduce", &jobs, watch)?;
        let mut trials: Vec<Vec<(Prepared, Trial)>> = Variant::ALL.iter().map(|_| Vec::new()).collect();
        for (index, (job, result)) in jobs.into_iter().zip(results).enumerate() {
            let variant = index / seeds.len();
            match result {
                Ok(trial) => trials[variant].push((job, trial)),
                Err(Broken::Interrupted) => return Ok(None),
                Err(Broken::Failed(why)) => {
                    let (name, seed) = (Variant::ALL[variant].name(), seeds[index % seeds.len()]);
                    return Err(Failure::Work(format!("{name} with seed {seed} failed: {why}")));
                }
            }
        }
        Ok(Some(Self { seeds, trials }))
    }

    /// The trials of `variant`, the first seed first.
    pub fn of(&self, variant: Variant) -> impl Iterator<Item = &Trial> {
        self.prepared(variant).map(|(_, trial)| trial)
    }

    /// The same, with their tasks.
    pub fn prepared(&self, variant: Variant) -> impl Iterator<Item = &(Prepared, Trial)> {
        let index = Variant::ALL.iter().position(|one| *one == variant).expect("ALL has every variant");
        self.trials[index].iter()
    }

    /// The first trial of `variant`: the one that figures show.
    pub fn first(&self, variant: Variant) -> &(Prepared, Trial) {
        self.prepared(variant).next().expect("there is at least one seed")
    }

    /// The spread over seeds of what `of` says about a trial.
    pub fn spread(&self, variant: Variant, of: impl Fn(&Trial) -> f64) -> Spread {
        Spread::of(self.of(variant).map(of)).expect("there is at least one seed")
    }

    /// The spread over seeds of a measure.
    pub fn metric(&self, variant: Variant, name: &str) -> Spread {
        self.spread(variant, |trial| {
            let found = trial.summary.metrics.iter().find(|metric| metric.name == name);
            found.map_or(f64::NAN, |metric| metric.value)
        })
    }

    /// The beam of Task 2.
    pub fn beam(&self) -> &Cantilever {
        match &self.first(Variant::Cantilever).0.loaded.task.contact {
            Some(Contact::Cantilever(beam)) => beam,
            _ => unreachable!("the shipped task has a beam"),
        }
    }

    /// The text of `results.csv`: a row per run and measure.
    pub fn csv(&self) -> String {
        let mut text = "variant,seed,motions,measure,unit,value\n".to_owned();
        for variant in Variant::ALL {
            for Trial { summary, .. } in self.of(variant) {
                let terms =
                    Term::NAMES.iter().zip(&summary.last.1).map(|(name, value)| (format!("cost_{name}"), "", *value));
                let metrics = summary.metrics.iter().map(|metric| (metric.name.to_owned(), metric.unit, metric.value));
                for (name, unit, value) in
                    [("cost".to_owned(), "", summary.last.0)].into_iter().chain(terms).chain(metrics)
                {
                    let (task, seed, motions) = (variant.name(), summary.seed, summary.rollouts);
                    text += &format!("{task},{seed},{motions},{name},{unit},{value:?}\n");
                }
            }
        }
        text
    }

    /// Whether every run of a shipped task met its targets.
    pub fn meets_targets(&self) -> bool {
        let shipped = Variant::ALL.into_iter().filter(|variant| variant.is_shipped());
        shipped.flat_map(|variant| self.of(variant)).all(|trial| !trial.summary.is_missed())
    }
}

/// How far from its goal the tool ends under a constant force, at the most stiffness allowed [m].
///
/// # Errors
/// [`Failure`] where the embedded task is not valid.
pub fn constant_force_error() -> Result<f64, Failure> {
    let task = embedded(("constant_force.toml", CONSTANT_FORCE), &[])?.task;
    let failed = |error: &dyn core::fmt::Display| Failure::Work(format!("constant_force.toml: {error}"));
    let policy = Policy::initial(&task).map_err(|error| failed(&error))?;
    let simulation = Simulation::new(&task, &policy).map_err(|error| failed(&error))?;
    let trace = simulation.rollout(&simulation.parameters(&policy));
    let end = trace.axes[0].position.last().expect("a motion has steps");
    Ok(end - task.axis[0].goal)
}
