//! Tests the outputs and faults that messages of the topics cause.

use std::f64::consts::PI;

use mdle_runtime::Volts;
use serde::Serialize;

use super::*;
use crate::choices::{Distribution, RangeSensor, RangeSensors};
use crate::config::Configured;
use crate::messages::{ClockMessage, Time};

/// Sensing of a robot, with the time of the host in milliseconds.
struct Robot {
    sensing: Sensing,
    now: u64,
}

impl Robot {
    fn new(change: impl Fn(&mut Config)) -> Self {
        let mut config = Configured::read(None).unwrap().config;
        change(&mut config);
        Self { sensing: Sensing::new(&config).unwrap(), now: 0 }
    }

    /// Passes a message of a topic to the robot's sensing.
    fn take<T: Serialize>(&mut self, source: TopicPurpose, message: &T) -> Result<(), Fault> {
        let index = self.sensing.inputs().position(|input| input.source == source).unwrap();
        let (now, at) = (Duration::from_millis(self.now), Nanos(self.now * 1_000_000));
        self.sensing.take(index, &Payload::of(message).unwrap(), now, at)
    }

    /// Passes odometry with the current time and the position `x`.
    fn odometry(&mut self, x: f64) -> Result<(), Fault> {
        let mut message = Odometry::default();
        message.header.stamp = Time::of(1_000_000_000 + self.now as i64 * 1_000_000);
        message.pose.pose.position.x = x;
        message.pose.pose.orientation.w = 1.0;
        self.take(TopicPurpose::Odometry, &message)
    }

    /// Passes a scan whose rays all have this range.
    fn scan(&mut self, range: f32) -> Result<(), Fault> {
        let (angle_min, angle_increment, range_max) = (-PI as f32, (PI / 180.0) as f32, 10.0);
        let ranges = vec![range; 360];
        self.take(
            TopicPurpose::Scan,
            &LaserScan { angle_min, angle_increment, range_max, ranges, ..LaserScan::default() },
        )
    }

    fn sensed(&self) -> Sensed {
        self.sensing.sensed(Nanos(self.now * 1_000_000)).unwrap()
    }

    fn check(&self) -> Result<(), Fault> {
        self.sensing.check(Duration::from_millis(self.now))
    }
}

#[test]
fn messages_make_an_output() {
    let mut robot = Robot::new(|_| {});
    assert_eq!(robot.sensing.awaited().count(), 2);
    robot.odometry(0.5).unwrap();
    robot.scan(2.0).unwrap();
    assert_eq!(robot.sensing.awaited().count(), 0);
    let y = robot.sensed();
    assert_eq!(y.odometry.x, Meters(0.5));
    for pings in &y.pings {
        let ping = pings.newest_first().next().unwrap();
        assert!((ping.range.unwrap().0 - 1.82).abs() < 1e-6 && ping.pose.x == Meters(0.5), "{ping:?}");
    }
}

#[test]
fn a_silent_topic_is_stale_after_its_limit() {
    let mut robot = Robot::new(|config| config.stale_odom = 500);
    robot.odometry(0.0).unwrap();
    robot.scan(2.0).unwrap();
    assert_eq!(robot.sensed().data_age, Nanos::ZERO);
    robot.now = 500;
    // A scan does not update the robot's pose.
    robot.scan(2.0).unwrap();
    assert_eq!((robot.check(), robot.sensed().data_age), (Ok(()), Nanos(500_000_000)));
    robot.now = 501;
    let stale = Fault::Stale { topic: "/odom".to_owned(), age: 501, limit: 500, why: String::new() };
    assert_eq!(robot.check(), Err(stale));
    robot.odometry(0.0).unwrap();
    assert_eq!((robot.check(), robot.sensed().data_age), (Ok(()), Nanos::ZERO));
}

#[test]
fn messages_that_cannot_be_read_make_a_topic_stale() {
    let mut robot = Robot::new(|_| {});
    robot.odometry(0.0).unwrap();
    robot.scan(2.0).unwrap();
    robot.now = 1001;
    robot.odometry(0.0).unwrap();
    robot.scan(f32::NAN).unwrap();
    let Err(Fault::Stale { topic, why, .. }) = robot.check() else { panic!("a fault") };
    assert_eq!((&*topic, &*why), ("/scan", "none of its 360 rays is valid"));
    robot.take(TopicPurpose::Scan, &Bool { data: true }).unwrap();
    assert!(matches!(robot.check(), Err(Fault::Stale { why, .. }) if why.starts_with("1 bytes that cannot")));
}

#[test]
fn a_direction_that_is_lost_is_forgotten() {
    let mut robot = Robot::new(|_| {});
    robot.odometry(0.0).unwrap();
    robot.scan(2.0).unwrap();
    let blind = |robot: &mut Robot| {
        let mut ranges = vec![2.0; 360];
        ranges[160..200].fill(f32::NAN);
        let (angle_min, angle_increment, range_max) = (-PI as f32, (PI / 180.0) as f32, 10.0);
        let scan = LaserScan { angle_min, angle_increment, range_max, ranges, ..LaserScan::default() };
        robot.take(TopicPurpose::Scan, &scan).unwrap();
        robot.sensed().pings[0].newest_first().count()
    };
    robot.now = 900;
    assert_eq!(blind(&mut robot), 1);
    robot.now = 1100;
    assert_eq!(blind(&mut robot), 0);
}

#[test]
fn range_sensors_have_the_layout_of_their_distribution() {
    let sensor = || RangeSensor { topic: "left".to_owned(), x: 0.0, y: 0.1, yaw: PI / 2.0 };
    let robot = |distribution| {
        let mut robot = Robot::new(|config| {
            (config.distribution, config.ring_radius) = (distribution, 0.2);
            config.scan.clear();
            config.ranges = RangeSensors(vec![sensor()]);
        });
        robot.odometry(0.0).unwrap();
        robot
    };
    let old = |range| ShortRange { min_range: 0.1, max_range: 4.0, range, ..ShortRange::default() };
    let mut humble = robot(Distribution::Humble);
    for (range, expected) in [(1.0, Some(0.9)), (5.0, None), (f32::INFINITY, None)] {
        humble.take(TopicPurpose::Range(0), &old(range)).unwrap();
        let heard = humble.sensed().pings[4].newest_first().next().unwrap().range;
        assert_eq!(heard.map(|range| (range.0 * 10.0).round() / 10.0), expected);
    }
    let count = |robot: &Robot| robot.sensed().pings[4].newest_first().count();
    humble.take(TopicPurpose::Range(0), &old(f32::NAN)).unwrap();
    humble.take(TopicPurpose::Range(0), &Range::from(old(1.0))).unwrap();
    assert_eq!(count(&humble), 3);
    let mut jazzy = robot(Distribution::Jazzy);
    jazzy.take(TopicPurpose::Range(0), &old(1.0)).unwrap();
    assert_eq!(count(&jazzy), 0);
    jazzy.take(TopicPurpose::Range(0), &Range::from(old(1.0))).unwrap();
    assert_eq!(count(&jazzy), 1);
}

#[test]
fn a_bumper_and_a_battery_may_report_changes_only() {
    let mut robot = Robot::new(|config| {
        config.bumper_type = BumperSource::Bool;
        config.battery = "battery".to_owned();
    });
    robot.odometry(0.0).unwrap();
    robot.scan(2.0).unwrap();
    assert_eq!(robot.sensing.awaited().count(), 0);
    robot.take(TopicPurpose::Bumper, &Bool { data: true }).unwrap();
    robot.take(TopicPurpose::Battery, &BatteryState { voltage: 12.0, ..BatteryState::default() }).unwrap();
    assert_eq!((robot.sensed().switches, robot.sensed().supply.battery), (1, Volts(12.0)));
    assert_eq!(robot.check(), Ok(()));
}

#[test]
fn a_scan_can_be_the_bumper() {
    let mut robot = Robot::new(|config| config.bumper_type = BumperSource::Scan);
    robot.odometry(0.0).unwrap();
    robot.scan(0.19).unwrap();
    assert_eq!(robot.sensed().switches, 0b1111);
    robot.scan(0.21).unwrap();
    assert_eq!(robot.sensed().switches, 0);
}

#[test]
fn a_scan_that_is_blind_ahead_is_no_bumper() {
    let mut robot = Robot::new(|config| config.bumper_type = BumperSource::Scan);
    robot.odometry(0.0).unwrap();
    let mut ranges = vec![2.0; 360];
    ranges[140..220].fill(f32::NAN);
    let (angle_min, angle_increment, range_max) = (-PI as f32, (PI / 180.0) as f32, 10.0);
    let mut scan = LaserScan { angle_min, angle_increment, range_max, ranges, ..LaserScan::default() };
    robot.take(TopicPurpose::Scan, &scan).unwrap();
    let why = "as a bumper (`bumper-type = \"scan\"`) the scan has to look ahead: none of its rays ahead is valid";
    let rejected = |robot: &Robot| robot.sensing.awaited().map(|(_, why)| why.to_owned()).next();
    assert_eq!(rejected(&robot).as_deref(), Some(why));
    scan.ranges[180] = 2.0;
    robot.take(TopicPurpose::Scan, &scan).unwrap();
    assert_eq!(rejected(&robot), None);
}

#[test]
fn messages_before_the_first_clock_are_not_stale() {
    let mut robot = Robot::new(|config| config.use_sim_time = true);
    robot.odometry(0.0).unwrap();
    robot.scan(2.0).unwrap();
    robot.take(TopicPurpose::Clock, &ClockMessage { clock: Time::of(1_700_000_000_000_000_000) }).unwrap();
    assert_eq!(robot.sensing.check(robot.sensing.simulated()), Ok(()));
    robot.take(TopicPurpose::Clock, &ClockMessage { clock: Time::of(1_700_000_000_600_000_000) }).unwrap();
    assert!(robot.sensing.check(robot.sensing.simulated()).is_err());
}

#[test]
fn messages_that_come_at_once_with_the_first_clock_are_not_stale() {
    let mut robot = Robot::new(|config| config.use_sim_time = true);
    robot.take(TopicPurpose::Clock, &ClockMessage { clock: Time::of(1_000_000_000_000) }).unwrap();
    robot.odometry(0.0).unwrap();
    robot.scan(2.0).unwrap();
    assert_eq!(robot.sensing.check(robot.sensing.simulated()), Ok(()));
}
