//! Frames on the rFLEX line: start, port, id, opcode, length, data, checksum and end. Each byte 1B inside a frame is
//! escaped. See docs/src/reference/protocols.md, 2.2.
//!
//! The bytes 1B 00 represent the value 1B; 1B 02 begins a frame, 1B 03 ends a frame, and 1B 01 is filler without a
//! meaning.

/// First byte of a two-byte mark.
const ESCAPE: u8 = 0x1B;
/// Second byte of the filler mark, which has no meaning.
const FILLER: u8 = 0x01;
/// Second byte of the mark that begins a frame.
const START: u8 = 0x02;
/// Second byte of the mark that ends a frame.
const END: u8 = 0x03;
/// Second byte of the mark for the value 1B.
const LITERAL: u8 = 0x00;
/// Length of a packet's header (port, id, opcode and length), in bytes.
const HEAD: usize = 4;
/// Maximum length of a packet, in bytes: the header, 255 bytes of data, and the checksum.
const LONGEST: usize = HEAD + 255 + 1;
/// Maximum number of data bytes in a packet that the driver writes.
const MOST: usize = 32;
/// Maximum length, in bytes, of a transmitted packet with [`MOST`] data bytes: the length if every byte is escaped.
const ROOM: usize = 2 * (HEAD + MOST + 1) + 4;

/// Content of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Packet<'a> {
    /// Part of the robot that receives or sends the packet.
    pub port: u8,
    /// Number of the packet. The robot increments it for each packet; the driver ignores it.
    pub id: u8,
    /// Number that identifies the command or report within its port.
    pub opcode: u8,
    /// Bytes after the packet's header.
    pub data: &'a [u8],
}

/// Transmitted bytes of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameBytes {
    bytes: [u8; ROOM],
    count: usize,
}

/// Reason why bytes are not a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Garbled {
    /// The length is wrong. Contains the number of data bytes that the frame declares, and the number that was
    /// received.
    Length(usize, usize),
    /// The checksum is wrong. Contains the checksum of the received bytes, and the checksum in the frame.
    Check(u8, u8),
    /// A byte 1B is followed by this byte, which is not the second byte of a known mark.
    Mark(u8),
    /// This byte was received outside of any frame.
    Outside(u8),
}

impl core::fmt::Display for Garbled {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Length(length, count) => {
                write!(f, "a frame says that it has {length} bytes of data, and has {count}")
            }
            Self::Check(right, wrong) => write!(f, "the check of a frame is {right:02X}, and it says {wrong:02X}"),
            Self::Mark(byte) => write!(f, "in a frame, 1B is followed by {byte:02X}"),
            Self::Outside(byte) => write!(f, "there is {byte:02X} outside of any frame"),
        }
    }
}

/// Returns the checksum of `bytes`.
pub(crate) fn check(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |check, byte| check ^ byte)
}

impl Packet<'_> {
    /// Encodes the packet for transmission; it may have at most 32 bytes of data. If `marks` is `true`, bytes with the
    /// value 1B are escaped.
    #[must_use]
    pub fn written(&self, marks: bool) -> FrameBytes {
        let data = self.data.get(..self.data.len().min(MOST)).unwrap_or_default();
        let head = [self.port, self.id, self.opcode, data.len() as u8];
        let check = check(&head) ^ check(data);
        let mut written = FrameBytes { bytes: [0; ROOM], count: 0 };
        written.put(&[ESCAPE, START]);
        for byte in head.iter().chain(data).chain([&check]) {
            written.put(&[*byte]);
            if *byte == ESCAPE && marks {
                written.put(&[LITERAL]);
            }
        }
        written.put(&[ESCAPE, END]);
        written
    }
}

impl FrameBytes {
    fn put(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if let Some(place) = self.bytes.get_mut(self.count) {
                *place = *byte;
                self.count += 1;
            }
        }
    }

    /// Returns the transmitted bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.count).unwrap_or_default()
    }
}

/// State of a frame reader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ReaderState {
    /// Outside of any frame. `after_escape` is `true` if the last byte was 1B; `is_reported` is `true` if the error
    /// about these bytes has already been returned.
    Outside { after_escape: bool, is_reported: bool },
    /// Inside a frame. `after_escape` is `true` if the last byte was 1B.
    Inside { after_escape: bool },
}

/// Finds frames in received bytes.
#[derive(Debug)]
pub struct Reader {
    place: ReaderState,
    bytes: [u8; LONGEST],
    count: usize,
}

impl Default for Reader {
    fn default() -> Self {
        Self { place: ReaderState::Outside { after_escape: false, is_reported: false }, bytes: [0; LONGEST], count: 0 }
    }
}

impl Reader {
    /// Processes the next byte. Returns the packet that the byte completes; `None` if it completes no packet.
    ///
    /// # Errors
    /// Fails if the bytes that have been received so far are not a frame. The reader then waits for the beginning of
    /// the next frame.
    pub fn take(&mut self, byte: u8) -> Result<Option<Packet<'_>>, Garbled> {
        match (self.place, byte) {
            (ReaderState::Outside { after_escape: true, .. }, START)
            | (ReaderState::Inside { after_escape: true }, START) => {
                let cut = matches!(self.place, ReaderState::Inside { .. }) && self.count > 0;
                let found = self.count;
                (self.place, self.count) = (ReaderState::Inside { after_escape: false }, 0);
                // The previous frame had no end.
                if cut {
                    Err(Garbled::Length(self.declared_length(), found.saturating_sub(HEAD + 1)))
                } else {
                    Ok(None)
                }
            }
            (ReaderState::Outside { is_reported, .. }, ESCAPE) => {
                self.goes_on(ReaderState::Outside { after_escape: true, is_reported })
            }
            (ReaderState::Outside { after_escape: true, is_reported }, FILLER) => {
                self.goes_on(ReaderState::Outside { after_escape: false, is_reported })
            }
            (ReaderState::Outside { is_reported: false, .. }, _) => {
                self.place = ReaderState::Outside { after_escape: false, is_reported: true };
                Err(Garbled::Outside(byte))
            }
            (ReaderState::Outside { is_reported: true, .. }, _) => {
                self.goes_on(ReaderState::Outside { after_escape: false, is_reported: true })
            }
            (ReaderState::Inside { after_escape: true }, FILLER) => {
                self.goes_on(ReaderState::Inside { after_escape: false })
            }
            (ReaderState::Inside { after_escape: true }, LITERAL) => self.keep(ESCAPE),
            (ReaderState::Inside { after_escape: true }, END) => {
                self.place = ReaderState::Outside { after_escape: false, is_reported: false };
                self.packet().map(Some)
            }
            (ReaderState::Inside { after_escape: true }, _) => {
                self.place = ReaderState::Outside { after_escape: byte == ESCAPE, is_reported: true };
                Err(Garbled::Mark(byte))
            }
            (ReaderState::Inside { after_escape: false }, ESCAPE) => {
                self.goes_on(ReaderState::Inside { after_escape: true })
            }
            (ReaderState::Inside { after_escape: false }, _) => self.keep(byte),
        }
    }

    fn goes_on(&mut self, place: ReaderState) -> Result<Option<Packet<'_>>, Garbled> {
        self.place = place;
        Ok(None)
    }

    /// Stores a byte of the packet that does not complete the packet. Fails if the packet is too long.
    fn keep(&mut self, byte: u8) -> Result<Option<Packet<'_>>, Garbled> {
        match self.bytes.get_mut(self.count) {
            Some(place) => {
                *place = byte;
                self.count += 1;
                self.goes_on(ReaderState::Inside { after_escape: false })
            }
            None => {
                self.place = ReaderState::Outside { after_escape: false, is_reported: true };
                Err(Garbled::Length(self.declared_length(), self.count))
            }
        }
    }

    /// Returns the length of the data, as declared in the packet's header.
    fn declared_length(&self) -> usize {
        self.bytes.get(HEAD - 1).copied().map_or(0, usize::from)
    }

    /// Parses the stored bytes as a complete packet. Fails if the length or the checksum is wrong.
    fn packet(&self) -> Result<Packet<'_>, Garbled> {
        let whole = self.bytes.get(..self.count).unwrap_or_default();
        let [checked @ .., check_byte] = whole else { return Err(Garbled::Length(0, 0)) };
        let [port, id, opcode, length, data @ ..] = checked else { return Err(Garbled::Length(0, 0)) };
        if usize::from(*length) != data.len() {
            return Err(Garbled::Length(usize::from(*length), data.len()));
        }
        if check(checked) != *check_byte {
            return Err(Garbled::Check(check(checked), *check_byte));
        }
        Ok(Packet { port: *port, id: *id, opcode: *opcode, data })
    }
}
