//! Finds answers in received bytes. Bytes that cannot begin a frame are skipped one by one.

use crate::frame::{Frame, Garbled, START};

/// Maximum number of bytes that are read from the line at once.
pub(crate) const CHUNK: usize = 512;

/// Bytes that have been received since the last command; the reader finds frames in them.
#[derive(Debug)]
pub struct Reader {
    /// Bytes that have not been read as a frame. They are empty, or begin with the start byte of a frame.
    waiting: Vec<u8>,
    /// First error in the bytes since the last call of `clear`; `None` if there is no error.
    garbled: Option<Garbled>,
    /// `true` after a malformed frame whose length was right.
    was_whole: bool,
}

impl Default for Reader {
    fn default() -> Self {
        // Capacity for an incomplete frame and one read, so that turns do not allocate.
        Self { waiting: Vec::with_capacity(2 * CHUNK), garbled: None, was_whole: false }
    }
}

impl Reader {
    /// Discards all received bytes.
    pub fn clear(&mut self) {
        self.waiting.clear();
        (self.garbled, self.was_whole) = (None, false);
    }

    /// Appends received bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        self.waiting.extend_from_slice(bytes);
    }

    /// Returns the number of stored bytes that may still become part of a frame.
    #[must_use]
    pub fn kept(&self) -> usize {
        self.waiting.len()
    }

    /// Removes and returns the next frame with a correct checksum; `None` if no frame is complete. Bytes before the
    /// frame are discarded if they cannot begin a frame.
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

    /// Removes and returns a frame of type `kind` that follows the incomplete beginning of another frame, which may be
    /// noise; `None` if there is no such frame. Must be called only when no more bytes arrive, because otherwise a part
    /// of a valid frame could be mistaken for a frame.
    pub fn after_false_start(&mut self, kind: u8) -> Option<Frame> {
        let found = (1..self.waiting.len()).find_map(|place| {
            let frame = Frame::read(self.waiting.get(place..)?).ok().flatten();
            frame.filter(|(frame, _)| frame.kind == kind).map(|(frame, count)| (frame, place + count))
        });
        let (frame, end) = found?;
        self.waiting.drain(..end);
        Some(frame)
    }

    /// Returns the first error in the received bytes; `None` if there is no error.
    #[must_use]
    pub fn garbled(&self) -> Option<Garbled> {
        self.garbled
    }

    /// Returns `true` if a complete frame was malformed. The robot has then answered, and the command can be repeated.
    #[must_use]
    pub fn was_whole(&self) -> bool {
        self.was_whole
    }
}
