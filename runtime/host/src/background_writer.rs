//! A writer for which a robot never has to wait: a separate thread writes the text that the turns produce.

#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::Builder;
use std::time::{Duration, Instant};

use crate::patience::{AT_THE_END, Patience};

/// Stack size of a thread that only writes, in bytes. All memory of a run is locked, so the stack is as small as
/// possible.
pub(crate) const STACK: usize = 128 * 1024;
/// Maximum size, in bytes, of the text that is queued for a slow reader.
const WAITING: usize = 1 << 20;
/// Size, in bytes, from which collected text is passed to the thread even without a flush.
const PIECE: usize = 1 << 16;
/// Maximum size of a single write, in bytes. Each completed write shows that the reader has not stalled.
const CHUNK: usize = 1 << 13;
/// Maximum time without progress on a file that must be complete, while a robot is being driven.
const LAG: Duration = Duration::from_secs(5);
/// Maximum wait between two checks of the deadline.
const LOOK: Duration = Duration::from_millis(20);
/// Time after which an idle thread also writes text that was not flushed: a turn that never returns flushes nothing.
const IDLE: Duration = Duration::from_secs(1);
/// Line in place of text that was dropped.
const MISSING: &[u8] = b"(lines are missing here: they were not read in time)\n";

/// Policy for text that does not fit into the queue of a slow reader while a robot is being driven.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Keeps {
    /// Text for people. Text that does not fit is dropped, and a line reports this.
    WhatIsRead,
    /// A file that must be complete. A full queue is an error.
    All,
}

/// A writer whose `flush` returns at once while a robot is being driven. At other times, `flush` waits until all text
/// is written, but at most as long as [`Patience`] permits. Dropping the writer waits in the same way.
#[derive(Debug)]
pub(crate) struct Outlet {
    keeps: Keeps,
    patience: Patience,
    /// `true` once the writer no longer waits for the reader.
    given_up: bool,
    shared: Arc<WriterQueue>,
}

#[derive(Debug)]
struct WriterQueue {
    queue: Mutex<Queue>,
    changed: Condvar,
}

#[derive(Debug)]
struct Queue {
    /// Text collected since text was last passed to the thread.
    collected: Vec<u8>,
    /// `true` if text has been dropped since text was last passed to the thread.
    lost: bool,
    pieces: VecDeque<Vec<u8>>,
    /// Number of bytes that are queued or being written.
    bytes: usize,
    /// Time at which the reader last accepted text; if the thread was idle, the time at which it received new text.
    moved: Instant,
    is_closed: bool,
    /// Error that ended the thread.
    error: Option<io::Error>,
    has_ended: bool,
}

impl WriterQueue {
    fn queue(&self) -> MutexGuard<'_, Queue> {
        // No code panics while it holds this lock.
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Queue {
    /// Appends a piece of text. Returns `false`, and drops the piece, if the queue has no space. An empty queue has
    /// space for a piece of any length.
    fn push(&mut self, piece: Vec<u8>) -> bool {
        let has_space = self.has_space(piece.len());
        if has_space {
            self.append(piece);
        }
        has_space
    }

    /// Passes the collected text to the thread. Returns `false`, and keeps the text, if the queue has no space.
    fn hand_over(&mut self) -> bool {
        let has_space = self.has_space(self.collected.len());
        if has_space {
            let mut piece = std::mem::take(&mut self.collected);
            if std::mem::take(&mut self.lost) {
                piece.splice(0..0, MISSING.iter().copied());
            }
            self.append(piece);
        }
        has_space
    }

    fn has_space(&self, length: usize) -> bool {
        self.bytes == 0 || self.bytes.saturating_add(length) <= WAITING
    }

    fn append(&mut self, piece: Vec<u8>) {
        if self.bytes == 0 {
            self.moved = Instant::now();
        }
        self.bytes += piece.len();
        self.pieces.push_back(piece);
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
    /// Starts a thread that writes to `sink`.
    ///
    /// # Errors
    /// Fails if the system cannot create a thread.
    pub(crate) fn open(sink: impl Write + Send + 'static, keeps: Keeps, patience: &Patience) -> io::Result<Self> {
        let queue = Queue {
            collected: Vec::new(),
            lost: false,
            pieces: VecDeque::new(),
            bytes: 0,
            moved: Instant::now(),
            is_closed: false,
            error: None,
            has_ended: false,
        };
        let shared = Arc::new(WriterQueue { queue: Mutex::new(queue), changed: Condvar::new() });
        let writer = Arc::clone(&shared);
        Builder::new().name("writer".to_owned()).stack_size(STACK).spawn(move || write_all(sink, &writer))?;
        Ok(Self { keeps, patience: patience.clone(), given_up: false, shared })
    }

    /// Returns a handle with which other threads write text without waiting.
    pub(crate) fn aside(&self) -> Aside {
        Aside(Arc::clone(&self.shared))
    }

    /// Passes the text collected so far to the thread.
    fn hand_over(&mut self) -> io::Result<()> {
        let shared = Arc::clone(&self.shared);
        let begun = Instant::now();
        let mut queue = shared.queue();
        if queue.collected.is_empty() {
            return Ok(());
        }
        loop {
            queue.check()?;
            if queue.hand_over() {
                break;
            }
            if self.has_no_patience(queue.moved.max(begun)) {
                queue.collected.clear();
                return self.without_room(&mut queue);
            }
            queue = self.wait(queue);
        }
        shared.changed.notify_all();
        let lags = self.keeps == Keeps::All && self.is_driving() && queue.moved.elapsed() >= LAG;
        if lags { Err(too_slow(LAG)) } else { Ok(()) }
    }

    /// Handles text that does not fit into the queue: either reports it as dropped or returns an error.
    fn without_room(&mut self, queue: &mut Queue) -> io::Result<()> {
        match self.keeps {
            Keeps::WhatIsRead if self.is_driving() => {
                queue.lost = true;
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

    /// Waits until all text is written, but at most as long as the run's phase permits. Does not wait while a robot is
    /// being driven.
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

    /// Returns `true` while a robot is being driven; the robot must not wait for the writer.
    fn is_driving(&self) -> bool {
        self.patience.limit() == Some(Duration::ZERO)
    }

    /// Returns `true` if the writer no longer waits for a reader that has accepted nothing since `since`.
    fn has_no_patience(&self, since: Instant) -> bool {
        self.given_up || self.patience.limit().is_some_and(|limit| since.elapsed() >= limit)
    }

    fn wait<'q>(&self, queue: MutexGuard<'q, Queue>) -> MutexGuard<'q, Queue> {
        self.shared.changed.wait_timeout(queue, LOOK).unwrap_or_else(PoisonError::into_inner).0
    }
}

/// Returns the error about a reader that accepts nothing.
fn too_slow(limit: Duration) -> io::Error {
    io::Error::new(io::ErrorKind::TimedOut, unread(limit))
}

fn unread(limit: Duration) -> String {
    format!("it was not read for {} s", limit.as_secs())
}

impl Write for Outlet {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut queue = self.shared.queue();
        queue.collected.extend_from_slice(bytes);
        let is_full = queue.collected.len() >= PIECE;
        drop(queue);
        if is_full {
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
        // An error at this point affects only the last lines of a report, after the robot was stopped.
        let _ = self.flush();
        self.shared.queue().is_closed = true;
        self.shared.changed.notify_all();
    }
}

/// A handle of an outlet, for messages from threads that cannot wait.
#[derive(Debug, Clone)]
pub(crate) struct Aside(Arc<WriterQueue>);

impl Aside {
    /// Passes a text to the outlet, or drops it if there is no space.
    pub(crate) fn tell(&self, text: String) {
        let _was_taken = self.0.queue().push(text.into_bytes());
        self.0.changed.notify_all();
    }
}

/// Writes all pieces of text until the queue is closed.
fn write_all(mut sink: impl Write, shared: &WriterQueue) {
    let written = loop {
        let mut queue = shared.queue();
        while queue.pieces.is_empty() && !queue.is_closed {
            let (woken, wait) = shared.changed.wait_timeout(queue, IDLE).unwrap_or_else(PoisonError::into_inner);
            queue = woken;
            if wait.timed_out() && !queue.collected.is_empty() {
                queue.hand_over();
            }
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

/// Writes a piece of text, and records the progress.
fn write_piece(sink: &mut impl Write, piece: &[u8], shared: &WriterQueue) -> io::Result<()> {
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
