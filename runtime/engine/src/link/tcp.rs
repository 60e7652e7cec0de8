//! The link over TCP between processes and machines. The robot's turn only hands over a state and takes states
//! that have arrived; threads do all work that may wait.
//!
//! A robot connects to each of its peers to send, and listens to receive. Each connection has a sender that
//! writes only the newest state, and each letter, so a peer that reads slowly or never does not delay the others.

#[cfg(test)]
mod letter_tests;
mod letters;
mod receiver;
mod sender;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::hash::{BuildHasher as _, RandomState};
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mdle_runtime::Nanos;

use super::frame::{self, Key};
use super::{Letter, Link, State};
use letters::Letters;
use receiver::listen;
use sender::Slot;

/// Maximum number of messages that wait to be shown to the operator.
const MESSAGES: usize = 32;

/// Addresses and key of a link over TCP.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TcpSettings {
    /// Name of the robot.
    pub name: String,
    /// Address at which the robot listens.
    pub listen: SocketAddr,
    /// Name and address of each other robot.
    pub peers: Vec<(String, SocketAddr)>,
    /// Key that all robots of the link have.
    pub key: String,
    /// Name of each robot with which plans are exchanged, and the key that only both have.
    pub plans: Vec<(String, String)>,
}

/// The endpoint of one robot on a state link over TCP.
pub struct Tcp {
    shared: Arc<Shared>,
    /// Name of each peer, with the newest state and the letters for it.
    slots: Vec<(String, Arc<Slot>)>,
    key: Key,
    session: u64,
}

/// Data that the threads share with the turns.
struct Shared {
    /// Names of the robots from which states are accepted.
    peers: Vec<String>,
    key: Key,
    /// For each robot, the newest state that has arrived since the last turn.
    arrived: Mutex<BTreeMap<String, State>>,
    letters: Letters,
    messages: Mutex<Vec<String>>,
    /// `true` once the robot's run has ended.
    is_over: AtomicBool,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Reports a message to the operator, unless too many messages wait.
    fn say(&self, message: String) {
        let mut messages = lock(&self.messages);
        if messages.len() < MESSAGES {
            messages.push(message);
        }
    }

    fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    /// Stores a state that has arrived.
    fn take(&self, state: State) {
        self.letters.heard(&state);
        let mut arrived = lock(&self.arrived);
        match arrived.get(&state.name) {
            Some(known) if !state.replaces(known) => {}
            Some(_) | None => {
                arrived.insert(state.name.clone(), state);
            }
        }
    }
}

impl Tcp {
    /// Begins to listen, and to connect to the peers.
    ///
    /// # Errors
    /// Fails if the robot cannot listen at the address, or if the system cannot create the threads.
    pub fn open(settings: &TcpSettings) -> io::Result<Self> {
        let listener = TcpListener::bind(settings.listen)?;
        Self::on(listener, settings)
    }

    /// Returns the link of a robot that accepts connections from `listener`.
    fn on(listener: TcpListener, settings: &TcpSettings) -> io::Result<Self> {
        let TcpSettings { name, peers, key, plans, .. } = settings;
        let key = Key::of(key);
        // Keyed by random numbers of the system.
        let session = RandomState::new().hash_one(name);
        let shared = Arc::new(Shared {
            peers: peers.iter().map(|(name, _)| name.clone()).collect(),
            key: key.clone(),
            arrived: Mutex::default(),
            letters: Letters::new(name, session, plans),
            messages: Mutex::default(),
            is_over: AtomicBool::new(false),
        });
        let mut link = Self { shared, slots: Vec::new(), key, session };
        listen(listener, &link.shared)?;
        for (name, address) in peers {
            link.slots.push((name.clone(), sender::begin(name.clone(), *address, &link.shared)?));
        }
        Ok(link)
    }
}

impl Link for Tcp {
    fn session(&self) -> u64 {
        self.session
    }

    fn send(&mut self, state: &State, _: Nanos) {
        let frame: Arc<[u8]> = frame::written(state, &self.key).into();
        self.slots.iter().for_each(|(_, slot)| slot.put(Arc::clone(&frame)));
    }

    fn receive(&mut self, _: Nanos, take: &mut dyn FnMut(State)) {
        let arrived = std::mem::take(&mut *lock(&self.shared.arrived));
        arrived.into_values().for_each(take);
    }

    fn post(&mut self, to: &str, letter: &Letter, _: Nanos) -> Result<(), String> {
        let slot = self.slots.iter().find(|(name, _)| name == to).map(|(_, slot)| slot);
        let slot = slot.ok_or_else(|| format!("there is no robot `{to}`"))?;
        let frame = self.shared.letters.frame(to, letter)?;
        slot.post(frame.into()).map_err(|waiting| format!("{waiting} letters wait for {to} already"))
    }

    fn letters(&mut self, _: Nanos, take: &mut dyn FnMut(Letter)) {
        self.shared.letters.arrived().into_iter().for_each(take);
    }

    fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        let messages = std::mem::take(&mut *lock(&self.shared.messages));
        messages.iter().for_each(|message| say(message));
    }
}

impl Drop for Tcp {
    fn drop(&mut self) {
        // The threads look at it several times a second; nobody waits for them.
        self.shared.is_over.store(true, Ordering::Relaxed);
        self.slots.iter().for_each(|(_, slot)| slot.wake());
    }
}
