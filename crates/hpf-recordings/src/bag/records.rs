//! The records of MCAP files, no length of which is trusted.

use std::collections::HashMap;
use std::io::Read as _;

use mcap::records::Record;

/// Most that one chunk unpacks to [bytes].
const MAX_CHUNK: u64 = 256 << 20;
/// Most that all chunks unpack to: so much, and so many times the size of the file beyond it [bytes].
const MAX_UNPACKED: (u64, u64) = (256 << 20, 200);

/// A message, and what it is.
pub struct Message<'m> {
    pub topic: &'m str,
    /// Name of its type.
    pub schema: &'m str,
    /// How its bytes are written.
    pub encoding: &'m str,
    /// When it arrived [ns].
    pub log_time: u64,
    pub data: &'m [u8],
}

/// What was seen beside messages.
#[derive(Default)]
pub struct Contents {
    pub is_cut: bool,
    pub damaged: usize,
    pub orphans: usize,
    pub files: usize,
    /// The task of a run, in its log.
    pub task: Option<String>,
}

#[derive(Default)]
struct Reader {
    contents: Contents,
    schemas: HashMap<u16, String>,
    /// Topic, schema, encoding.
    channels: HashMap<u16, (String, u16, String)>,
    unpacked: u64,
}

/// Gives every message of `bytes` to `use_message`.
pub fn read(bytes: &[u8], mut use_message: impl FnMut(&Message<'_>)) -> Result<Contents, String> {
    let mut reader = Reader::default();
    let most = MAX_UNPACKED.0.saturating_add(MAX_UNPACKED.1.saturating_mul(bytes.len() as u64));
    let mut rest = bytes;
    while !rest.is_empty() {
        if let Some(behind) = rest.strip_prefix(mcap::MAGIC) {
            // A magic begins a file or ends one; another file has definitions of its own.
            if behind.first() == Some(&mcap::records::op::HEADER) {
                reader.contents.files += 1;
                (reader.schemas, reader.channels) = (HashMap::new(), HashMap::new());
            }
            rest = behind;
            continue;
        }
        let Some((opcode, body, behind)) = record(rest) else {
            reader.contents.is_cut = true;
            break;
        };
        reader.take(opcode, body, true, &mut use_message);
        if reader.unpacked > most {
            return Err(format!(
                "its chunks unpack to more than {} MB, at most {} MB and {} times the size of the file are read",
                most >> 20,
                MAX_UNPACKED.0 >> 20,
                MAX_UNPACKED.1
            ));
        }
        rest = behind;
    }
    Ok(reader.contents)
}

/// The first record of `bytes`: kind, contents, what follows.
fn record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (head, rest) = bytes.split_first_chunk::<9>()?;
    let length = u64::from_le_bytes(*head.last_chunk::<8>()?);
    let (body, rest) = rest.split_at_checked(usize::try_from(length).ok()?)?;
    Some((head[0], body, rest))
}

impl Reader {
    fn take(&mut self, opcode: u8, body: &[u8], is_outer: bool, use_message: &mut impl FnMut(&Message<'_>)) {
        use mcap::records::op;
        if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK | op::ATTACHMENT) {
            return;
        }
        let Ok(record) = mcap::parse_record(opcode, body) else {
            self.contents.damaged += 1;
            return;
        };
        match record {
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                self.channels.insert(channel.id, (channel.topic, channel.schema_id, channel.message_encoding));
            }
            Record::Message { header, data } => {
                let Some((topic, schema, encoding)) = self.channels.get(&header.channel_id) else {
                    self.contents.orphans += 1;
                    return;
                };
                let schema = self.schemas.get(schema).map_or("", String::as_str);
                use_message(&Message { topic, schema, encoding, log_time: header.log_time, data: &data });
            }
            Record::Attachment { header, data, .. } if header.name == "task.toml" => {
                self.contents.task = String::from_utf8(data.into_owned()).ok();
            }
            Record::Chunk { header, data } if is_outer => {
                let size = header.uncompressed_size;
                self.unpacked = self.unpacked.saturating_add(size);
                let unpacked = if size > MAX_CHUNK { None } else { unpack(&header.compression, &data, size) };
                let Some(records) = unpacked else {
                    self.contents.damaged += 1;
                    return;
                };
                if header.uncompressed_crc != 0 && header.uncompressed_crc != crc32fast::hash(&records) {
                    self.contents.damaged += 1;
                    return;
                }
                let mut rest = records.as_slice();
                while let Some((opcode, body, behind)) = self::record(rest) {
                    self.take(opcode, body, false, use_message);
                    rest = behind;
                }
            }
            _ => {}
        }
    }
}

/// The records of a chunk of `size` bytes.
fn unpack(compression: &str, data: &[u8], size: u64) -> Option<Vec<u8>> {
    let mut unpacked = Vec::new();
    match compression {
        "" => unpacked.extend_from_slice(data),
        "zstd" => {
            zstd::Decoder::new(data).ok()?.take(size).read_to_end(&mut unpacked).ok()?;
        }
        "lz4" => {
            lz4::Decoder::new(data).ok()?.take(size).read_to_end(&mut unpacked).ok()?;
        }
        _ => return None,
    }
    (unpacked.len() as u64 == size).then_some(unpacked)
}
