//! Sends velocity commands, and the zero velocity with which a run ends.

use std::thread::sleep;
use std::time::{Duration, Instant};

use mdle_runtime::Twist;

use crate::cdr::Payload;
use crate::command_graph::{TWIST, TWIST_STAMPED};
use crate::config::Config;
use crate::driver::LOOK;
use crate::fault::Fault;
use crate::graph::Graph;
use crate::messages::{Header, Time, TwistMessage, TwistStamped, Vector3};
use crate::names::dds_type;
use crate::participant::{Delivery, Participant, Writer};

/// Interval at which the zero velocity is repeated.
const AGAIN: Duration = Duration::from_millis(100);
/// Minimum number of repetitions. It is needed because a suspension of the program may use up the time.
const TIMES: u32 = 5;
/// Maximum time for which a new writer waits for the subscribers of the writer that it replaces.
const REJOINING: Duration = Duration::from_secs(5);

/// The writer of velocity commands.
pub(crate) struct Commands {
    pub(crate) topic: String,
    frame: String,
    pub(crate) writer: Writer,
    pub(crate) is_stamped: bool,
}

impl Commands {
    /// Creates a writer of commands to `topic`; the commands have a time stamp if `is_stamped` is `true`.
    pub(crate) fn new(
        config: &Config,
        participant: &Participant,
        topic: &str,
        is_stamped: bool,
    ) -> Result<Self, Fault> {
        let writer = participant.writer(topic, kind_of(is_stamped), Delivery::Reliable)?;
        Ok(Self { topic: topic.to_owned(), frame: config.frame_id.clone(), writer, is_stamped })
    }

    /// Creates a writer of the same commands that belongs to `participant`.
    pub(crate) fn by(&self, participant: &Participant) -> Result<Self, Fault> {
        let writer = participant.writer(&self.topic, self.kind(), Delivery::Reliable)?;
        let (topic, frame) = (self.topic.clone(), self.frame.clone());
        Ok(Self { topic, frame, writer, is_stamped: self.is_stamped })
    }

    /// Returns the type of the velocity commands.
    fn kind(&self) -> &'static str {
        kind_of(self.is_stamped)
    }

    /// Returns `true` if a program on the graph subscribes to commands of this type and the middleware has connected it
    /// to this writer.
    pub(crate) fn are_heard(&mut self, graph: &Graph) -> bool {
        // The middleware also matches a subscriber of another type, which cannot decode the commands.
        let kind = dds_type(self.kind());
        self.writer.matched() > 0 && graph.readers_of(&self.topic).any(|reader| reader.kind == kind)
    }

    pub(crate) fn send(&self, twist: Twist, stamp: i64) -> Result<(), String> {
        let vector = |x, z| (Vector3 { x, ..Vector3::default() }, Vector3 { z, ..Vector3::default() });
        let (linear, angular) = vector(twist.v.0, twist.omega.0);
        let twist = TwistMessage { linear, angular };
        let payload = if self.is_stamped {
            let header = Header { stamp: Time::of(stamp), frame_id: self.frame.clone() };
            Payload::of(&TwistStamped { header, twist })
        } else {
            Payload::of(&twist)
        };
        self.writer.write(payload?)
    }

    /// Sends a zero velocity until all reliable subscribers have acknowledged it, or until `limit` has passed. Returns
    /// `false` if no subscriber is reliable.
    ///
    /// # Errors
    /// Fails if the reliable subscribers have not acknowledged the zero velocity in time, or if there is no subscriber.
    pub(crate) fn halt(&mut self, participant: &Participant, limit: Duration, stamp: i64) -> Result<bool, Fault> {
        let begun = Instant::now();
        let acknowledges = participant.graph().readers_of(&self.topic).any(|reader| reader.is_reliable);
        for times in 1.. {
            let sent = self.send(Twist::default(), stamp);
            // Without subscribers, the middleware reports every message as acknowledged.
            if sent.is_ok() && acknowledges && self.writer.is_acknowledged(AGAIN) && self.writer.matched() > 0 {
                return Ok(true);
            }
            if times >= TIMES && begun.elapsed() >= limit {
                break;
            }
            if !acknowledges || sent.is_err() {
                sleep(AGAIN);
            }
        }
        let topic = self.topic.clone();
        match (acknowledges, self.writer.matched()) {
            (true, _) => Err(Fault::Unacknowledged(topic)),
            (false, 0) => Err(Fault::Unheard(topic)),
            (false, _) => Ok(false),
        }
    }

    /// Sends a zero velocity repeatedly for the time `limit`, and then calls [`Commands::halt`]. A subscriber that has
    /// just been found may not have found this writer yet. In this case, it acknowledges earlier messages without
    /// reading them.
    ///
    /// # Errors
    /// Fails if the reliable subscribers have not acknowledged the last zero velocity, or if there is no subscriber.
    pub(crate) fn insist(&mut self, participant: &Participant, limit: Duration, stamp: i64) -> Result<bool, Fault> {
        let begun = Instant::now();
        while begun.elapsed() < limit {
            // `halt` reports an error if sending continues to fail.
            let _ = self.send(Twist::default(), stamp);
            sleep(AGAIN);
        }
        self.halt(participant, limit, stamp)
    }

    /// Sends a zero velocity repeatedly until `expected` subscribers have been found, or until [`REJOINING`] has
    /// passed. One subscriber is not sufficient, because the first one that is found may be a program other than the
    /// robot.
    ///
    /// # Errors
    /// Fails if fewer subscribers were found.
    pub(crate) fn meet(&mut self, expected: i32, stamp: i64) -> Result<(), Fault> {
        let begun = Instant::now();
        let mut due = Duration::ZERO;
        while self.writer.matched() < expected {
            let passed = begun.elapsed();
            if passed > REJOINING {
                let (topic, found) = (self.topic.clone(), self.writer.matched());
                return Err(Fault::Lost { topic, found, expected });
            }
            if self.writer.matched() > 0 && passed >= due {
                due = passed + AGAIN;
                // `halt` reports an error if sending continues to fail.
                let _ = self.send(Twist::default(), stamp);
            }
            sleep(LOOK);
        }
        Ok(())
    }
}

/// Returns the type of velocity commands.
fn kind_of(is_stamped: bool) -> &'static str {
    if is_stamped { TWIST_STAMPED } else { TWIST }
}
