//! The drift of a heading by odometry, measured by walls: wheels that slip in turns leave odometry a heading that is
//! off, and walls do not turn.
//!
//! Walls are taken to run at right angles to each other. The drift is a number with an error, which grows with each
//! turn and way; a measurement counts by its own error, and one that is off by more than both is of something else.

use core::f64::consts::FRAC_PI_2;

use crate::{Meters, Nanos, PINGS_KEPT, Pings, Pose, Radians, SONARS, Shape};

/// The sonars that look to the left and to the right, and the sign of the direction.
const SIDES: [(usize, f64); 2] = [(4, 1.0), (12, -1.0)];
/// Greatest angle between the robot's heading and walls along which it drives.
const ALONG: Radians = Radians::from_degrees(25.0);
/// Walls further away than this, in metres, are not looked at.
const WITHIN: f64 = 1.5;
/// Greatest distance, in metres, of an echo from the line of its wall.
const APART: f64 = 0.1;
/// Greatest number of echoes that a line remembers.
const KEPT: f64 = 24.0;
/// Least sum of squared distances along a wall, in square metres, by which its direction is known: errors of 1.5 cm are
/// then 1 degree. Sides of boxes are shorter, and may stand at any angle.
const KNOWN: f64 = 1.0;
/// Least such sum by which the next echo of the wall is expected.
const GUESSED: f64 = 0.02;
/// Least such sum by which the direction of a wall alone is known.
const LONG: f64 = 4.0;
/// Greatest difference of the slopes of walls on both sides.
const PARALLEL: f64 = 0.14;
/// Greatest difference, in metres, of the ranges to both sides of a wall to which the robot is nearly square.
const SQUARE: f64 = 0.12;
/// Greatest distance, in metres, of the middle of a straight wall from the mean of its sides.
const STRAIGHT: f64 = 0.1;

/// Error of a direction, in radians, by walls on both sides of the way.
const BOTH: f64 = 0.026;
/// Error of a direction, in radians, by one wall beside the way.
const ONE: f64 = 0.06;
/// Error of a direction, in radians, by three pings of a wall.
const THREE: f64 = 0.12;
/// Least time between two measurements by three pings.
const AGAIN: Nanos = Nanos(1_000_000_000);
/// Error of the drift, in radians, before any wall was heard.
const AT_FIRST: f64 = 0.1;
/// Greatest error of the drift, in radians.
const UNKNOWN: f64 = 0.35;
/// Greatest error, in radians, of a drift that is known.
const BELIEVED: f64 = 0.3;
/// Measurements off by more than this many times their error are of something else.
const GATE: f64 = 2.0;
/// Error of a turn by odometry, as a part of the angle.
const OF_TURNS: f64 = 0.025;
/// Square of the error of the heading after a metre, in radians squared.
const OF_WAYS: f64 = 2e-4;
/// Angle, in radians, from the axes of odometry below which a frame is along them.
const ALIGNED: f64 = 0.02;
/// Greatest angle, in radians, of the first walls from the axes of odometry: a plan that begins further off them does
/// not take walls for its axes.
const ALONG_AXES: f64 = 0.17;
/// Greatest drift from an axis of a frame that is not one of odometry: further off, the frame lies askew in the room.
const MOST: Radians = Radians::from_degrees(20.0);

/// The drift of the heading by odometry from walls at right angles to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compass {
    /// The direction of the walls in the axes of odometry, in radians; 0 if nothing has drifted.
    drift: f64,
    /// Error of `drift`, in radians.
    error: f64,
    /// The part of `drift` that the first walls account for, as they lay askew to the axes of odometry; `None` before
    /// any were measured.
    askew: Option<f64>,
    /// The pose by odometry when the last output was taken in.
    last: Pose,
    /// The place from which lines are measured, with the direction along which the robot drives, and the number of that
    /// quarter of the circle; `None` while it drives along no wall.
    way: Option<(Pose, i32)>,
    sides: [Line; 2],
    /// Time of the last ping when three pings were last looked at.
    judged: Nanos,
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

impl Default for Compass {
    fn default() -> Self {
        Self {
            drift: 0.0,
            error: AT_FIRST,
            askew: None,
            last: Pose::ORIGIN,
            way: None,
            sides: [Line::default(); 2],
            judged: Nanos::ZERO,
        }
    }
}

impl Compass {
    /// Returns the angle by which odometry has turned a frame, one of whose axes has the direction `axis` by odometry;
    /// 0 while it is not known.
    ///
    /// A frame is taken to be along the walls, unless the first walls lay askew to the axes of odometry: then the drift
    /// of those axes since is known, and that of other frames is not.
    #[must_use]
    pub fn drift(&self, axis: Radians) -> Radians {
        let (of_frame, askew) = (-off_quarter(axis.0), self.askew.unwrap_or(0.0));
        let drift = self.drift - askew + of_frame;
        let is_sound = of_frame.abs() < ALIGNED || askew == 0.0 && drift.abs() <= MOST.0;
        Radians(if self.error <= BELIEVED && is_sound { drift } else { 0.0 })
    }

    /// Takes in the last pings of a robot of this shape, and its pose by odometry. A robot whose sonars all ping in
    /// every turn is taken to have odometry that does not drift.
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

    /// Takes a measurement of the drift in. The first one tells whether walls are along the axes of odometry.
    fn measure(&mut self, drift: f64, error: f64) {
        let off = drift - self.drift;
        if self.askew.is_none() {
            let askew = if off.abs() <= ALONG_AXES { 0.0 } else { off };
            (self.askew, self.drift) = (Some(askew), self.drift + askew);
        }
        let (ours, theirs) = (self.error * self.error, error * error);
        let off = drift - self.drift;
        if off.abs() <= GATE * libm::sqrt(ours + theirs) {
            self.drift += off * ours / (ours + theirs);
            self.error = libm::sqrt(ours * theirs / (ours + theirs)).max(error.min(self.error));
        }
    }

    /// Returns the place from which lines are measured; `None` if the robot does not head along walls.
    fn along(&mut self, pings: &[Pings; SONARS], odometry: Pose) -> Option<Pose> {
        let heading = odometry.theta.0 - self.drift;
        let off = off_quarter(heading);
        if off.abs() > ALONG.0 {
            self.way = None;
            return None;
        }
        let quarter = libm::round(Radians(heading).wrapped().0 / FRAC_PI_2) as i32 & 3;
        if let Some((origin, _)) = self.way.filter(|(_, before)| *before == quarter) {
            return Some(origin);
        }
        let origin = Pose { theta: Radians(odometry.theta.0 - off), ..odometry };
        self.sides = SIDES.map(|(sonar, _)| {
            let newest = pings.get(sonar).and_then(|pings| pings.newest_first().next());
            Line { last: newest.map_or(Nanos::ZERO, |ping| ping.at), ..Line::default() }
        });
        self.way = Some((origin, quarter));
        Some(origin)
    }

    /// Measures the drift by walls beside the way.
    fn drives(&mut self, pings: &[Pings; SONARS], odometry: Pose, shape: &Shape) {
        let Some(origin) = self.along(pings, odometry) else { return };
        let mut takes = false;
        for (line, (sonar, side)) in self.sides.iter_mut().zip(SIDES) {
            let newest = pings.get(sonar).and_then(|pings| pings.newest_first().next());
            let Some(ping) = newest.filter(|ping| ping.at > line.last) else { continue };
            line.last = ping.at;
            let Some(range) = ping.range.filter(|range| range.0 < WITHIN) else { continue };
            // The echo comes from where the wall faces the sonar, whichever way that looks.
            let off = off_quarter(ping.pose.theta.0 - self.drift);
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

    /// Returns the slope of the walls beside the way, and its error in radians, if it is known.
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

    /// Measures the drift by a straight wall that three sonars hear square to it, while it is not known better. Three
    /// pings are too few to tell first whether the room lies askew.
    ///
    /// A wall to which the robot is square is as far before that direction as behind it.
    fn faces(&mut self, pings: &[Pings; SONARS], odometry: Pose, apart: Meters) {
        let newest = pings.iter().filter_map(|pings| pings.newest_first().next()).map(|ping| ping.at).max();
        let Some(newest) =
            newest.filter(|newest| newest.since(self.judged) >= AGAIN && self.error > THREE && self.askew.is_some())
        else {
            return;
        };
        self.judged = newest;
        // The nearest of two: few ranges that mean nothing are too short.
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

/// Returns the angle from the nearest whole quarter of a circle, -π/4 to π/4.
fn off_quarter(angle: f64) -> f64 {
    let Radians(angle) = Radians(angle).wrapped();
    angle - libm::round(angle / FRAC_PI_2) * FRAC_PI_2
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
    use crate::capability::Steering;
    use crate::{Mount, Ping};

    const SHAPE: Shape = Shape {
        body_radius: Meters(0.3),
        half_length: Meters(0.3),
        half_width: Meters(0.3),
        wheel_base: Meters(0.4),
        sonars_apart: Some(Meters(0.33)),
        ring_radius: Meters(0.19),
        confirmation: 2,
        steering: Steering::USUAL,
    };

    /// The pings and the compass of a robot.
    struct Trial {
        pings: [Pings; SONARS],
        compass: Compass,
        now: Nanos,
    }

    impl Trial {
        fn new() -> Self {
            Self { pings: [Pings::default(); SONARS], compass: Compass::default(), now: Nanos::ZERO }
        }

        /// Takes in these ranges, in metres, heard half a second later at a pose.
        fn hears(&mut self, pose: Pose, ranges: &[(usize, f64)], shape: &Shape) {
            self.now = Nanos(self.now.0 + 500_000_000);
            for (sonar, range) in ranges {
                let range = Some(Meters(*range));
                self.pings[*sonar].push(Ping { range, at: self.now, pose, mount: Mount::default() });
            }
            self.compass.take(&self.pings, pose, shape);
        }

        /// Drives in a hallway 1.5 m wide that odometry has this many degrees off its axis. Every seventh echo of the
        /// left sonar strays, and the right wall leads off by `leads` for each step of 10 cm.
        fn drives(&mut self, turned: f64, metres: f64, leads: f64) {
            let theta = Radians::from_degrees(turned);
            for step in 1..=libm::round(metres / 0.1) as u32 {
                let pose = Pose { theta, ..Pose::ORIGIN.towards(theta, Meters(0.1 * f64::from(step))) };
                let left = if step % 7 == 0 { 1.2 } else { 0.56 };
                self.hears(pose, &[(4, left), (12, leads * f64::from(step) + 0.56)], &SHAPE);
            }
        }

        /// Returns the drift, in degrees, in a frame of which an axis has this direction, in degrees.
        fn drift(&self, axis: f64) -> f64 {
            self.compass.drift(Radians::from_degrees(axis)).degrees()
        }
    }

    #[test]
    fn walls_on_both_sides_tell_how_far_the_heading_is_off() {
        for turned in [-6.0, -4.0, 0.0, 4.0, 6.0] {
            let mut trial = Trial::new();
            trial.drives(turned, 4.0, 0.0);
            assert!((trial.drift(0.0) - turned).abs() < 1.0, "{turned}: {}", trial.drift(0.0));
            assert_eq!(trial.drift(0.0), trial.drift(90.0));
        }
    }

    /// A plan that begins 20 degrees off the walls keeps its heading in the room, and knows what odometry drifts later.
    #[test]
    fn walls_askew_to_the_first_heading_are_no_drift() {
        let mut trial = Trial::new();
        trial.drives(20.0, 4.0, 0.0);
        assert!(trial.drift(0.0).abs() < 0.1, "{}", trial.drift(0.0));
        trial.drives(24.0, 6.0, 0.0);
        assert!((trial.drift(0.0) - 4.0).abs() < 1.5, "{}", trial.drift(0.0));
        assert_eq!(trial.drift(30.0), 0.0, "of a frame that is not along odometry's axes nothing is known");
    }

    #[test]
    fn a_short_way_and_walls_apart_tell_nothing() {
        for (metres, leads) in [(0.5, 0.0), (3.0, 0.03)] {
            let mut trial = Trial::new();
            trial.drives(6.0, metres, leads);
            assert!(trial.drift(0.0).abs() < 0.01, "{metres} m, {leads}: {}", trial.drift(0.0));
        }
    }

    #[test]
    fn the_drift_is_kept_while_the_robot_turns() {
        let mut trial = Trial::new();
        trial.drives(6.0, 4.0, 0.0);
        for step in 0..=18 {
            let theta = Radians::from_degrees(6.0 + 5.0 * f64::from(step));
            trial.hears(Pose { theta, ..Pose::ORIGIN }, &[], &SHAPE);
        }
        assert!((trial.drift(0.0) - 6.0).abs() < 1.0, "{}", trial.drift(0.0));
        // A wall that would be 30 degrees off is of something else.
        trial.drives(126.0, 3.0, 0.0);
        assert!((trial.drift(0.0) - 6.0).abs() < 1.0, "{}", trial.drift(0.0));
    }

    #[test]
    fn a_wall_square_to_a_robot_measures_its_heading() {
        let measured = |degrees: f64, ranges: [f64; 3]| {
            let (mut trial, theta) = (Trial::new(), Radians::from_degrees(degrees));
            let [before, middle, behind] = ranges;
            trial.drives(0.0, 4.0, 0.0);
            // After a full circle the heading is no longer known well.
            for step in 0..36 {
                let theta = Radians::from_degrees(10.0 * f64::from(step) + degrees);
                trial.hears(Pose { theta, ..Pose::ORIGIN }, &[], &SHAPE);
            }
            for _ in 0..20 {
                let ranges = [(3, before), (4, middle), (5, behind)];
                trial.hears(Pose { theta, ..Pose::ORIGIN }, &ranges, &SHAPE);
            }
            trial.drift(0.0)
        };
        let drift = measured(8.0, [0.5, 0.49, 0.5]);
        assert!((3.0..=8.0).contains(&drift), "{drift}");
        for ranges in [[0.5, 0.5, 0.7], [0.7, 0.5, 0.7], [1.7, 1.6, 1.7]] {
            assert!(measured(8.0, ranges).abs() < 0.5, "{ranges:?}");
        }
    }

    #[test]
    fn a_robot_whose_sonars_ping_together_does_not_drift() {
        let mut trial = Trial::new();
        for step in 1..=40 {
            let pose = Pose { x: Meters(0.1 * f64::from(step)), theta: Radians::from_degrees(6.0), ..Pose::ORIGIN };
            trial.hears(pose, &[(4, 0.56), (12, 0.56)], &Shape { confirmation: 3, ..SHAPE });
        }
        assert_eq!(trial.drift(0.0), 0.0);
    }
}
