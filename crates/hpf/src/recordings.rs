//! Recordings by their path: a file, the folder of a bag, or a run.

use std::fs;
use std::path::{Path, PathBuf};

use hpf_sim::{AxisTrace, Demonstration, Imitated, Trace};

use crate::failure::Failure;
use crate::files::{in_file, read_bytes, read_task, sha256_of_bytes, verify_run};

pub use hpf_recordings::{
    AxisSource, Mapping, Mistake, PRESETS, Preset, Read, Refusal, Saw, Source, UnitWord, align_turns, inspect, read,
    units_of,
};

/// A recording and where it comes from.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The file that was read.
    pub path: PathBuf,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// The recording.
    pub recording: Demonstration,
    /// What the user should know, each with the name of the file.
    pub notes: Vec<String>,
}

/// Reads the recording at `path`: a file of any format that is read, the folder of a bag of ROS 2, or a run, of which the
/// trajectory is read without the rest time after the movement.
///
/// # Errors
/// [`Failure::Input`] with every mistake and its place, and what is in the file where it could be looked into.
pub fn load(path: &Path, mapping: &Mapping) -> Result<Loaded, Failure> {
    let (path, bytes) = bytes_of(path)?;
    let task = path.with_file_name("task.toml");
    let is_of_run = path.ends_with("trajectory.csv") && task.is_file();
    let movement = if is_of_run { Some(read_task(&task, &[])?.task.duration) } else { None };
    let summary = path.with_file_name("summary.json");
    if is_of_run && summary.is_file() {
        verify_run(&summary)?;
    }
    let Read { mut recording, notes } = read(&bytes, mapping).map_err(|refusal| refused(&path, &refusal))?;
    if let Some(duration) = movement {
        recording.cut(duration);
    }
    let notes = notes.into_iter().map(|note| format!("{}: {note}", path.display())).collect();
    Ok(Loaded { sha256: sha256_of_bytes(&bytes), path, recording, notes })
}

/// The file that is meant by `path`, and its bytes.
///
/// # Errors
/// [`Failure::Input`] for what cannot be read.
pub fn bytes_of(path: &Path) -> Result<(PathBuf, Vec<u8>), Failure> {
    if !path.is_dir() {
        return read_bytes(path).map(|bytes| (path.to_owned(), bytes));
    }
    if !path.join("metadata.yaml").is_file() {
        let path = path.join("trajectory.csv");
        return read_bytes(&path).map(|bytes| (path, bytes));
    }
    // A bag is a folder: its files follow each other by their numbers.
    let entries = fs::read_dir(path).map_err(in_file(path))?;
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.sort_by_key(|file| (file.as_os_str().len(), file.clone()));
    let of = |ending: &str| {
        files.iter().filter(|file| file.to_string_lossy().ends_with(ending)).cloned().collect::<Vec<_>>()
    };
    let (mcap, packed, sqlite) = (of(".mcap"), of(".zstd"), of(".db3"));
    match (mcap.as_slice(), packed.first(), sqlite.first()) {
        ([first, rest @ ..], ..) => {
            let mut bytes = read_bytes(first)?;
            for file in rest {
                bytes.extend(read_bytes(file)?);
            }
            Ok((first.clone(), bytes))
        }
        ([], Some(packed), _) => {
            let unpack = "this bag is packed as a whole file, which is not read; this unpacks it: zstd -d --rm";
            Err(in_file(packed)(format!("{unpack} {}", packed.display())))
        }
        // Refused by what is in it.
        ([], None, Some(sqlite)) => read_bytes(sqlite).map(|bytes| (sqlite.clone(), bytes)),
        ([], None, None) => Err(in_file(path)("this folder of a bag holds no .mcap file")),
    }
}

/// A policy that leaves the range of its recordings by more than this share of it is noted.
const MARGIN: f64 = 0.05;
/// A position is rounded to this share of itself, at least.
const ROUNDING: f64 = 1e-9;

/// Notes of axes whose reference in `trace` leaves the range of the demonstrations by more than 5 % of it.
pub fn notes_outside(imitated: &Imitated, trace: &Trace) -> Vec<String> {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let of_axis = |(a, axis): (usize, &AxisTrace)| {
        let recorded = imitated.demonstrations.iter().chain(&imitated.aligned);
        let [low, high] = range(&mut recorded.flat_map(|one| one[a].iter().copied()));
        let [least, most] = range(&mut axis.reference_position[..=trace.steps()].iter().copied());
        let beyond = (low - least).max(most - high);
        let (name, unit) = (&imitated.policy.axes[a].name, imitated.policy.axes[a].unit.symbol());
        // Of an axis that never moves the range is rounding.
        (beyond > MARGIN * (high - low) + ROUNDING * high.abs().max(low.abs())).then(|| {
            format!(
                "axis `{name}`: the policy leaves the range of the recordings, {low:.4} to {high:.4} {unit}, by {beyond:.4} \
                 {unit}"
            )
        })
    };
    trace.axes.iter().enumerate().filter_map(of_axis).collect()
}

/// A refusal of the file `path`: its mistakes, what was seen, and the command that may read it.
pub fn refused(path: &Path, refusal: &Refusal) -> Failure {
    let lines = refusal.mistakes.iter().map(|mistake| format!("{}:{mistake}", path.display()));
    let mut text = lines.collect::<Vec<_>>().join("\nerror: ");
    if let Some(saw) = &refusal.saw {
        text += &format!("\n\nIn the file: {}", saw.to_string().trim_end());
        if let Some(command) = saw.command(&path.display().to_string()) {
            text += &format!("\n\ntry: {command}");
        }
    }
    Failure::Input(text)
}
