//! Sonar readings in the paper's sixteen directions, each with its age and the pose from which it was taken.

use core::f64::consts::FRAC_PI_2;

use crate::{Meters, Nanos, Pose, Radians};

/// Number of sonars, which is also the number of directions in the paper's plans.
pub const SONARS: usize = 16;
/// Number of pings that an output keeps for each sonar; this many pings confirm that a direction is free.
pub const PINGS_KEPT: usize = 3;

/// One of the sixteen sonars: number `i` looks along `i · 22.5°`, counter-clockwise from the front, on every robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SonarId(u8);

impl SonarId {
    /// Returns the sonar with this number. Numbers wrap around the ring, so 16 is the sonar 0.
    #[must_use]
    pub const fn new(number: u8) -> Self {
        Self(number & 15)
    }

    /// Returns the sonar's number, below [`SONARS`].
    #[must_use]
    pub const fn number(self) -> usize {
        // The number is already below 16. The mask shows this to the optimizer, so that indexing a ring needs no code
        // that panics.
        (self.0 & 15) as usize
    }

    /// Returns the direction of the sonar's axis, relative to the robot's heading.
    #[must_use]
    pub const fn bearing(self) -> Radians {
        Radians::from_degrees(self.0 as f64 * 22.5)
    }
}

/// One ping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ping {
    /// Range from the transducer; `None` if no echo returned.
    pub range: Option<Meters>,
    /// Time at which the ping was taken.
    pub at: Nanos,
    /// Pose of the robot by odometry when the ping was taken.
    pub pose: Pose,
    /// Mount of the transducer that received the echo.
    pub mount: Mount,
}

/// Position and direction of a transducer relative to its sonar on the ring. The type has single precision, as
/// an output keeps 48 pings.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mount {
    /// Distance, in metres, at which the transducer's axis passes the robot's centre; positive on the left.
    pub left: f32,
    /// Angle, in radians, from the sonar's axis to the transducer's axis, counter-clockwise positive.
    pub turned: f32,
}

impl Mount {
    /// Returns the mount of a transducer that represents `sonar`, faces along `bearing`, and is `x` metres ahead of the
    /// robot's centre and `y` metres to the left of it.
    #[must_use]
    pub fn of(x: f64, y: f64, bearing: Radians, sonar: SonarId) -> Self {
        let (sin, cos) = libm::sincos(bearing.0);
        let turned = Radians(bearing.0 - sonar.bearing().0).wrapped();
        Self { left: (y * cos - x * sin) as f32, turned: turned.0 as f32 }
    }
}

impl Ping {
    /// Returns the transducer's axis as a pose: the heading of the axis, and the point from which the range
    /// plus the ring's radius is measured along it. For a transducer on the ring, this point is the robot's
    /// centre.
    #[must_use]
    pub fn axis(&self, sonar: SonarId) -> Pose {
        let theta = Radians(self.pose.theta.0 + sonar.bearing().0 + f64::from(self.mount.turned));
        if self.mount.left == 0.0 {
            return Pose { theta, ..self.pose };
        }
        let left = Meters(self.mount.left.into());
        Pose { theta, ..self.pose.towards(Radians(theta.0 + FRAC_PI_2), left) }
    }
}

/// The last pings of one sonar, newest first.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pings {
    latest: [Option<Ping>; PINGS_KEPT],
}

impl Pings {
    /// Adds a new ping and removes the oldest.
    pub fn push(&mut self, ping: Ping) {
        let [first, second, _] = self.latest;
        self.latest = [Some(ping), first, second];
    }

    /// Returns the stored pings, newest first; fewer than [`PINGS_KEPT`] shortly after the start.
    pub fn newest_first(&self) -> impl Iterator<Item = &Ping> {
        self.latest.iter().flatten()
    }

    /// Returns the smallest range among the newest `count` pings; `None` if none of these pings had an echo.
    #[must_use]
    pub fn nearest(&self, count: usize) -> Option<Meters> {
        let ranges = self.newest_first().take(count).filter_map(|ping| ping.range);
        ranges.fold(None, |least, range| match least {
            Some(Meters(best)) if best <= range.0 => least,
            Some(_) | None => Some(range),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns one ping for each range. The ranges are in the order in which the pings are taken.
    fn pings(ranges: &[Option<f64>]) -> Pings {
        let mut pings = Pings::default();
        for range in ranges {
            pings.push(Ping { range: range.map(Meters), at: Nanos::ZERO, pose: Pose::ORIGIN, mount: Mount::default() });
        }
        pings
    }

    #[test]
    fn the_nearest_echo_counts_and_silence_does_not() {
        assert_eq!(pings(&[]).nearest(3), None);
        assert_eq!(pings(&[None, None]).nearest(3), None);
        assert_eq!(pings(&[Some(2.0), None, Some(3.0)]).nearest(3), Some(Meters(2.0)));
        assert_eq!(pings(&[Some(2.0), Some(1.0), Some(3.0)]).nearest(3), Some(Meters(1.0)));
    }

    #[test]
    fn only_the_newest_pings_are_asked() {
        let pings = pings(&[Some(0.1), Some(1.0), Some(2.0), Some(3.0)]);
        assert_eq!(
            [0, 1, 2, 3, 9].map(|count| pings.nearest(count)),
            [None, Some(Meters(3.0)), Some(Meters(2.0)), Some(Meters(1.0)), Some(Meters(1.0))]
        );
    }
}
