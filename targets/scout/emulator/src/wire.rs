//! The Scout's protocol on the robot's side: decodes requests and encodes answers.
//!
//! The code is independent of the driver's implementation of this protocol, so that tests reveal an error in either.

/// A request, which consists of a command and its arguments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    /// Type of the command.
    pub command: u8,
    /// Arguments of the command.
    pub data: Vec<u8>,
}

/// Received bytes, which may contain requests.
#[derive(Debug, Default)]
pub struct Incoming(Vec<u8>);

impl Incoming {
    /// Appends received bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    /// Returns the number of bytes that are stored for an incomplete request.
    #[must_use]
    pub fn kept(&self) -> usize {
        self.0.len()
    }

    /// Returns the next complete request; `None` if no request is complete. Bytes that cannot begin a request are
    /// skipped one by one, as the real robot does when it waits for a start byte.
    pub fn next_request(&mut self) -> Option<Request> {
        loop {
            let Some(begin) = self.0.iter().position(|byte| *byte == 1) else {
                // No byte in the buffer can begin a request.
                self.0.clear();
                return None;
            };
            self.0.drain(..begin);
            let length = match self.0.as_slice() {
                [1, low, 0, ..] if *low >= 2 => usize::from(*low),
                [_, _, _, ..] => {
                    self.0.remove(0);
                    continue;
                }
                _ => return None,
            };
            if self.0.len() < length + 4 {
                return None;
            }
            let total = self.0.iter().take(length + 2).map(|byte| u32::from(*byte)).sum::<u32>() % 256;
            let ends = (self.0.get(length + 2).copied().map(u32::from), self.0.get(length + 3).copied());
            if ends != (Some(total), Some(b'\\')) {
                self.0.remove(0);
                continue;
            }
            let request: Vec<u8> = self.0.drain(..length + 4).collect();
            let data = request.iter().skip(4).take(length - 2).copied().collect();
            return Some(Request { command: request.get(3).copied()?, data });
        }
    }
}

/// Encodes an answer of the type `kind`; `body` is its content.
#[must_use]
pub fn answer(kind: u8, body: &[u8]) -> Vec<u8> {
    let length = (body.len() + 2).min(usize::from(u8::MAX));
    let mut bytes = vec![0x01, length as u8, 0x00, kind];
    bytes.extend(body.iter().take(length - 2));
    let total: u32 = bytes.iter().map(|byte| u32::from(*byte)).sum();
    bytes.push((total % 256) as u8);
    bytes.push(b'\\');
    bytes
}

/// Decodes a number from two bytes: 15 bits of magnitude and a sign bit.
#[must_use]
pub fn number(low: u8, high: u8) -> i32 {
    let size = i32::from(high % 128) * 256 + i32::from(low);
    if high >= 128 { -size } else { size }
}

/// Encodes a number as two bytes in sign-magnitude form. The number wraps modulo 65,535, which is the number of
/// different values in this form.
#[must_use]
pub fn two_bytes(number: i64) -> [u8; 2] {
    let number = (number + 32_767).rem_euclid(65_535) - 32_767;
    let size = number.unsigned_abs();
    [(size % 256) as u8, (size / 256) as u8 + if number < 0 { 128 } else { 0 }]
}
