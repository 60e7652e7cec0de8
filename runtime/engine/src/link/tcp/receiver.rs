//! The receiver: one thread that accepts connections, and one thread for each peer whose state has arrived.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::{io, iter, thread};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::connection::{Connection, LOOK};
use super::strangers::{Proved, Strangers};
use crate::link::endpoint::Endpoint;

/// Maximum number of connections accepted before the open connections are checked.
const AT_ONCE: usize = 16;

/// Starts the thread that accepts connections; `peers` are the addresses from which peers are expected to connect.
///
/// # Errors
/// Fails if the system cannot configure the listener or create the thread.
pub(super) fn listen(listener: TcpListener, endpoint: &Arc<Endpoint>, peers: Vec<IpAddr>) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let endpoint = Arc::clone(endpoint);
    thread::Builder::new().name("state link".to_owned()).spawn(move || accept(&listener, &endpoint, peers))?;
    Ok(())
}

fn accept(listener: &TcpListener, endpoint: &Arc<Endpoint>, peers: Vec<IpAddr>) {
    let mut strangers = Strangers::new(peers);
    // Maps each peer to the flag of its connection: `true` once the connection has been replaced.
    let mut connections = BTreeMap::<String, Arc<AtomicBool>>::new();
    while !endpoint.is_over() {
        wait(listener, &strangers);
        for Proved { stream, source, robot } in strangers.look(endpoint) {
            let is_replaced = Arc::<AtomicBool>::default();
            // The peer's old connection may still be open when it connects again.
            if let Some(old) = connections.insert(robot.clone(), Arc::clone(&is_replaced)) {
                old.store(true, Ordering::Relaxed);
            }
            let connection = Connection { stream, source, is_replaced, endpoint: Arc::clone(endpoint) };
            let begun = thread::Builder::new().name(format!("from {robot}")).spawn(move || connection.receive());
            if begun.is_err() {
                endpoint.refuse(&robot, "the system gives no thread");
            }
        }
        for connection in iter::from_fn(|| accept_one(listener)).take(AT_ONCE) {
            match connection {
                Ok((stream, from)) => strangers.add(stream, from.ip(), endpoint),
                Err(error) => {
                    endpoint.refuse("a connection", &format!("the system does not accept it: {error}"));
                    // The connection remains in the queue, so `poll` would return at once: wait before the next
                    // attempt.
                    thread::sleep(LOOK);
                    break;
                }
            }
        }
    }
}

/// Accepts a connection; returns `None` if no connection is waiting.
fn accept_one(listener: &TcpListener) -> Option<io::Result<(TcpStream, SocketAddr)>> {
    let connection = listener.accept();
    let is_none = |error: &io::Error| matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted);
    (!connection.as_ref().is_err_and(is_none)).then_some(connection)
}

/// Waits briefly for a new connection, or for bytes on a connection whose robot has not proved its name yet.
fn wait(listener: &TcpListener, strangers: &Strangers) {
    let mut files: Vec<_> = strangers.streams().map(|stream| PollFd::new(stream, PollFlags::IN)).collect();
    files.push(PollFd::new(listener, PollFlags::IN));
    let timeout = Timespec { tv_sec: 0, tv_nsec: LOOK.subsec_nanos().into() };
    if poll(&mut files, Some(&timeout)).is_err() {
        thread::sleep(LOOK);
    }
}
