//! Combines the latest messages of all topics into the output of a turn.

#[cfg(test)]
mod tests;

use std::time::Duration;

use mdle_runtime::{
    Compass, Meters, Mount, Nanos, PathStore, Ping, Pings, Pose, Published, Radians, SONARS, Sensed, Shape, Supply,
};

use crate::battery::supply;
use crate::cdr::Payload;
use crate::choices::BumperSource;
use crate::config::Config;
use crate::contact;
use crate::fault::Fault;
use crate::messages::{
    BatteryState, Bool, ClockMessage, HazardDetectionVector, Header, LaserScan, Odometry, Range, ShortRange,
};
use crate::odometer::Odometer;
use crate::scan::{Direction, Scanner, sonar_at};
use crate::source::{Input, TopicPurpose, has_variance, inputs};

/// A topic, and data about its last accepted message.
#[derive(Debug, Clone)]
struct Seen {
    input: Input,
    /// Time at which the last message was accepted; its age is computed from this time. `None` before the first
    /// message.
    at: Option<Duration>,
    /// Time stamp of the last accepted message, in nanoseconds.
    stamp: i64,
    /// Reason why the last message was rejected; empty if it was accepted or no message has arrived.
    left_out: String,
}

/// Data that the messages of all topics of a robot have reported.
#[derive(Debug, Clone)]
pub struct Sensing {
    config: Config,
    shape: Shape,
    scanner: Scanner,
    seen: Vec<Seen>,
    odometer: Odometer,
    /// Time of the exchange that received the last odometry.
    positioned: Nanos,
    pings: [Pings; SONARS],
    /// Time of the last valid ray in each direction; the age of the direction's ping is computed from this time.
    known: [Duration; SONARS],
    switches: u32,
    supply: Supply,
    /// Latest time of `/clock`, in nanoseconds.
    clock: i64,
    /// Recorded paths that the plan can replay.
    pub paths: PathStore,
}

impl Sensing {
    /// Creates the data of a robot that has sent no message yet.
    ///
    /// # Errors
    /// Returns the reason, as a sentence, if the configuration has an invalid topic name.
    pub fn new(config: &Config) -> Result<Self, String> {
        let seen = |input| Seen { input, at: None, stamp: 0, left_out: String::new() };
        Ok(Self {
            shape: config.shape(),
            scanner: Scanner::of(config),
            seen: inputs(config)?.into_iter().map(seen).collect(),
            odometer: Odometer::new(config),
            positioned: Nanos::ZERO,
            pings: [Pings::default(); SONARS],
            known: [Duration::ZERO; SONARS],
            switches: 0,
            supply: Supply::default(),
            clock: 0,
            paths: PathStore::EMPTY,
            config: config.clone(),
        })
    }

    /// Stores a message of the topic with this index. The age of messages is computed from `now`; `at` is the time of
    /// the output.
    ///
    /// A message that cannot be decoded is rejected. Without further messages, the topic's data become stale.
    ///
    /// # Errors
    /// Fails if the odometry is invalid, has jumped, or has gone back in time.
    pub fn take(&mut self, index: usize, payload: &Payload, now: Duration, at: Nanos) -> Result<(), Fault> {
        let Some(seen) = self.seen.get(index) else { return Ok(()) };
        // Messages that arrive together with the first `/clock` are as recent as its time.
        let now = now.max(self.simulated());
        let (source, since) = (seen.input.source, seen.at.map_or(now, |at| now.saturating_sub(at)));
        let taken = match source {
            TopicPurpose::Odometry => match payload.read::<Odometry>() {
                Err(why) => Err(why),
                Ok(message) if self.odometer.take(&message, since.as_secs_f64())? => {
                    self.positioned = at;
                    Ok(message.header.stamp.nanos())
                }
                Ok(_) => Err("its time is not after that of the message before".to_owned()),
            },
            TopicPurpose::Scan => payload.read().and_then(|scan: LaserScan| self.take_scan(&scan, now, at)),
            TopicPurpose::Range(number) => self.read_range(payload).map(|range| self.take_range(number, &range, at)),
            TopicPurpose::Bumper => self.take_bumper(payload),
            TopicPurpose::Battery => payload.read().and_then(|message: BatteryState| {
                self.supply = supply(&message, self.config.low_battery)?;
                Ok(message.header.stamp.nanos())
            }),
            TopicPurpose::Clock => payload.read::<ClockMessage>().map(|message| {
                self.take_clock(message.clock.nanos());
                self.clock
            }),
        };
        if let Some(seen) = self.seen.get_mut(index) {
            match taken {
                Ok(stamp) => (seen.at, seen.stamp, seen.left_out) = (Some(now), stamp, String::new()),
                Err(why) => seen.left_out = why,
            }
        }
        Ok(())
    }

    /// Stores the time of a simulation. Messages that arrived before the first time of `/clock` get that time.
    fn take_clock(&mut self, clock: i64) {
        let is_first = self.clock == 0;
        self.clock = clock;
        if is_first {
            let now = self.simulated();
            self.seen.iter_mut().for_each(|seen| seen.at = seen.at.map(|_| now));
        }
    }

    fn take_scan(&mut self, scan: &LaserScan, now: Duration, at: Nanos) -> Result<i64, String> {
        let is_bumper = self.config.bumper_type == BumperSource::Scan;
        let as_bumper = |why: &str| format!("as a bumper (`bumper-type = \"scan\"`) the scan has to look ahead: {why}");
        if is_bumper {
            self.scanner.looks_ahead(scan).map_err(|why| as_bumper(&why))?;
        }
        let pose = self.pose_of(&scan.header);
        let directions = self.scanner.directions(scan);
        if directions.iter().all(|direction| *direction == Direction::Unknown) {
            return Err(format!("none of its {} rays is valid", scan.ranges.len()));
        }
        if is_bumper && !Scanner::sees_ahead(&directions) {
            return Err(as_bumper("none of its rays ahead is valid"));
        }
        let limit = Duration::from_millis(self.config.stale_scan);
        for ((direction, pings), known) in directions.into_iter().zip(&mut self.pings).zip(&mut self.known) {
            let (range, mount) = match direction {
                Direction::Echo { range, mount } => (Some(range), mount),
                Direction::Free => (None, Mount::default()),
                Direction::Unknown => {
                    if now.saturating_sub(*known) > limit {
                        *pings = Pings::default();
                    }
                    continue;
                }
            };
            *known = now;
            pings.push(Ping { range, at, pose, mount });
        }
        if is_bumper {
            self.switches = contact::of_scan(&self.config, &self.scanner, scan);
        }
        Ok(scan.header.stamp.nanos())
    }

    fn read_range(&self, payload: &Payload) -> Result<Range, String> {
        let range: Range =
            if has_variance(self.config.distribution) { payload.read()? } else { payload.read::<ShortRange>()?.into() };
        let is_echo = range.range >= range.min_range && range.range <= range.max_range;
        let is_free = range.range == f32::INFINITY || range.range > range.max_range;
        if is_echo || is_free { Ok(range) } else { Err(format!("its range is {}", range.range)) }
    }

    /// Stores a valid range. A range that is infinite or beyond the sensor's maximum means that there was no echo.
    fn take_range(&mut self, number: usize, message: &Range, at: Nanos) -> i64 {
        let pose = self.pose_of(&message.header);
        if let Some(sensor) = self.config.ranges.0.get(number) {
            let (bearing, sonar) = (Radians(sensor.yaw), sonar_at(Radians(sensor.yaw)));
            let (sin, cos) = libm::sincos(sensor.yaw);
            let ahead = sensor.x * cos + sensor.y * sin - self.config.ring_radius;
            let echo = f64::from(message.range) + ahead;
            let range = (message.range <= message.max_range).then_some(Meters(echo.max(0.0)));
            let ping = Ping { range, at, pose, mount: Mount::of(sensor.x, sensor.y, bearing, sonar) };
            if let Some(pings) = self.pings.get_mut(sonar.number()) {
                pings.push(ping);
            }
        }
        message.header.stamp.nanos()
    }

    fn take_bumper(&mut self, payload: &Payload) -> Result<i64, String> {
        let (switches, stamp) = match self.config.bumper_type {
            BumperSource::Hazard => {
                let hazards: HazardDetectionVector = payload.read()?;
                (contact::of_hazards(&hazards), hazards.header.stamp.nanos())
            }
            BumperSource::None | BumperSource::Bool | BumperSource::Scan => (payload.read::<Bool>()?.data.into(), 0),
        };
        self.switches = switches;
        Ok(stamp)
    }

    /// Returns the robot's pose at the time of a message.
    fn pose_of(&self, header: &Header) -> Pose {
        self.odometer.pose_at(&header.stamp).unwrap_or(Pose::ORIGIN)
    }

    /// Returns the topics that the robot reads.
    pub fn inputs(&self) -> impl Iterator<Item = &Input> {
        self.seen.iter().map(|seen| &seen.input)
    }

    /// Returns the topics from which no valid message has arrived, each with the reason why the last message was
    /// rejected. A topic that reports only changes is omitted, unless its message was rejected.
    pub fn awaited(&self) -> impl Iterator<Item = (&Input, &str)> {
        let may_wait = |seen: &Seen| reports_changes(&seen.input) && seen.left_out.is_empty();
        let awaited = self.seen.iter().filter(move |seen| seen.at.is_none() && !may_wait(seen));
        awaited.map(|seen| (&seen.input, seen.left_out.as_str()))
    }

    /// Returns two time stamps in nanoseconds: the time stamp of the last odometry, and the time stamp of the oldest
    /// message among the scan and the ranges.
    #[must_use]
    pub fn stamps(&self) -> (i64, i64) {
        let looks = |source| match source {
            TopicPurpose::Scan | TopicPurpose::Range(_) => true,
            TopicPurpose::Odometry | TopicPurpose::Bumper | TopicPurpose::Battery | TopicPurpose::Clock => false,
        };
        let seen = self.seen.iter().filter(|seen| looks(seen.input.source)).map(|seen| seen.stamp);
        (self.odometer.stamp(), seen.min().unwrap_or(i64::MAX))
    }

    /// Returns the time of `/clock`, in nanoseconds.
    #[must_use]
    pub fn clock(&self) -> i64 {
        self.clock
    }

    /// Returns the time of `/clock` as a duration since its zero.
    #[must_use]
    pub fn simulated(&self) -> Duration {
        Duration::from_nanos(self.clock.try_into().unwrap_or(0))
    }

    /// Checks that no topic has stale data.
    ///
    /// # Errors
    /// Returns the fault of the first topic with stale data.
    pub fn check(&self, now: Duration) -> Result<(), Fault> {
        for seen in self.seen.iter().filter(|seen| seen.input.limit > 0) {
            let age = now.saturating_sub(seen.at.unwrap_or(Duration::ZERO)).as_millis();
            if age > u128::from(seen.input.limit) {
                let (topic, why) = (seen.input.topic.clone(), seen.left_out.clone());
                return Err(Fault::Stale { topic, age, limit: seen.input.limit, why });
            }
        }
        Ok(())
    }

    /// Returns the output of the robot at the time `at`.
    ///
    /// # Errors
    /// Fails if no odometry has arrived yet.
    pub fn sensed(&self, at: Nanos) -> Result<Sensed, Fault> {
        let (odometry, velocity) = self.odometer.last().ok_or(Fault::NoPose)?;
        Ok(Sensed {
            at,
            data_age: at.since(self.positioned),
            odometry,
            velocity,
            switches: self.switches,
            pings: self.pings,
            compass: Compass::default(),
            supply: self.supply,
            shape: self.shape,
            paths: self.paths,
            published: Published::NONE,
        })
    }
}

/// Returns `true` if a topic reports only changes. The plan may then begin without a message of this topic, once the
/// topic has a publisher.
fn reports_changes(input: &Input) -> bool {
    match input.source {
        TopicPurpose::Bumper | TopicPurpose::Battery => input.limit == 0,
        TopicPurpose::Odometry | TopicPurpose::Scan | TopicPurpose::Range(_) | TopicPurpose::Clock => false,
    }
}
