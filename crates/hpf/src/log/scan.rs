//! Finds the whole records of an MCAP file that was cut or damaged.
//!
//! The file is read from its front, record by record. Behind bytes that are no record the search continues for records that
//! prove themselves: chunks and attachments by their checksum, metadata by its frame. No length in the file is believed:
//! nothing is allocated for bytes that are not there.

use std::borrow::Cow;
use std::io::{self, Read};

use mcap::records::{Metadata, op};
use mcap::{Attachment, MAGIC, McapError};

use super::fields::{Chunk, Fields, are_framed, chunk};
use super::work::Work;

/// Bytes before the contents of a record: its kind and its length.
const RECORD_HEAD: usize = 9;
/// Most bytes that one chunk is unpacked to.
const MOST: u64 = 1 << 30;

/// A part of the file that can be read.
pub enum Piece<'a> {
    /// A record outside of chunks.
    Record(u8, &'a [u8]),
    /// A chunk whose checksum is right.
    Whole(Chunk<'a>),
    /// A chunk that the file ends in.
    Cut(Chunk<'a>),
}

/// What is found at a place in the file.
enum Place<'a> {
    /// A piece, and how long it is [bytes].
    Piece(Piece<'a>, usize),
    /// A chunk that is all there and damaged, and how long it is [bytes].
    Damaged(usize),
    /// Bytes that are no record.
    Strange,
}

/// What is in a file.
#[derive(Default)]
pub struct Found<'a> {
    /// What can be read, in its order.
    pub pieces: Vec<Piece<'a>>,
    /// Chunks and attachments whose checksum is wrong.
    pub damaged: u64,
    /// Bytes in no record that can be read.
    pub strange_bytes: u64,
}

impl<'a> Found<'a> {
    /// Looks through a file.
    ///
    /// # Errors
    /// A file that asks for too much work.
    pub fn scan(bytes: &'a [u8]) -> io::Result<Self> {
        let work = Work::of(bytes.len() as u64);
        let mut found = Self::default();
        let mut rest = bytes.strip_prefix(MAGIC).unwrap_or(bytes);
        // Whether `rest` begins where a record ended.
        let mut is_aligned = rest.len() < bytes.len();
        let mut unread = 0;
        // Behind the end of the data is the index: what looks like a message there is a damaged record of another kind.
        let mut is_index = false;
        while !rest.is_empty() {
            if is_aligned && rest == MAGIC {
                break;
            }
            let place = if is_aligned { aligned(rest, &work) } else { proven(rest, &work) };
            work.check()?;
            let length = match place {
                Place::Piece(piece, length) => {
                    is_aligned = !matches!(piece, Piece::Cut(_));
                    found.strange_bytes += core::mem::take(&mut unread);
                    is_index |= matches!(piece, Piece::Record(op::DATA_END, data) if data.len() == 4);
                    if is_index && matches!(piece, Piece::Record(op::MESSAGE, _)) {
                        found.damaged += 1;
                    } else {
                        found.pieces.push(piece);
                    }
                    length
                }
                Place::Damaged(length) => {
                    found.damaged += 1;
                    length
                }
                Place::Strange => {
                    is_aligned = false;
                    unread += 1;
                    1
                }
            };
            rest = &rest[length..];
        }
        // What follows the head of a cut chunk is that chunk.
        if !matches!(found.pieces.last(), Some(Piece::Cut(_))) {
            found.strange_bytes += unread;
        }
        Ok(found)
    }

    /// Every record, in and out of chunks, and whether it is from a cut chunk, up to the first error of `use_record`.
    pub fn for_each(
        &self,
        mut use_record: impl FnMut(u8, &[u8], bool) -> Result<(), McapError>,
    ) -> Result<(), McapError> {
        for piece in &self.pieces {
            let (chunk, is_cut) = match piece {
                Piece::Record(opcode, data) => {
                    use_record(*opcode, data, false)?;
                    continue;
                }
                Piece::Whole(chunk) => (chunk, false),
                Piece::Cut(chunk) => (chunk, true),
            };
            let unpacked = unpack(chunk);
            let mut records = Fields(&unpacked);
            while let Some((opcode, data)) = records.record() {
                use_record(opcode, data, is_cut)?;
            }
        }
        Ok(())
    }
}

/// What stands where a record is to begin.
fn aligned<'a>(rest: &'a [u8], work: &Work) -> Place<'a> {
    let proven = proven(rest, work);
    if !matches!(proven, Place::Strange) {
        return proven;
    }
    if let Some((opcode, data)) = (Fields(rest)).record() {
        let length = RECORD_HEAD + data.len();
        if !is_kind(opcode) || !may_begin(&rest[length..]) {
            return Place::Strange;
        }
        return match opcode {
            op::CHUNK if chunk(data).is_some_and(|chunk| chunk.crc == 0 && is_intact(&chunk, work)) => {
                Place::Piece(Piece::Whole(chunk(data).expect("it was read just now")), length)
            }
            op::CHUNK => Place::Damaged(length),
            op::ATTACHMENT if attachment_crc(data) != Some(0) => Place::Damaged(length),
            // A damaged length may reach over records that are whole.
            _ if hides_record(data, work) => Place::Strange,
            _ => Place::Piece(Piece::Record(opcode, data), length),
        };
    }
    // A chunk that the file ends in, or that its writer never closed.
    match rest.split_first_chunk::<RECORD_HEAD>() {
        Some((head, data)) if head[0] == op::CHUNK => match chunk(data) {
            // Its length may be what is damaged: the search continues inside, where no record proves itself.
            Some(chunk) => Place::Piece(Piece::Cut(chunk), RECORD_HEAD),
            None => Place::Strange,
        },
        _ => Place::Strange,
    }
}

/// A record that proves itself: a chunk or an attachment by its checksum, metadata by filling its frame.
fn proven<'a>(rest: &'a [u8], work: &Work) -> Place<'a> {
    let Some((&opcode, _)) = rest.split_first() else { return Place::Strange };
    if opcode == op::CHUNK && rest.len() > RECORD_HEAD {
        // One of the lengths, the record's and the chunk's own, may be damaged: the shorter one reaches over no other.
        let outer = Fields(&rest[1..]).u64().and_then(|length| usize::try_from(length).ok()).unwrap_or(usize::MAX);
        let found = chunk(&rest[RECORD_HEAD..]).filter(|chunk| chunk.crc != 0 && is_intact(chunk, work));
        return found.map_or(Place::Strange, |chunk| {
            let length = RECORD_HEAD + chunk.extent().min(outer);
            Place::Piece(Piece::Whole(chunk), length)
        });
    }
    let Some((_, data)) = Fields(rest).record() else { return Place::Strange };
    let is_proven = match opcode {
        op::ATTACHMENT => attachment_crc(data).is_some_and(|crc| {
            crc != 0 && work.spend(data.len() as u64) && crc == crc32fast::hash(&data[..data.len() - 4])
        }),
        op::METADATA => metadata(data).is_some() && may_begin(&rest[RECORD_HEAD + data.len()..]),
        _ => false,
    };
    if is_proven { Place::Piece(Piece::Record(opcode, data), RECORD_HEAD + data.len()) } else { Place::Strange }
}

/// Whether `bytes` hold a whole chunk or attachment.
fn hides_record(bytes: &[u8], work: &Work) -> bool {
    // A record is looked through once: what it hides is not looked through again for each of its bytes.
    if !work.spend(bytes.len() as u64) {
        return false;
    }
    let may_be = |at: &usize| [op::CHUNK, op::ATTACHMENT].contains(&bytes[*at]);
    (0..bytes.len()).filter(may_be).any(|at| !matches!(proven(&bytes[at..], work), Place::Strange))
}

/// Whether a record, all of it or its first bytes, may begin here.
fn may_begin(rest: &[u8]) -> bool {
    let mut fields = Fields(rest);
    let Some(opcode) = fields.bytes(1).map(|opcode| opcode[0]) else { return true };
    let length = fields.u64();
    let is_length = length.is_none_or(|length| length <= MOST || (opcode == op::CHUNK && length == u64::MAX));
    MAGIC.starts_with(&rest[..rest.len().min(MAGIC.len())]) || (is_kind(opcode) && is_length)
}

/// Whether records of this kind exist: those of the format, and private ones.
fn is_kind(opcode: u8) -> bool {
    (op::HEADER..=op::DATA_END).contains(&opcode) || opcode >= 0x80
}

/// Whether a chunk is all there, of the size and with the checksum it says.
fn is_intact(chunk: &Chunk<'_>, work: &Work) -> bool {
    whole(chunk, work).is_ok()
}

/// The records of a chunk that is all there, of the size and with the checksum it says.
///
/// # Errors
/// What is wrong with it.
pub fn whole<'a>(chunk: &Chunk<'a>, work: &Work) -> Result<Cow<'a, [u8]>, &'static str> {
    if chunk.records.len() as u64 != chunk.length || chunk.size > MOST {
        return Err("a chunk is not as long as it says");
    }
    if !["", "zstd", "lz4"].contains(&chunk.compression.as_str()) {
        return Err("a chunk is compressed in a way that is not read");
    }
    if !work.spend(chunk.size.max(chunk.length)) {
        return Err("the chunks unpack to too much");
    }
    let unpacked = unpack(chunk);
    if unpacked.len() as u64 != chunk.size {
        return Err("a chunk does not unpack to the size it says");
    }
    if chunk.crc != 0 && crc32fast::hash(&unpacked) != chunk.crc {
        return Err("the checksum (CRC) of a chunk is wrong");
    }
    if are_framed(&unpacked) { Ok(unpacked) } else { Err("a chunk does not hold whole records") }
}

/// The records of a chunk, as far as they can be unpacked.
fn unpack<'a>(chunk: &Chunk<'a>) -> Cow<'a, [u8]> {
    let read = |decoder: io::Result<Box<dyn Read + 'a>>| {
        let mut unpacked = Vec::new();
        if let Ok(decoder) = decoder {
            // Where a stream breaks off, what came before is kept.
            let _ = decoder.take(chunk.size.min(MOST)).read_to_end(&mut unpacked);
        }
        Cow::Owned(unpacked)
    };
    match chunk.compression.as_str() {
        "" => Cow::Borrowed(chunk.records),
        "zstd" => read(zstd::Decoder::new(chunk.records).map(|decoder| Box::new(decoder) as _)),
        "lz4" => read(lz4::Decoder::new(chunk.records).map(|decoder| Box::new(decoder) as _)),
        _ => Cow::Borrowed(&[]),
    }
}

/// The fields of an attachment; `None` where they are not all there.
pub fn attachment(data: &[u8]) -> Option<Attachment<'_>> {
    let mut fields = Fields(data);
    let (log_time, create_time) = (fields.u64()?, fields.u64()?);
    let (name, media_type) = (fields.text()?, fields.text()?);
    let length = usize::try_from(fields.u64()?).ok()?;
    Some(Attachment { log_time, create_time, name, media_type, data: Cow::Borrowed(fields.bytes(length)?) })
}

/// The checksum of an attachment whose fields and checksum fill its record; zero where it has none.
fn attachment_crc(data: &[u8]) -> Option<u32> {
    let (front, crc) = data.split_last_chunk::<4>()?;
    let found = attachment(front)?;
    let fixed = 8 + 8 + 4 + 4 + 8;
    let length = fixed + found.name.len() + found.media_type.len() + found.data.len();
    (length == front.len()).then(|| u32::from_le_bytes(*crc))
}

/// Metadata that fills its record.
pub fn metadata(data: &[u8]) -> Option<Metadata> {
    let mut fields = Fields(data);
    let metadata = Metadata { name: fields.text()?, metadata: fields.map()? };
    fields.0.is_empty().then_some(metadata)
}
