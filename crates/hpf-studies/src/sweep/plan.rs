//! Which runs a sweep has: settings times seeds, and a directory for each.

use std::path::{Path, PathBuf};

use hpf::Watch;
use hpf::failure::Failure;
use hpf::files::{in_file, read_task, sha256};
use hpf::trial::Prepared;

/// Most runs of one sweep.
const MOST_RUNS: usize = 10_000;
/// Longest name of the directory of a setting; longer ones are cut, and distinguished by a hash.
const LONGEST_NAME: usize = 100;

/// What a sweep is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The task file.
    pub task: PathBuf,
    /// Runs of every setting, each with a seed of its own.
    pub seeds: u32,
    /// The first seed; `None` for that of the task.
    pub first_seed: Option<u64>,
    /// Keys that are varied, each `key.path=value,value,...`.
    pub vary: Vec<String>,
    /// Variants of the task that are set beside each other, each `name: key.path=value; key.path=value`.
    pub variants: Vec<String>,
    /// Changes to every run, each `key.path=value`.
    pub set: Vec<String>,
}

/// What is varied: a key of the task, or the task as a whole in variants.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// The key's path in the task, or `variant`.
    pub key: String,
    /// Its values, as TOML, or the names of the variants.
    pub values: Vec<String>,
    /// The changes that each value makes, `key.path=value`.
    changes: Vec<Vec<String>>,
}

/// What the factor is called whose values are variants of the task.
pub const VARIANT: &str = "variant";

/// One combination of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// A value for each factor.
    pub values: Vec<String>,
    /// The whole of it as `key=value, ...`; empty where nothing is varied.
    pub name: String,
    /// The changes that it makes.
    changes: Vec<String>,
}

/// One run.
pub struct Job {
    /// Which setting.
    pub setting: usize,
    /// Its seed.
    pub seed: u64,
    /// Its directory inside that of the sweep.
    pub directory: PathBuf,
    /// The task as it will run.
    pub prepared: Prepared,
}

/// Everything that is to be learned.
pub struct Plan {
    /// Name of the task.
    pub task: String,
    /// What is varied.
    pub factors: Vec<Factor>,
    /// Every combination, the last factor varying fastest.
    pub settings: Vec<Setting>,
    /// Seeds, in order.
    pub seeds: Vec<u64>,
    /// Settings times seeds, in that order.
    pub jobs: Vec<Job>,
}

impl Plan {
    /// The plan that `request` asks for; `watch` hears the notes of the task, once for all runs.
    ///
    /// # Errors
    /// [`Failure`] for values that cannot be, before anything is learned.
    pub fn new(request: &Request, watch: &dyn Watch) -> Result<Self, Failure> {
        let loaded = read_task(&request.task, &request.set)?;
        loaded.notes.iter().for_each(|note| watch.note(&format!("note: {note}")));
        let base = loaded.task;
        let mut factors = request.vary.iter().map(|text| factor(text)).collect::<Result<Vec<_>, _>>()?;
        if !request.variants.is_empty() {
            factors.insert(0, variants(&request.variants)?);
        }
        if let Some(twice) = (1..factors.len()).find(|i| factors[..*i].iter().any(|one| one.key == factors[*i].key)) {
            let message =
                format!("--vary {}: the key is varied already, name all its values at once", factors[twice].key);
            return Err(Failure::Input(message));
        }
        let first = request.first_seed.unwrap_or(base.learning.seed);
        let last = first.checked_add(u64::from(request.seeds) - 1).filter(|last| *last <= i64::MAX as u64);
        let last = last.ok_or_else(|| {
            Failure::Input(format!("{} seeds from {first} on pass the largest seed, {}", request.seeds, i64::MAX))
        })?;
        let seeds: Vec<u64> = (first..=last).collect();
        let runs = factors.iter().map(|factor| factor.values.len()).try_fold(seeds.len(), usize::checked_mul);
        if runs.is_none_or(|runs| runs > MOST_RUNS) {
            return Err(Failure::Input(format!(
                "the grid has more than {MOST_RUNS} runs, which is the most a sweep makes"
            )));
        }
        let settings = settings(&factors);
        let mut jobs = Vec::new();
        for (index, setting) in settings.iter().enumerate() {
            for &seed in &seeds {
                let mut changes = request.set.clone();
                changes.extend(setting.changes.iter().cloned());
                changes.push(format!("learning.seed={seed}"));
                let prepared = Prepared::read(&request.task, &changes).map_err(|failure| {
                    failure.with(&format!("this is one of the runs that are asked for: {}", setting.name))
                })?;
                if prepared.loaded.task.environment.is_some() {
                    let message = "a sweep makes several motions at once, in simulation; [environment] names a process, \
                                   which hpf learn runs";
                    return Err(in_file(&request.task)(message));
                }
                let directory = Path::new("runs").join(directory(setting)).join(format!("seed-{seed}"));
                jobs.push(Job { setting: index, seed, directory, prepared });
            }
        }
        Ok(Self { task: base.name, factors, settings, seeds, jobs })
    }

    /// What figures call a setting: the last two parts of its keys, where they distinguish the keys; a variant its name.
    pub fn label(&self, setting: &Setting) -> String {
        let last = |key: &str| {
            let parts: Vec<&str> = key.split('.').collect();
            parts[parts.len().saturating_sub(2)..].join(".")
        };
        let mut lasts: Vec<String> = self.factors.iter().map(|factor| last(&factor.key)).collect();
        lasts.sort();
        lasts.dedup();
        let brief = lasts.len() == self.factors.len();
        let name = |factor: &Factor| if brief { last(&factor.key) } else { factor.key.clone() };
        let part = |(factor, value): (&Factor, &String)| {
            if factor.key == VARIANT { value.clone() } else { format!("{} = {value}", name(factor)) }
        };
        let parts = self.factors.iter().zip(&setting.values).map(part);
        parts.collect::<Vec<_>>().join(", ")
    }

    /// The short name of a setting: its values.
    pub fn short_name(&self, setting: &Setting) -> String {
        if setting.values.is_empty() { self.task.clone() } else { setting.values.join(" / ") }
    }
}

/// The directory of a setting: its name with signs that every file system takes.
fn directory(setting: &Setting) -> String {
    let plain = |sign: char| if sign.is_ascii_alphanumeric() || "._-+=,".contains(sign) { sign } else { '-' };
    let name: String = setting.name.replace(", ", ",").chars().map(plain).collect();
    if name == setting.name.replace(", ", ",") && name.len() <= LONGEST_NAME {
        return name;
    }
    let cut: String = name.chars().take(LONGEST_NAME).collect();
    format!("{cut}-{}", &sha256(&setting.name)[..8])
}

/// Every combination of the values of `factors`.
fn settings(factors: &[Factor]) -> Vec<Setting> {
    let mut combinations: Vec<Vec<usize>> = vec![Vec::new()];
    for factor in factors {
        let extended = combinations.iter().flat_map(|before| {
            (0..factor.values.len()).map(|value| before.iter().copied().chain([value]).collect::<Vec<_>>())
        });
        combinations = extended.collect();
    }
    let setting = |chosen: Vec<usize>| {
        let of_factors = || factors.iter().zip(&chosen);
        let values: Vec<String> = of_factors().map(|(factor, &value)| factor.values[value].clone()).collect();
        let parts: Vec<String> =
            factors.iter().zip(&values).map(|(factor, value)| format!("{}={value}", factor.key)).collect();
        let changes = of_factors().flat_map(|(factor, &value)| factor.changes[value].iter().cloned()).collect();
        Setting { name: parts.join(", "), values, changes }
    };
    combinations.into_iter().map(setting).collect()
}

/// Reads variants, each `name: key.path=value; key.path=value`.
fn variants(texts: &[String]) -> Result<Factor, Failure> {
    let mut factor = Factor { key: VARIANT.to_owned(), values: Vec::new(), changes: Vec::new() };
    for text in texts {
        let wrong = |why: &str| Err(Failure::Input(format!("--variant {text}: {why}")));
        let Some((name, changes)) = text.split_once(':') else {
            return wrong("write it as NAME: key.path=value; key.path=value, or as NAME: for the task as it is");
        };
        let name = name.trim();
        if name.is_empty() || name.contains('=') {
            return wrong("it begins with a name");
        }
        if factor.values.iter().any(|known| known == name) {
            return wrong("the name is that of another variant");
        }
        let changes: Vec<String> = split(changes, ';').into_iter().map(|change| change.trim().to_owned()).collect();
        if changes.iter().any(|change| change.starts_with("learning.seed")) {
            return wrong("seeds are varied with --seeds, from --seed on");
        }
        factor.values.push(name.to_owned());
        factor.changes.push(changes.into_iter().filter(|change| !change.is_empty()).collect());
    }
    Ok(factor)
}

/// Reads `key.path=value,value,...`.
fn factor(text: &str) -> Result<Factor, Failure> {
    let wrong = |why: &str| Err(Failure::Input(format!("--vary {text}: {why}")));
    let Some((key, values)) = text.split_once('=') else {
        return wrong("write it as key.path=value,value, such as learning.noise.movement=10,30,100");
    };
    let key = key.trim();
    if key.split('.').any(str::is_empty) {
        return wrong("the key has an empty part");
    }
    if key == "learning.seed" {
        return wrong("seeds are varied with --seeds, from --seed on");
    }
    let values: Vec<String> = split(values, ',').into_iter().map(|value| value.trim().to_owned()).collect();
    if values.iter().any(String::is_empty) {
        return wrong("a value is missing");
    }
    if let Some(twice) = (1..values.len()).find(|i| values[..*i].contains(&values[*i])) {
        return wrong(&format!("the value {} is named twice", values[twice]));
    }
    let changes = values.iter().map(|value| vec![format!("{key}={value}")]).collect();
    Ok(Factor { key: key.to_owned(), values, changes })
}

/// `text` cut at each `separator` outside of lists, tables and strings.
fn split(text: &str, separator: char) -> Vec<&str> {
    let (mut parts, mut start, mut depth, mut quote) = (Vec::new(), 0, 0_i32, None);
    for (at, sign) in text.char_indices() {
        match (quote, sign) {
            (Some(open), _) if sign == open => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(sign),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            (None, sign) if sign == separator && depth == 0 => {
                parts.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_cut_at_commas_outside_of_lists_tables_and_texts() {
        let split = |text| split(text, ',');
        assert_eq!(split("10,30,100"), ["10", "30", "100"]);
        assert_eq!(split("[0.6,0.8],[0.5, 0.9]"), ["[0.6,0.8]", "[0.5, 0.9]"]);
        assert_eq!(split("{ a = 1, b = 2 },\"x,y\",'z,'"), ["{ a = 1, b = 2 }", "\"x,y\"", "'z,'"]);
    }

    #[test]
    fn settings_are_every_combination_and_none_is_one() {
        let factor = |key: &str, values: &[&str]| Factor {
            key: key.into(),
            values: values.iter().map(|value| (*value).to_owned()).collect(),
            changes: values.iter().map(|value| vec![format!("{key}={value}")]).collect(),
        };
        let names = |factors: &[Factor]| settings(factors).into_iter().map(|setting| setting.name).collect::<Vec<_>>();
        let grid = names(&[factor("a", &["1", "2"]), factor("b", &["x", "y"])]);
        assert_eq!(grid, ["a=1, b=x", "a=1, b=y", "a=2, b=x", "a=2, b=y"]);
        assert_eq!(names(&[]), [""]);
    }

    #[test]
    fn variants_are_names_with_the_changes_that_they_make() {
        let read = |texts: &[&str]| variants(&texts.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>());
        let factor = read(&["as it is:", "stiff: stiffness.min=[1; 2]; a = \"x;y\""]).unwrap();
        assert_eq!(factor.values, ["as it is", "stiff"]);
        assert_eq!(factor.changes, [vec![], vec!["stiffness.min=[1; 2]".to_owned(), "a = \"x;y\"".to_owned()]]);
        for wrong in [&["a=1"][..], &[": a=1"], &["one:", "one: a=1"], &["a: learning.seed=3"]] {
            assert!(read(wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn directories_are_plain_and_never_shared() {
        let of = |name: &str| directory(&Setting { values: Vec::new(), name: name.into(), changes: Vec::new() });
        assert_eq!(of("learning.noise.movement=10, rate=50"), "learning.noise.movement=10,rate=50");
        let (one, other) = (of("v=[1, 2]"), of("v={1, 2}"));
        assert!(one != other && one.starts_with("v=-1,2--"), "{one} {other}");
        assert!(of(&"x".repeat(300)).len() < 120);
    }
}
