//! Conformance test of the driver: with a body whose odometry, scan, bumper and battery arrive as the bytes of their
//! topics, the driver does what its capabilities require of any robot. The middleware is not included; `test_tour.py`
//! tests it.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::cell::RefCell;
use std::f64::consts::PI;
use std::rc::Rc;
use std::time::Duration;

use mdle_conformance::{Room, Stage, Suite, Supplied};
use mdle_host::StopRequest;
use mdle_ros2::cdr::Payload;
use mdle_ros2::config::{Config, Configured};
use mdle_ros2::messages::{BatteryState, Bool, Header, LaserScan, Odometry, Time};
use mdle_ros2::report::StateMessages;
use mdle_ros2::sensing::Sensing;
use mdle_ros2::source::{TopicPurpose, inputs};
use mdle_ros2::{Fault, Link, Pacing, Ros2, alphabet};
use mdle_runtime::{Meters, Nanos, PathStore, Pose, Radians, Twist};
use mdle_serial::Moment;
use mdle_simulator::{Point, Walls, World};

/// Number of rays of a scan.
const RAYS: u32 = 720;
/// Maximum range of the scanner, in metres.
const REACH: f64 = 12.0;
/// Time step of the body.
const STEP: Duration = Duration::from_millis(10);
/// Time without a command after which the base stops itself.
const WATCHDOG: Duration = Duration::from_millis(500);

/// The robot behind the topics: a round body that moves as last commanded, until a wall stops it.
struct Base {
    config: Config,
    walls: Walls,
    /// Pose of the body in the room.
    pose: Pose,
    /// Pose at which the odometry is zero.
    began: Pose,
    velocity: Twist,
    is_pressed: bool,
    battery: BatteryState,
    time: Duration,
    /// Time since the last command.
    unheard: Duration,
    /// Messages that have not been received: the number of the topic, and the bytes.
    sent: Vec<(usize, Payload)>,
}

impl Base {
    /// Moves the body for a turn, and publishes its sensor data.
    fn pass(&mut self) {
        let period = Duration::from_nanos(alphabet::PERIOD.0);
        let mut passed = Duration::ZERO;
        while passed < period {
            self.advance();
            passed += STEP;
        }
        self.time += period;
        self.unheard += period;
        if self.unheard > WATCHDOG {
            self.velocity = Twist::default();
        }
        self.publish();
    }

    fn advance(&mut self) {
        let seconds = STEP.as_secs_f64();
        let turn = self.velocity.omega.0 * seconds;
        let heading = Radians(self.pose.theta.0 + turn / 2.0);
        let next = self.pose.towards(heading, Meters(self.velocity.v.0 * seconds));
        self.pose.theta.0 += turn;
        self.is_pressed = self.walls.clearance(Point::of(&next), REACH) < self.config.body_radius;
        if !self.is_pressed {
            (self.pose.x, self.pose.y) = (next.x, next.y);
        }
    }

    /// Returns a header with the current time.
    fn header(&self) -> Header {
        // The clock does not begin at zero, as on a real robot.
        Header { stamp: Time::of(1_000_000_000_000 + self.time.as_nanos() as i64), frame_id: String::new() }
    }

    fn odometry(&self) -> Odometry {
        let mut message = Odometry { header: self.header(), ..Odometry::default() };
        let (x, y) = (self.pose.x.0 - self.began.x.0, self.pose.y.0 - self.began.y.0);
        let (sin, cos) = libm::sincos(self.began.theta.0);
        let pose = &mut message.pose.pose;
        (pose.position.x, pose.position.y) = (x * cos + y * sin, y * cos - x * sin);
        // A quaternion does not count full turns.
        let heading = Radians(self.pose.theta.0 - self.began.theta.0).wrapped().0;
        (pose.orientation.z, pose.orientation.w) = libm::sincos(heading / 2.0);
        let twist = &mut message.twist.twist;
        twist.linear.x = if self.is_pressed { 0.0 } else { self.velocity.v.0 };
        twist.angular.z = self.velocity.omega.0;
        message
    }

    fn scan(&self) -> LaserScan {
        let step = 2.0 * PI / f64::from(RAYS);
        let range = |ray: u32| {
            let direction = Radians(self.pose.theta.0 - PI + f64::from(ray) * step);
            self.walls.ray(Point::of(&self.pose), direction, REACH).map_or(f32::INFINITY, |range| range as f32)
        };
        LaserScan {
            header: self.header(),
            angle_min: -PI as f32,
            angle_max: (PI - step) as f32,
            angle_increment: step as f32,
            range_min: 0.05,
            range_max: REACH as f32,
            ranges: (0..RAYS).map(range).collect(),
            ..LaserScan::default()
        }
    }

    fn publish(&mut self) {
        for (number, input) in inputs(&self.config).unwrap().iter().enumerate() {
            let payload = match input.source {
                TopicPurpose::Odometry => Payload::of(&self.odometry()),
                TopicPurpose::Scan => Payload::of(&self.scan()),
                TopicPurpose::Bumper => Payload::of(&Bool { data: self.is_pressed }),
                TopicPurpose::Battery => Payload::of(&BatteryState { header: self.header(), ..self.battery.clone() }),
                TopicPurpose::Range(_) | TopicPurpose::Clock => continue,
            };
            self.sent.push((number, payload.unwrap()));
        }
    }
}

/// A link to the base without middleware.
struct Wire(Rc<RefCell<Base>>);

impl Link for Wire {
    fn command(&mut self, twist: Twist) -> Result<(), Fault> {
        let mut base = self.0.borrow_mut();
        (base.velocity, base.unheard) = (twist, Duration::ZERO);
        base.pass();
        Ok(())
    }

    fn receive(&mut self, take: &mut dyn FnMut(usize, &Payload) -> Result<(), Fault>) -> Result<(), Fault> {
        let sent = std::mem::take(&mut self.0.borrow_mut().sent);
        sent.iter().try_for_each(|(number, payload)| take(*number, payload))
    }

    fn halt(&mut self, _limit: Duration) -> Result<bool, Fault> {
        self.0.borrow_mut().velocity = Twist::default();
        Ok(true)
    }

    fn publish(&mut self, _messages: StateMessages) {}
}

/// Stage of the conformance suite: places a base in a room and connects a driver to it.
struct Floor {
    config: Config,
    base: Option<Rc<RefCell<Base>>>,
}

impl Floor {
    fn base(&self) -> &RefCell<Base> {
        self.base.as_ref().unwrap()
    }
}

impl Stage for Floor {
    type Robot = Ros2<Wire>;
    type Alphabet = alphabet::Alphabet;
    const PERIOD: Nanos = alphabet::PERIOD;

    fn robot(&mut self, room: &Room, at: Pose) -> Result<Ros2<Wire>, String> {
        let world = World::parse("the room", &room.to_string()).map_err(|error| error.to_string())?;
        let config = self.config.clone();
        let battery =
            BatteryState { voltage: 12.5, percentage: 0.9, power_supply_status: 2, ..BatteryState::default() };
        let (time, velocity) = (Duration::ZERO, Twist::default());
        let (walls, is_pressed, sent) = (Walls::of(&world), false, Vec::new());
        let base =
            Base { config, walls, pose: at, began: at, velocity, is_pressed, battery, time, unheard: time, sent };
        let base = Rc::new(RefCell::new(base));
        self.base = Some(Rc::clone(&base));
        let sensing = Sensing::new(&self.config)?;
        let pacing = Pacing::Lockstep(Duration::from_nanos(Self::PERIOD.0));
        Ok(Ros2::new(self.config.clone(), Wire(base), sensing, pacing, StopRequest::default(), Moment::now()))
    }

    fn take_paths(&mut self, robot: &mut Ros2<Wire>, paths: PathStore) {
        robot.take_paths(paths);
    }

    fn supply(&mut self, _robot: &mut Ros2<Wire>, supplied: Supplied) {
        let battery = &mut self.base().borrow_mut().battery;
        match supplied {
            Supplied::Well => {}
            Supplied::Low => (battery.voltage, battery.percentage) = (11.1, 0.05),
            Supplied::Plugged => battery.power_supply_status = 1,
        }
    }

    fn truth(&self, _robot: &Ros2<Wire>) -> Pose {
        self.base().borrow().pose
    }

    fn left_alone(&mut self, _robot: &mut Ros2<Wire>, periods: u32) {
        (0..periods).for_each(|_| self.base().borrow_mut().pass());
    }
}

/// Returns a configuration with all capabilities, for a robot that is as fast as plans may request.
fn config() -> Config {
    let mut config = Configured::read(None).unwrap().config;
    (config.fastest, config.fastest_turn) = (2.0, 6.0);
    config.bumper_type = mdle_ros2::choices::BumperSource::Bool;
    config.battery = "battery_state".to_owned();
    config
}

#[test]
fn the_driver_conforms() {
    let mut stage = Floor { config: config(), base: None };
    let report = Suite::on(&mut stage).diff_drive().odometry().bumper().sonar().paths().power().report();
    assert!(report.holds(), "{report}");
}

#[test]
fn a_scanner_that_is_turned_the_wrong_way_is_found() {
    let mut config = config();
    config.scan_yaw = PI;
    let report = Suite::on(&mut Floor { config, base: None }).sonar().report().to_string();
    let is_named = |line: &str| line.starts_with("BROKEN") && line.ends_with("looks where its number says");
    assert!(report.lines().any(is_named), "{report}");
}
