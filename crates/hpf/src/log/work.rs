//! How much work a log may ask for: what its chunks unpack to is bounded by the length of the file.
//!
//! A few bytes of zstd unpack to gigabytes. Logs of robots pack to a tenth or a hundredth.

use core::cell::Cell;
use std::io;

/// Bytes that the chunks of any file may unpack to, all together.
const FREE: u64 = 256 << 20;
/// Beyond that, so many times the length of the file.
const MOST_RATIO: u64 = 200;
/// And never more than this.
const MOST: u64 = 64 << 30;

/// The bytes that may still be unpacked.
pub struct Work {
    all: u64,
    left: Cell<u64>,
    is_spent: Cell<bool>,
}

impl Work {
    /// What a file of `length` bytes may ask for.
    pub fn of(length: u64) -> Self {
        let all = FREE.saturating_add(length.saturating_mul(MOST_RATIO)).min(MOST);
        Self { all, left: Cell::new(all), is_spent: Cell::new(false) }
    }

    /// Takes `bytes` of work; `false` where so much is not left.
    pub fn spend(&self, bytes: u64) -> bool {
        match self.left.get().checked_sub(bytes) {
            Some(left) => self.left.set(left),
            None => self.is_spent.set(true),
        }
        !self.is_spent.get()
    }

    /// An error once more was asked for than there is.
    pub fn check(&self) -> io::Result<()> {
        if !self.is_spent.get() {
            return Ok(());
        }
        let why = format!(
            "its chunks unpack to more than {} MB: at most {} MB and {MOST_RATIO} times the size of the file are unpacked, \
             {} GB in all; a log of a robot packs to far less than that",
            self.all >> 20,
            FREE >> 20,
            MOST >> 30
        );
        Err(io::Error::new(io::ErrorKind::InvalidData, why))
    }
}
