//! The receiver: a listener, and a thread for each connection, which reads frames within limits.

use std::io::{self, ErrorKind, Read, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::link::endpoint::Endpoint;
use crate::link::frame::Challenge;
use crate::link::letter_frame::{LONGEST_LETTER, is_letter};
use crate::link::source::Source;
use crate::link::state_frame::LONGEST;

/// Time between two checks for a connection, and maximum wait of a read.
const LOOK: Duration = Duration::from_millis(20);
/// Time without a byte after which a connection is closed.
const SILENT: Duration = Duration::from_secs(2);
/// Maximum number of connections for each peer: an old connection may still be open when the peer connects
/// again.
const CONNECTIONS: usize = 4;

/// Starts the thread that accepts connections.
///
/// # Errors
/// Fails if the system cannot set up the listener or create the thread.
pub(super) fn listen(listener: TcpListener, endpoint: &Arc<Endpoint>) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let endpoint = Arc::clone(endpoint);
    thread::Builder::new().name("state link".to_owned()).spawn(move || accept(&listener, &endpoint))?;
    Ok(())
}

fn accept(listener: &TcpListener, endpoint: &Arc<Endpoint>) {
    let open = Arc::new(AtomicUsize::new(0));
    let most = CONNECTIONS * (endpoint.peers().len() + 1);
    while !endpoint.is_over() {
        let Ok((stream, from)) = listener.accept() else {
            thread::sleep(LOOK);
            continue;
        };
        if open.load(Ordering::Relaxed) >= most {
            endpoint
                .say(format!("warning: state link: {from} is refused: {most} connections are open, which is the most"));
            continue;
        }
        open.fetch_add(1, Ordering::Relaxed);
        let (own, count) = (Arc::clone(endpoint), Arc::clone(&open));
        let begun = thread::Builder::new().name(format!("from {from}")).spawn(move || {
            if let Err(why) = receive(stream, &own) {
                own.say(format!("warning: state link: {from} is refused: {why}"));
            }
            count.fetch_sub(1, Ordering::Relaxed);
        });
        if begun.is_err() {
            open.fetch_sub(1, Ordering::Relaxed);
            endpoint.say(format!("warning: state link: {from} is refused: the system gives no thread"));
        }
    }
}

/// Greets the sender of a connection, and takes its frames until it ends.
///
/// # Errors
/// Fails with the end of a sentence if anything but states and letters of a peer arrives.
fn receive(mut stream: TcpStream, endpoint: &Endpoint) -> Result<(), String> {
    let set = stream.set_nonblocking(false).and_then(|()| stream.set_read_timeout(Some(LOOK)));
    let challenge = set.and_then(|()| Challenge::random()).map_err(|error| error.to_string())?;
    // A sender that is gone already is no fault of this robot's.
    if stream.write_all(&challenge.greeting()).is_err() {
        return Ok(());
    }
    let mut source = Source::of_connection(challenge);
    while let Some(frame) = next(&mut stream, endpoint)? {
        endpoint.take(&mut source, &frame)?;
    }
    Ok(())
}

/// Reads a frame; returns `None` if the connection or the run has ended before a frame began.
fn next(stream: &mut TcpStream, endpoint: &Endpoint) -> Result<Option<Vec<u8>>, String> {
    let mut length = [0; 4];
    if !fill(stream, &mut length, endpoint)? {
        return Ok(None);
    }
    let length = u32::from_le_bytes(length) as usize;
    if length > LONGEST_LETTER {
        return Err("it sends no states".to_owned());
    }
    let mut frame = vec![0; length];
    if !fill(stream, &mut frame, endpoint)? {
        return Err("it ended within a frame".to_owned());
    }
    if length > LONGEST && !is_letter(&frame) {
        return Err("it sends no states".to_owned());
    }
    Ok(Some(frame))
}

/// Fills `bytes`; returns `false` if the connection breaks or ends before the first byte, or if the run has
/// ended.
fn fill(stream: &mut TcpStream, bytes: &mut [u8], endpoint: &Endpoint) -> Result<bool, String> {
    let (mut heard, mut filled) = (Instant::now(), 0);
    while filled < bytes.len() {
        if endpoint.is_over() {
            return Ok(false);
        }
        if heard.elapsed() >= SILENT {
            return Err(format!("it sends nothing for {} s", SILENT.as_secs()));
        }
        let Some(rest) = bytes.get_mut(filled..) else { return Ok(false) };
        match stream.read(rest) {
            Ok(0) if filled == 0 => return Ok(false),
            Ok(0) => return Err("it ended within a frame".to_owned()),
            Ok(count) => (heard, filled) = (Instant::now(), filled + count),
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) => {}
            // A peer that went away is not a fault of this robot's; its state grows old.
            Err(_) => return Ok(false),
        }
    }
    Ok(true)
}
