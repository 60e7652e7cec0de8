//! The direction of a hallway, by the walls that the robot hears on both sides while it drives: wheels that slip in
//! turns leave odometry a heading that is off, and walls do not turn.

use mdle_runtime::capability::{Odometry, SonarRing};
use mdle_runtime::{Nanos, Pose, Radians, SonarId, off_axis};

/// The sonars that look to the left and to the right.
const SIDES: [SonarId; 2] = [SonarId::new(4), SonarId::new(12)];
/// Greatest angle between a hallway and the axis of the frame along which it runs.
const AXIS: Radians = Radians::from_degrees(40.0);
/// Greatest angle between the robot's heading and the hallway at which its sides hear the walls.
const ALONG: Radians = Radians::from_degrees(30.0);
/// Echoes from further away than this, in metres, are of no hallway.
const WITHIN: f64 = 1.5;
/// Greatest distance, in metres, of an echo from the line of its wall.
const APART: f64 = 0.1;
/// Greatest number of echoes that a line remembers.
const KEPT: f64 = 24.0;
/// Least sum of squared distances along a wall, in square metres, by which its direction is known: errors of 1.5 cm are
/// then 2 degrees.
const KNOWN: f64 = 0.2;
/// Least such sum by which the next echo of the wall is expected.
const GUESSED: f64 = 0.02;
/// Greatest difference of the slopes of both walls.
const PARALLEL: f64 = 0.14;

/// The walls of a hallway.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hallway {
    /// The place of the origin of `Line`, and the direction of the frame's axis along which the robot drives.
    origin: Pose,
    sides: [Line; 2],
    /// Angle from the axis to the hallway, as last known.
    turned: Radians,
}

/// A line through echoes: distances along the axis and across it, in metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Line {
    count: f64,
    along: f64,
    across: f64,
    /// Sums of squares and of products of the distances from the means.
    squares: f64,
    products: f64,
    /// `true` if the last echo was not of this line.
    strays: bool,
    last: Nanos,
}

impl Hallway {
    /// No echoes yet, for a robot at `here` that will drive in the direction of `way`. Hallways run along the axes of
    /// the frame, of which one has the direction `axis`.
    pub(crate) fn begin<Y: Odometry + SonarRing>(y: &Y, here: Pose, way: Radians, axis: Radians) -> Self {
        let theta = Radians(axis.0 + off_axis(way, axis).0);
        let line = Line { last: y.now(), ..Line::default() };
        Self { origin: Pose { theta, ..here }, sides: [line; 2], turned: y.drift(axis) }
    }

    /// Takes the newest echoes to both sides in, and returns the angle from the frame's axis, as odometry has it, to
    /// the hallway: the last one that was known, or the drift measured at the beginning.
    pub(crate) fn turned<Y: SonarRing>(&mut self, y: &Y) -> Radians {
        let (mut takes, ring) = (false, y.ring_radius().0);
        for (line, (sonar, side)) in self.sides.iter_mut().zip(SIDES.into_iter().zip([1.0, -1.0])) {
            let Some(ping) = y.pings(sonar).newest_first().next().filter(|ping| ping.at > line.last) else { continue };
            line.last = ping.at;
            let Some(range) = ping.range.filter(|range| range.0 < WITHIN) else { continue };
            let off = Radians(ping.pose.theta.0 - self.origin.theta.0 - self.turned.0).wrapped();
            if off.0.abs() > ALONG.0 {
                continue;
            }
            // The echo comes from where the wall faces the sonar, whichever way that looks.
            let (sin, cos) = libm::sincos(self.origin.theta.0);
            let (x, y) = (ping.pose.x.0 - self.origin.x.0, ping.pose.y.0 - self.origin.y.0);
            let across = y * cos - x * sin + side * (ring * libm::cos(off.0) + range.0);
            line.take(x * cos + y * sin, across);
            takes = true;
        }
        let [left, right] = self.sides.map(|line| line.slope());
        if let Some((left, right)) = left.zip(right).filter(|(left, right)| takes && (left - right).abs() < PARALLEL) {
            let [one, other] = self.sides.map(|line| line.squares);
            let turned = Radians(libm::atan((left * one + right * other) / (one + other)));
            if turned.0.abs() <= AXIS.0 {
                self.turned = turned;
            }
        }
        self.turned
    }
}

impl Line {
    /// Takes in an echo; the second one in a row that is not of the line begins another.
    fn take(&mut self, along: f64, across: f64) {
        let slope = if self.squares >= GUESSED { self.products / self.squares } else { 0.0 };
        let line = self.across + slope * (along - self.along);
        let strays = self.count > 0.0 && (across - line).abs() > APART;
        if strays && !self.strays {
            self.strays = true;
            return;
        }
        if strays {
            *self = Self { last: self.last, ..Self::default() };
        }
        self.strays = false;
        if self.count >= KEPT {
            self.squares *= 1.0 - 1.0 / KEPT;
            self.products *= 1.0 - 1.0 / KEPT;
        } else {
            self.count += 1.0;
        }
        let (from_along, from_across) = (along - self.along, across - self.across);
        self.along += from_along / self.count;
        self.across += from_across / self.count;
        self.squares += from_along * (along - self.along);
        self.products += from_along * (across - self.across);
    }

    /// The slope of the line, if it is known.
    fn slope(&self) -> Option<f64> {
        (self.squares >= KNOWN).then(|| self.products / self.squares)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;
    use mdle_runtime::{Meters, Nanos};

    /// The angle, in degrees, to a hallway 1.5 m wide that odometry has `turned` degrees off the axis, after a way of
    /// `metres` along it. Every seventh echo of the left sonar strays.
    fn measured(turned: f64, metres: f64, right: f64) -> f64 {
        let mut y = Sensed { confirmation: 2, ..Sensed::heading(turned) };
        let mut hallway = Hallway::begin(&y, y.pose, Radians(0.0), Radians(0.0));
        let mut known = Radians(0.0);
        for step in 1..=libm::round(metres / 0.1) as u32 {
            y.pose = Pose { theta: y.pose.theta, ..Pose::ORIGIN.towards(y.pose.theta, Meters(0.1 * f64::from(step))) };
            let at = Nanos(u64::from(step) * 500_000_000);
            y.ping_at(SIDES[0], Some(if step % 7 == 0 { 1.2 } else { 0.56 }), at);
            y.ping_at(SIDES[1], Some(right * f64::from(step) + 0.56), at);
            known = hallway.turned(&y);
        }
        known.degrees()
    }

    #[test]
    fn walls_on_both_sides_tell_how_far_the_heading_is_off() {
        for turned in [-20.0, -10.0, 0.0, 10.0, 20.0] {
            assert!((measured(turned, 3.0, 0.0) - turned).abs() < 0.5, "{turned}: {}", measured(turned, 3.0, 0.0));
        }
    }

    #[test]
    fn a_short_way_walls_apart_and_a_slanting_hallway_tell_nothing() {
        assert_eq!(measured(10.0, 0.5, 0.0), 0.0);
        assert_eq!(measured(10.0, 3.0, 0.02), 0.0, "the right wall leads off");
        assert_eq!(measured(44.0, 3.0, 0.0), 0.0);
    }
}
