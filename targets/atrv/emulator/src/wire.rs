//! The rFLEX protocol on the controller's side: decodes commands and encodes reports.
//!
//! The code is independent of the driver's implementation of this protocol, so that tests reveal an error in either.

/// Maximum length of a command, in bytes. If a command is longer, its end mark was lost during transmission.
const LONGEST: usize = 1000;

/// A command. Contains the part of the robot that executes it, its number, and its arguments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    /// Part of the robot: 1 system, 2 motors, 4 sonars, 5 digital inputs.
    pub port: u8,
    /// Number of the command within its part.
    pub code: u8,
    /// Arguments of the command.
    pub data: Vec<u8>,
}

/// Received bytes, which may contain commands.
#[derive(Debug, Default)]
pub struct Incoming {
    bytes: Vec<u8>,
    /// `true` if the bytes `1B 00` represent the value 1B.
    marks: bool,
}

impl Incoming {
    /// Creates an empty buffer. If `marks` is `true`, the bytes `1B 00` represent the value 1B; no known controller
    /// supports this.
    #[must_use]
    pub const fn new(marks: bool) -> Self {
        Self { bytes: Vec::new(), marks }
    }

    /// Appends received bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Returns the number of bytes that are stored for an incomplete command.
    #[must_use]
    pub fn kept(&self) -> usize {
        self.bytes.len()
    }

    /// Returns the next complete command; `None` if no command is complete. Skips commands that have a wrong length or
    /// checksum, or an unknown byte after 1B.
    pub fn next_request(&mut self) -> Option<Request> {
        loop {
            let Some(begin) = self.bytes.windows(2).position(|two| two == [0x1B, 0x02]) else {
                // The last byte may be the first half of a start mark.
                let keep = usize::from(self.bytes.last() == Some(&0x1B));
                self.bytes.drain(..self.bytes.len() - keep);
                return None;
            };
            self.bytes.drain(..begin);
            let (body, used) = match self.body() {
                CommandBody::Open => return None,
                CommandBody::Lost(used) => (None, used),
                CommandBody::Whole(body, used) => (Some(body), used),
            };
            self.bytes.drain(..used);
            if let Some([port, _, code, size, rest @ ..]) = body.as_deref()
                && let [data @ .., _] = rest
                && data.len() == usize::from(*size)
                && body.iter().flatten().fold(0, |all, byte| all ^ byte) == 0
            {
                return Some(Request { port: *port, code: *code, data: data.to_vec() });
            }
        }
    }

    /// Returns the bytes between the start mark and the end mark of the first command in the buffer.
    fn body(&self) -> CommandBody {
        let mut body = Vec::new();
        let mut at = 2;
        loop {
            match (self.bytes.get(at), self.bytes.get(at + 1)) {
                (None, _) | (Some(0x1B), None) => return CommandBody::Open,
                (Some(0x1B), Some(0x03)) => return CommandBody::Whole(body, at + 2),
                (Some(0x1B), Some(0x02)) => return CommandBody::Lost(at),
                (Some(0x1B), Some(0x01)) => at += 2,
                (Some(0x1B), Some(0x00)) if self.marks => {
                    body.push(0x1B);
                    at += 2;
                }
                (Some(0x1B), Some(_)) => return CommandBody::Lost(at + 1),
                (Some(byte), _) => {
                    body.push(*byte);
                    at += 1;
                }
            }
            if body.len() > 260 || at > LONGEST {
                return CommandBody::Lost(at);
            }
        }
    }
}

enum CommandBody {
    /// The command is not complete yet.
    Open,
    /// This number of bytes at the beginning of the buffer does not belong to a command.
    Lost(usize),
    /// Bytes of a complete command, and the number of buffer bytes that the command occupies.
    Whole(Vec<u8>, usize),
}

/// Encodes a report for transmission. A byte 1B is followed by 00, and `filler` is inserted into the report.
#[must_use]
pub fn report(port: u8, number: u8, code: u8, data: &[u8], filler: &[u8]) -> Vec<u8> {
    let data = data.get(..data.len().min(255)).unwrap_or_default();
    let mut inside = vec![port, number, code, data.len() as u8];
    inside.extend_from_slice(data);
    inside.push(inside.iter().fold(0, |all, byte| all ^ byte));
    let mut bytes = vec![0x1B, 0x02];
    for (place, byte) in inside.iter().enumerate() {
        if place == 1 {
            bytes.extend_from_slice(filler);
        }
        bytes.push(*byte);
        if *byte == 0x1B {
            bytes.push(0x00);
        }
    }
    bytes.extend([0x1B, 0x03]);
    bytes
}

/// Returns the number that the first four bytes contain (big-endian).
#[must_use]
pub fn number(bytes: &[u8]) -> u32 {
    bytes.iter().take(4).fold(0, |number, byte| number << 8 | u32::from(*byte))
}
