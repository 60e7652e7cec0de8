//! The link over TCP between processes and machines. A robot's turn only hands over its state and collects the states
//! that have arrived; separate threads do everything that may block.
//!
//! A robot opens a connection to each peer for sending, and accepts connections for receiving. Each peer has its own
//! sender, which sends all letters, but only the newest state, so a peer that reads slowly or never does not delay the
//! others. The receiver of a connection first sends a challenge, for which each frame needs a proof.

#[cfg(test)]
mod answer_tests;
mod connection;
#[cfg(test)]
mod letter_tests;
mod receiver;
#[cfg(test)]
mod refusal_tests;
mod sender;
mod strangers;
#[cfg(test)]
mod tests;

use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::time::Instant;

use mdle_runtime::Nanos;

use super::endpoint::{Endpoint, LinkSettings};
use super::outbox::Outbox;
use super::{Content, Letter, Link, RefusedPlan, State};
use receiver::listen;

/// Names, keys and addresses of a link over TCP.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TcpSettings {
    /// Names and keys.
    pub link: LinkSettings,
    /// Address at which the robot listens.
    pub listen: SocketAddr,
    /// Address of each peer, in the order of the peers' names.
    pub addresses: Vec<SocketAddr>,
}

/// One robot's end of a state link over TCP.
pub struct Tcp {
    endpoint: Arc<Endpoint>,
    /// The outbox of each peer, with the peer's name.
    outboxes: Vec<(String, Arc<Outbox>)>,
}

impl Tcp {
    /// Starts to listen, and to connect to the peers.
    ///
    /// # Errors
    /// Fails with a sentence if the robot cannot listen at the address, or if the system cannot create the threads.
    pub fn open(settings: &TcpSettings) -> Result<Self, String> {
        let TcpSettings { listen, .. } = settings;
        let listener = TcpListener::bind(listen).map_err(|error| format!("nothing can listen at {listen}: {error}"))?;
        Self::on(listener, settings).map_err(|error| format!("the system gives no thread: {error}"))
    }

    /// Returns the link of a robot that accepts connections from `listener`.
    fn on(listener: TcpListener, settings: &TcpSettings) -> io::Result<Self> {
        let TcpSettings { link: settings, addresses, .. } = settings;
        let mut link = Self { endpoint: Arc::new(Endpoint::new(settings)), outboxes: Vec::new() };
        listen(listener, &link.endpoint, addresses.iter().map(SocketAddr::ip).collect())?;
        for (name, address) in settings.peers.iter().zip(addresses) {
            link.outboxes.push((name.clone(), sender::begin(name.clone(), *address, &link.endpoint)?));
        }
        Ok(link)
    }
}

impl Link for Tcp {
    fn session(&self) -> u64 {
        self.endpoint.session()
    }

    fn send(&mut self, state: &State, _: Nanos) {
        let draft = self.endpoint.state(state);
        self.outboxes.iter().for_each(|(_, outbox)| outbox.put(draft.clone()));
    }

    fn receive(&mut self, _: Nanos, take: &mut dyn FnMut(State)) {
        self.endpoint.states().for_each(take);
    }

    fn post(&mut self, to: &str, letter: &Letter, _: Nanos) -> Result<(), String> {
        let outbox = self.outboxes.iter().find(|(name, _)| name == to).map(|(_, outbox)| outbox);
        let outbox = outbox.ok_or_else(|| format!("there is no robot `{to}`"))?;
        let posted = outbox.post(self.endpoint.letter(to, letter)?, Instant::now());
        posted.inspect_err(|_| self.endpoint.is_unsent(letter.number))
    }

    fn letters(&mut self, _: Nanos, take: &mut dyn FnMut(Letter)) {
        for letter in self.endpoint.letters() {
            let outbox = self.outboxes.iter().find(|(name, _)| *name == letter.from);
            if let (Content::Answer { of, .. }, Some((_, outbox))) = (&letter.content, outbox) {
                outbox.is_answered(*of);
            }
            take(letter);
        }
    }

    fn refused_plans(&mut self, take: &mut dyn FnMut(RefusedPlan)) {
        self.endpoint.refused_plans().into_iter().for_each(take);
    }

    fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        self.endpoint.messages().iter().for_each(|message| say(message));
    }
}

impl Drop for Tcp {
    fn drop(&mut self) {
        // The threads check this several times a second; dropping the link does not wait for them.
        self.endpoint.end();
        self.outboxes.iter().for_each(|(_, outbox)| outbox.wake());
    }
}
