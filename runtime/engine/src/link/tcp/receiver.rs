//! The receiver: a listener, and a thread for each connection, which reads frames within limits.

use std::io::{self, ErrorKind, Read};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::Shared;
use crate::link::frame::{self, LONGEST, Refused, VERSION};
use crate::link::letter_frame::{LONGEST_LETTER, is_letter};

/// Time between two checks for a connection, and maximum wait of a read.
const LOOK: Duration = Duration::from_millis(20);
/// Time within which a whole frame has to arrive on a connection.
const SILENT: Duration = Duration::from_secs(2);
/// Maximum number of frames that a connection may send in a second: twice as many as a robot with turns of a
/// millisecond sends.
const FRAMES: u32 = 2000;
/// Maximum number of letters that a connection may send in a second.
const LETTERS: u32 = 20;
/// Maximum number of connections for each peer: an old connection may still be open when the peer connects
/// again.
const CONNECTIONS: usize = 4;

/// Starts the thread that accepts connections.
///
/// # Errors
/// Fails if the system cannot set up the listener or create the thread.
pub(super) fn listen(listener: TcpListener, shared: &Arc<Shared>) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let shared = Arc::clone(shared);
    thread::Builder::new().name("state link".to_owned()).spawn(move || accept(&listener, &shared))?;
    Ok(())
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    let open = Arc::new(AtomicUsize::new(0));
    let most = CONNECTIONS * (shared.peers.len() + 1);
    while !shared.is_over() {
        let Ok((stream, from)) = listener.accept() else {
            thread::sleep(LOOK);
            continue;
        };
        if open.load(Ordering::Relaxed) >= most {
            shared
                .say(format!("warning: state link: {from} is refused: {most} connections are open, which is the most"));
            continue;
        }
        open.fetch_add(1, Ordering::Relaxed);
        let (own, count) = (Arc::clone(shared), Arc::clone(&open));
        let begun = thread::Builder::new().name(format!("from {from}")).spawn(move || {
            if let Err(why) = receive(stream, &own) {
                own.say(format!("warning: state link: {from} is refused: {why}"));
            }
            count.fetch_sub(1, Ordering::Relaxed);
        });
        if begun.is_err() {
            open.fetch_sub(1, Ordering::Relaxed);
            shared.say(format!("warning: state link: {from} is refused: the system gives no thread"));
        }
    }
}

/// Receives states from a connection until it ends.
///
/// # Errors
/// Fails with the end of a sentence if anything but states of a peer arrives.
fn receive(mut stream: TcpStream, shared: &Shared) -> Result<(), String> {
    let set = stream.set_nonblocking(false).and_then(|()| stream.set_read_timeout(Some(LOOK)));
    set.map_err(|error| error.to_string())?;
    let (mut second, mut count, mut letters) = (Instant::now(), 0, 0);
    loop {
        let Some(frame) = next(&mut stream, shared)? else { return Ok(()) };
        if second.elapsed() >= Duration::from_secs(1) {
            (second, count, letters) = (Instant::now(), 0, 0);
        }
        if is_letter(&frame) {
            letters += 1;
            if letters > LETTERS {
                return Err(format!("it sends more than {LETTERS} letters a second"));
            }
            shared.letters.take(&frame)?;
            continue;
        }
        let state = frame::read(&frame, &shared.key).map_err(|refused| match refused {
            Refused::Garbage => "it sends no states".to_owned(),
            Refused::Version(other) => format!("its version of the link is {other}, and this one has {VERSION}"),
            Refused::Key => "it has another key".to_owned(),
        })?;
        if !shared.peers.contains(&state.name) {
            return Err(format!("its robot `{}` is none of {}", state.name, shared.peers.join(", ")));
        }
        shared.take(state);
        count += 1;
        if count > FRAMES {
            return Err(format!("it sends more than {FRAMES} states a second"));
        }
    }
}

/// Reads a frame; returns `None` if the connection or the run has ended before a frame began.
fn next(stream: &mut TcpStream, shared: &Shared) -> Result<Option<Vec<u8>>, String> {
    let mut length = [0; 4];
    if !fill(stream, &mut length, shared)? {
        return Ok(None);
    }
    let length = u32::from_le_bytes(length) as usize;
    if length > LONGEST_LETTER {
        return Err("it sends no states".to_owned());
    }
    let mut frame = vec![0; length];
    if !fill(stream, &mut frame, shared)? {
        return Err("it ended within a state".to_owned());
    }
    if length > LONGEST && !is_letter(&frame) {
        return Err("it sends no states".to_owned());
    }
    Ok(Some(frame))
}

/// Fills `bytes`; returns `false` if the connection breaks or ends before the first byte, or if the run has
/// ended.
fn fill(stream: &mut TcpStream, bytes: &mut [u8], shared: &Shared) -> Result<bool, String> {
    let (begun, mut filled) = (Instant::now(), 0);
    while filled < bytes.len() {
        if shared.is_over() {
            return Ok(false);
        }
        if begun.elapsed() >= SILENT {
            return Err(format!("it sends nothing for {} s", SILENT.as_secs()));
        }
        let Some(rest) = bytes.get_mut(filled..) else { return Ok(false) };
        match stream.read(rest) {
            Ok(0) if filled == 0 => return Ok(false),
            Ok(0) => return Err("it ended within a state".to_owned()),
            Ok(count) => filled += count,
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) => {}
            // A peer that went away is not a fault of this robot's; its state grows old.
            Err(_) => return Ok(false),
        }
    }
    Ok(true)
}
