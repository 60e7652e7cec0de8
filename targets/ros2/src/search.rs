//! Searches for the robot's topics at the start of a run.

use std::thread::sleep;
use std::time::{Duration, Instant};

use mdle_host::StopRequest;
use mdle_runtime::Nanos;
use mdle_serial::Moment;

use crate::cdr::Payload;
use crate::commands::Commands;
use crate::config::Config;
use crate::driver::{HALTING, LOOK};
use crate::fault::Fault;
use crate::graph::Graph;
use crate::participant::{Participant, Reader};
use crate::publishers::{Probation, Publishers};
use crate::sensing::Sensing;
use crate::source::{Input, TopicPurpose};
use crate::stamp::ros_now;

/// Interval between two checks of the graph for topics.
const GRAPH: Duration = Duration::from_millis(50);
/// Time without a message from a publisher on the graph after which it is assumed that this publisher has not found the
/// participant.
const DEAF: Duration = Duration::from_secs(3);

/// Minimum time for which all messages of a topic have been rejected before the run ends.
const REJECTED: Duration = Duration::from_secs(1);

/// Start of the current period in which a condition has been true without interruption; `None` if it is not true.
#[derive(Debug, Clone, Copy, Default)]
struct Lasting(Option<Duration>);

impl Lasting {
    /// Returns the time for which the condition has been true. `holds` is `true` if the condition is true at the time
    /// `now`.
    fn time(&mut self, holds: bool, now: Duration) -> Duration {
        let since = *self.0.get_or_insert(now);
        self.0 = holds.then_some(since);
        now.saturating_sub(if holds { since } else { now })
    }
}

/// The search for the robot's topics.
pub(crate) struct Search<'s> {
    pub(crate) config: &'s Config,
    pub(crate) request: &'s StopRequest,
    /// Time at which connecting to the robot began.
    pub(crate) begun: Moment,
}

impl Search<'_> {
    /// Waits until all topics of the robot have been found, and returns the writer of velocity commands. Returns `None`
    /// if `may_rejoin` is `true` and a publisher of a topic sends no message.
    ///
    /// RustDDS sends to an address of this computer's loopback interface only after it has received a datagram from the
    /// participant at this address itself. If that participant was first announced in a datagram of another participant
    /// of its program, RustDDS never answers it, so the participant never learns of the driver's readers. In this case,
    /// a new participant of the driver helps, because the publisher's participant is announced to it again.
    ///
    /// # Errors
    /// Fails if topics are missing, or if the middleware does not work.
    pub(crate) fn find(
        &self,
        participant: &Participant,
        readers: &[(Input, Reader)],
        sensing: &mut Sensing,
        publishers: &mut Publishers,
        may_rejoin: bool,
    ) -> Result<Option<Commands>, Fault> {
        let mut commands = None;
        let found = self.seek((participant, readers), sensing, publishers, may_rejoin, &mut commands);
        // A robot that another program has left moving is stopped, too. A subscriber that has just been found may
        // acknowledge a message unread.
        if let (Err(_), Some(mut commands)) = (&found, commands) {
            let _ = commands.insist(participant, HALTING, ros_now());
        }
        found
    }

    /// Waits as [`Search::find`] does. If the wait fails, `commands` contains the writer, if it has been created.
    fn seek(
        &self,
        (participant, readers): (&Participant, &[(Input, Reader)]),
        sensing: &mut Sensing,
        publishers: &mut Publishers,
        may_rejoin: bool,
        commands: &mut Option<Commands>,
    ) -> Result<Option<Commands>, Fault> {
        let topic = self.config.topic(&self.config.cmd_vel).map_err(Fault::Middleware)?;
        let limit = Duration::from_millis(self.config.discovery);
        let (mut silence, mut rejection, mut probation) =
            (Lasting::default(), Lasting::default(), Probation::default());
        loop {
            self.listen(participant, readers, sensing, publishers)?;
            let graph = participant.graph();
            let is_stamped = graph.is_stamped(&topic, self.config.stamped);
            // A subscriber that is found later may change the type.
            let current = commands.as_ref().map(|commands| commands.is_stamped);
            if let Some(is_stamped) = is_stamped.filter(|_| is_stamped != current) {
                *commands = Some(Commands::new(self.config, participant, &topic, is_stamped)?);
            }
            let missing = missing(sensing, &graph);
            let is_heard = commands.as_mut().is_some_and(|commands| commands.are_heard(&graph));
            let passed = self.begun.elapsed();
            let mut odometry = sensing.inputs().filter(|input| input.source == TopicPurpose::Odometry);
            let is_alone = odometry.all(|input| probation.is_over(input, &graph, passed));
            match commands.take() {
                Some(found) if is_heard && missing.is_empty() && (is_alone || passed > limit) => {
                    return Ok(Some(found));
                }
                other => *commands = other,
            }
            if passed > limit {
                return Err(self.fault(sensing, &graph, missing, &topic, is_heard));
            }
            let rejected = sensing.awaited().find(|(_, why)| !why.is_empty());
            let lasts = rejection.time(rejected.is_some(), passed);
            if let Some((input, why)) = rejected.filter(|(input, _)| lasts > REJECTED.max(limit_of(input))) {
                return Err(Fault::Missing(graph.about_input(input, why)));
            }
            let patience = patience(sensing, &graph);
            let lasts = silence.time(patience.is_some(), passed);
            // A new participant needs time to find the topics that this participant has found.
            if may_rejoin && patience.is_some_and(|patience| lasts > patience) && passed + DEAF < limit {
                return Ok(None);
            }
        }
    }

    /// Returns the fault for topics that were not found in time.
    fn fault(&self, sensing: &Sensing, graph: &Graph, mut missing: Vec<String>, topic: &str, is_heard: bool) -> Fault {
        if !is_heard {
            missing.insert(0, graph.about_commands(topic, self.config.stamped));
        }
        let help = graph.help(sensing.inputs(), topic, self.config);
        Fault::Missing(format!("{}{help}", graph.about_missing(&missing, self.config)))
    }

    /// Receives messages for the time [`GRAPH`].
    fn listen(
        &self,
        participant: &Participant,
        readers: &[(Input, Reader)],
        sensing: &mut Sensing,
        publishers: &mut Publishers,
    ) -> Result<(), Fault> {
        let looked = Instant::now();
        while looked.elapsed() < GRAPH {
            if self.request.is_made() {
                return Err(Fault::Ended);
            }
            let now = if self.config.use_sim_time { sensing.simulated() } else { self.begun.elapsed() };
            receive(readers, &mut |input, index, payload, writer| {
                let take = || sensing.take(index, payload, now, Nanos::ZERO);
                publishers.pass(input, writer, || participant.graph(), take)
            })?;
            sleep(LOOK);
        }
        Ok(())
    }
}

/// Returns a sentence for each missing topic that the plan needs before it can begin.
fn missing(sensing: &Sensing, graph: &Graph) -> Vec<String> {
    let mut missing: Vec<_> = sensing.awaited().map(|(input, why)| graph.about_input(input, why)).collect();
    let is_awaited = |input: &Input| sensing.awaited().any(|(awaited, _)| awaited == input);
    let unpublished = sensing.inputs().filter(|input| !is_awaited(input) && graph.publishers(input) == 0);
    missing.extend(unpublished.map(|input| graph.about_input(input, "")));
    missing
}

/// Returns the maximum age of the last message of `input`.
fn limit_of(input: &Input) -> Duration {
    Duration::from_millis(input.limit)
}

/// Returns the maximum time to wait for the first message of a topic that has a publisher; `None` if all topics with
/// publishers have sent messages.
fn patience(sensing: &Sensing, graph: &Graph) -> Option<Duration> {
    let silent = sensing.awaited().filter(|(input, left_out)| left_out.is_empty() && graph.is_offered(input));
    silent.map(|(input, _)| limit_of(input).max(DEAF)).min()
}

/// A function that receives a message: its topic, the topic's index, its bytes, and the id of its publisher.
type Take<'a> = dyn FnMut(&Input, usize, &Payload, [u8; 16]) -> Result<(), Fault> + 'a;

/// Calls `take` with each message that has arrived.
pub(crate) fn receive(readers: &[(Input, Reader)], take: &mut Take<'_>) -> Result<(), Fault> {
    for (index, (input, reader)) in readers.iter().enumerate() {
        while let Some(arrival) = reader.take() {
            take(input, index, &arrival.payload, arrival.writer)?;
        }
    }
    Ok(())
}
