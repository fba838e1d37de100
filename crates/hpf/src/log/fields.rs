//! The fields of MCAP records, read without trusting any length in them.

use std::collections::BTreeMap;

/// The fields of a record, taken from its front; `None` where it is too short.
pub struct Fields<'a>(pub &'a [u8]);

impl<'a> Fields<'a> {
    pub fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (front, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(front)
    }

    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.bytes(N)?.try_into().ok()
    }

    pub fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub fn text(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        self.bytes(length).map(|text| String::from_utf8_lossy(text).into_owned())
    }

    pub fn map(&mut self) -> Option<BTreeMap<String, String>> {
        let length = self.u32()? as usize;
        let mut pairs = Fields(self.bytes(length)?);
        let mut map = BTreeMap::new();
        while !pairs.0.is_empty() {
            map.insert(pairs.text()?, pairs.text()?);
        }
        Some(map)
    }

    /// The next record: its kind and its contents.
    pub fn record(&mut self) -> Option<(u8, &'a [u8])> {
        let opcode = self.bytes(1)?[0];
        let length = usize::try_from(self.u64()?).ok()?;
        Some((opcode, self.bytes(length)?))
    }
}

/// Longest name of a compression [bytes].
const LONGEST_COMPRESSION: u32 = 32;

/// The fields of a chunk.
pub struct Chunk<'a> {
    /// Length of its records [bytes]; `u64::MAX` in a chunk that was never closed.
    pub size: u64,
    /// CRC-32 of its records; zero where there is none.
    pub crc: u32,
    /// How they are compressed.
    pub compression: String,
    /// Length of what they are compressed to [bytes].
    pub length: u64,
    /// That, as far as it is there.
    pub records: &'a [u8],
}

/// Reads the head of a chunk; `None` where not all of it is there.
pub fn chunk(bytes: &[u8]) -> Option<Chunk<'_>> {
    let mut fields = Fields(bytes);
    fields.bytes(16)?;
    let (size, crc) = (fields.u64()?, fields.u32()?);
    // Bytes that are no chunk at all are often read as one: no long name is copied for nothing.
    let name = Fields(fields.0).u32()?;
    let compression = if name <= LONGEST_COMPRESSION { fields.text()? } else { return None };
    let length = fields.u64()?;
    let there = usize::try_from(length).map_or(fields.0.len(), |length| length.min(fields.0.len()));
    let records = fields.bytes(there)?;
    Some(Chunk { size, crc, compression, length, records })
}

impl Chunk<'_> {
    /// Length of its fields as far as they are there [bytes].
    pub fn extent(&self) -> usize {
        8 + 8 + 8 + 4 + (4 + self.compression.len()) + 8 + self.records.len()
    }

    /// Whether all of it is there and, where it is not compressed, records fill it.
    pub fn is_framed(&self) -> bool {
        self.records.len() as u64 == self.length && (!self.compression.is_empty() || are_framed(self.records))
    }
}

/// Whether records fill `bytes`.
pub fn are_framed(bytes: &[u8]) -> bool {
    let mut records = Fields(bytes);
    while !records.0.is_empty() {
        if records.record().is_none() {
            return false;
        }
    }
    true
}
