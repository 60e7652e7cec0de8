//! The sender to one peer, which connects, and writes only the newest state, and each letter.

use std::collections::VecDeque;
use std::io::{self, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::{Arc, Condvar, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use super::{Shared, lock};
use crate::link::letter::UNREAD;

/// Maximum time for an attempt to connect.
const CONNECTS: Duration = Duration::from_millis(500);
/// Time between two attempts to connect.
const AGAIN: Duration = Duration::from_millis(200);
/// Time after which the connection to a peer that reads nothing is closed and made again.
pub(super) const WRITES: Duration = Duration::from_millis(500);
/// Time without a new state after which the last one is sent again, so that the connection stays open.
const HEARTBEAT: Duration = Duration::from_millis(500);

/// The newest state and the letters for a peer.
#[derive(Default)]
pub(super) struct Slot {
    waiting: Mutex<Waiting>,
    is_new: Condvar,
}

/// Frames that wait for the sender.
#[derive(Default)]
struct Waiting {
    /// The newest state; `None` once it has been taken.
    state: Option<Arc<[u8]>>,
    letters: VecDeque<Arc<[u8]>>,
}

impl Slot {
    /// Replaces the state, without waiting.
    pub(super) fn put(&self, frame: Arc<[u8]>) {
        lock(&self.waiting).state = Some(frame);
        self.is_new.notify_one();
    }

    /// Appends a letter, without waiting.
    ///
    /// # Errors
    /// Returns the number of letters if too many wait.
    pub(super) fn post(&self, frame: Arc<[u8]>) -> Result<(), usize> {
        let mut waiting = lock(&self.waiting);
        if waiting.letters.len() >= UNREAD {
            return Err(waiting.letters.len());
        }
        waiting.letters.push_back(frame);
        self.is_new.notify_one();
        Ok(())
    }

    /// Wakes the sender.
    pub(super) fn wake(&self) {
        self.is_new.notify_all();
    }

    /// Waits a while for a state or a letter that has not been sent; returns the state, or `None` if there is none.
    fn next(&self) -> Option<Arc<[u8]>> {
        let waiting = lock(&self.waiting);
        let is_idle = |waiting: &mut Waiting| waiting.state.is_none() && waiting.letters.is_empty();
        let (mut waiting, _) = self
            .is_new
            .wait_timeout_while(waiting, HEARTBEAT, is_idle)
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        waiting.state.take()
    }

    /// Returns the first letter that has not been sent.
    fn letter(&self) -> Option<Arc<[u8]>> {
        lock(&self.waiting).letters.front().cloned()
    }

    /// Removes the first letter, which has been sent.
    fn letter_is_sent(&self) {
        lock(&self.waiting).letters.pop_front();
    }
}

/// Begins to send to the peer of this name.
///
/// # Errors
/// Fails if the system cannot create the thread.
pub(super) fn begin(name: String, address: SocketAddr, shared: &Arc<Shared>) -> io::Result<Arc<Slot>> {
    let slot = Arc::<Slot>::default();
    let (own, shared) = (Arc::clone(&slot), Arc::clone(shared));
    thread::Builder::new().name(format!("to {name}")).spawn(move || keep_sending(&name, address, &own, &shared))?;
    Ok(slot)
}

/// Connects and sends until the run is over. A peer that cannot be reached is reported only once, until it has
/// been reached again.
fn keep_sending(name: &str, address: SocketAddr, slot: &Slot, shared: &Shared) {
    let mut is_known_as_down = false;
    // The last state that was taken, which a new connection begins with.
    let mut last = None;
    while !shared.is_over() {
        let begun = Instant::now();
        let failure = match connect(address) {
            Ok(stream) => {
                if is_known_as_down {
                    shared.say(format!("state link: connected to {name} again"));
                }
                is_known_as_down = false;
                send(stream, slot, &mut last, shared)
            }
            Err(error) => error,
        };
        if !is_known_as_down && !shared.is_over() {
            shared.say(format!("warning: state link: {name} at {address} cannot be reached: {failure}"));
            is_known_as_down = true;
        }
        thread::sleep(AGAIN.saturating_sub(begun.elapsed()));
    }
}

fn connect(address: SocketAddr) -> io::Result<TcpStream> {
    let stream = TcpStream::connect_timeout(&address, CONNECTS)?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(WRITES))?;
    Ok(stream)
}

/// Sends states and letters until that fails; returns the error. `last` is the state that was taken last, with which
/// every connection begins: a letter is taken only from a robot whose state has arrived.
fn send(mut stream: TcpStream, slot: &Slot, last: &mut Option<Arc<[u8]>>, shared: &Shared) -> io::Error {
    while !shared.is_over() {
        *last = slot.next().or(last.take());
        let Some(frame) = last else { continue };
        // A frame that was written in part would shift all that follow: the connection is made anew.
        if let Err(error) = stream.write_all(frame) {
            return error;
        }
        while let Some(letter) = slot.letter() {
            if let Err(error) = stream.write_all(&letter) {
                return error;
            }
            slot.letter_is_sent();
        }
    }
    io::ErrorKind::Interrupted.into()
}
