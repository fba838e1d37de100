//! One way for every file: its reader by its first bytes, the mapping, the treatment.

use hpf_sim::Demonstration;

use crate::collect::collect;
use crate::mapping::Mapping;
use crate::mistake::{Mistake, Refusal};
use crate::saw::{Saw, Topic};
use crate::select::plan;
use crate::table::Table;
use crate::treat::treat;
use crate::{npy, refused, text};

/// A recording, and what was mended in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Read {
    /// The recording.
    pub recording: Demonstration,
    /// What the user should know: what was mended, what was taken for granted, what is not read.
    pub notes: Vec<String>,
}

/// A format: how it is recognized and read. A file each.
trait Format {
    /// Whether these are the first bytes of a file of this format.
    fn fits(&self, bytes: &[u8]) -> bool;

    /// Its columns, and the topics that there are.
    fn table(&self, bytes: &[u8], mapping: &Mapping) -> Result<(Table, Vec<Topic>), Refusal>;
}

struct Array;

impl Format for Array {
    fn fits(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(npy::MAGIC)
    }

    fn table(&self, bytes: &[u8], _: &Mapping) -> Result<(Table, Vec<Topic>), Refusal> {
        npy::read(bytes).map(|table| (table, Vec::new()))
    }
}

struct Archive;

impl Format for Archive {
    fn fits(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(npy::ZIP_MAGIC)
    }

    fn table(&self, bytes: &[u8], mapping: &Mapping) -> Result<(Table, Vec<Topic>), Refusal> {
        npy::read_archive(bytes, mapping)
    }
}

#[cfg(feature = "bags")]
struct Bag;

#[cfg(feature = "bags")]
impl Format for Bag {
    fn fits(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(mcap::MAGIC)
    }

    fn table(&self, bytes: &[u8], mapping: &Mapping) -> Result<(Table, Vec<Topic>), Refusal> {
        crate::bag::read(bytes, mapping)
    }
}

struct Text;

impl Format for Text {
    fn fits(&self, _: &[u8]) -> bool {
        true
    }

    fn table(&self, bytes: &[u8], _: &Mapping) -> Result<(Table, Vec<Topic>), Refusal> {
        text::read(bytes).map(|table| (table, Vec::new()))
    }
}

/// Every format in the order in which it is tried. Text has no mark of its own and comes last.
const FORMATS: &[&dyn Format] = &[
    &Array,
    &Archive,
    #[cfg(feature = "bags")]
    &Bag,
    &Text,
];

fn table(bytes: &[u8], mapping: &Mapping) -> Result<(Table, Vec<Topic>), Refusal> {
    if let Some(why) = refused::known(bytes) {
        return Err(Mistake::whole(why).into());
    }
    let format = FORMATS.iter().find(|format| format.fits(bytes)).expect("text fits everything");
    format.table(bytes, mapping)
}

/// Reads the recording in `bytes`, a whole file.
///
/// ```
/// let text = "time_s,x_m\n3.0,0.0\n3.1,0.1\n3.2,0.5\n3.3,0.9\n3.4,1.0\n";
/// let read = hpf_recordings::read(text.as_bytes(), &hpf_recordings::Mapping::default()).unwrap();
/// assert_eq!(read.recording.axes[0].name, "x");
/// assert!((read.recording.duration() - 0.4).abs() < 1e-12);
/// ```
///
/// # Errors
/// Every mistake found, to [`MAX_MISTAKES`](crate::MAX_MISTAKES), and what is in the file where it could be looked into.
pub fn read(bytes: &[u8], mapping: &Mapping) -> Result<Read, Refusal> {
    mapping.check().map_err(|why| Refusal::from(Mistake::whole(why)))?;
    let (table, topics) = table(bytes, mapping)?;
    let mut notes = table.notes.clone();
    let with_saw =
        |mistakes| Refusal { saw: Some(Box::new(Saw::of(&table, topics.clone()))), ..Refusal::new(mistakes) };
    let plan = plan(&table, mapping).map_err(with_saw)?;
    notes.extend(plan.notes.iter().cloned());
    let mut raw = collect(&table, &plan, mapping, &mut notes).map_err(Refusal::new)?;
    treat(&mut raw, mapping, &mut notes).map_err(Refusal::new)?;
    Ok(Read { recording: Demonstration { time: raw.time, axes: raw.axes }, notes })
}

/// What is in `bytes`, a whole file: its columns, what they may be and why, and the options that may read it.
///
/// # Errors
/// Why nothing of it can be read.
pub fn inspect(bytes: &[u8], mapping: &Mapping) -> Result<Saw, Refusal> {
    match table(bytes, mapping) {
        Ok((table, topics)) => Ok(Saw::of(&table, topics)),
        Err(Refusal { saw: Some(saw), .. }) => Ok(*saw),
        Err(refusal) => Err(refusal),
    }
}
