//! CDR, the bytes of messages of ROS 2, read without trusting a length in them. (The crate `cdr`, which writes those of
//! hpf, allocates what the length of a text says before it looks whether so much is there.)
//!
//! ```text
//! bytes    0, 0 or 1 for big- or little-endian, 0 0; then the fields, numbers at multiples of their size from there
//! text     its length with the terminating zero byte in 4 bytes, its bytes, a zero byte
//! list     its count in 4 bytes, its elements
//! ```

/// A message that ends before its fields, or in another encoding.
#[derive(Debug)]
pub struct Damaged;

/// The fields of a message, taken from its front.
pub struct Cdr<'m> {
    bytes: &'m [u8],
    at: usize,
    is_big: bool,
}

impl<'m> Cdr<'m> {
    /// The fields behind the encapsulation header of `message`.
    pub fn new(message: &'m [u8]) -> Result<Self, Damaged> {
        let (head, bytes) = message.split_first_chunk::<4>().ok_or(Damaged)?;
        match head[..2] {
            [0, order @ (0 | 1)] => Ok(Self { bytes, at: 0, is_big: order == 0 }),
            _ => Err(Damaged),
        }
    }

    fn take(&mut self, count: usize) -> Result<&'m [u8], Damaged> {
        let end = self.at.checked_add(count).ok_or(Damaged)?;
        let taken = self.bytes.get(self.at..end).ok_or(Damaged)?;
        self.at = end;
        Ok(taken)
    }

    /// A number of `N` bytes, at a multiple of them.
    fn number<const N: usize>(&mut self) -> Result<[u8; N], Damaged> {
        self.at = self.at.next_multiple_of(N);
        let mut bytes: [u8; N] = self.take(N)?.try_into().map_err(|_| Damaged)?;
        if self.is_big {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub fn u32(&mut self) -> Result<u32, Damaged> {
        self.number().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32, Damaged> {
        self.number().map(i32::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, Damaged> {
        self.number().map(f64::from_le_bytes)
    }

    pub fn text(&mut self) -> Result<String, Damaged> {
        let length = self.u32()? as usize;
        let bytes = self.take(length)?;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        str::from_utf8(text).map(str::to_owned).map_err(|_| Damaged)
    }

    /// `N` numbers.
    pub fn numbers<const N: usize>(&mut self) -> Result<[f64; N], Damaged> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Ok(numbers)
    }

    /// Numbers and their count before them.
    pub fn list(&mut self) -> Result<Vec<f64>, Damaged> {
        let count = self.u32()?;
        // A list grows as its numbers are read: a count that cannot be ends at the end of the message.
        (0..count).map(|_| self.f64()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_aligned_and_lengths_are_not_believed() {
        // The text ends behind six bytes; the number stands at the next multiple of eight.
        let message = [0, 1, 0, 0, 2, 0, 0, 0, b'a', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f];
        let mut cdr = Cdr::new(&message).unwrap();
        assert_eq!((cdr.text().unwrap().as_str(), cdr.f64().unwrap()), ("a", 1.0));
        assert!(cdr.f64().is_err());
        let mut cdr = Cdr::new(&[0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff]).unwrap();
        assert!(cdr.text().is_err());
        let mut cdr = Cdr::new(&[0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff]).unwrap();
        assert!(cdr.list().is_err());
        let mut cdr = Cdr::new(&[0, 0, 0, 0, 0, 0, 1, 2]).unwrap();
        assert_eq!(cdr.u32().unwrap(), 258);
        assert!(Cdr::new(&[0, 7, 0, 0]).is_err());
    }
}
