//! `checkpoint`: the records of learning so far, from which a resumed run leads to the same bytes.
//!
//! ```text
//! hpf-checkpoint 3 hpf 0.1.0 task.toml=3f...\n  version of the file, of the program, SHA-256 of what the run began with
//! length crc record, length crc record, ...    u32, u32 (CRC-32 of the record), postcard of `hpf_learn::Record`
//! ```
//! The file only grows, by one write for each batch of motions: nothing is written twice, whatever the size of the
//! learner's state, and every prefix of the file is a checkpoint too. Where a kill or a lost disk block cuts a record,
//! only the motions after it are lost: they are made again, and are the same.

use core::time::Duration;
use std::fs::File;
use std::io::{self, BufRead as _, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::Instant;

use hpf_learn::Record;

use crate::failure::Failure;
use crate::files::{in_file, while_writing};
use crate::nodes;

/// Version of the file.
const VERSION: &str = "3";
/// Longest first line read [bytes].
const LONGEST_HEAD: u64 = 1 << 14;
/// Bytes before a record: its length and its checksum.
const FRAME: usize = 8;
/// Longest time until a power cut can no longer undo an update.
const SYNC_INTERVAL: Duration = Duration::from_secs(10);

/// A checkpoint being written.
pub struct Checkpoint {
    file: File,
    path: PathBuf,
    buffer: Vec<u8>,
    synced: Instant,
}

/// A file that a run begins with: its name in the run directory, and its SHA-256.
pub type Input = (String, String);

fn head(inputs: &[Input]) -> String {
    let inputs: String = inputs.iter().map(|(name, sha256)| format!(" {name}={sha256}")).collect();
    format!("hpf-checkpoint {VERSION} hpf {}{inputs}\n", env!("CARGO_PKG_VERSION"))
}

impl Checkpoint {
    /// Begins the checkpoint of a run that begins with `inputs`.
    ///
    /// # Errors
    /// [`Failure::Work`] that names the file.
    pub fn create(path: &Path, inputs: &[Input]) -> Result<Self, Failure> {
        let create = || {
            let mut file = File::create_new(path)?;
            file.write_all(head(inputs).as_bytes())?;
            Ok(file)
        };
        let file = create().map_err(while_writing::<io::Error>(path))?;
        Ok(Self { file, path: path.to_owned(), buffer: Vec::new(), synced: Instant::now() })
    }

    /// Opens the checkpoint of a run that began with `inputs`, hands each of its records to `take`, and cuts off what is
    /// damaged. Returns the bytes cut off, too.
    ///
    /// # Errors
    /// [`Failure::Input`] for a file that is no checkpoint of this version and these inputs; what `take` says.
    pub fn open(
        path: &Path,
        inputs: &[Input],
        mut take: impl FnMut(Record) -> Result<(), Failure>,
    ) -> Result<(Self, u64), Failure> {
        let file = nodes::replaceable(path).and_then(|()| File::options().read(true).write(true).open(path));
        let file = file.map_err(in_file(path))?;
        let length = file.metadata().map_err(in_file(path))?.len();
        let mut reader = BufReader::new(&file);
        let mut line = Vec::new();
        (&mut reader).take(LONGEST_HEAD).read_until(b'\n', &mut line).map_err(in_file(path))?;
        check_head(&String::from_utf8_lossy(&line), inputs).map_err(in_file(path))?;
        let mut whole = line.len() as u64;
        while let Some((record, bytes)) = next(&mut reader, length - whole).map_err(in_file(path))? {
            take(record)?;
            whole += bytes;
        }
        let mut file = file;
        file.set_len(whole).and_then(|()| file.seek(SeekFrom::End(0))).map_err(while_writing(path))?;
        let checkpoint = Self { file, path: path.to_owned(), buffer: Vec::new(), synced: Instant::now() };
        Ok((checkpoint, length - whole))
    }

    /// Adds a record: it outlives the program from here on, and a power cut some seconds later.
    ///
    /// # Errors
    /// [`Failure::Work`] that names the file.
    pub fn append(&mut self, record: &Record) -> Result<(), Failure> {
        let mut buffer = core::mem::take(&mut self.buffer);
        buffer.clear();
        buffer.resize(FRAME, 0);
        buffer = postcard::to_extend(record, buffer).expect("numbers and lists can be written");
        let (frame, body) = buffer.split_at_mut(FRAME);
        let length = u32::try_from(body.len()).map_err(|_| {
            let size = body.len();
            Failure::Work(format!("cannot write {}: a record of {size} bytes is too long", self.path.display()))
        })?;
        frame[..4].copy_from_slice(&length.to_le_bytes());
        frame[4..].copy_from_slice(&crc32fast::hash(body).to_le_bytes());
        let mut write = || {
            self.file.write_all(&buffer)?;
            if self.synced.elapsed() >= SYNC_INTERVAL {
                self.synced = Instant::now();
                self.file.sync_data()?;
            }
            Ok(())
        };
        write().map_err(while_writing::<io::Error>(&self.path))?;
        self.buffer = buffer;
        Ok(())
    }
}

/// Refuses a first line that is not this one, and says what it is.
fn check_head(line: &str, inputs: &[Input]) -> Result<(), String> {
    if line == head(inputs) {
        return Ok(());
    }
    let damaged =
        || Err("this is no checkpoint, or its first line is damaged; learn the task again with --force".into());
    let words: Vec<&str> = line.split_whitespace().collect();
    let ["hpf-checkpoint", version, "hpf", program, began_with @ ..] = &words[..] else { return damaged() };
    if *version != VERSION {
        return Err(format!("this is a checkpoint of version {version}; this program reads version {VERSION}"));
    }
    if *program != env!("CARGO_PKG_VERSION") {
        let own = env!("CARGO_PKG_VERSION");
        return Err(format!("hpf {program} began this run and hpf {own} may go on differently: use hpf {program}"));
    }
    let began_with: Vec<(&str, &str)> = began_with.iter().filter_map(|input| input.split_once('=')).collect();
    let is_same = |(name, sha256): &(&str, &str)| inputs.iter().any(|(own, is)| own == name && is == sha256);
    if let Some((name, _)) = began_with.iter().find(|input| !is_same(input)) {
        return Err(format!(
            "{name} is not what this run began with; put it back, or learn the task anew with --force"
        ));
    }
    match inputs.iter().find(|(name, _)| began_with.iter().all(|(before, _)| before != name)) {
        Some((name, _)) => {
            Err(format!("this run began without {name}; remove it, or learn the task anew with --force"))
        }
        None => damaged(),
    }
}

/// The next record and its size in the file; `None` at the end and where what follows is damaged.
fn next(reader: &mut impl io::Read, left: u64) -> io::Result<Option<(Record, u64)>> {
    let mut frame = [0; FRAME];
    if left < FRAME as u64 {
        return Ok(None);
    }
    reader.read_exact(&mut frame)?;
    let [a, b, c, d, rest @ ..] = frame;
    let (length, checksum) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes(rest));
    // The length is believed no further than the file goes: it may be damaged itself.
    if u64::from(length) > left - FRAME as u64 {
        return Ok(None);
    }
    let mut body = vec![0; length as usize];
    reader.read_exact(&mut body)?;
    if crc32fast::hash(&body) != checksum {
        return Ok(None);
    }
    Ok(postcard::from_bytes(&body).ok().map(|record| (record, FRAME as u64 + u64::from(length))))
}

#[cfg(test)]
mod tests {
    use hpf_learn::Price;

    use super::*;

    fn records() -> Vec<Record> {
        let price = |total: f64| Price { total, terms: vec![total, -0.0, f64::MIN_POSITIVE] };
        vec![
            Record::Costs(vec![price(0.1)]),
            Record::Update {
                update: 1,
                weights: vec![1.0 / 3.0, 5e-324],
                spread: vec![1.0, 1.0],
                exploration: 0.5,
                rejected: 2,
                cheapest: Some((vec![2.0, 3.0], price(1e300))),
            },
            Record::Signals { prices: vec![price(f64::INFINITY)], signals: vec![vec![f64::NEG_INFINITY, 0.25]] },
        ]
    }

    fn inputs() -> Vec<Input> {
        [("task.toml", "abc"), ("start_policy.json", "123")].map(|(name, sum)| (name.into(), sum.into())).to_vec()
    }

    fn write(path: &Path) {
        let mut checkpoint = Checkpoint::create(path, &inputs()).unwrap();
        records().iter().for_each(|record| checkpoint.append(record).unwrap());
    }

    fn read(path: &Path) -> Result<(Vec<Record>, u64), String> {
        let mut found = Vec::new();
        let opened = Checkpoint::open(path, &inputs(), |record| {
            found.push(record);
            Ok(())
        });
        opened.map(|(_, damaged)| (found, damaged)).map_err(|failure| failure.to_string())
    }

    #[test]
    fn records_come_back_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint");
        write(&path);
        assert_eq!(read(&path).unwrap(), (records(), 0));
    }

    #[test]
    fn cut_anywhere_a_checkpoint_has_the_records_before_the_cut_and_goes_on_from_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint");
        write(&path);
        let bytes = std::fs::read(&path).unwrap();
        for length in head(&inputs()).len()..bytes.len() {
            std::fs::write(&path, &bytes[..length]).unwrap();
            let (found, _) = read(&path).unwrap();
            assert!(found.len() < 3 && found[..] == records()[..found.len()], "{length} bytes");
            // What is left is whole, and what is added follows it.
            let (mut checkpoint, damaged) = Checkpoint::open(&path, &inputs(), |_| Ok(())).unwrap();
            assert_eq!(damaged, 0);
            records()[found.len()..].iter().for_each(|record| checkpoint.append(record).unwrap());
            assert_eq!(std::fs::read(&path).unwrap(), bytes);
        }
    }

    #[test]
    fn a_damaged_byte_ends_the_checkpoint_before_its_record_or_refuses_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint");
        write(&path);
        let bytes = std::fs::read(&path).unwrap();
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 0x41;
            std::fs::write(&path, &damaged).unwrap();
            match read(&path) {
                Ok((found, cut)) => {
                    assert!(place >= head(&inputs()).len() && cut > 0, "byte {place}");
                    assert!(found.len() < 3 && found[..] == records()[..found.len()], "byte {place}");
                }
                Err(_) => assert!(place < head(&inputs()).len(), "byte {place}"),
            }
        }
    }

    #[test]
    fn other_versions_and_inputs_are_refused_by_name() {
        let own = head(&inputs());
        for (line, words) in [
            (own.replace("checkpoint 3", "checkpoint 9"), "version 9"),
            (own.replace(env!("CARGO_PKG_VERSION"), "7.7.7"), "hpf 7.7.7"),
            (own.replace("abc", "def"), "task.toml is not what"),
            (own.replace("123", "321"), "start_policy.json is not what"),
            (own.replace(" start_policy.json=123", ""), "began without start_policy.json"),
            (own.replace('\n', " disturbance_0.csv=5\n"), "disturbance_0.csv is not what"),
            (own.replace('\n', " and more\n"), "no checkpoint"),
            ("\u{fffd}\u{fffd}".to_owned(), "no checkpoint"),
            (String::new(), "no checkpoint"),
        ] {
            let refused = check_head(&line, &inputs()).unwrap_err();
            assert!(refused.contains(words), "{refused}");
        }
    }
}
