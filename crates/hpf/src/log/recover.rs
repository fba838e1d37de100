//! What can be rescued of an MCAP file that was cut or damaged, written as a whole one.
//!
//! A chunk whose checksum is right is taken whole; one whose checksum is wrong is left out whole; one that the file ends
//! in is taken as far as it goes.

use std::collections::BTreeMap;
use std::io::{self, Cursor};

use mcap::records::{MessageHeader, op};
use mcap::{MAGIC, McapError, Writer};
use prost::Message as _;

use super::fields::Fields;
use super::read::{Ending, summarize_bytes};
use super::scan::{Found, Piece, attachment, metadata};
use super::topic::Topic;
use super::{options, proto, to_io};

/// What was rescued, and what was not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recovered {
    /// A whole log of it.
    pub bytes: Vec<u8>,
    /// How the file that was read ends.
    pub ending: Ending,
    /// Messages rescued.
    pub messages: u64,
    /// Of these, from a chunk that the file ends in.
    pub from_cut_chunk: u64,
    /// Whole chunks rescued.
    pub chunks: u64,
    /// Names of the attachments rescued.
    pub attachments: Vec<String>,
    /// Names of the metadata rescued.
    pub metadata: Vec<String>,
    /// Time of the first and of the last message rescued [ns].
    pub times: Option<(u64, u64)>,
    /// The last learning update among them.
    pub last_update: Option<u64>,
    /// Chunks and attachments left out because their checksum is wrong.
    pub damaged: u64,
    /// Messages left out because nothing says what they are.
    pub orphans: u64,
    /// Bytes of the file in no record that could be read.
    pub strange_bytes: u64,
}

/// Rescues what is whole in the MCAP file `bytes`.
///
/// # Errors
/// A file in which nothing of an MCAP file is found.
pub fn recover(bytes: &[u8]) -> io::Result<Recovered> {
    let found = Found::scan(bytes)?;
    let has_anything = found.pieces.iter().any(|piece| !matches!(piece, Piece::Record(op::HEADER, _)));
    if !has_anything {
        let what = if bytes.starts_with(MAGIC) {
            "no whole record is in it: there is nothing to recover"
        } else {
            "this is not an MCAP file"
        };
        return Err(io::Error::new(io::ErrorKind::InvalidData, what));
    }
    let ending = summarize_bytes(bytes, bytes.len() as u64).map_or(Ending::Truncated, |summary| summary.ending);
    rewrite(&found).map(|recovered| Recovered { ending, ..recovered }).map_err(to_io)
}

/// Writes what was found as a whole log.
fn rewrite(found: &Found<'_>) -> Result<Recovered, McapError> {
    let mut definitions = Definitions::default();
    found.for_each(|opcode, data, _| {
        definitions.take(opcode, data);
        Ok(())
    })?;
    let is_whole = |piece: &&Piece<'_>| matches!(piece, Piece::Whole(_));
    let mut recovered = Recovered {
        chunks: found.pieces.iter().filter(is_whole).count() as u64,
        damaged: found.damaged,
        strange_bytes: found.strange_bytes,
        ..Recovered::default()
    };
    let mut writer = options().profile(definitions.profile.clone()).create(Cursor::new(Vec::new()))?;
    let mut is_defined = false;
    found.for_each(|opcode, data, is_cut| {
        match opcode {
            op::MESSAGE => {
                if !core::mem::replace(&mut is_defined, true) {
                    definitions.write(&mut writer)?;
                }
                recovered.message(data, is_cut, &definitions, &mut writer)?;
            }
            op::ATTACHMENT => {
                if let Some(attachment) = attachment(data) {
                    recovered.attachments.push(attachment.name.clone());
                    writer.attach(&attachment)?;
                }
            }
            op::METADATA => {
                if let Some(metadata) = metadata(data) {
                    recovered.metadata.push(metadata.name.clone());
                    writer.write_metadata(&metadata)?;
                }
            }
            _ => {}
        }
        Ok(())
    })?;
    if !is_defined {
        definitions.write(&mut writer)?;
    }
    writer.finish()?;
    recovered.bytes = writer.into_inner().into_inner();
    Ok(recovered)
}

impl Recovered {
    /// Writes a message, if it is known what it is.
    fn message(
        &mut self,
        data: &[u8],
        is_cut: bool,
        definitions: &Definitions,
        writer: &mut Writer<Cursor<Vec<u8>>>,
    ) -> Result<(), McapError> {
        let mut fields = Fields(data);
        let header = (|| {
            let (channel_id, sequence) = (fields.u16()?, fields.u32()?);
            let (log_time, publish_time) = (fields.u64()?, fields.u64()?);
            Some(MessageHeader { channel_id, sequence, log_time, publish_time })
        })();
        let channel = header.and_then(|header| definitions.channel(header.channel_id));
        let (Some(header), Some(channel)) = (header, channel) else {
            self.orphans += 1;
            return Ok(());
        };
        writer.write_to_known_channel(&header, fields.0)?;
        self.messages += 1;
        self.from_cut_chunk += u64::from(is_cut);
        let (first, last) = self.times.unwrap_or((header.log_time, header.log_time));
        self.times = Some((first.min(header.log_time), last.max(header.log_time)));
        if channel.topic == Topic::Update.name()
            && let Ok(update) = proto::Update::decode(fields.0)
        {
            self.last_update = Some(update.update);
        }
        Ok(())
    }
}

/// What messages are: the first definition of each number holds.
#[derive(Default)]
struct Definitions {
    profile: String,
    /// Name, encoding and definition.
    schemas: BTreeMap<u16, (String, String, Vec<u8>)>,
    channels: BTreeMap<u16, Channel>,
}

struct Channel {
    schema: u16,
    topic: String,
    encoding: String,
    metadata: BTreeMap<String, String>,
}

impl Definitions {
    fn take(&mut self, opcode: u8, data: &[u8]) {
        let mut fields = Fields(data);
        // A definition that is not all there defines nothing.
        let _ = match opcode {
            op::HEADER => (|| {
                self.profile = fields.text()?;
                Some(())
            })(),
            op::SCHEMA => (|| {
                let (id, name, encoding) = (fields.u16()?, fields.text()?, fields.text()?);
                let length = fields.u32()? as usize;
                let data = fields.bytes(length)?;
                if id != 0 {
                    self.schemas.entry(id).or_insert_with(|| (name, encoding, data.to_vec()));
                }
                Some(())
            })(),
            op::CHANNEL => (|| {
                let (id, schema) = (fields.u16()?, fields.u16()?);
                let (topic, encoding, metadata) = (fields.text()?, fields.text()?, fields.map()?);
                self.channels.entry(id).or_insert(Channel { schema, topic, encoding, metadata });
                Some(())
            })(),
            _ => None,
        };
    }

    /// The channel of this number, if its schema is known.
    fn channel(&self, id: u16) -> Option<&Channel> {
        self.channels.get(&id).filter(|channel| channel.schema == 0 || self.schemas.contains_key(&channel.schema))
    }

    /// Writes all of them, under the numbers they have.
    fn write(&self, writer: &mut Writer<Cursor<Vec<u8>>>) -> Result<(), McapError> {
        for (&id, (name, encoding, data)) in &self.schemas {
            writer.add_schema_with_id(id, name, encoding, data)?;
        }
        for &id in self.channels.keys() {
            if let Some(Channel { schema, topic, encoding, metadata }) = self.channel(id) {
                writer.add_channel_with_id(id, *schema, topic, encoding, metadata)?;
            }
        }
        Ok(())
    }
}
