//! The sender to one peer: connects to the peer, and sends all letters, but only the newest state.

use std::io::{self, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use rustix::net::sockopt::{set_socket_send_buffer_size, set_tcp_user_timeout};

use crate::link::endpoint::Endpoint;
use crate::link::frame::{Challenge, FrameDraft, GREETING_LENGTH, RefusedFrame, VERSION};
use crate::link::outbox::Outbox;

/// Maximum duration of an attempt to connect.
const CONNECTS: Duration = Duration::from_millis(500);
/// Maximum wait for a peer's greeting.
const GREETS: Duration = Duration::from_secs(1);
/// Minimum time between two attempts to connect.
const AGAIN: Duration = Duration::from_millis(200);
/// Time after which a connection is closed and opened again if the peer neither acknowledges nor reads data. Without
/// this limit, the system would retransmit lost data at longer and longer intervals, even after the line has recovered.
pub(super) const WRITES: Duration = Duration::from_secs(2);
/// Time after which a connection is considered stable.
const LASTS: Duration = Duration::from_secs(1);
/// Minimum time between two states. Only the newest state matters, and a receiver accepts at most 2000 per second.
const SPACING: Duration = Duration::from_millis(1);
/// Size of the system's send buffer, in bytes. A newer state does not replace states in this buffer.
const BUFFER: usize = 16_384;

/// Starts to send to the peer `name`.
///
/// # Errors
/// Fails if the system cannot create the thread.
pub(super) fn begin(name: String, address: SocketAddr, endpoint: &Arc<Endpoint>) -> io::Result<Arc<Outbox>> {
    let outbox = Arc::<Outbox>::default();
    let (own, endpoint) = (Arc::clone(&outbox), Arc::clone(endpoint));
    thread::Builder::new().name(format!("to {name}")).spawn(move || keep_sending(&name, address, &own, &endpoint))?;
    Ok(outbox)
}

/// Connects and sends until the run has ended. Reports that the peer cannot be reached, and does not repeat this report
/// before a connection to the peer has been stable.
fn keep_sending(name: &str, address: SocketAddr, outbox: &Outbox, endpoint: &Endpoint) {
    let mut sender = Sender { name, outbox, endpoint, last: None, is_known_as_down: false };
    while !endpoint.is_over() {
        let begun = Instant::now();
        sender.drop_late_letters();
        sender.last = outbox.next().or(sender.last.take());
        if sender.last.is_none() {
            // Before its first turn, the robot has no state to send, and a receiver expects a state first.
            continue;
        }
        let failure = match connect(address) {
            Ok(connection) => {
                outbox.open();
                let failure = sender.send(connection);
                outbox.close();
                reason(&failure)
            }
            Err(failure) => failure,
        };
        if !sender.is_known_as_down && !endpoint.is_over() {
            endpoint.say(format!("warning: state link: {name} at {address} cannot be reached: {failure}"));
            sender.is_known_as_down = true;
        }
        thread::sleep(AGAIN.saturating_sub(begun.elapsed()));
    }
}

/// Returns why a connection ended, as the end of a sentence. A peer closes the connection both when it ends and when it
/// refuses this robot.
fn reason(failure: &io::Error) -> String {
    use io::ErrorKind::{BrokenPipe, ConnectionAborted, ConnectionReset};

    if ![BrokenPipe, ConnectionAborted, ConnectionReset].contains(&failure.kind()) {
        return failure.to_string();
    }
    "it has closed the connection, as a robot does that has ended, or that refuses this one and says why in its own \
     warnings"
        .to_owned()
}

/// Connects to a peer, and receives the peer's challenge.
///
/// # Errors
/// Returns the end of a sentence if the peer cannot be reached, or uses another version of the link.
fn connect(address: SocketAddr) -> Result<(TcpStream, Challenge), String> {
    let mut greeting = [0; GREETING_LENGTH];
    let connected = (|| {
        let mut stream = TcpStream::connect_timeout(&address, CONNECTS)?;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(WRITES))?;
        set_tcp_user_timeout(&stream, WRITES.as_millis() as u32)?;
        set_socket_send_buffer_size(&stream, BUFFER)?;
        stream.set_read_timeout(Some(GREETS))?;
        Ok((stream.read_exact(&mut greeting), stream))
    })();
    let (read, stream) = connected.map_err(|error: io::Error| error.to_string())?;
    read.map_err(|_| "it sends no greeting, as no version of the link before 4 does".to_owned())?;
    match Challenge::of_greeting(&greeting) {
        Ok(challenge) => Ok((stream, challenge)),
        Err(RefusedFrame::Version(other)) => {
            Err(format!("its version of the link is {other}, and this one has {VERSION}"))
        }
        Err(RefusedFrame::Garbage | RefusedFrame::Key | RefusedFrame::Impossible) => {
            Err("its greeting is none of a robot".to_owned())
        }
    }
}

/// Sends states and letters to a peer.
struct Sender<'l> {
    /// Name of the peer.
    name: &'l str,
    outbox: &'l Outbox,
    endpoint: &'l Endpoint,
    /// The state that was sent last; `None` before the first. Every connection begins with this state, because a letter
    /// is accepted only from a robot whose state has arrived.
    last: Option<FrameDraft>,
    /// `true` once it has been reported that the peer cannot be reached.
    is_known_as_down: bool,
}

impl Sender<'_> {
    /// Sends states and letters until an error occurs or the run has ended; returns the error.
    fn send(&mut self, (mut stream, challenge): (TcpStream, Challenge)) -> io::Error {
        let begun = Instant::now();
        while !self.endpoint.is_over() {
            // A partly written frame would make all later frames unreadable: a new connection is opened.
            if let Err(error) = self.last.iter().try_for_each(|state| stream.write_all(&state.frame(&challenge))) {
                return error;
            }
            let written = Instant::now();
            while let Some(letter) = self.outbox.letter(Instant::now()) {
                if let Err(error) = stream.write_all(&letter.draft.frame(&challenge)) {
                    return error;
                }
                self.outbox.is_sent(letter.number);
            }
            // A peer with a different key closes each connection at once.
            if self.is_known_as_down && begun.elapsed() >= LASTS {
                self.endpoint.say(format!("state link: connected to {} again", self.name));
                self.is_known_as_down = false;
            }
            thread::sleep(SPACING.saturating_sub(written.elapsed()));
            self.last = self.outbox.next().or(self.last.take());
            self.drop_late_letters();
        }
        io::ErrorKind::Interrupted.into()
    }

    fn drop_late_letters(&self) {
        self.outbox.late(Instant::now()).iter().for_each(|letter| self.endpoint.is_late(letter));
    }
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use rustix::net::sockopt::tcp_user_timeout;

    use super::*;

    #[test]
    fn a_connection_without_acknowledgements_is_given_up() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let peer = thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            stream.write_all(&Challenge::NONE.greeting()).unwrap();
        });
        let (stream, challenge) = connect(address).unwrap();
        peer.join().unwrap();
        assert_eq!((tcp_user_timeout(&stream), challenge), (Ok(2000), Challenge::NONE));
    }
}
