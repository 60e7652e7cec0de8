//! Frames on the Scout's line: start, length, type, arguments, sum and end, with no byte stuffing.
//! See docs/src/reference/protocols.md, 1.2.

use arrayvec::ArrayVec;

/// The first byte of each frame.
pub(crate) const START: u8 = 0x01;
/// The last byte of each frame.
const END: u8 = 0x5C;
/// Number of a frame's bytes besides its arguments: start, two bytes of length, type, sum, end.
pub(crate) const AROUND: usize = 6;
/// Maximum length of a reply that is accepted: a garbled length must not be waited for, and replies are far shorter.
const LONGEST: usize = 255;
/// Maximum number of argument bytes: type and sum count to the length.
const MOST: usize = LONGEST - 2;

/// A frame's arguments; a turn allocates nothing.
pub type Arguments = ArrayVec<u8, MOST>;

/// A frame that has come in: its type, and its arguments in the order of the line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// The type of the command that the frame answers, or is.
    pub kind: u8,
    /// The arguments.
    pub arguments: Arguments,
}

/// Reason why bytes are not a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Garbled {
    /// The bytes begin with this one instead of the first byte of a frame.
    Start(u8),
    /// The frame gives this length, which no frame of a Scout has.
    Length(u16),
    /// The sum of the bytes is the first number; the frame's own sum is the second.
    Sum(u8, u8),
    /// This byte follows the sum instead of the last byte of a frame.
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

/// The sum of these bytes, modulo 256.
fn sum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

impl Frame {
    /// Returns the frame's bytes on the line.
    #[must_use]
    pub fn bytes(&self) -> ArrayVec<u8, { MOST + AROUND }> {
        // Type and sum count.
        let length = self.arguments.len() as u8 + 2;
        let mut bytes: ArrayVec<u8, _> =
            [START, length, 0, self.kind].into_iter().chain(self.arguments.iter().copied()).collect();
        bytes.push(sum(&bytes));
        bytes.push(END);
        bytes
    }

    /// Returns the frame at the beginning of `bytes` and its number of bytes, or `None` if it is not complete.
    ///
    /// # Errors
    /// These bytes do not begin a frame, whatever follows them.
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
