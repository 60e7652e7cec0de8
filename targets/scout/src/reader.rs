//! Finds answers in the bytes of the line: what cannot be a frame is skipped, byte by byte.

use crate::frame::{Frame, Garbled, START};

/// Maximum number of bytes that are read from the line at once.
pub(crate) const CHUNK: usize = 512;

/// The bytes received since a command was sent, and the frames in them.
#[derive(Debug)]
pub struct Reader {
    /// Empty, or from where a frame may begin.
    waiting: Vec<u8>,
    /// First defect of the bytes since the last good frame.
    garbled: Option<Garbled>,
    /// `true` after a defective frame whose length was right.
    was_whole: bool,
}

impl Default for Reader {
    fn default() -> Self {
        // What may become a frame and what comes at once: a turn allocates nothing.
        Self { waiting: Vec::with_capacity(2 * CHUNK), garbled: None, was_whole: false }
    }
}

impl Reader {
    /// Forgets all that has come in.
    pub fn clear(&mut self) {
        self.waiting.clear();
        (self.garbled, self.was_whole) = (None, false);
    }

    /// Takes in more bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        self.waiting.extend_from_slice(bytes);
    }

    /// Returns the number of bytes kept that may still become part of a report.
    #[must_use]
    pub fn kept(&self) -> usize {
        self.waiting.len()
    }

    /// Takes out the next frame with a right sum. Bytes before it that cannot begin one are thrown away.
    pub fn next_frame(&mut self) -> Option<Frame> {
        loop {
            match Frame::read(&self.waiting) {
                Ok(Some((frame, count))) => {
                    self.waiting.drain(..count);
                    return Some(frame);
                }
                Ok(None) => return None,
                Err(garbled) => {
                    self.was_whole |= matches!(garbled, Garbled::Sum(..) | Garbled::End(_));
                    self.garbled = self.garbled.or(Some(garbled));
                    let next = self.waiting.iter().skip(1).position(|byte| *byte == START);
                    self.waiting.drain(..next.map_or(self.waiting.len(), |place| place + 1));
                }
            }
        }
    }

    /// Takes out a frame of this type that comes after bytes that may still become another one: noise that looks like
    /// the beginning of a frame. To be asked for when nothing more comes, or a part of a true frame could be taken for
    /// one.
    pub fn after_false_start(&mut self, kind: u8) -> Option<Frame> {
        let found = (1..self.waiting.len()).find_map(|place| {
            let frame = Frame::read(self.waiting.get(place..)?).ok().flatten();
            frame.filter(|(frame, _)| frame.kind == kind).map(|(frame, count)| (frame, place + count))
        });
        let (frame, end) = found?;
        self.waiting.drain(..end);
        Some(frame)
    }

    /// Returns the first defect of the received bytes.
    #[must_use]
    pub fn garbled(&self) -> Option<Garbled> {
        self.garbled
    }

    /// Returns `true` if a whole frame was wrong: the robot has answered, and can be asked again.
    #[must_use]
    pub fn was_whole(&self) -> bool {
        self.was_whole
    }
}
