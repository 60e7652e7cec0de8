//! Runs the thread that maintains a session with the router. The thread publishes every letter, but only the newest
//! state.

use std::net::SocketAddr;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use mdle::RouterSettings;
use mdle_engine::link::{Endpoint, FrameDraft, LONGEST_LETTER, Outbox};
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::{Config, Session, Wait as _};

use crate::subscriptions::subscribe;
use crate::topics;

/// Interval between two attempts to connect.
const AGAIN: Duration = Duration::from_millis(200);
/// Timeout for an attempt to connect, in milliseconds.
const OPENS: u64 = 2000;
/// Time without data from this robot after which the router considers it disconnected, in milliseconds.
const LEASE: u64 = 2000;
/// Minimum time between two published states. Only the newest state matters, and a receiver accepts at most 2000 states
/// per second.
const SPACING: Duration = Duration::from_millis(1);
/// Interval at which the connection is checked.
const LOOK: Duration = Duration::from_millis(100);

/// Data of the thread that maintains the session.
pub(crate) struct Carrier {
    name: String,
    router: SocketAddr,
    /// Name of the link file, which names the router.
    file: String,
    endpoint: Arc<Endpoint>,
    outbox: Arc<Outbox>,
    /// `true` while the session has a connection to the router.
    is_up: bool,
    /// `true` if it has already been reported that the router cannot be reached.
    is_known_as_down: bool,
}

impl Carrier {
    pub(crate) fn new(settings: &RouterSettings, endpoint: &Arc<Endpoint>, outbox: &Arc<Outbox>) -> Self {
        Self {
            name: settings.link.name.clone(),
            router: settings.router,
            file: settings.file.display().to_string(),
            endpoint: Arc::clone(endpoint),
            outbox: Arc::clone(outbox),
            is_up: false,
            is_known_as_down: false,
        }
    }

    /// Connects and publishes until the run is over. If the router cannot be reached, this is reported only once, and
    /// again only after the router has been reached in between.
    pub(crate) fn carry(mut self) {
        while !self.endpoint.is_over() {
            let begun = Instant::now();
            // A session reconnects by itself; a new session is opened only after a session has failed.
            self.is_up = false;
            if let Err(failure) = self.session().and_then(|session| self.publish(&session)) {
                self.outbox.close();
                self.is_down(&failure.to_string());
            }
            thread::sleep(AGAIN.saturating_sub(begun.elapsed()));
        }
    }

    /// Opens a session, and subscribes to the frames for this robot.
    ///
    /// # Errors
    /// Fails if the router cannot be reached.
    fn session(&self) -> zenoh::Result<Session> {
        let session = zenoh::open(self.config()?).wait()?;
        subscribe(&session, &self.name, &self.endpoint)?;
        Ok(session)
    }

    /// Returns the configuration of a session: one connection to the router, and no search for other routers or peers.
    fn config(&self) -> zenoh::Result<Config> {
        let again = AGAIN.as_millis();
        let mut config = Config::default();
        for (key, value) in [
            ("mode", "\"client\"".to_owned()),
            ("connect/endpoints", format!("[\"tcp/{}\"]", self.router)),
            ("connect/timeout_ms", "0".to_owned()),
            (
                "connect/retry",
                format!("{{ period_init_ms: {again}, period_max_ms: {again}, period_increase_factor: 1 }}"),
            ),
            ("scouting/multicast/enabled", "false".to_owned()),
            ("scouting/gossip/enabled", "false".to_owned()),
            ("transport/unicast/open_timeout", OPENS.to_string()),
            ("transport/link/tx/lease", LEASE.to_string()),
            // Space for a frame with its key; longer messages are dropped unread.
            ("transport/link/rx/max_message_size", (LONGEST_LETTER + 1024).to_string()),
        ] {
            config.insert_json5(key, &value)?;
        }
        Ok(config)
    }

    /// Publishes states and letters until the run is over.
    ///
    /// # Errors
    /// Fails if the session fails.
    fn publish(&mut self, session: &Session) -> zenoh::Result<()> {
        let states = self.states(session)?;
        let (mut last, mut looked) = (None::<FrameDraft>, None::<Instant>);
        while !self.endpoint.is_over() {
            // A receiver accepts letters only from a robot whose state has arrived, so the last state is sent before
            // any letter.
            last = self.outbox.next().or(last);
            self.outbox.late(Instant::now()).iter().for_each(|letter| self.endpoint.is_late(letter));
            if looked.is_none_or(|at| at.elapsed() >= LOOK) {
                self.look(session);
                looked = Some(Instant::now());
            }
            if !self.is_up {
                thread::sleep(LOOK);
                continue;
            }
            let Some(state) = &last else { continue };
            let written = Instant::now();
            states.put(state.payload()).wait()?;
            while let Some(letter) = self.outbox.letter(Instant::now()) {
                let put = session.put(topics::of_letters(&self.name, &letter.to), letter.draft.payload());
                put.congestion_control(CongestionControl::Block).wait()?;
                self.outbox.is_sent(letter.number);
            }
            thread::sleep(SPACING.saturating_sub(written.elapsed()));
        }
        Ok(())
    }

    /// Returns the publisher of states. It sends a state at once, or drops the state if the connection is congested.
    fn states<'s>(&self, session: &'s Session) -> zenoh::Result<Publisher<'s>> {
        let publisher = session.declare_publisher(topics::of_states(&self.name));
        publisher.congestion_control(CongestionControl::Drop).priority(Priority::RealTime).express(true).wait()
    }

    /// Checks whether the session has a connection to the router, and reports a connection that was lost or restored.
    fn look(&mut self, session: &Session) {
        let was_up = std::mem::replace(&mut self.is_up, session.info().routers_zid().wait().next().is_some());
        if !self.is_up {
            self.outbox.close();
            self.is_down("it has closed the connection");
        } else if !was_up {
            // Messages that were sent before may have been lost.
            self.outbox.open();
            if std::mem::take(&mut self.is_known_as_down) {
                self.endpoint.say(format!("state link: connected to the router at {} again", self.router));
            }
        }
    }

    /// Reports that the router cannot be reached, unless this has already been reported. `failure` is the reason.
    fn is_down(&mut self, failure: &str) {
        if self.is_known_as_down || self.endpoint.is_over() {
            return;
        }
        self.is_known_as_down = true;
        let Self { router, file, .. } = self;
        self.endpoint.say(format!(
            "warning: state link: the router at {router} cannot be reached: {failure}; start it, or correct `router` in {file}"
        ));
    }
}
