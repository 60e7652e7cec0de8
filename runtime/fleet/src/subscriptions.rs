//! Receives frames from the router: the states of the other robots, and their letters to this robot.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

use mdle_engine::link::{Endpoint, FrameSource, LONGEST_LETTER};
use zenoh::sample::Sample;
use zenoh::{Session, Wait as _};

use crate::topics;

/// Maximum number of reasons for refusing messages that are reported for one robot.
const REASONS: usize = 16;

/// Subscribes to the frames for the robot of this name, until the session ends.
///
/// # Errors
/// Fails if the session has ended, or if a key is invalid.
pub(crate) fn subscribe(session: &Session, name: &str, endpoint: &Arc<Endpoint>) -> zenoh::Result<()> {
    for peer in endpoint.peers() {
        let intake = Arc::new(Intake::new(peer));
        for key in [topics::of_states(peer), topics::of_letters(peer, name)] {
            let (intake, endpoint) = (Arc::clone(&intake), Arc::clone(endpoint));
            let take = move |sample: Sample| intake.take(&sample, &endpoint);
            session.declare_subscriber(key).callback(take).background().wait()?;
        }
    }
    Ok(())
}

/// Receiver of the frames that one robot publishes.
struct Intake(Mutex<Counted>);

/// A robot as a source of frames, and the reported reasons for which its messages were refused.
struct Counted {
    source: FrameSource,
    reasons: BTreeSet<String>,
}

impl Intake {
    fn new(robot: &str) -> Self {
        Self(Mutex::new(Counted { source: FrameSource::without_connection(robot), reasons: BTreeSet::new() }))
    }

    /// Passes a message to the endpoint, or refuses it. A robot that sends invalid messages cannot be cut off, because
    /// a key cannot be closed like a connection. Therefore each reason for a refusal is reported only once.
    fn take(&self, sample: &Sample, endpoint: &Endpoint) {
        let mut counted = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let payload = sample.payload();
        let result = if payload.len() > LONGEST_LETTER {
            Err("it sends no states".to_owned())
        } else {
            endpoint.take(&mut counted.source, &payload.to_bytes())
        };
        let Err(reason) = result else { return };
        let reason = format!("a sender under {} is refused: {reason}", sample.key_expr());
        if counted.reasons.len() < REASONS && counted.reasons.insert(reason.clone()) {
            endpoint.say(format!("warning: state link: {reason}"));
        }
    }
}
