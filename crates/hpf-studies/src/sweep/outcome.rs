//! The results of the runs of a sweep, read back from their directories: a table, a summary, and the data of its figures.

use std::path::Path;

use hpf::failure::Failure;
use hpf::files::{in_file, read_text, while_writing};
use hpf::results::{LearningRow, read_learning};
use hpf::statistics::Spread;
use hpf_sim::cost::Term;
use serde_json::{Map, Value, json};

use super::plan::{Job, Plan};
use super::work::Done;

/// A run that was finished.
pub struct Sample {
    /// Its `summary.json`.
    pub summary: Value,
    /// Its `learning.csv`.
    pub learning: Vec<LearningRow>,
}

impl Sample {
    /// Cost of the learned policy.
    pub fn total(&self) -> f64 {
        number(&self.summary["cost"]["final"]["total"])
    }

    /// Its measures: each with name, unit, value, and target where it has one.
    pub fn metrics(&self) -> impl Iterator<Item = (&str, &str, f64, Option<f64>)> {
        self.summary["metrics"].as_array().into_iter().flatten().filter_map(|metric| {
            let text = |key: &str| metric[key].as_str();
            Some((text("name")?, text("unit")?, number(&metric["value"]), metric["target"].as_f64()))
        })
    }

    /// Whether every target was met; `None` without one.
    pub fn pass(&self) -> Option<bool> {
        let passes =
            self.summary["metrics"].as_array().into_iter().flatten().filter_map(|metric| metric["pass"].as_bool());
        passes.reduce(|all, pass| all && pass)
    }
}

/// A number of a summary; JSON has no word for one that is not finite.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// The result of a sweep.
pub struct Outcome<'p> {
    plan: &'p Plan,
    /// For each run of the plan what it left, where it is finished.
    pub samples: Vec<Option<Sample>>,
    /// For each run of the plan why it failed, if it did.
    failures: &'p [Option<String>],
    interrupted: bool,
}

impl<'p> Outcome<'p> {
    /// Reads the finished runs of `plan` in `folder`.
    ///
    /// # Errors
    /// [`Failure::Input`] that names a damaged file.
    pub fn read(plan: &'p Plan, done: &'p Done, folder: &Path) -> Result<Self, Failure> {
        let read = |(job, failure): (&Job, &Option<String>)| {
            let directory = folder.join(&job.directory);
            let file = directory.join("summary.json");
            if failure.is_some() || !file.exists() {
                return Ok(None);
            }
            let summary = serde_json::from_str(&read_text(&file)?).map_err(in_file(&file))?;
            let file = directory.join("learning.csv");
            let learning = read_learning(&read_text(&file)?).map_err(in_file(&file))?;
            Ok(Some(Sample { summary, learning }))
        };
        let samples = plan.jobs.iter().zip(&done.failures).map(read).collect::<Result<_, Failure>>()?;
        Ok(Self { plan, samples, failures: &done.failures, interrupted: done.interrupted })
    }

    /// The runs that failed: directory and reason.
    pub fn failed(&self) -> impl Iterator<Item = (String, &str)> {
        let reasons = self.plan.jobs.iter().zip(self.failures);
        reasons.filter_map(|(job, why)| Some((job.directory.display().to_string(), why.as_deref()?)))
    }

    /// Finished runs that missed a target.
    pub fn missed(&self) -> usize {
        self.samples.iter().flatten().filter(|sample| sample.pass() == Some(false)).count()
    }

    /// The finished runs of a setting.
    pub fn of_setting(&self, setting: usize) -> impl Iterator<Item = &Sample> {
        let with_job = self.plan.jobs.iter().zip(&self.samples);
        with_job.filter(move |(job, _)| job.setting == setting).filter_map(|(_, sample)| sample.as_ref())
    }

    /// Names and units of all measures, in the order in which they first occur.
    fn metric_names(&self) -> Vec<(String, String)> {
        let mut names: Vec<(String, String)> = Vec::new();
        for (name, unit, ..) in self.samples.iter().flatten().flat_map(Sample::metrics) {
            if names.iter().all(|(known, _)| known != name) {
                names.push((name.to_owned(), unit.to_owned()));
            }
        }
        names
    }

    /// The text of `results.csv`: a row per finished or failed run.
    ///
    /// # Errors
    /// [`Failure::Work`] where the rows make no table.
    pub fn csv(&self) -> Result<Vec<u8>, Failure> {
        let metrics = self.metric_names();
        let mut header = vec!["run".to_owned()];
        header.extend(self.plan.factors.iter().map(|factor| factor.key.clone()));
        header.extend(["seed", "status", "pass", "total"].map(str::to_owned));
        header.extend(Term::NAMES.map(str::to_owned));
        header.extend(metrics.iter().map(|(name, unit)| column(name, unit)));
        header.extend(["motions", "updates", "learning_s", "total_s", "stopped_because"].map(str::to_owned));
        let mut rows = vec![header];
        for ((job, sample), failure) in self.plan.jobs.iter().zip(&self.samples).zip(self.failures) {
            let mut row = vec![job.directory.display().to_string()];
            row.extend(self.plan.settings[job.setting].values.iter().cloned());
            row.push(job.seed.to_string());
            if let Some(sample) = sample {
                let summary = &sample.summary;
                let cost = &summary["cost"]["final"];
                row.push("done".into());
                row.push(sample.pass().map(|pass| pass.to_string()).unwrap_or_default());
                row.push(plain(&cost["total"]));
                row.extend(Term::NAMES.iter().map(|name| plain(&cost[*name])));
                row.extend(metrics.iter().map(|(name, _)| {
                    let value =
                        sample.metrics().find(|metric| metric.0 == name).map(|metric| format!("{:?}", metric.2));
                    value.unwrap_or_default()
                }));
                row.extend(["rollouts_total", "updates", "learning_s", "total_s"].map(|key| plain(&summary[key])));
                row.push(summary["stopped_because"].as_str().unwrap_or_default().to_owned());
            } else if let Some(why) = failure {
                row.push("failed".into());
                row.resize(rows[0].len() - 1, String::new());
                row.push(why.clone());
            } else {
                continue;
            }
            rows.push(row);
        }
        let mut writer = csv::Writer::from_writer(Vec::new());
        let path = Path::new("results.csv");
        rows.iter().try_for_each(|row| writer.write_record(row)).map_err(while_writing(path))?;
        writer.into_inner().map_err(while_writing(path))
    }

    /// The contents of `summary.json`.
    pub fn to_json(&self) -> Value {
        let settings = self.plan.settings.iter().enumerate().map(|(index, setting)| {
            let samples: Vec<&Sample> = self.of_setting(index).collect();
            let failed =
                self.plan.jobs.iter().zip(self.failures).filter(|(job, why)| job.setting == index && why.is_some());
            let keys =
                self.plan.factors.iter().zip(&setting.values).map(|(factor, value)| (factor.key.clone(), json!(value)));
            let spread = |of: &dyn Fn(&Sample) -> f64| {
                Spread::of(samples.iter().map(|sample| of(sample))).map_or(Value::Null, Spread::to_json)
            };
            let mut cost = Map::from_iter([("total".to_owned(), spread(&Sample::total))]);
            cost.extend(
                Term::NAMES.iter().map(|term| {
                    ((*term).to_owned(), spread(&|sample| number(&sample.summary["cost"]["final"][*term])))
                }),
            );
            let metrics = self.metric_names().into_iter().map(|(name, unit)| {
                let of = |sample: &Sample| {
                    sample.metrics().find(|metric| metric.0 == name).map_or(f64::NAN, |metric| metric.2)
                };
                let target = samples
                    .iter()
                    .flat_map(|sample| sample.metrics())
                    .find(|metric| metric.0 == name)
                    .and_then(|metric| metric.3);
                json!({ "name": name, "unit": unit, "target": target, "over_seeds": spread(&of) })
            });
            json!({
                "set": keys.collect::<Map<String, Value>>(),
                "finished": samples.len(),
                "passed": samples.iter().filter(|sample| sample.pass() == Some(true)).count(),
                "missed": samples.iter().filter(|sample| sample.pass() == Some(false)).count(),
                "failed": failed.count(),
                "cost": cost,
                "metrics": metrics.collect::<Vec<_>>(),
                "motions": spread(&|sample| number(&sample.summary["rollouts_total"])),
                "learning_s": spread(&|sample| number(&sample.summary["learning_s"])),
            })
        });
        json!({
            "format": "hpf-sweep",
            "version": 1,
            "task": self.plan.task,
            "seeds": self.plan.seeds,
            "vary": self.plan.factors.iter().map(|factor| json!({ "key": factor.key, "values": factor.values })).collect::<Vec<_>>(),
            "planned": self.plan.jobs.len(),
            "finished": self.samples.iter().flatten().count(),
            "interrupted": self.interrupted,
            "settings": settings.collect::<Vec<_>>(),
            "failures": self.failed().map(|(run, why)| json!({ "run": run, "reason": why })).collect::<Vec<_>>(),
        })
    }
}

/// The text of a number of a summary.
fn plain(value: &Value) -> String {
    if value.is_null() { String::new() } else { value.to_string() }
}

/// The column of a measure: its name and unit, such as `max_end_speed_m_s`.
fn column(name: &str, unit: &str) -> String {
    let unit: String =
        unit.to_lowercase().chars().map(|sign| if sign.is_alphanumeric() { sign } else { '_' }).collect();
    if unit.is_empty() { name.to_owned() } else { format!("{name}_{unit}") }
}
