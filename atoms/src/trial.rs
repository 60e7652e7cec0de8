//! Contains outputs of a robot, written by hand, for tests of quarks.

use core::f64::consts::PI;

use mdle_runtime::capability::{Bumpers, DiffDrive, Modules, Odometry, Paths, Power, SonarRing, StateLink};
use mdle_runtime::{
    Begin, Completes, Frame, Law, Links, Meters, Mount, Nanos, Output, PathStore, Peer, Ping, Pings, Pose, Published,
    PublishedNumber, Radians, SONARS, Setpoint, SonarId, Supply, Twist, Volts,
};

/// The period of a turn in these trials, in seconds.
pub(crate) const PERIOD: f64 = 0.1;

/// The output of a robot with every capability.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sensed {
    pub(crate) now: Nanos,
    pub(crate) pose: Pose,
    pub(crate) velocity: Twist,
    pub(crate) pressed: bool,
    pub(crate) pings: [Pings; SONARS],
    pub(crate) confirmation: usize,
    pub(crate) supply: Supply,
    pub(crate) paths: PathStore,
    pub(crate) published: Published,
    /// Drift of the heading.
    pub(crate) drift: Radians,
    /// Half of the body's length and of its width, in metres; equal for a disc.
    pub(crate) halves: [f64; 2],
}

impl Default for Sensed {
    fn default() -> Self {
        Self {
            now: Nanos::ZERO,
            pose: Pose::ORIGIN,
            velocity: Twist::default(),
            pressed: false,
            pings: [Pings::default(); SONARS],
            confirmation: 3,
            supply: Supply::default(),
            paths: PathStore::EMPTY,
            published: Published::NONE,
            drift: Radians(0.0),
            halves: [0.205; 2],
        }
    }
}

impl Sensed {
    /// Returns the output at the origin, at rest, with this heading in degrees.
    pub(crate) fn heading(degrees: f64) -> Self {
        Self { pose: Pose { theta: Radians::from_degrees(degrees), ..Pose::ORIGIN }, ..Self::default() }
    }

    /// Adds a ping from the robot's current pose.
    pub(crate) fn ping(&mut self, sonar: SonarId, range: Option<f64>) {
        self.ping_at(sonar, range, Nanos::ZERO);
    }

    /// Adds a ping at this time from the robot's current pose.
    pub(crate) fn ping_at(&mut self, sonar: SonarId, range: Option<f64>, at: Nanos) {
        let ping = Ping { range: range.map(Meters), at, pose: self.pose, mount: Mount::default() };
        self.pings.get_mut(sonar.number()).expect("one of the sixteen").push(ping);
    }

    /// Makes `peer` the only other robot in the state link.
    pub(crate) fn link(&mut self, peer: Peer) {
        let mut links = Links::NONE;
        assert!(links.add(peer));
        self.published = self.published.with_links(links);
    }

    /// Moves the robot as an ideal drive with this input does in one period.
    pub(crate) fn drive(&mut self, input: Twist) {
        let theta = self.pose.theta.0;
        self.pose.x.0 += input.v.0 * PERIOD * libm::cos(theta);
        self.pose.y.0 += input.v.0 * PERIOD * libm::sin(theta);
        self.pose.theta.0 += input.omega.0 * PERIOD;
        self.velocity = input;
    }
}

impl Output for Sensed {
    fn here(&self) -> Pose {
        self.pose
    }
}

impl Odometry for Sensed {
    fn pose(&self) -> Pose {
        self.pose
    }

    fn velocity(&self) -> Twist {
        self.velocity
    }

    fn drift(&self, _: Radians) -> Radians {
        self.drift
    }
}

impl Bumpers for Sensed {
    fn pressed(&self) -> bool {
        self.pressed
    }
}

impl DiffDrive for Sensed {
    fn body_radius(&self) -> Meters {
        let [length, width] = self.halves;
        Meters(if length > width { libm::hypot(length, width) } else { length })
    }

    fn half_length(&self) -> Meters {
        Meters(self.halves[0])
    }

    fn half_width(&self) -> Meters {
        Meters(self.halves[1])
    }

    fn wheel_base(&self) -> Meters {
        Meters(0.345)
    }
}

impl SonarRing for Sensed {
    fn pings(&self, sonar: SonarId) -> &Pings {
        self.pings.get(sonar.number()).expect("one of the sixteen")
    }

    fn now(&self) -> Nanos {
        self.now
    }

    fn ring_radius(&self) -> Meters {
        Meters(0.19)
    }

    fn confirmation(&self) -> usize {
        self.confirmation
    }
}

impl Power for Sensed {
    fn battery(&self) -> Volts {
        self.supply.battery
    }

    fn is_low(&self) -> bool {
        self.supply.is_low
    }

    fn is_plugged(&self) -> bool {
        self.supply.is_plugged
    }
}

impl Modules for Sensed {
    fn published(&self, module: &str, attribute: &str) -> Option<PublishedNumber> {
        self.published.number(module, attribute)
    }
}

impl StateLink for Sensed {
    fn links(&self) -> &Links {
        self.published.links()
    }
}

impl Paths for Sensed {
    fn path(&self, name: &str) -> Option<&[Setpoint]> {
        self.paths.path(name)
    }
}

/// Returns a robot of this half length and half width, in metres.
pub(crate) fn sized(half_length: f64, half_width: f64) -> Sensed {
    Sensed { halves: [half_length, half_width], ..Sensed::default() }
}

/// Returns the data with which an atom begins at time 0, in a frame that equals the odometry coordinates.
pub(crate) fn begun() -> Begin {
    framed(0.0)
}

/// Returns the data with which an atom begins at time 0, in a frame that is turned by this many degrees.
pub(crate) fn framed(degrees: f64) -> Begin {
    Begin { now: Nanos::ZERO, frame: Frame::default().turned(Radians::from_degrees(degrees)) }
}

/// Runs a law until it is done; returns the angle by which the robot turned, in degrees, including full
/// circles.
pub(crate) fn until_completed<L>(law: &mut L, y: &mut Sensed) -> f64
where
    L: Completes<Sensed> + Law<Sensed, Input = Twist>,
{
    let mut turned = 0.0;
    for _ in 0..1000 {
        if law.completed(y, Nanos::ZERO) {
            return turned * (180.0 / PI);
        }
        let input = law.input(y, Nanos::ZERO);
        turned += input.omega.0 * PERIOD;
        y.drive(input);
        // Odometry reports a wrapped heading.
        y.pose.theta = y.pose.theta.wrapped();
    }
    panic!("not done after 1000 turns");
}
