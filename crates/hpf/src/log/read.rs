//! What is in an MCAP file, complete or not, ours or not.
//!
//! No length in the file is trusted: bytes are read as they come, a record is taken only when all of it is there, and
//! what the chunks unpack to is bounded ([`Work`]). Of a truncated file this finds
//! every whole chunk. An open chunk, as other writers leave it, carries the length `u64::MAX`: there the file ends.

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::Path;

use mcap::McapError;
use mcap::records::op;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::fields::{Chunk, Fields, chunk};
use super::scan::whole;
use super::work::Work;
use crate::nodes;

/// Bytes read at once.
const BLOCK: usize = 64 << 10;
/// Largest record, if the file is not larger [bytes]: a chunk can hold more than its file is long.
const LIMIT: u64 = 16 << 20;
/// Largest record of any file [bytes].
const MOST: u64 = 1 << 30;

/// What is in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// How it ends.
    pub ending: Ending,
    /// The program that wrote it.
    pub library: String,
    /// The topics, by name.
    pub topics: BTreeMap<String, TopicSummary>,
    /// Messages of all topics.
    pub messages: u64,
    /// Whole chunks.
    pub chunks: u64,
    /// Time of the first and of the last message [ns].
    pub times: Option<(u64, u64)>,
    /// Attachments in their order: name, media type and size [bytes].
    pub attachments: Vec<(String, String, u64)>,
    /// Metadata by name.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// Messages of channels that nothing defines, by the number of the channel.
    pub orphans: BTreeMap<u16, u64>,
    /// Logs that follow the first one in the file.
    pub followers: u64,
}

/// What is in a topic.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TopicSummary {
    /// Name of its schema; empty where it has none.
    pub schema: String,
    /// Encoding of its schema.
    pub schema_encoding: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// Number of its messages.
    pub messages: u64,
}

/// How a file ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Ending {
    /// As it should, and every checksum is right.
    Complete,
    /// In the middle: its writer was stopped.
    #[default]
    Truncated,
    /// With bytes that cannot be: what is wrong with them.
    Damaged(String),
}

/// Reads what is in the file at `path`.
///
/// # Errors
/// A file that cannot be read, or that is no MCAP file from its first bytes on.
pub fn summarize(path: &Path) -> io::Result<Summary> {
    let file = nodes::open(path)?;
    let length = file.metadata()?.len();
    summarize_bytes(file, length)
}

/// The same of `length` bytes.
///
/// # Errors
/// As for [`summarize`].
pub fn summarize_bytes(mut bytes: impl Read, length: u64) -> io::Result<Summary> {
    let limit = usize::try_from(length.clamp(LIMIT, MOST)).unwrap_or(usize::MAX);
    let options = LinearReaderOptions::default()
        .with_emit_chunks(true)
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true)
        .with_record_length_limit(limit);
    let mut reader = LinearReader::new_with_options(options.clone());
    let mut contents = Contents::default();
    let work = Work::of(length);
    let mut begun = false;
    // The first byte behind the end of a log, where another one follows.
    let mut ahead = None;
    contents.summary.ending = loop {
        match reader.next_event() {
            None => {
                let mut next = [0];
                if bytes.read(&mut next)? == 0 {
                    break Ending::Complete;
                }
                if next[0] != mcap::MAGIC[0] {
                    break Ending::Damaged("bytes that are no log follow its end".into());
                }
                ahead = Some(next[0]);
                contents.settle();
                contents.summary.followers += 1;
                reader = LinearReader::new_with_options(options.clone());
            }
            Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                let buffer = reader.insert(wanted.min(BLOCK));
                let read = match ahead.take() {
                    Some(byte) => {
                        buffer[0] = byte;
                        1
                    }
                    None => bytes.read(buffer)?,
                };
                reader.notify_read(read);
            }
            Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                begun = true;
                let taken = contents.take(opcode, data, &work);
                work.check()?;
                if let Err(ending) = taken {
                    break ending;
                }
            }
            Some(Err(McapError::BadMagic)) if !begun => {
                return Err(io::Error::new(io::ErrorKind::InvalidData, "this is not an MCAP file"));
            }
            Some(Err(error)) => break ending_of(&error, length),
        }
    };
    if !begun && length < mcap::MAGIC.len() as u64 {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "this is not an MCAP file: it is too short"));
    }
    Ok(contents.summary())
}

fn ending_of(error: &McapError, length: u64) -> Ending {
    match error {
        McapError::UnexpectedEof => Ending::Truncated,
        McapError::RecordTooLarge { len, .. } if *len > length => Ending::Truncated,
        other => Ending::Damaged(other.to_string()),
    }
}

/// What was found so far.
#[derive(Default)]
struct Contents {
    summary: Summary,
    schemas: BTreeMap<u16, (String, String)>,
    channels: BTreeMap<u16, Channel>,
}

#[derive(Default)]
struct Channel {
    topic: String,
    schema: u16,
    encoding: String,
    messages: u64,
}

impl Contents {
    /// Takes a record of the file, and all records of a chunk or none.
    fn take(&mut self, opcode: u8, data: &[u8], work: &Work) -> Result<(), Ending> {
        if opcode != op::CHUNK {
            return self.record(opcode, data).ok_or_else(|| Ending::Damaged(bad_record(opcode)));
        }
        let Some(chunk) = chunk(data).filter(Chunk::is_framed) else {
            return Err(Ending::Damaged(bad_record(opcode)));
        };
        // A chunk whose checksum is wrong gives no record at all.
        let records = whole(&chunk, work).map_err(|why| Ending::Damaged(why.into()))?;
        let mut records = Fields(&records);
        while let Some((opcode, data)) = records.record() {
            // A chunk holds nothing else.
            if matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
                self.record(opcode, data).ok_or_else(|| Ending::Damaged(bad_record(opcode)))?;
            }
        }
        self.summary.chunks += 1;
        Ok(())
    }

    /// Takes a record; `None` where its fields are not all there.
    fn record(&mut self, opcode: u8, data: &[u8]) -> Option<()> {
        let mut fields = Fields(data);
        match opcode {
            op::HEADER => {
                fields.text()?;
                self.summary.library = fields.text()?;
            }
            op::SCHEMA => {
                self.schemas.insert(fields.u16()?, (fields.text()?, fields.text()?));
            }
            op::CHANNEL => {
                let (id, schema) = (fields.u16()?, fields.u16()?);
                let (topic, encoding) = (fields.text()?, fields.text()?);
                // The summary section repeats every channel.
                let messages = self.channels.get(&id).map_or(0, |channel| channel.messages);
                self.channels.insert(id, Channel { topic, schema, encoding, messages });
            }
            op::MESSAGE => {
                let (id, _sequence, time) = (fields.u16()?, fields.u32()?, fields.u64()?);
                let Some(channel) = self.channels.get_mut(&id) else {
                    *self.summary.orphans.entry(id).or_default() += 1;
                    return Some(());
                };
                channel.messages += 1;
                let (first, last) = self.summary.times.unwrap_or((time, time));
                self.summary.times = Some((first.min(time), last.max(time)));
                self.summary.messages += 1;
            }
            op::ATTACHMENT => {
                fields.bytes(16)?;
                self.summary.attachments.push((fields.text()?, fields.text()?, fields.u64()?));
            }
            op::METADATA => {
                let name = fields.text()?;
                self.summary.metadata.insert(name, fields.map()?);
            }
            _ => {}
        }
        Some(())
    }

    /// Counts the messages of a log: another one defines its channels anew.
    fn settle(&mut self) {
        for channel in core::mem::take(&mut self.channels).into_values() {
            let (schema, schema_encoding) = self.schemas.get(&channel.schema).cloned().unwrap_or_default();
            let topic = self.summary.topics.entry(channel.topic).or_default();
            let messages = topic.messages + channel.messages;
            *topic = TopicSummary { schema, schema_encoding, encoding: channel.encoding, messages };
        }
        self.schemas.clear();
    }

    fn summary(mut self) -> Summary {
        self.settle();
        self.summary
    }
}

fn bad_record(opcode: u8) -> String {
    format!("a record of kind {opcode:#04x} has fields longer than itself")
}
