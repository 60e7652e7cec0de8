//! A robot's state link over a router. In a turn, the robot only hands over its state and takes states that have
//! arrived. A separate thread publishes the state, because Zenoh may block.

use std::io;
use std::sync::Arc;
use std::thread;
use std::time::Instant;

use mdle::RouterSettings;
use mdle_engine::link::{Content, Endpoint, Letter, Link, Outbox, RefusedPlan, State};
use mdle_runtime::Nanos;

use crate::carrier::Carrier;

/// The endpoint of one robot on a state link over a router.
struct RouterLink {
    endpoint: Arc<Endpoint>,
    outbox: Arc<Outbox>,
    peers: Vec<String>,
}

/// Opens a link over a router, which need not be reachable yet.
///
/// # Errors
/// Fails if the system cannot create a thread.
pub fn open(settings: &RouterSettings) -> io::Result<Box<dyn Link>> {
    let endpoint = Arc::new(Endpoint::new(&settings.link));
    let outbox = Arc::<Outbox>::default();
    let carrier = Carrier::new(settings, &endpoint, &outbox);
    thread::Builder::new().name("router".to_owned()).spawn(move || carrier.carry())?;
    Ok(Box::new(RouterLink { endpoint, outbox, peers: settings.link.peers.clone() }))
}

impl Link for RouterLink {
    fn session(&self) -> u64 {
        self.endpoint.session()
    }

    fn send(&mut self, state: &State, _: Nanos) {
        self.outbox.put(self.endpoint.state(state));
    }

    fn receive(&mut self, _: Nanos, take: &mut dyn FnMut(State)) {
        self.endpoint.states().for_each(take);
    }

    fn post(&mut self, to: &str, letter: &Letter, _: Nanos) -> Result<(), String> {
        if !self.peers.iter().any(|peer| peer == to) {
            return Err(format!("there is no robot `{to}`"));
        }
        let posted = self.outbox.post(self.endpoint.letter(to, letter)?, Instant::now());
        posted.inspect_err(|_| self.endpoint.is_unsent(letter.number))
    }

    fn letters(&mut self, _: Nanos, take: &mut dyn FnMut(Letter)) {
        for letter in self.endpoint.letters() {
            if let Content::Answer { of, .. } = &letter.content {
                self.outbox.is_answered(*of);
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

impl Drop for RouterLink {
    fn drop(&mut self) {
        // The thread checks for the end several times a second; the drop does not wait for it.
        self.endpoint.end();
        self.outbox.wake();
    }
}
