//! The driver of a robot that speaks ROS 2, as a kinetic state machine. The input is a velocity command; the output
//! combines the latest messages.

use std::thread::sleep;
use std::time::{Duration, Instant};

use mdle_host::{Ended, Observer, PlanPosition, StopRequest};
use mdle_runtime::{MetersPerSecond, Nanos, PathStore, RadiansPerSecond, Robot, Sensed, Twist};
use mdle_serial::{Moment, Times};

use crate::config::Config;
use crate::fault::Fault;
use crate::link::Link;
use crate::pacing::Pacing;
use crate::report::PlanState;
use crate::sensing::Sensing;
use crate::stamp::ros_now;

/// Interval between two checks for messages.
pub(crate) const LOOK: Duration = Duration::from_micros(500);
/// Maximum real time to wait for a robot in lockstep or in a simulation, which has its own time.
const PATIENCE: Duration = Duration::from_secs(5);
/// Maximum time by which `/clock` may go back, in nanoseconds.
const BACK: i64 = 1_000_000_000;
/// Maximum time for which the zero velocity is repeated.
pub(crate) const HALTING: Duration = Duration::from_millis(500);
/// Maximum time after the zero velocity until odometry has to report that the robot slows down.
const SLOWING: Duration = Duration::from_secs(3);
/// Length of the last part of [`SLOWING`]. The lowest speeds in this part decide whether the robot has slowed down.
const JUDGED: Duration = Duration::from_secs(1);
/// Minimum time for which the robot has to be at rest.
const STANDING: Duration = Duration::from_millis(200);
/// Speeds below which the robot is treated as being at rest.
const REST: Twist = Twist { v: MetersPerSecond(0.02), omega: RadiansPerSecond(0.05) };
/// Interval after which an unchanged state of the plan is published again.
const REPEAT: Nanos = Nanos(1_000_000_000);

/// A robot that speaks ROS 2. The driver reaches it through the link `L`.
#[derive(Debug)]
pub struct Ros2<L> {
    link: L,
    config: Config,
    sensing: Sensing,
    pacing: Pacing,
    times: Times,
    /// Time at which connecting to the robot began.
    begun: Moment,
    request: StopRequest,
    /// Time of `/clock` at the first turn, in nanoseconds.
    origin: Option<i64>,
    /// Latest time of `/clock` so far, in nanoseconds; 0 if `/clock` is not used.
    latest: i64,
    turns: u32,
    /// Number of the atom and time of the turn in the last published state.
    published: Option<(u64, Nanos)>,
}

impl<L: Link> Ros2<L> {
    /// Creates the driver of a robot. `link` reaches the robot, and `sensing` contains the robot's first messages.
    pub fn new(config: Config, link: L, sensing: Sensing, pacing: Pacing, request: StopRequest, begun: Moment) -> Self {
        let times = Times::new(pacing.clock());
        Self {
            link,
            config,
            sensing,
            pacing,
            times,
            begun,
            request,
            origin: None,
            latest: 0,
            turns: 0,
            published: None,
        }
    }

    /// Stores the recorded paths that the plan can replay.
    pub fn take_paths(&mut self, paths: PathStore) {
        self.sensing.paths = paths;
    }

    /// Limits `input` to the maximum speeds. Both speeds are reduced by the same factor, so that the robot stays on its
    /// curve.
    fn limited(&self, input: &Twist) -> Result<Twist, Fault> {
        if !(input.v.0.is_finite() && input.omega.0.is_finite()) {
            return Err(Fault::NoNumber);
        }
        let part = |value: f64, most: f64| if value.abs() > most { most / value.abs() } else { 1.0 };
        let scale = part(input.v.0, self.config.fastest).min(part(input.omega.0, self.config.fastest_turn));
        Ok(Twist { v: MetersPerSecond(input.v.0 * scale), omega: RadiansPerSecond(input.omega.0 * scale) })
    }

    /// Returns the current time; the age of messages is computed from it.
    fn now(&self) -> Duration {
        match self.pacing {
            Pacing::Wall => self.begun.elapsed(),
            Pacing::Lockstep(period) => period.saturating_mul(self.turns),
            Pacing::Simulated(_) => self.sensing.simulated(),
        }
    }

    /// Passes the messages that have arrived to [`Sensing`].
    fn receive(&mut self, at: Nanos) -> Result<(), Fault> {
        let now = self.now();
        let sensing = &mut self.sensing;
        self.link.receive(&mut |index, payload| sensing.take(index, payload, now, at))
    }

    /// Updates the latest time of `/clock`.
    ///
    /// # Errors
    /// Fails if `/clock` has gone back by more than [`BACK`], because turns would wait until the clock has caught up,
    /// while the robot continued to drive.
    fn follow_clock(&mut self) -> Result<(), Fault> {
        let clock = self.sensing.clock();
        let back = self.latest.saturating_sub(clock);
        if back > BACK {
            return Err(Fault::ClockReset(back as f64 / 1e9));
        }
        self.latest = self.latest.max(clock);
        Ok(())
    }

    /// Receives messages until `is_there` returns `true` or the run is asked to end.
    fn wait(&mut self, at: Nanos, topic: &str, is_there: impl Fn(&Sensing) -> bool) -> Result<(), Fault> {
        let mut last = (self.latest, Instant::now());
        loop {
            self.receive(at)?;
            self.follow_clock()?;
            if is_there(&self.sensing) || self.request.is_made() {
                return Ok(());
            }
            if self.latest > last.0 {
                last = (self.latest, Instant::now());
            }
            let age = last.1.elapsed();
            if age > PATIENCE {
                let is_back = self.sensing.clock() < self.latest;
                let why = if is_back { "its time has gone back" } else { "" }.to_owned();
                let (topic, limit) = (topic.to_owned(), PATIENCE.as_millis() as u64);
                return Err(Fault::Stale { topic, age: age.as_millis(), limit, why });
            }
            sleep(LOOK);
        }
    }

    /// Sends a velocity command, and receives the messages that follow it.
    fn turn(&mut self, twist: Twist, at: Nanos) -> Result<(), Fault> {
        self.turns = self.turns.saturating_add(1);
        match self.pacing {
            Pacing::Wall => {
                self.link.command(twist)?;
                self.receive(at)
            }
            Pacing::Lockstep(_) => {
                // In lockstep, a robot without a command repeats its messages.
                self.receive(at)?;
                let (before, _) = self.sensing.stamps();
                self.link.command(twist)?;
                let odom = self.config.topic(&self.config.odom).unwrap_or_default();
                self.wait(at, &odom, |sensing| {
                    let (odometry, looked) = sensing.stamps();
                    odometry > before && looked >= odometry
                })
            }
            Pacing::Simulated(period) => {
                self.link.command(twist)?;
                let origin = *self.origin.get_or_insert(self.sensing.clock());
                let passed = period.saturating_mul(self.turns - 1).as_nanos();
                let due = origin.saturating_add(i64::try_from(passed).unwrap_or(i64::MAX));
                self.wait(at, "/clock", |sensing| sensing.clock() >= due)
            }
        }
    }

    /// Returns the absolute speeds that the last odometry reports.
    fn speeds(&self) -> Twist {
        let velocity = self.sensing.sensed(Nanos::ZERO).map(|sensed| sensed.velocity).unwrap_or_default();
        Twist { v: MetersPerSecond(velocity.v.0.abs()), omega: RadiansPerSecond(velocity.omega.0.abs()) }
    }

    /// Returns `true` if the last odometry is not stale and reports that the robot is at rest.
    fn rests(&mut self) -> bool {
        let is_informed = self.receive(Nanos::ZERO).is_ok() && self.sensing.check(self.now()).is_ok();
        is_informed && is_within(self.speeds(), REST)
    }

    /// Waits until new odometry reports that the robot is at rest. Returns `false` if no new odometry has arrived.
    ///
    /// # Errors
    /// Fails if odometry continues to report more than a quarter of the speeds `before`, which the robot had before it
    /// was stopped.
    fn slows(&mut self, before: Twist) -> Result<bool, Fault> {
        // What has come while the robot was being stopped, or while the program was suspended, is no news.
        if self.receive(Nanos::ZERO).is_err() {
            return Ok(false);
        }
        let (begun, (last, _)) = (Instant::now(), self.sensing.stamps());
        let (mut slowest, mut rest): (Option<Twist>, Option<Instant>) = (None, None);
        while begun.elapsed() < SLOWING {
            if self.receive(Nanos::ZERO).is_err() {
                return Ok(false);
            }
            if self.sensing.stamps().0 > last {
                let speeds = self.speeds();
                // Odometry is noisy: the least of many counts.
                let is_last = begun.elapsed() + JUDGED > SLOWING;
                slowest = Some(slowest.filter(|_| is_last).map_or(speeds, |slowest| least(slowest, speeds)));
                rest = rest.filter(|_| is_within(speeds, REST)).or(is_within(speeds, REST).then(Instant::now));
                if rest.is_some_and(|rest| rest.elapsed() >= STANDING) {
                    return Ok(true);
                }
            }
            sleep(LOOK);
        }
        let limits = Twist {
            v: MetersPerSecond(REST.v.0.max(before.v.0 / 4.0)),
            omega: RadiansPerSecond(REST.omega.0.max(before.omega.0 / 4.0)),
        };
        match slowest {
            Some(slowest) if !is_within(slowest, limits) => {
                let topic = self.config.topic(&self.config.odom).unwrap_or_default();
                Err(Fault::Moving { topic, twist: self.speeds() })
            }
            Some(_) => Ok(true),
            None => Ok(false),
        }
    }

    /// Publishes the state of the plan. If the state cannot be encoded, it is not published, and the plan continues.
    fn tell(&mut self, state: &PlanState) {
        let stamp = if self.config.use_sim_time { self.sensing.clock() } else { ros_now() };
        if let Ok(messages) = state.messages(stamp) {
            self.link.publish(messages);
        }
    }
}

/// Returns `true` if both speeds are below their limits.
fn is_within(speeds: Twist, limits: Twist) -> bool {
    speeds.v.0 < limits.v.0 && speeds.omega.0 < limits.omega.0
}

/// Returns the lower speed of both, separately for the forward speed and the turn rate.
fn least(one: Twist, other: Twist) -> Twist {
    Twist { v: MetersPerSecond(one.v.0.min(other.v.0)), omega: RadiansPerSecond(one.omega.0.min(other.omega.0)) }
}

impl<L: Link> Robot for Ros2<L> {
    type Output = Sensed;
    type Input = Twist;
    type Error = Fault;

    fn exchange(&mut self, input: &Twist) -> Result<Sensed, Fault> {
        let twist = self.limited(input)?;
        let at = self.times.now();
        self.turn(twist, at)?;
        self.sensing.check(self.now())?;
        self.sensing.sensed(at)
    }

    fn stop(&mut self) -> Result<(), Fault> {
        let before = self.speeds();
        match self.link.halt(HALTING) {
            // A robot in lockstep moves only when it gets a command.
            Ok(_) if matches!(self.pacing, Pacing::Lockstep(_)) => Ok(()),
            Ok(is_acknowledged) => {
                let is_seen = self.slows(before)?;
                let topic = self.config.topic(&self.config.odom).unwrap_or_default();
                if is_acknowledged || is_seen { Ok(()) } else { Err(Fault::Unseen(topic)) }
            }
            // Another subscriber may be gone, and the robot has stopped.
            Err(Fault::Unacknowledged(_) | Fault::Unheard(_)) if self.rests() => Ok(()),
            Err(fault) => Err(fault),
        }
    }

    fn longest_gap(&self) -> Option<Duration> {
        Some(self.config.longest_gap())
    }
}

impl<L: Link> Observer for Ros2<L> {
    fn looks(&self) -> bool {
        !(self.config.state.is_empty() && self.config.diagnostics.is_empty())
    }

    fn turned(&mut self, position: &PlanPosition<'_>) {
        let is_old = self.published.is_none_or(|(state, t)| state != position.state || position.t.since(t) >= REPEAT);
        if is_old {
            self.published = Some((position.state, position.t));
            self.tell(&PlanState::at(position));
        }
    }

    fn ended(&mut self, ended: &Ended<'_>) {
        self.tell(&PlanState::after(ended));
    }
}
