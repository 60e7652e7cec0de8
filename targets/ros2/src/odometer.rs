//! The pose and the speed that odometry reports, after plausibility checks.

use std::collections::VecDeque;

use mdle_runtime::{Meters, MetersPerSecond, Pose, Radians, RadiansPerSecond, Twist};

use crate::config::Config;
use crate::fault::Fault;
use crate::messages::{Odometry, Time};

/// Maximum step, in nanoseconds, by which the time of odometry may go back. After a larger step, the run ends with a
/// fault.
const BACK: i64 = 1_000_000_000;
/// Number of stored poses. The pose at the time of a scan is chosen from them.
const KEPT: usize = 32;
/// Tolerance of the plausibility check: the factor by which a robot may exceed its maximum speeds.
const OVERSHOOT: f64 = 1.5;
/// Angle, in radians, by which a change of heading may exceed the maximum turn.
const JUMP: f64 = 0.6;

/// A pose, and the time of its message.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Timed {
    /// Time of the message, in nanoseconds; 0 if the robot has no clock.
    stamp: i64,
    pose: Pose,
}

/// The last poses and the current speed of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Odometer {
    poses: VecDeque<Timed>,
    velocity: Twist,
    fastest: Twist,
    jump: f64,
}

impl Odometer {
    /// Creates an odometer that has received no message yet.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        let fastest = Twist { v: MetersPerSecond(config.fastest), omega: RadiansPerSecond(config.fastest_turn) };
        Self { poses: VecDeque::new(), velocity: Twist::default(), fastest, jump: config.jump }
    }

    /// Stores a message that arrived `since` seconds after the previous message. Returns `false` if its time stamp is
    /// not newer than the last one.
    ///
    /// # Errors
    /// Fails if the pose is invalid or has jumped, or if the time has gone back.
    pub fn take(&mut self, message: &Odometry, since: f64) -> Result<bool, Fault> {
        let next = Timed { stamp: message.header.stamp.nanos(), pose: pose(message)? };
        if let Some(last) = self.poses.back() {
            let back = last.stamp.saturating_sub(next.stamp);
            if back > BACK && next.stamp != 0 {
                return Err(Fault::Backwards(back as f64 / 1e9));
            }
            // Best-effort delivery may duplicate and reorder messages.
            if next.stamp != 0 && back >= 0 {
                return Ok(false);
            }
            let stamped = if next.stamp == 0 || last.stamp == 0 { 0.0 } else { -back as f64 / 1e9 };
            self.believe(last.pose, next.pose, since.max(stamped))?;
        }
        self.velocity = velocity(message)?;
        self.poses.push_back(next);
        if self.poses.len() > KEPT {
            self.poses.pop_front();
        }
        Ok(true)
    }

    /// Checks that the robot can have moved from the pose `last` to the pose `next` within `seconds`.
    fn believe(&self, last: Pose, next: Pose, seconds: f64) -> Result<(), Fault> {
        let way = last.distance(&next).0;
        let turn = Radians(next.theta.0 - last.theta.0).wrapped().0.abs();
        let most = |fastest: f64, jump: f64| OVERSHOOT * fastest * seconds + jump;
        if way > most(self.fastest.v.0, self.jump) || turn > most(self.fastest.omega.0, JUMP) {
            return Err(Fault::Jumped { way, degrees: turn.to_degrees(), seconds });
        }
        Ok(())
    }

    /// Returns the last pose and speed; `None` before the first message.
    #[must_use]
    pub fn last(&self) -> Option<(Pose, Twist)> {
        self.poses.back().map(|last| (last.pose, self.velocity))
    }

    /// Returns the time of the last message, in nanoseconds.
    #[must_use]
    pub fn stamp(&self) -> i64 {
        self.poses.back().map_or(0, |last| last.stamp)
    }

    /// Returns the stored pose nearest to the time `stamp`; the last pose if `stamp` is 0.
    #[must_use]
    pub fn pose_at(&self, stamp: &Time) -> Option<Pose> {
        let stamp = stamp.nanos();
        let nearest = self.poses.iter().rev().min_by_key(|timed| timed.stamp.saturating_sub(stamp).saturating_abs());
        let last = self.poses.back();
        if stamp == 0 { last } else { nearest }.map(|timed| timed.pose)
    }
}

/// Returns the pose on the floor that `message` reports.
fn pose(message: &Odometry) -> Result<Pose, Fault> {
    let (position, q) = (&message.pose.pose.position, &message.pose.pose.orientation);
    let norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if !(position.x.is_finite() && position.y.is_finite() && (0.5..2.0).contains(&norm)) {
        return Err(Fault::NoPose);
    }
    let theta = libm::atan2(2.0 * (q.w * q.z + q.x * q.y), q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z);
    Ok(Pose { x: Meters(position.x), y: Meters(position.y), theta: Radians(theta) })
}

/// Returns the speed that `message` reports.
fn velocity(message: &Odometry) -> Result<Twist, Fault> {
    let twist = &message.twist.twist;
    let velocity = Twist { v: MetersPerSecond(twist.linear.x), omega: RadiansPerSecond(twist.angular.z) };
    if velocity.v.0.is_finite() && velocity.omega.0.is_finite() { Ok(velocity) } else { Err(Fault::NoSpeed) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::config::Configured;

    fn odometer() -> Odometer {
        Odometer::new(&Configured::read(None).unwrap().config)
    }

    /// Returns an odometry message with the time stamp `millis` in milliseconds, the position `x` and the heading
    /// `theta`.
    fn message(millis: i64, x: f64, theta: f64) -> Odometry {
        let mut message = Odometry::default();
        message.header.stamp = Time::of(millis * 1_000_000);
        message.pose.pose.position.x = x;
        (message.pose.pose.orientation.z, message.pose.pose.orientation.w) = libm::sincos(theta / 2.0);
        message
    }

    #[test]
    fn a_pose_is_that_of_the_floor() {
        let mut odometer = odometer();
        let mut first = message(1, 3.0, FRAC_PI_2);
        (first.twist.twist.linear.x, first.twist.twist.angular.z) = (0.2, -0.4);
        assert_eq!(odometer.take(&first, 0.1), Ok(true));
        let (pose, velocity) = odometer.last().unwrap();
        assert!((pose.theta.0 - FRAC_PI_2).abs() < 1e-12 && pose.x == Meters(3.0));
        assert_eq!(velocity, Twist { v: MetersPerSecond(0.2), omega: RadiansPerSecond(-0.4) });
    }

    #[test]
    fn older_messages_are_left_out_and_another_run_is_a_fault() {
        let mut odometer = odometer();
        assert_eq!(odometer.take(&message(5000, 0.0, 0.0), 0.1), Ok(true));
        assert_eq!(odometer.take(&message(5000, 0.0, 0.0), 0.1), Ok(false));
        assert_eq!(odometer.take(&message(4900, 0.0, 0.0), 0.1), Ok(false));
        assert_eq!(odometer.take(&message(3000, 0.0, 0.0), 0.1), Err(Fault::Backwards(2.0)));
        assert_eq!(odometer.take(&message(5100, 0.0, 0.0), 0.1), Ok(true));
    }

    #[test]
    fn a_jump_is_a_fault_and_a_gap_is_none() {
        let mut odometer = odometer();
        assert_eq!(odometer.take(&message(0, 0.0, 0.0), 0.1), Ok(true));
        assert_eq!(odometer.take(&message(100, 0.34, 0.0), 0.1), Ok(true));
        // Within this time the robot can have driven this far at 0.3 m/s.
        assert_eq!(odometer.take(&message(2100, 1.5, 0.0), 0.1), Ok(true));
        assert!(matches!(odometer.take(&message(2200, 1.9, 0.0), 0.1), Err(Fault::Jumped { .. })));
        assert!(matches!(odometer.take(&message(2200, 1.5, 1.0), 0.1), Err(Fault::Jumped { .. })));
    }

    #[test]
    fn messages_without_a_time_count_as_they_come() {
        let mut odometer = odometer();
        for x in [0.0, 0.0, 0.01] {
            assert_eq!(odometer.take(&message(0, x, 0.0), 0.1), Ok(true));
        }
        assert_eq!(odometer.pose_at(&Time::of(7)).unwrap().x, Meters(0.01));
    }

    #[test]
    fn what_is_no_pose_is_a_fault() {
        let mut flat = message(1, 0.0, 0.0);
        flat.pose.pose.orientation.w = 0.0;
        let mut speed = message(1, 0.0, 0.0);
        speed.twist.twist.linear.x = f64::INFINITY;
        for wrong in [message(1, f64::NAN, 0.0), flat] {
            assert_eq!(odometer().take(&wrong, 0.1), Err(Fault::NoPose));
        }
        assert_eq!(odometer().take(&speed, 0.1), Err(Fault::NoSpeed));
    }

    #[test]
    fn a_scan_has_the_pose_of_its_time() {
        let mut odometer = odometer();
        for number in 1..=100 {
            odometer.take(&message(number * 100, number as f64 / 100.0, 0.0), 0.1).unwrap();
        }
        let x = |millis: i64| odometer.pose_at(&Time::of(millis * 1_000_000)).unwrap().x.0;
        assert_eq!(
            [x(9640), x(9660), x(99_000), x(1), odometer.pose_at(&Time::default()).unwrap().x.0],
            [0.96, 0.97, 1.0, 0.69, 1.0]
        );
    }
}
