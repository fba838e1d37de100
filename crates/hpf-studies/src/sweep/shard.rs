//! Shares of a sweep that several machines learn, and who may write to its folder.
//!
//! A sweep holds its lock file for as long as it goes on; a shard has a lock file of its own, so that shards go on side by
//! side in a folder they share. The lock file of a shard stays, as a mark that the folder belongs to a sweep.

use core::str::FromStr;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use hpf::failure::Failure;
use hpf::files::{make_folder, read_text, while_writing};
use hpf::nodes;
use serde_json::{Value, json};

/// Every `count`-th run, from the `index`-th on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shard {
    index: usize,
    count: usize,
}

/// Most shards of a sweep: as many as it may have runs.
const MOST_SHARDS: usize = 10_000;
/// The file that a sweep under way holds locked; one that was broken off leaves it.
const LOCK: &str = ".lock";

impl Shard {
    /// Whether run number `run`, from 0 on, belongs to it.
    pub fn has(self, run: usize) -> bool {
        run % self.count == self.index - 1
    }

    fn lock(self) -> String {
        format!("{LOCK}-{}-of-{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((index, count)) if 1 <= index && index <= count && count <= MOST_SHARDS => Ok(Self { index, count }),
            _ => Err(format!("write it as I/N with 1 <= I <= N <= {MOST_SHARDS}, such as 3/16")),
        }
    }
}

/// The lock of a sweep or of a shard on a folder, held.
pub struct Claim {
    _lock: File,
    folder: PathBuf,
}

impl Claim {
    /// Takes the marks of the sweep, of its shards too, from the folder.
    ///
    /// # Errors
    /// [`Failure`] where one cannot be removed.
    pub fn give_up(self) -> Result<(), Failure> {
        for name in locks(&self.folder) {
            fs::remove_file(self.folder.join(name)).map_err(while_writing(&self.folder))?;
        }
        Ok(())
    }
}

/// Names of the lock files in `folder`.
fn locks(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    names.filter(|name| name == LOCK || name.starts_with(&format!("{LOCK}-"))).collect()
}

/// Makes the folder of a sweep, or takes the one of a sweep that is there, for as long as the claim is held.
///
/// # Errors
/// [`Failure::Input`] where the folder holds something else, or whoever writes the same runs goes on in it.
pub fn claim(folder: &Path, shard: Option<Shard>) -> Result<Claim, Failure> {
    let refuse = |why: &str| Err(Failure::Input(format!("{} {why}", folder.display())));
    let going_on = || refuse("belongs to a sweep that is going on; wait for it, or pass another --out");
    let is_empty = fs::read_dir(folder).map_or(true, |mut entries| entries.next().is_none());
    let summary = read_text(&folder.join("summary.json")).unwrap_or_default();
    let summary: Value = serde_json::from_str(&summary).unwrap_or_default();
    let there = locks(folder);
    let is_sweep = summary["format"] == json!("hpf-sweep") || there.iter().any(|name| folder.join(name).is_file());
    if !(is_empty && !folder.is_file() || is_sweep) {
        return refuse("is no sweep and is left as it is; pass another --out");
    }
    make_folder(folder)?;
    let own = shard.map_or_else(|| LOCK.to_owned(), Shard::lock);
    let path = folder.join(&own);
    let lock = nodes::replaceable(&path).and_then(|()| File::create(&path)).map_err(while_writing(&path))?;
    if lock.try_lock().is_err() {
        return going_on();
    }
    // Other shards of as many have other runs.
    let of_as_many = shard.map(|shard| format!("-of-{}", shard.count));
    for name in there.iter().filter(|name| **name != own) {
        let has_other_runs = of_as_many.as_ref().is_some_and(|end| name.ends_with(end));
        let is_held = || File::open(folder.join(name)).is_ok_and(|lock| lock.try_lock().is_err());
        if !has_other_runs && is_held() {
            return going_on();
        }
    }
    Ok(Claim { _lock: lock, folder: folder.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_belongs_to_one_shard() {
        let shards: Vec<Shard> = (1..=5).map(|index| format!("{index}/5").parse().unwrap()).collect();
        for run in 0..23 {
            assert_eq!(shards.iter().filter(|shard| shard.has(run)).count(), 1);
        }
    }

    #[test]
    fn what_is_no_shard_is_refused() {
        for text in ["", "3", "0/4", "5/4", "1/0", "-1/4", "1/4/2", "1/10001", "a/b", "1 / 4"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
