//! Frames on the Scout's line: start, length, type, arguments, checksum and end, without byte stuffing. See
//! docs/src/reference/protocols.md, 1.2.

use arrayvec::ArrayVec;

/// First byte of each frame.
pub(crate) const START: u8 = 0x01;
/// Last byte of each frame.
const END: u8 = 0x5C;
/// Number of bytes in a frame in addition to its arguments: start, two bytes of length, type, checksum, and end.
pub(crate) const AROUND: usize = 6;
/// Maximum length of an answer. Real answers are far shorter. With this limit, the driver does not wait long for the
/// rest of an answer whose length was corrupted.
const LONGEST: usize = 255;
/// Maximum number of argument bytes. The length of a frame also includes its type and checksum.
const MOST: usize = LONGEST - 2;

/// Arguments of a frame, stored without heap allocation.
pub type Arguments = ArrayVec<u8, MOST>;

/// A received frame, with its type and with its arguments as transmitted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// Type of the command that the frame contains or answers.
    pub kind: u8,
    /// Arguments of the frame.
    pub arguments: Arguments,
}

/// Reason why bytes are not a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Garbled {
    /// The first byte is not the start byte of a frame; contains the first byte.
    Start(u8),
    /// The frame declares this length, which is invalid.
    Length(u16),
    /// The checksum is wrong. Contains the checksum of the received bytes, and the checksum in the frame.
    Sum(u8, u8),
    /// The byte after the checksum is not the end byte of a frame; contains this byte.
    End(u8),
}

impl core::fmt::Display for Garbled {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Start(byte) => write!(f, "a frame begins with {byte:02X} instead of {START:02X}"),
            Self::Length(length) => write!(f, "a frame says that its length is {length}"),
            Self::Sum(right, wrong) => write!(f, "the bytes of a frame add up to {right:02X}, and it says {wrong:02X}"),
            Self::End(byte) => write!(f, "a frame ends with {byte:02X} instead of {END:02X}"),
        }
    }
}

/// Returns the checksum of `bytes`, which is their sum modulo 256.
fn sum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

impl Frame {
    /// Returns the transmitted bytes of the frame.
    #[must_use]
    pub fn bytes(&self) -> ArrayVec<u8, { MOST + AROUND }> {
        // The length includes type and checksum.
        let length = self.arguments.len() as u8 + 2;
        let mut bytes: ArrayVec<u8, _> =
            [START, length, 0, self.kind].into_iter().chain(self.arguments.iter().copied()).collect();
        bytes.push(sum(&bytes));
        bytes.push(END);
        bytes
    }

    /// Decodes the frame at the beginning of `bytes`. Returns the frame and its length in bytes; `None` if the frame is
    /// incomplete.
    ///
    /// # Errors
    /// Fails if `bytes` is not the beginning of a valid frame.
    pub fn read(bytes: &[u8]) -> Result<Option<(Self, usize)>, Garbled> {
        match bytes.first() {
            None => return Ok(None),
            Some(&START) => {}
            Some(&other) => return Err(Garbled::Start(other)),
        }
        let Some(&[low, high]) = bytes.get(1..3) else { return Ok(None) };
        let length = u16::from_le_bytes([low, high]);
        let count = usize::from(length);
        if !(2..=LONGEST).contains(&count) {
            return Err(Garbled::Length(length));
        }
        let Some(whole) = bytes.get(..count + AROUND - 2) else { return Ok(None) };
        let [summed @ .., found, end] = whole else { return Ok(None) };
        if sum(summed) != *found {
            return Err(Garbled::Sum(sum(summed), *found));
        }
        if *end != END {
            return Err(Garbled::End(*end));
        }
        let [_, _, _, kind, arguments @ ..] = summed else { return Ok(None) };
        Ok(Some((Self { kind: *kind, arguments: arguments.iter().copied().collect() }, whole.len())))
    }
}
