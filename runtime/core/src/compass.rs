//! Estimates the drift of the odometry heading from walls. Wheels slip in turns, so the heading becomes wrong, but
//! walls keep their direction.
//!
//! Walls are assumed to be parallel or at right angles to each other. The drift is an estimate with an error, which
//! grows with each turn and with the distance driven. A measurement is weighted by its own error. A measurement that
//! deviates from the estimate by more than both errors allow is rejected, because the echo is then not from such a
//! wall.

mod line;
#[cfg(test)]
mod tests;

use core::f64::consts::FRAC_PI_2;

use crate::{Meters, Nanos, PINGS_KEPT, Pings, Pose, Radians, SONARS, Shape};
use line::RegressionLine;

/// Sonars that face left and right, each with the sign of its direction.
const SIDES: [(usize, f64); 2] = [(4, 1.0), (12, -1.0)];
/// Maximum angle between the robot's heading and walls along which it drives.
const ALONG: Radians = Radians::from_degrees(25.0);
/// Distance, in metres, beyond which walls are ignored.
const WITHIN: f64 = 1.5;
/// Minimum value of `RegressionLine::squares`, in square metres, at which one wall alone is enough to determine the
/// direction.
const LONG: f64 = 4.0;
/// Maximum difference between the slopes of the left and the right wall at which the walls are treated as parallel.
const PARALLEL: f64 = 0.14;
/// Maximum difference, in metres, between the ranges of the outer two of three adjacent sonars at which the robot is
/// treated as nearly square to the wall.
const SQUARE: f64 = 0.12;
/// Maximum difference, in metres, between the range of the middle sonar and the mean range of its two neighbours at
/// which the wall is treated as straight.
const STRAIGHT: f64 = 0.1;

/// Error, in radians, of a direction that is determined from walls on both sides of the path.
const BOTH: f64 = 0.026;
/// Error, in radians, of a direction that is determined from a wall on one side of the path.
const ONE: f64 = 0.06;
/// Error, in radians, of a direction that is determined from three pings of a wall.
const THREE: f64 = 0.12;
/// Minimum time, in nanoseconds, between two measurements from three pings.
const AGAIN: Nanos = Nanos(1_000_000_000);
/// Error of the drift, in radians, before any wall is measured.
const AT_FIRST: f64 = 0.1;
/// Maximum error of the drift, in radians.
const UNKNOWN: f64 = 0.35;
/// Maximum deviation of a measurement from the drift, as a multiple of their combined error. A measurement with a
/// larger deviation is not from a wall and is rejected.
const GATE: f64 = 2.0;
/// Error of odometry in a turn, as a fraction of the turn's angle.
const OF_TURNS: f64 = 0.025;
/// Increase of the squared error of the heading per metre driven, in square radians.
const OF_WAYS: f64 = 2e-4;
/// Maximum angle, in radians, between the first walls and the axes of odometry, or of a frame, at which the walls are
/// treated as parallel to these axes.
const ALONG_AXES: f64 = 0.17;
/// Maximum drift of a frame that is not parallel to the first walls. A frame with a larger drift is treated as not
/// parallel to the walls of the room.
const MOST: Radians = Radians::from_degrees(20.0);

/// Estimate of the drift of the odometry heading, from walls that are parallel or at right angles to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compass {
    /// Direction of the walls in odometry coordinates, in radians; 0 if the walls were parallel to the axes of odometry
    /// and the heading has not drifted.
    drift: f64,
    /// Error of `drift`, in radians.
    error: f64,
    /// Direction of the first walls in odometry coordinates, in radians; `None` before any wall is measured.
    first: Option<f64>,
    /// Pose by odometry at the last output.
    last: Pose,
    /// Origin and direction of the axis along which the lines of the walls are measured; `None` while the robot does
    /// not drive along walls.
    way: Option<Pose>,
    sides: [RegressionLine; 2],
    /// Time of the newest ping in the last evaluation of three pings.
    judged: Nanos,
}

impl Default for Compass {
    fn default() -> Self {
        Self {
            drift: 0.0,
            error: AT_FIRST,
            first: None,
            last: Pose::ORIGIN,
            way: None,
            sides: [RegressionLine::default(); 2],
            judged: Nanos::ZERO,
        }
    }
}

impl Compass {
    /// Returns the angle by which drift has turned a frame, by the last measurement; 0 before any wall is measured.
    /// `axis` is the direction, by odometry, of one of the frame's axes.
    ///
    /// A frame is assumed to be parallel to the walls. However, if the first walls were parallel neither to the axes of
    /// odometry nor to the frame, the result is always 0: among furniture, what seemed to be the first wall often is
    /// none, and a drift measured from it would be wrong by up to 40°.
    #[must_use]
    pub fn drift(&self, axis: Radians) -> Radians {
        let Some(first) = self.first else { return Radians(0.0) };
        let off = off_quarter(first - axis.0);
        let drift = self.drift - first + off;
        if off.abs() <= ALONG_AXES {
            return Radians(drift);
        }
        // The plan may have taken the frame when the heading had already drifted.
        let drift = off_quarter(drift);
        Radians(if first.abs() <= ALONG_AXES && drift.abs() <= MOST.0 { drift } else { 0.0 })
    }

    /// Updates the drift with the last pings and the odometry pose of a robot with this shape. Does nothing for a robot
    /// whose sonars all ping in every turn, because its odometry is assumed not to drift.
    pub fn take(&mut self, pings: &[Pings; SONARS], odometry: Pose, shape: &Shape) {
        if shape.confirmation >= PINGS_KEPT {
            return;
        }
        let turned = Radians(odometry.theta.0 - self.last.theta.0).wrapped().0.abs();
        let Meters(way) = odometry.distance(&self.last);
        self.last = odometry;
        let error = self.error + OF_TURNS * turned;
        self.error = libm::sqrt(error * error + OF_WAYS * way).min(UNKNOWN);
        self.drives(pings, odometry, shape);
        if let Some(apart) = shape.sonars_apart {
            self.faces(pings, odometry, apart);
        }
    }

    /// Combines the drift with a measurement. The first measurement of walls that are not parallel to the axes of
    /// odometry replaces the drift.
    fn measure(&mut self, drift: f64, error: f64) {
        if self.first.is_none() && drift.abs() > ALONG_AXES {
            (self.drift, self.error) = (drift, error);
        }
        self.first.get_or_insert(drift);
        let off = drift - self.drift;
        let (ours, theirs) = (self.error * self.error, error * error);
        if off.abs() <= GATE * libm::sqrt(ours + theirs) {
            self.drift += off * ours / (ours + theirs);
            self.error = libm::sqrt(ours * theirs / (ours + theirs)).max(error.min(self.error));
        }
    }

    /// Returns the origin and the direction of the axis along which lines are measured; `None` if the robot does not
    /// head along walls.
    ///
    /// Before any wall is measured, walls may run in any direction: lines are then measured along the robot's heading.
    fn along(&mut self, pings: &[Pings; SONARS], odometry: Pose) -> Option<Pose> {
        let heads_along = |axis: Radians| Radians(odometry.theta.0 - axis.0).wrapped().0.abs() <= ALONG.0;
        self.way = self.way.filter(|origin| heads_along(origin.theta));
        if self.way.is_some() {
            return self.way;
        }
        let off = self.first.map_or(0.0, |_| off_quarter(odometry.theta.0 - self.drift));
        let axis = Radians(odometry.theta.0 - off);
        if !heads_along(axis) {
            return None;
        }
        self.sides = SIDES.map(|(sonar, _)| {
            let newest = pings.get(sonar).and_then(|pings| pings.newest_first().next());
            RegressionLine::since(newest.map_or(Nanos::ZERO, |ping| ping.at))
        });
        self.way = Some(Pose { theta: axis, ..odometry });
        self.way
    }

    /// Measures the drift from the walls on the left and on the right of the robot's path.
    fn drives(&mut self, pings: &[Pings; SONARS], odometry: Pose, shape: &Shape) {
        let Some(origin) = self.along(pings, odometry) else { return };
        let mut takes = false;
        for (line, (sonar, side)) in self.sides.iter_mut().zip(SIDES) {
            let newest = pings.get(sonar).and_then(|pings| pings.newest_first().next());
            let Some(ping) = newest.filter(|ping| ping.at > line.last) else { continue };
            line.last = ping.at;
            let Some(range) = ping.range.filter(|range| range.0 < WITHIN) else { continue };
            // The echo comes from the point of the wall that is nearest to the sonar, whatever direction the sonar
            // faces.
            let off = ping.pose.theta.0 - origin.theta.0;
            let (sin, cos) = libm::sincos(origin.theta.0);
            let (x, y) = (ping.pose.x.0 - origin.x.0, ping.pose.y.0 - origin.y.0);
            let across = y * cos - x * sin + side * (shape.ring_radius.0 * libm::cos(off) + range.0);
            line.take(x * cos + y * sin, across);
            takes = true;
        }
        if !takes {
            return;
        }
        let axis = self.drift + off_quarter(origin.theta.0 - self.drift);
        if let Some((slope, error)) = self.slope() {
            self.measure(axis + libm::atan(slope), error);
        }
    }

    /// Returns the slope of the walls on both sides of the robot's path, and the error of the slope in radians; `None`
    /// while the slope is not known.
    fn slope(&self) -> Option<(f64, f64)> {
        let [left, right] = self.sides;
        match (left.slope(), right.slope()) {
            (Some(one), Some(other)) => {
                let slope = (one * left.squares + other * right.squares) / (left.squares + right.squares);
                ((one - other).abs() < PARALLEL).then_some((slope, BOTH))
            }
            (Some(slope), None) => (left.squares >= LONG).then_some((slope, ONE)),
            (None, Some(slope)) => (right.squares >= LONG).then_some((slope, ONE)),
            (None, None) => None,
        }
    }

    /// Measures the drift from a straight wall, whose echoes three adjacent sonars receive while the middle sonar is
    /// about square to the wall. Measures nothing while the drift is known more precisely. The first measurement must
    /// come from another method, because three pings are too few to decide whether the walls of the room are parallel
    /// to the axes of odometry.
    ///
    /// If the robot is square to the wall, the two outer sonars measure equal ranges.
    fn faces(&mut self, pings: &[Pings; SONARS], odometry: Pose, apart: Meters) {
        let newest = pings.iter().filter_map(|pings| pings.newest_first().next()).map(|ping| ping.at).max();
        let Some(newest) =
            newest.filter(|newest| newest.since(self.judged) >= AGAIN && self.error > THREE && self.first.is_some())
        else {
            return;
        };
        self.judged = newest;
        // The smaller of the last two ranges, because few wrong ranges are too short.
        let range = |sonar: usize| pings.get(sonar % SONARS)?.nearest(2).map(|range| range.0);
        let mut nearest = None;
        for sonar in (0..SONARS).step_by(4) {
            let around = [sonar.wrapping_add(SONARS - 1), sonar, sonar.wrapping_add(1)];
            let [Some(before), Some(middle), Some(behind)] = around.map(range) else {
                continue;
            };
            let is_wall = (before - behind).abs() < SQUARE && ((before + behind) / 2.0 - middle).abs() < STRAIGHT;
            if is_wall && middle < nearest.map_or(WITHIN, |(range, _)| range) {
                nearest = Some((middle, (before - behind) / apart.0));
            }
        }
        if let Some((_, askew)) = nearest {
            let wall = odometry.theta.0 + askew;
            self.measure(self.drift + off_quarter(wall - self.drift), THREE);
        }
    }
}

/// Returns the difference between `angle` and the nearest multiple of a right angle, from -π/4 to π/4.
fn off_quarter(angle: f64) -> f64 {
    let Radians(angle) = Radians(angle).wrapped();
    angle - libm::round(angle / FRAC_PI_2) * FRAC_PI_2
}
