//! The writer of velocity commands, and the zero velocity with which a run ends.

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

/// Time between two repetitions of the zero velocity.
const AGAIN: Duration = Duration::from_millis(100);
/// Minimum number of repetitions: a suspension of the program uses up time.
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
    /// Returns a writer of commands to `topic`, with a time stamp if `is_stamped` is `true`.
    pub(crate) fn new(
        config: &Config,
        participant: &Participant,
        topic: &str,
        is_stamped: bool,
    ) -> Result<Self, Fault> {
        let writer = participant.writer(topic, kind_of(is_stamped), Delivery::Reliable)?;
        Ok(Self { topic: topic.to_owned(), frame: config.frame_id.clone(), writer, is_stamped })
    }

    /// Returns a writer of the same commands by another participant.
    pub(crate) fn by(&self, participant: &Participant) -> Result<Self, Fault> {
        let writer = participant.writer(&self.topic, self.kind(), Delivery::Reliable)?;
        let (topic, frame) = (self.topic.clone(), self.frame.clone());
        Ok(Self { topic, frame, writer, is_stamped: self.is_stamped })
    }

    /// Returns the type of the velocity commands.
    fn kind(&self) -> &'static str {
        kind_of(self.is_stamped)
    }

    /// Returns `true` if a program on the graph subscribes to the commands, and the middleware has matched it.
    pub(crate) fn are_heard(&mut self, graph: &Graph) -> bool {
        // The middleware also matches a subscriber of another type, which understands nothing.
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

    /// Sends a zero velocity until all subscribers that acknowledge messages have done so, or until `limit` has passed.
    /// Returns `false` if no subscriber acknowledges messages.
    ///
    /// # Errors
    /// Fails if no subscriber has acknowledged the zero velocity.
    pub(crate) fn halt(&mut self, participant: &Participant, limit: Duration, stamp: i64) -> Result<bool, Fault> {
        let begun = Instant::now();
        let acknowledges = participant.graph().readers_of(&self.topic).any(|reader| reader.is_reliable);
        for times in 1.. {
            let sent = self.send(Twist::default(), stamp);
            // Without subscribers everything counts as acknowledged.
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

    /// Sends a zero velocity repeatedly for the time `limit`, and then as [`Commands::halt`] does: a subscriber that
    /// has just been found may acknowledge, unread, what was sent before it had found this writer in turn.
    ///
    /// # Errors
    /// Fails if no subscriber has acknowledged the last zero velocity.
    pub(crate) fn insist(&mut self, participant: &Participant, limit: Duration, stamp: i64) -> Result<bool, Fault> {
        let begun = Instant::now();
        while begun.elapsed() < limit {
            // `halt` reports that it cannot be sent.
            let _ = self.send(Twist::default(), stamp);
            sleep(AGAIN);
        }
        self.halt(participant, limit, stamp)
    }

    /// Sends a zero velocity repeatedly until as many subscribers as `expected` have been found, or until the maximum
    /// time has passed. The first that is found need not be the robot.
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
                // `halt` reports that it cannot be sent.
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
