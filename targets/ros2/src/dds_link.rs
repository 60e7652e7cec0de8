//! The link to the robot over DDS. It finds the robot's topics, sends velocities, and receives messages.

use std::mem;
use std::time::{Duration, Instant};

use mdle_host::StopRequest;
use mdle_runtime::Twist;
use mdle_serial::Moment;

use crate::cdr::Payload;
use crate::choices::Distribution;
use crate::commands::Commands;
use crate::config::Config;
use crate::fault::Fault;
use crate::link::Link;
use crate::messages::{ClockMessage, Gid, NodeEntitiesInfo, ParticipantEntitiesInfo};
use crate::pacing::Pacing;
use crate::participant::{Delivery, Participant, Reader, Writer};
use crate::publishers::Publishers;
use crate::report::StateMessages;
use crate::search::{Search, receive};
use crate::sensing::Sensing;
use crate::source::{Input, TopicPurpose};
use crate::stamp::ros_now;

/// Maximum number of times that the driver joins with a new participant in order to search for the robot.
const REJOINS: u32 = 2;
/// Minimum time without a turn after which the middleware may have dropped the robot, or the robot may have dropped
/// this program. CycloneDDS and RustDDS drop a program that is silent for 10 s; other middleware drops it later.
const FORGOTTEN: Duration = Duration::from_secs(8);
/// Maximum number of new DDS participants that the driver creates one after the other in order to stop the robot. A
/// new participant is necessary if the program was suspended for at least `FORGOTTEN`, and also if it is suspended
/// again during the stop.
const ATTEMPTS: u32 = 3;

/// The readers of a participant, each with its topic.
type Readers = Vec<(Input, Reader)>;

/// A link to the robot over DDS.
pub struct DdsLink {
    participant: Participant,
    readers: Readers,
    commands: Commands,
    /// Earlier participants, which still publish the state of the plan.
    earlier: Vec<(Participant, Readers, Commands)>,
    /// Number of subscribers of velocity commands when the driver last commanded a velocity. The number is kept while
    /// `may_be_forgotten` is `true`, so that a new participant knows how many subscribers it has to find.
    subscribers: i32,
    /// Time of the last command or check for messages.
    active: Instant,
    /// `true` if the program was suspended for so long that the middleware may have dropped the robot.
    may_be_forgotten: bool,
    config: Config,
    state: Option<Writer>,
    diagnostics: Option<Writer>,
    /// Writer that announces the node to the graph. It is kept as long as the node exists.
    node: Option<Writer>,
    publishers: Publishers,
    /// Time of `/clock` in nanoseconds, for the headers of commands; `None` if headers contain the system's time.
    clock: Option<i64>,
}

impl DdsLink {
    /// Joins the domain, and waits until all topics of the configuration have been found.
    ///
    /// # Errors
    /// Fails if topics are missing, or if the middleware does not work.
    pub fn connect(
        config: &Config,
        pacing: Pacing,
        request: &StopRequest,
        begun: Moment,
    ) -> Result<(Self, Sensing), Fault> {
        let search = Search { config, request, begun };
        let mut rejoins = REJOINS;
        loop {
            if let Some(found) = Self::join(&search, pacing, rejoins > 0)? {
                return Ok(found);
            }
            rejoins = rejoins.saturating_sub(1);
        }
    }

    /// Joins the domain, and waits until all topics have been found. Returns `None` if `may_rejoin` is `true` and it
    /// seems that a publisher has not found this participant.
    fn join(search: &Search<'_>, pacing: Pacing, may_rejoin: bool) -> Result<Option<(Self, Sensing)>, Fault> {
        let config = search.config;
        let mut sensing = Sensing::new(config).map_err(Fault::Middleware)?;
        let participant = Participant::join(config)?;
        let delivery = match pacing {
            Pacing::Lockstep(_) => Delivery::Reliable,
            Pacing::Wall | Pacing::Simulated(_) => Delivery::BestEffort,
        };
        let readers = readers(&participant, sensing.inputs(), delivery)?;
        let optional = |name: &str, kind| match config.topic(name) {
            Ok(topic) if !name.is_empty() => participant.writer(&topic, kind, Delivery::Latched).map(Some),
            Ok(_) | Err(_) => Ok(None),
        };
        let state = optional(&config.state, "std_msgs/msg/String")?;
        let diagnostics = optional(&config.diagnostics, "diagnostic_msgs/msg/DiagnosticArray")?;
        let mut publishers = Publishers::default();
        let commands = search.find(&participant, &readers, &mut sensing, &mut publishers, may_rejoin)?;
        let Some(commands) = commands else { return Ok(None) };
        let clock = config.use_sim_time.then_some(0);
        let mut link = Self {
            participant,
            readers,
            commands,
            earlier: Vec::new(),
            subscribers: 0,
            active: Instant::now(),
            may_be_forgotten: false,
            config: config.clone(),
            state,
            diagnostics,
            node: None,
            publishers,
            clock,
        };
        link.node = link.announce(config)?;
        Ok(Some((link, sensing)))
    }

    /// Returns warnings, as sentences, about other publishers of velocity commands, and about subscribers of both
    /// command types, that have been found so far.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let (graph, Commands { topic, is_stamped, .. }) = (self.participant.graph(), &self.commands);
        let types = graph.about_types(topic, self.config.stamped, *is_stamped);
        graph.about_rivals(topic).into_iter().chain(types).collect()
    }

    /// Announces the node that owns the readers and writers to the graph.
    fn announce(&self, config: &Config) -> Result<Option<Writer>, Fault> {
        let is_long = match config.distribution {
            Distribution::Humble => true,
            Distribution::Jazzy | Distribution::Kilted => false,
        };
        let gid = |bytes| Gid { bytes, is_long };
        let writers = [Some(&self.commands.writer), self.state.as_ref(), self.diagnostics.as_ref()];
        let node = NodeEntitiesInfo {
            node_namespace: format!("/{}", config.namespace.trim_matches('/')),
            node_name: "mdle".to_owned(),
            reader_gid_seq: self.readers.iter().map(|(_, reader)| gid(reader.gid())).collect(),
            writer_gid_seq: writers.into_iter().flatten().map(|writer| gid(writer.gid())).collect(),
        };
        let info = ParticipantEntitiesInfo { gid: gid(self.participant.gid()), node_entities_info_seq: vec![node] };
        let kind = "rmw_dds_common/msg/ParticipantEntitiesInfo";
        let writer = self.participant.dds_writer("ros_discovery_info", kind, Delivery::Latched)?;
        // The robot can be driven without this announcement.
        Ok(Payload::of(&info).and_then(|payload| writer.write(payload)).ok().map(|()| writer))
    }
}

impl DdsLink {
    /// Records whether the program was suspended since the last call.
    fn notice_suspension(&mut self) {
        self.may_be_forgotten |= self.active.elapsed() >= FORGOTTEN;
        self.active = Instant::now();
    }

    /// Returns the time stamp for the header of a command.
    fn stamp(&self) -> i64 {
        self.clock.unwrap_or_else(ros_now)
    }

    /// Stops the robot with a new participant, after finding as many subscribers as the first participant had. From now
    /// on, the new participant also reads the robot's topics.
    fn halt_anew(&mut self, limit: Duration) -> Result<bool, Fault> {
        let (expected, stamp) = (self.subscribers.max(1), self.stamp());
        let participant = Participant::join(&self.config)?;
        let readers = readers(&participant, self.readers.iter().map(|(input, _)| input), Delivery::BestEffort)?;
        let commands = self.commands.by(&participant)?;
        let earlier = (
            mem::replace(&mut self.participant, participant),
            mem::replace(&mut self.readers, readers),
            mem::replace(&mut self.commands, commands),
        );
        self.earlier.push(earlier);
        let met = self.commands.meet(expected, stamp);
        let halted = self.commands.insist(&self.participant, limit, stamp);
        met.and(halted)
    }
}

/// Returns readers of the topics of `inputs`.
fn readers<'i>(
    participant: &Participant,
    inputs: impl Iterator<Item = &'i Input>,
    delivery: Delivery,
) -> Result<Readers, Fault> {
    inputs.map(|input| Ok((input.clone(), participant.reader(&input.topic, input.kind, delivery)?))).collect()
}

impl Link for DdsLink {
    fn command(&mut self, twist: Twist) -> Result<(), Fault> {
        self.notice_suspension();
        let subscribers = self.commands.writer.matched();
        if !self.may_be_forgotten {
            self.subscribers = subscribers;
        }
        if subscribers == 0 {
            return Err(Fault::Unheard(self.commands.topic.clone()));
        }
        self.commands.send(twist, self.stamp()).map_err(Fault::Middleware)
    }

    fn receive(&mut self, take: &mut dyn FnMut(usize, &Payload) -> Result<(), Fault>) -> Result<(), Fault> {
        self.notice_suspension();
        let Self { readers, publishers, participant, clock, .. } = self;
        receive(readers, &mut |input, index, payload, writer| {
            if let (TopicPurpose::Clock, Some(clock)) = (input.source, clock.as_mut())
                && let Ok(message) = payload.read::<ClockMessage>()
            {
                *clock = message.clock.nanos();
            }
            publishers.pass(input, writer, || participant.graph(), || take(index, payload))
        })
    }

    fn halt(&mut self, limit: Duration) -> Result<bool, Fault> {
        self.notice_suspension();
        let stamp = self.stamp();
        let mut halted = self.commands.halt(&self.participant, limit, stamp);
        // The program may also be suspended while it stops the robot.
        self.notice_suspension();
        for _ in 0..ATTEMPTS {
            if !mem::take(&mut self.may_be_forgotten) {
                break;
            }
            halted = self.halt_anew(limit);
            self.notice_suspension();
        }
        halted
    }

    fn publish(&mut self, messages: StateMessages) {
        for (writer, payload) in [(&self.state, messages.text), (&self.diagnostics, messages.diagnostics)] {
            if let Some(writer) = writer {
                // The state is published on a best-effort basis: the plan does not depend on it.
                let _ = writer.write(payload);
            }
        }
    }
}
