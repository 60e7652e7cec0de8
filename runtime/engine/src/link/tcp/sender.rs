//! The sender to one peer, which connects, and writes only the newest state, and each letter.

use std::io::{self, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use rustix::net::sockopt::{set_socket_send_buffer_size, set_tcp_user_timeout};

use crate::link::endpoint::Endpoint;
use crate::link::frame::{Challenge, Draft, GREETING_LENGTH, Refused, VERSION};
use crate::link::outbox::Outbox;

/// Maximum time for an attempt to connect.
const CONNECTS: Duration = Duration::from_millis(500);
/// Maximum time that a peer may take for its greeting.
const GREETS: Duration = Duration::from_secs(1);
/// Time between two attempts to connect.
const AGAIN: Duration = Duration::from_millis(200);
/// Time after which the connection to a peer that acknowledges nothing, or reads nothing, is closed and made again.
/// Without it the system would send what was lost again at ever longer intervals, also once the line is good.
pub(super) const WRITES: Duration = Duration::from_secs(2);
/// Size of the system's buffer, in bytes: what is in it is not replaced by newer states.
const BUFFER: usize = 16_384;

/// Begins to send to the peer of this name.
///
/// # Errors
/// Fails if the system cannot create the thread.
pub(super) fn begin(name: String, address: SocketAddr, endpoint: &Arc<Endpoint>) -> io::Result<Arc<Outbox>> {
    let outbox = Arc::<Outbox>::default();
    let (own, endpoint) = (Arc::clone(&outbox), Arc::clone(endpoint));
    thread::Builder::new().name(format!("to {name}")).spawn(move || keep_sending(&name, address, &own, &endpoint))?;
    Ok(outbox)
}

/// Connects and sends until the run is over. A peer that cannot be reached is reported only once, until it has
/// been reached again.
fn keep_sending(name: &str, address: SocketAddr, outbox: &Outbox, endpoint: &Endpoint) {
    let mut is_known_as_down = false;
    // The last state that was taken, which a new connection begins with.
    let mut last = None;
    while !endpoint.is_over() {
        let begun = Instant::now();
        outbox.late(begun).iter().for_each(|letter| endpoint.is_late(letter));
        let failure = match connect(address) {
            Ok(connection) => {
                if is_known_as_down {
                    endpoint.say(format!("state link: connected to {name} again"));
                }
                is_known_as_down = false;
                outbox.open();
                let failure = send(connection, outbox, &mut last, endpoint);
                outbox.close();
                failure.to_string()
            }
            Err(failure) => failure,
        };
        if !is_known_as_down && !endpoint.is_over() {
            endpoint.say(format!("warning: state link: {name} at {address} cannot be reached: {failure}"));
            is_known_as_down = true;
        }
        thread::sleep(AGAIN.saturating_sub(begun.elapsed()));
    }
}

/// Connects to a peer, and reads its challenge.
///
/// # Errors
/// The peer cannot be reached, or has another version of the link: the end of a sentence.
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
        Err(Refused::Version(other)) => Err(format!("its version of the link is {other}, and this one has {VERSION}")),
        Err(Refused::Garbage | Refused::Key | Refused::Impossible) => Err("its greeting is none of a robot".to_owned()),
    }
}

/// Sends states and letters until that fails; returns the error. `last` is the state that was taken last, with which
/// every connection begins: a letter is taken only from a robot whose state has arrived.
fn send(
    (mut stream, challenge): (TcpStream, Challenge),
    outbox: &Outbox,
    last: &mut Option<Draft>,
    endpoint: &Endpoint,
) -> io::Error {
    while !endpoint.is_over() {
        *last = outbox.next().or(last.take());
        let Some(state) = last else { continue };
        // A frame that was written in part would shift all that follow: the connection is made anew.
        if let Err(error) = stream.write_all(&state.frame(&challenge)) {
            return error;
        }
        outbox.late(Instant::now()).iter().for_each(|letter| endpoint.is_late(letter));
        while let Some(letter) = outbox.letter(Instant::now()) {
            if let Err(error) = stream.write_all(&letter.draft.frame(&challenge)) {
                return error;
            }
            outbox.is_sent(letter.number);
        }
    }
    io::ErrorKind::Interrupted.into()
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
