//! Strangers: connections whose peers have not proved their names yet. The number of strangers is limited, and a new
//! one replaces an old one, so an attacker cannot lock out peers by keeping connections open.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{IpAddr, TcpStream};
use std::time::{Duration, Instant};

use crate::link::endpoint::Endpoint;
use crate::link::frame::Challenge;
use crate::link::source::FrameSource;
use crate::link::state_frame::LONGEST;

/// Maximum number of connections without a proved name.
const PLACES: usize = 64;
/// Maximum time from opening a connection to the arrival of the first state.
const PROVES: Duration = Duration::from_secs(1);

/// Connections without a proved name, in the order in which they were opened.
pub(super) struct Strangers {
    /// Addresses of the robot's peers.
    peers: Vec<IpAddr>,
    strangers: Vec<Stranger>,
}

/// A connection without a proved name.
struct Stranger {
    stream: TcpStream,
    from: IpAddr,
    since: Instant,
    source: FrameSource,
    /// Bytes that have arrived: the length of a frame, followed by the frame.
    bytes: Vec<u8>,
}

/// A connection on which the first state has arrived.
pub(super) struct Proved {
    pub(super) stream: TcpStream,
    pub(super) source: FrameSource,
    /// Name of the robot.
    pub(super) robot: String,
}

/// Progress of a stranger towards a proved name.
enum HandshakeProgress {
    Waits,
    /// The connection has ended.
    Gone,
    Proved,
    /// The connection has to be closed; contains the reason as the end of a sentence.
    Refused(String),
}

impl Strangers {
    /// Creates an empty list of strangers for a robot with peers at these addresses.
    pub(super) fn new(peers: Vec<IpAddr>) -> Self {
        Self { peers: peers.iter().map(IpAddr::to_canonical).collect(), strangers: Vec::new() }
    }

    /// Returns the streams of all strangers.
    pub(super) fn streams(&self) -> impl Iterator<Item = &TcpStream> {
        self.strangers.iter().map(|stranger| &stranger.stream)
    }

    /// Adds a new connection, and sends a greeting on it.
    pub(super) fn add(&mut self, stream: TcpStream, from: IpAddr, endpoint: &Endpoint) {
        // A listener for both versions of IP reports IPv4 addresses as IPv6 addresses.
        let from = from.to_canonical();
        let Ok(stranger) = Stranger::greeted(stream, from) else {
            return endpoint.refuse(&from.to_string(), "it could not be greeted");
        };
        if self.strangers.len() >= PLACES {
            let addresses: Vec<_> = self.strangers.iter().map(|stranger| stranger.from).collect();
            match place_for(from, &addresses, &self.peers) {
                Some(place) => drop(self.strangers.remove(place)),
                None => return,
            }
            endpoint.refuse("a connection", &format!("{PLACES} others have not sent a state yet"));
        }
        self.strangers.push(stranger);
    }

    /// Reads the bytes that strangers have sent; returns the connections whose names are now proved.
    pub(super) fn look(&mut self, endpoint: &Endpoint) -> Vec<Proved> {
        let mut proved = Vec::new();
        for mut stranger in std::mem::take(&mut self.strangers) {
            match stranger.look(endpoint) {
                HandshakeProgress::Waits => self.strangers.push(stranger),
                HandshakeProgress::Gone => {}
                HandshakeProgress::Refused(reason) => endpoint.refuse(&stranger.from.to_string(), &reason),
                HandshakeProgress::Proved => {
                    let Stranger { stream, source, .. } = stranger;
                    let robot = source.robot().unwrap_or_default().to_owned();
                    proved.push(Proved { stream, source, robot });
                }
            }
        }
        proved
    }
}

/// Returns the index of the stranger that is replaced by a new connection from the address `new`. This is the oldest
/// stranger that is not from a peer's address. If all strangers are from peers' addresses, it is the oldest stranger,
/// but only if `new` is also a peer's address; otherwise, returns `None`.
fn place_for(new: IpAddr, strangers: &[IpAddr], peers: &[IpAddr]) -> Option<usize> {
    let is_elsewhere = |from: &IpAddr| !peers.contains(from);
    strangers.iter().position(is_elsewhere).or_else(|| peers.contains(&new).then_some(0))
}

impl Stranger {
    /// Sends a challenge on a new connection, and returns the stranger.
    ///
    /// # Errors
    /// Fails if the connection has ended, or if the system has no random numbers.
    fn greeted(mut stream: TcpStream, from: IpAddr) -> std::io::Result<Self> {
        stream.set_nonblocking(true)?;
        let challenge = Challenge::random()?;
        // The send buffer of a new connection is empty, so this does not block.
        stream.write_all(&challenge.greeting())?;
        let source = FrameSource::of_connection(challenge);
        Ok(Self { stream, from, since: Instant::now(), source, bytes: Vec::new() })
    }

    /// Reads the available bytes of the first frame, and checks the frame once it is complete.
    fn look(&mut self, endpoint: &Endpoint) -> HandshakeProgress {
        loop {
            let missing = match self.bytes.split_first_chunk() {
                None => 4 - self.bytes.len(),
                Some((length, frame)) => {
                    let length = u32::from_le_bytes(*length) as usize;
                    if length > LONGEST {
                        return HandshakeProgress::Refused("it sends no states".to_owned());
                    }
                    if frame.len() >= length {
                        return match endpoint.take(&mut self.source, frame) {
                            Ok(()) => HandshakeProgress::Proved,
                            Err(reason) => HandshakeProgress::Refused(reason),
                        };
                    }
                    length - frame.len()
                }
            };
            let mut buffer = [0; 1024];
            let Some(place) = buffer.get_mut(..missing.min(1024)) else { return HandshakeProgress::Gone };
            match self.stream.read(place) {
                Ok(0) if self.bytes.is_empty() => return HandshakeProgress::Gone,
                Ok(0) => return HandshakeProgress::Refused("it ended within a frame".to_owned()),
                Ok(count) => self.bytes.extend(place.get(..count).unwrap_or_default()),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {
                    let is_late = self.since.elapsed() >= PROVES;
                    let reason = || format!("it has not sent a state within {} s", PROVES.as_secs());
                    return if is_late { HandshakeProgress::Refused(reason()) } else { HandshakeProgress::Waits };
                }
                Err(_) => return HandshakeProgress::Gone,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use super::*;
    use crate::link::endpoint::LinkSettings;

    #[test]
    fn a_stranger_makes_no_place_at_a_peers_address() {
        let [peer, one, other] = ["10.0.0.1", "10.0.0.2", "10.0.0.3"].map(|text| text.parse::<IpAddr>().unwrap());
        assert_eq!(place_for(peer, &[peer, one, other], &[peer]), Some(1));
        assert_eq!(place_for(other, &[peer, one], &[peer]), Some(1));
        assert_eq!(place_for(peer, &[peer, peer], &[peer]), Some(0));
        assert_eq!(place_for(other, &[peer, peer], &[peer]), None);
    }

    #[test]
    fn peers_at_an_ipv6_listener_are_known_by_ipv4() {
        let settings =
            LinkSettings { name: "bob".to_owned(), peers: Vec::new(), key: String::new(), plans: Vec::new() };
        let (listener, endpoint) = (TcpListener::bind("127.0.0.1:0").unwrap(), Endpoint::new(&settings));
        let address = listener.local_addr().unwrap();
        let [peer, mapped, other] =
            ["10.0.0.1", "::ffff:10.0.0.1", "10.0.0.2"].map(|text| text.parse::<IpAddr>().unwrap());
        for (of_file, from) in [(peer, mapped), (mapped, peer)] {
            let mut strangers = Strangers::new(vec![of_file]);
            let connect = |_| (TcpStream::connect(address).unwrap(), listener.accept().unwrap().0);
            let connections: Vec<_> = (0..=PLACES).map(connect).collect();
            for (place, (_, stream)) in connections.iter().enumerate() {
                strangers.add(stream.try_clone().unwrap(), if place == 0 { from } else { other }, &endpoint);
            }
            let first = &strangers.strangers.first().unwrap().stream;
            assert_eq!(first.peer_addr().unwrap(), connections[0].0.local_addr().unwrap(), "{from}");
        }
    }
}
