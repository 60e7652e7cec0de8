//! The link to the robot over DDS: finds the robot's topics, sends velocities and receives messages.

use std::thread::sleep;
use std::time::{Duration, Instant};

use mdle_host::StopRequest;
use mdle_runtime::{Nanos, Twist};
use mdle_serial::Moment;

use crate::cdr::Payload;
use crate::choices::{Distribution, Stamped};
use crate::config::Config;
use crate::driver::LOOK;
use crate::fault::Fault;
use crate::graph::{Graph, TWIST, TWIST_STAMPED};
use crate::link::Link;
use crate::messages::{
    Gid, Header, NodeEntitiesInfo, ParticipantEntitiesInfo, Time, TwistMessage, TwistStamped, Vector3,
};
use crate::names::dds_type;
use crate::pacing::Pacing;
use crate::participant::{Delivery, Participant, Reader, Writer};
use crate::report::StateMessages;
use crate::sensing::Sensing;
use crate::source::{Input, Source};
use crate::stamp::ros_now;

/// Time between two checks of the graph for topics.
const GRAPH: Duration = Duration::from_millis(50);
/// Time between two repetitions of the zero velocity.
const AGAIN: Duration = Duration::from_millis(100);

/// A link to the robot over DDS.
pub struct DdsLink {
    participant: Participant,
    readers: Vec<(Input, Reader)>,
    commands: Commands,
    state: Option<Writer>,
    diagnostics: Option<Writer>,
    /// Writer that announces the node to the graph, kept for as long as the node exists.
    node: Option<Writer>,
    /// Id of the program that publishes the odometry.
    odometer: Option<[u8; 16]>,
    /// Time of `/clock` in nanoseconds, for the headers of commands; `None` if headers have the system's time.
    clock: Option<i64>,
}

/// The writer of velocity commands.
struct Commands {
    topic: String,
    frame: String,
    writer: Writer,
    is_stamped: bool,
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
        let mut sensing = Sensing::new(config).map_err(Fault::Middleware)?;
        let participant = Participant::join(config)?;
        let delivery = match pacing {
            Pacing::Lockstep(_) => Delivery::Reliable,
            Pacing::Wall | Pacing::Simulated(_) => Delivery::BestEffort,
        };
        let inputs = sensing.inputs().cloned();
        let readers =
            inputs.map(|input| participant.reader(&input.topic, input.kind, delivery).map(|reader| (input, reader)));
        let readers = readers.collect::<Result<Vec<_>, _>>()?;
        let optional = |name: &str, kind| match config.topic(name) {
            Ok(topic) if !name.is_empty() => participant.writer(&topic, kind, Delivery::Latched).map(Some),
            Ok(_) | Err(_) => Ok(None),
        };
        let state = optional(&config.state, "std_msgs/msg/String")?;
        let diagnostics = optional(&config.diagnostics, "diagnostic_msgs/msg/DiagnosticArray")?;
        let commands = find(config, &participant, &readers, &mut sensing, request, begun)?;
        let clock = config.use_sim_time.then_some(0);
        let mut link = Self { participant, readers, commands, state, diagnostics, node: None, odometer: None, clock };
        link.node = link.announce(config)?;
        Ok((link, sensing))
    }

    /// Announces to the graph the node that owns the readers and writers.
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
        // Without it the robot drives as well.
        Ok(Payload::of(&info).and_then(|payload| writer.write(payload)).ok().map(|()| writer))
    }
}

/// Waits until all topics of the robot have been found, and returns the writer of velocity commands.
fn find(
    config: &Config,
    participant: &Participant,
    readers: &[(Input, Reader)],
    sensing: &mut Sensing,
    request: &StopRequest,
    begun: Moment,
) -> Result<Commands, Fault> {
    let topic = config.topic(&config.cmd_vel).map_err(Fault::Middleware)?;
    let limit = Duration::from_millis(config.discovery);
    let mut commands: Option<Commands> = None;
    loop {
        let looked = Instant::now();
        while looked.elapsed() < GRAPH {
            if request.is_made() {
                return Err(Fault::Ended);
            }
            let now = if config.use_sim_time { sensing.simulated() } else { begun.elapsed() };
            receive(readers, &mut |index, payload, _| sensing.take(index, payload, now, Nanos::ZERO))?;
            sleep(LOOK);
        }
        let graph = participant.graph();
        if commands.is_none()
            && let Some(is_stamped) = is_stamped(config, &graph, &topic)
        {
            let writer = participant.writer(&topic, kind_of(is_stamped), Delivery::Reliable)?;
            commands = Some(Commands { topic: topic.clone(), frame: config.frame_id.clone(), writer, is_stamped });
        }
        let mut missing: Vec<_> = sensing.awaited().map(|(input, why)| graph.about_input(input, why)).collect();
        let is_awaited = |input: &Input| sensing.awaited().any(|(awaited, _)| awaited == input);
        let unpublished = sensing.inputs().filter(|input| !is_awaited(input) && graph.publishers(input) == 0);
        missing.extend(unpublished.map(|input| graph.about_input(input, "")));
        // The middleware also matches a subscriber of another type, which understands nothing.
        let is_heard = commands.as_mut().is_some_and(|commands| {
            let kind = dds_type(commands.kind());
            commands.writer.matched() > 0 && graph.readers_of(&topic).any(|reader| reader.kind == kind)
        });
        match commands.take() {
            Some(found) if is_heard && missing.is_empty() => {
                several(sensing, &graph)?;
                return Ok(found);
            }
            other => commands = other,
        }
        if begun.elapsed() > limit {
            if !is_heard {
                missing.insert(0, graph.about_commands(&topic, kind_of(config.stamped == Stamped::Yes)));
            }
            let help = graph.help(sensing.inputs(), &topic);
            return Err(Fault::Missing(format!("{}{help}", graph.about_missing(&missing, config))));
        }
    }
}

/// Returns `true` if velocity commands have a time stamp; `None` if that depends on a subscriber that has not been
/// found.
fn is_stamped(config: &Config, graph: &Graph, topic: &str) -> Option<bool> {
    match config.stamped {
        Stamped::Yes => Some(true),
        Stamped::No => Some(false),
        Stamped::Auto => graph.readers_of(topic).find_map(|reader| match &*reader.kind {
            kind if kind == dds_type(TWIST) => Some(false),
            kind if kind == dds_type(TWIST_STAMPED) => Some(true),
            _ => None,
        }),
    }
}

/// Returns a fault if several programs publish the odometry.
fn several(sensing: &Sensing, graph: &Graph) -> Result<(), Fault> {
    let odometry = sensing.inputs().find(|input| input.source == Source::Odometry);
    match odometry.map(|input| (input, graph.publishers(input))) {
        Some((input, count)) if count > 1 => Err(Fault::Several { topic: input.topic.clone(), count }),
        Some(_) | None => Ok(()),
    }
}

/// A function that receives a message: the index of its topic, its bytes, and the id of its publisher.
type Take<'a> = dyn FnMut(usize, &Payload, [u8; 16]) -> Result<(), Fault> + 'a;

/// Calls `take` with each message that has arrived.
fn receive(readers: &[(Input, Reader)], take: &mut Take<'_>) -> Result<(), Fault> {
    for (index, (_, reader)) in readers.iter().enumerate() {
        while let Some(arrival) = reader.take() {
            take(index, &arrival.payload, arrival.writer)?;
        }
    }
    Ok(())
}

/// Returns the type of velocity commands.
fn kind_of(is_stamped: bool) -> &'static str {
    if is_stamped { TWIST_STAMPED } else { TWIST }
}

impl Commands {
    /// Returns the type of the velocity commands.
    fn kind(&self) -> &'static str {
        kind_of(self.is_stamped)
    }

    fn send(&self, twist: Twist, stamp: i64) -> Result<(), String> {
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
}

impl DdsLink {
    /// Returns the time for the header of a command.
    fn stamp(&self) -> i64 {
        self.clock.unwrap_or_else(ros_now)
    }
}

impl Link for DdsLink {
    fn command(&mut self, twist: Twist) -> Result<(), Fault> {
        if self.commands.writer.matched() == 0 {
            return Err(Fault::Unheard(self.commands.topic.clone()));
        }
        self.commands.send(twist, self.stamp()).map_err(Fault::Middleware)
    }

    fn receive(&mut self, take: &mut dyn FnMut(usize, &Payload) -> Result<(), Fault>) -> Result<(), Fault> {
        let Self { readers, odometer, participant, clock, .. } = self;
        receive(readers, &mut |index, payload, writer| {
            let Some((input, _)) = readers.get(index) else { return Ok(()) };
            match input.source {
                Source::Odometry if *odometer != Some(writer) => {
                    let count = participant.graph().publishers(input);
                    if odometer.replace(writer).is_some() && count > 1 {
                        return Err(Fault::Several { topic: input.topic.clone(), count });
                    }
                }
                Source::Clock => {
                    if let (Some(clock), Ok(message)) =
                        (clock.as_mut(), payload.read::<crate::messages::ClockMessage>())
                    {
                        *clock = message.clock.nanos();
                    }
                }
                Source::Odometry | Source::Scan | Source::Range(_) | Source::Bumper | Source::Battery => {}
            }
            take(index, payload)
        })
    }

    fn halt(&mut self, limit: Duration) -> Result<(), Fault> {
        let begun = Instant::now();
        let graph = self.participant.graph();
        let acknowledges = graph.readers_of(&self.commands.topic).any(|reader| reader.is_reliable);
        loop {
            let sent = self.commands.send(Twist::default(), self.stamp());
            if sent.is_ok() && acknowledges && self.commands.writer.is_acknowledged(AGAIN) {
                return Ok(());
            }
            if begun.elapsed() >= limit {
                break;
            }
            if !acknowledges || sent.is_err() {
                sleep(AGAIN);
            }
        }
        let topic = self.commands.topic.clone();
        match (acknowledges, self.commands.writer.matched()) {
            (true, _) => Err(Fault::Unacknowledged(topic)),
            (false, 0) => Err(Fault::Unheard(topic)),
            (false, _) => Ok(()),
        }
    }

    fn publish(&mut self, messages: StateMessages) {
        for (writer, payload) in [(&self.state, messages.text), (&self.diagnostics, messages.diagnostics)] {
            if let Some(writer) = writer {
                // Nobody waits for it.
                let _ = writer.write(payload);
            }
        }
    }
}
