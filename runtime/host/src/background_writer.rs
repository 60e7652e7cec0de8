//! A writer that never makes a robot wait: a thread of its own writes the text that the turns hand over.

#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::Builder;
use std::time::{Duration, Instant};

use crate::patience::{AT_THE_END, Patience};

/// The stack of a thread that only writes. All memory of a run is locked: this is as much as it takes.
pub(crate) const STACK: usize = 128 * 1024;
/// The maximum that waits for a slow reader, in bytes.
const WAITING: usize = 1 << 20;
/// Size from which text is handed over without a flush, in bytes.
const PIECE: usize = 1 << 16;
/// Maximum size of a single write, in bytes: a reader that takes this much counts as one that reads.
const CHUNK: usize = 1 << 13;
/// Maximum time without progress on a file that must be complete, while a robot drives.
const LAG: Duration = Duration::from_secs(5);
/// Maximum wait between two checks of the deadline.
const LOOK: Duration = Duration::from_millis(20);

/// The treatment of pieces for which a slow reader leaves no room while a robot drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Keeps {
    /// Lines for people: they are left out, and a line reports that.
    WhatIsRead,
    /// A record that must not lack anything: that is an error.
    All,
}

/// A writer whose `flush` returns at once while a robot drives, and otherwise when all is written, or when the patience
/// of the run ends. Dropping it waits likewise.
#[derive(Debug)]
pub(crate) struct Outlet {
    piece: Vec<u8>,
    keeps: Keeps,
    patience: Patience,
    /// `true` if pieces have been lost since the last piece that was handed over.
    lost: bool,
    /// `true` once the reader is not waited for any longer.
    given_up: bool,
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    queue: Mutex<Queue>,
    changed: Condvar,
}

#[derive(Debug)]
struct Queue {
    pieces: VecDeque<Vec<u8>>,
    /// Bytes that wait or are being written.
    bytes: usize,
    /// Time at which the reader took something last, or at which something was handed over to a waiting thread.
    moved: Instant,
    is_closed: bool,
    /// Error that ended the thread.
    error: Option<io::Error>,
    has_ended: bool,
}

impl Shared {
    fn queue(&self) -> MutexGuard<'_, Queue> {
        // Nothing in here panics half way.
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Queue {
    /// Adds a piece. There is always room for a single piece of any length.
    fn push(&mut self, piece: Vec<u8>) -> Result<(), Vec<u8>> {
        if self.bytes > 0 && self.bytes.saturating_add(piece.len()) > WAITING {
            return Err(piece);
        }
        if self.bytes == 0 {
            self.moved = Instant::now();
        }
        self.bytes += piece.len();
        self.pieces.push_back(piece);
        Ok(())
    }

    /// Returns an error once the thread has ended.
    fn check(&mut self) -> io::Result<()> {
        match self.error.take() {
            Some(error) => Err(error),
            None if self.has_ended => Err(io::ErrorKind::BrokenPipe.into()),
            None => Ok(()),
        }
    }
}

impl Outlet {
    /// Begins to write to `sink`.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub(crate) fn open(sink: impl Write + Send + 'static, keeps: Keeps, patience: &Patience) -> io::Result<Self> {
        let queue = Queue {
            pieces: VecDeque::new(),
            bytes: 0,
            moved: Instant::now(),
            is_closed: false,
            error: None,
            has_ended: false,
        };
        let shared = Arc::new(Shared { queue: Mutex::new(queue), changed: Condvar::new() });
        let writer = Arc::clone(&shared);
        Builder::new().name("writer".to_owned()).stack_size(STACK).spawn(move || write_all(sink, &writer))?;
        Ok(Self { piece: Vec::new(), keeps, patience: patience.clone(), lost: false, given_up: false, shared })
    }

    /// Returns a handle through which other threads write pieces, without waiting.
    pub(crate) fn aside(&self) -> Aside {
        Aside(Arc::clone(&self.shared))
    }

    /// Hands over the text that has been written so far.
    fn hand_over(&mut self) -> io::Result<()> {
        if self.piece.is_empty() {
            return Ok(());
        }
        let mut piece = std::mem::take(&mut self.piece);
        if self.lost {
            piece.splice(0..0, *b"(lines are missing here: they were not read in time)\n");
        }
        let shared = Arc::clone(&self.shared);
        let begun = Instant::now();
        let mut queue = shared.queue();
        loop {
            queue.check()?;
            piece = match queue.push(piece) {
                Ok(()) => break,
                Err(piece) => piece,
            };
            if self.has_no_patience(queue.moved.max(begun)) {
                return self.without_room();
            }
            queue = self.wait(queue);
        }
        self.lost = false;
        shared.changed.notify_all();
        let lags = self.keeps == Keeps::All && self.is_driving() && queue.moved.elapsed() >= LAG;
        if lags { Err(too_slow(LAG)) } else { Ok(()) }
    }

    /// A piece has to be left out.
    fn without_room(&mut self) -> io::Result<()> {
        match self.keeps {
            Keeps::WhatIsRead if self.is_driving() => {
                self.lost = true;
                Ok(())
            }
            Keeps::WhatIsRead | Keeps::All => {
                self.given_up = true;
                let took =
                    if self.is_driving() { "it takes less than is written".to_owned() } else { unread(AT_THE_END) };
                Err(io::Error::new(io::ErrorKind::TimedOut, took))
            }
        }
    }

    /// Waits until all is written, as far as patience goes.
    fn drain(&mut self) -> io::Result<()> {
        let shared = Arc::clone(&self.shared);
        let begun = Instant::now();
        let mut queue = shared.queue();
        loop {
            queue.check()?;
            if queue.bytes == 0 || self.is_driving() {
                return Ok(());
            }
            if self.has_no_patience(queue.moved.max(begun)) {
                self.given_up = true;
                return Err(too_slow(AT_THE_END));
            }
            queue = self.wait(queue);
        }
    }

    /// Returns `true` while a robot drives, which must not wait.
    fn is_driving(&self) -> bool {
        self.patience.limit() == Some(Duration::ZERO)
    }

    /// Returns `true` if a reader that has taken nothing `since` then is not waited for any longer.
    fn has_no_patience(&self, since: Instant) -> bool {
        self.given_up || self.patience.limit().is_some_and(|limit| since.elapsed() >= limit)
    }

    fn wait<'q>(&self, queue: MutexGuard<'q, Queue>) -> MutexGuard<'q, Queue> {
        self.shared.changed.wait_timeout(queue, LOOK).unwrap_or_else(PoisonError::into_inner).0
    }
}

/// The error of a reader that takes nothing.
fn too_slow(limit: Duration) -> io::Error {
    io::Error::new(io::ErrorKind::TimedOut, unread(limit))
}

fn unread(limit: Duration) -> String {
    format!("it was not read for {} s", limit.as_secs())
}

impl Write for Outlet {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.piece.extend_from_slice(bytes);
        if self.piece.len() >= PIECE {
            self.hand_over()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.hand_over()?;
        self.drain()
    }
}

impl Drop for Outlet {
    fn drop(&mut self) {
        // An error that comes only now is about the last lines of a report; the robot stands already.
        let _ = self.flush();
        self.shared.queue().is_closed = true;
        self.shared.changed.notify_all();
    }
}

/// A handle on an outlet for messages of other threads that cannot wait.
#[derive(Debug, Clone)]
pub(crate) struct Aside(Arc<Shared>);

impl Aside {
    /// Hands over a text, or drops it when there is no room.
    pub(crate) fn tell(&self, text: String) {
        let _ = self.0.queue().push(text.into_bytes());
        self.0.changed.notify_all();
    }
}

/// Writes pieces until there are no more.
fn write_all(mut sink: impl Write, shared: &Shared) {
    let written = loop {
        let mut queue = shared.queue();
        while queue.pieces.is_empty() && !queue.is_closed {
            queue = shared.changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
        }
        let Some(piece) = queue.pieces.pop_front() else { break Ok(()) };
        drop(queue);
        if let Err(error) = write_piece(&mut sink, &piece, shared) {
            break Err(error);
        }
    };
    let mut queue = shared.queue();
    queue.has_ended = true;
    queue.error = written.err();
    queue.pieces.clear();
    drop(queue);
    shared.changed.notify_all();
}

/// Writes a piece, and notes how it gets on.
fn write_piece(sink: &mut impl Write, piece: &[u8], shared: &Shared) -> io::Result<()> {
    for chunk in piece.chunks(CHUNK) {
        sink.write_all(chunk)?;
        sink.flush()?;
        let mut queue = shared.queue();
        queue.bytes = queue.bytes.saturating_sub(chunk.len());
        queue.moved = Instant::now();
        drop(queue);
        shared.changed.notify_all();
    }
    Ok(())
}
