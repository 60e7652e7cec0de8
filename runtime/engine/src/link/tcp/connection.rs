//! Reads frames from a connection whose peer has proved its name, until the connection ends.

use std::io::{ErrorKind, Read as _};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::link::endpoint::Endpoint;
use crate::link::letter_frame::{LONGEST_LETTER, is_letter};
use crate::link::source::FrameSource;
use crate::link::state_frame::LONGEST;

/// Maximum wait for bytes before the thread checks whether the run has ended.
pub(super) const LOOK: Duration = Duration::from_millis(20);
/// Time without any byte after which a connection is closed.
const SILENT: Duration = Duration::from_secs(2);

/// A connection from a peer.
pub(super) struct Connection {
    pub(super) stream: TcpStream,
    pub(super) source: FrameSource,
    /// `true` once the peer has opened another connection.
    pub(super) is_replaced: Arc<AtomicBool>,
    pub(super) endpoint: Arc<Endpoint>,
}

impl Connection {
    /// Receives and processes frames until the connection ends.
    pub(super) fn receive(mut self) {
        if let Err(reason) = self.frames() {
            let robot = self.source.robot().unwrap_or("a robot");
            self.endpoint.refuse(&format!("the connection of {robot}"), &reason);
        }
    }

    /// Processes frames until the connection ends.
    ///
    /// # Errors
    /// Fails with the end of a sentence if anything other than states and letters of the peer arrives, or if nothing
    /// arrives for a while.
    fn frames(&mut self) -> Result<(), String> {
        let set = self.stream.set_nonblocking(false).and_then(|()| self.stream.set_read_timeout(Some(LOOK)));
        set.map_err(|error| error.to_string())?;
        while let Some(frame) = self.next()? {
            self.endpoint.take(&mut self.source, &frame)?;
        }
        Ok(())
    }

    /// Reads a frame; returns `None` if the connection breaks, if it is replaced, or if the run has ended.
    fn next(&mut self) -> Result<Option<Vec<u8>>, String> {
        let mut length = [0; 4];
        if !self.fill(&mut length)? {
            return Ok(None);
        }
        let length = u32::from_le_bytes(length) as usize;
        if length > LONGEST_LETTER {
            return Err("it sends neither states nor letters".to_owned());
        }
        let mut frame = vec![0; length];
        if !self.fill(&mut frame)? {
            return Ok(None);
        }
        if length > LONGEST && !is_letter(&frame) {
            return Err("it sends neither states nor letters".to_owned());
        }
        Ok(Some(frame))
    }

    /// Fills `bytes`; returns `false` if the connection breaks, if it is replaced, or if the run has ended.
    fn fill(&mut self, bytes: &mut [u8]) -> Result<bool, String> {
        let (mut heard, mut filled) = (Instant::now(), 0);
        while let Some(rest) = bytes.get_mut(filled..).filter(|rest| !rest.is_empty()) {
            if self.endpoint.is_over() || self.is_replaced.load(Ordering::Relaxed) {
                return Ok(false);
            }
            if heard.elapsed() >= SILENT {
                return Err(format!("it sends nothing for {} s", SILENT.as_secs()));
            }
            match self.stream.read(rest) {
                // A peer that closes its connection is not an error of this robot; the peer's state becomes stale.
                Ok(0) => return Ok(false),
                Ok(count) => (heard, filled) = (Instant::now(), filled + count),
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) => {
                }
                Err(_) => return Ok(false),
            }
        }
        Ok(true)
    }
}
