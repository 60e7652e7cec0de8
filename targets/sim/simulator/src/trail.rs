//! The record of a run for its pictures: the driven path, the positions where atoms began, the echoes, and the
//! contacts.

mod ways;

use std::collections::BTreeSet;

use mdle_runtime::capability::{Odometry as _, SonarRing as _};
use mdle_runtime::{Meters, Nanos, Pose, Radians, SONARS, Sensed, SonarId};

use crate::footprint::{Footprint, Form};
use crate::frames::{FilmFrame, Frames};
use crate::point::Point;
pub(crate) use ways::{Mark, TrailAtom, Ways};

/// Side length of a square in which at most one echo is kept, in metres, so that even a long run stores a limited
/// number of echoes.
const SQUARE: f64 = 0.04;

/// Record of a robot's run.
#[derive(Debug, Clone)]
pub(crate) struct Trail {
    /// Form of the body.
    pub(crate) form: Form,
    pub(crate) start: Pose,
    /// Current pose of the robot.
    pub(crate) here: Pose,
    /// Current displacement of each moving object of the world; `None` for an open door.
    pub(crate) things: Vec<Option<Point>>,
    /// The driven path, divided by atoms.
    pub(crate) ways: Ways,
    /// Texts about the run, for titles.
    pub(crate) about: About,
    /// Positions of echoes, at most one per square of 4 cm.
    pub(crate) echoes: Vec<Point>,
    heard: BTreeSet<(i64, i64)>,
    /// Position and time of the beginning of each contact, at most one per square of 4 cm.
    pub(crate) contacts: Vec<(Point, Nanos)>,
    touched: BTreeSet<(i64, i64)>,
    /// Time of the robot's last output; `None` before the first output.
    sensed: Option<Nanos>,
    /// Time at which the turns ended; `None` before that.
    ended: Option<Nanos>,
    /// Frames of the animation; `None` if no animation is recorded.
    pub(crate) frames: Option<Frames>,
    /// The other robots of a fleet; empty if there is only one robot.
    pub(crate) companions: Vec<Companion>,
    /// Word for the units that drive the parts of the path: `atom`, or `robot` in a fleet.
    pub(crate) kind: &'static str,
}

/// A robot of a fleet.
#[derive(Debug, Clone)]
pub(crate) struct Companion {
    pub(crate) form: Form,
    pub(crate) start: Pose,
    pub(crate) here: Pose,
}

/// Texts about a run, for titles.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct About {
    /// Description of the world, the body and the seed.
    pub(crate) setup: String,
    /// Name of the plan; empty if it has no name, or before the run has ended.
    pub(crate) plan: String,
    /// Cause and time of the end; empty before the run has ended.
    pub(crate) end: String,
}

impl Trail {
    /// Begins the record of `body` at its current pose.
    pub(crate) fn from(body: &Footprint) -> Self {
        let pose = &body.pose;
        Self {
            form: body.form,
            start: *pose,
            here: *pose,
            things: Vec::new(),
            ways: Ways::from(Point::of(pose)),
            about: About::default(),
            echoes: Vec::new(),
            heard: BTreeSet::new(),
            contacts: Vec::new(),
            touched: BTreeSet::new(),
            sensed: None,
            ended: None,
            frames: None,
            companions: Vec::new(),
            kind: "atom",
        }
    }

    /// Records that the robot is at `pose`.
    pub(crate) fn went(&mut self, pose: &Pose) {
        self.here = *pose;
        self.ways.went(Point::of(pose));
    }

    /// Records the output `sensed` of the robot at its current pose, at time `t`.
    pub(crate) fn sensed(&mut self, sensed: &Sensed, t: Nanos) {
        self.ways.passed(t);
        let echoes = echoes(&self.here, sensed, self.sensed.replace(t));
        for echo in echoes.into_iter().flatten() {
            if self.heard.insert(square(echo)) {
                self.echoes.push(echo);
            }
        }
        if let Some(frames) = &mut self.frames {
            // After the last turn the robot is only stopped: the film has the duration of the plan.
            let t = self.ended.map_or(t, |ended| t.min(ended));
            frames.push(FilmFrame { t, pose: self.here, echoes, things: self.things.clone() });
        }
    }

    /// Records that the body comes into contact with an obstacle at `place`, at time `t`.
    pub(crate) fn touched(&mut self, place: Point, t: Nanos) {
        if self.touched.insert(square(place)) {
            self.contacts.push((place, t));
        }
    }

    /// Records that an atom begins at the robot's pose; `number` is the number of its state in the first pass of the
    /// enclosing loops.
    pub(crate) fn began(&mut self, number: u64, law: &str, t: Nanos) {
        self.ways.began(number, law, t, Point::of(&self.here));
    }

    /// Records that the turns of the run have ended.
    pub(crate) fn ended(&mut self, plan: &str, is_over: bool, by: &str, t: Nanos) {
        self.ended = Some(t);
        self.ways.ended(t);
        plan.clone_into(&mut self.about.plan);
        let how = if is_over { "over" } else { "stopped" };
        self.about.end = format!("{how} after {:.1} s: {by}", t.seconds());
    }

    /// Returns all recorded positions.
    pub(crate) fn places(&self) -> impl Iterator<Item = Point> {
        self.ways.places().chain([Point::of(&self.here)])
    }
}

/// Returns, for each sonar, the floor position of its latest echo, assuming that the echo comes from the axis of the
/// sonar's cone; `None` if the sonar has not pinged since the time `before`.
#[must_use]
pub fn echoes(pose: &Pose, sensed: &Sensed, before: Option<Nanos>) -> [Option<Point>; SONARS] {
    let mut echoes = [None; SONARS];
    for (echo, number) in echoes.iter_mut().zip(0..) {
        let sonar = SonarId::new(number);
        let newest =
            sensed.pings(sonar).newest_first().next().filter(|ping| before.is_none_or(|before| ping.at > before));
        let Some((ping, Meters(range))) = newest.and_then(|ping| Some((ping, ping.range?))) else { continue };
        let from = on_the_floor(&ping.pose, pose, &sensed.pose());
        let axis = Radians(from.theta.0 + sonar.bearing().0);
        let place = Point::of(&from.towards(axis, Meters(sensed.ring_radius().0 + range)));
        // A user's own driver may report any value.
        *echo = Some(place).filter(|place| place.x.is_finite() && place.y.is_finite());
    }
    echoes
}

/// Converts the pose `then` from the frame of the odometry to the floor. In these two frames, the robot's current pose
/// is `odometry` and `here`.
fn on_the_floor(then: &Pose, here: &Pose, odometry: &Pose) -> Pose {
    let turned = here.theta.0 - odometry.theta.0;
    let (x, y) = (then.x.0 - odometry.x.0, then.y.0 - odometry.y.0);
    let (sin, cos) = libm::sincos(turned);
    Pose {
        x: Meters(here.x.0 + cos * x - sin * y),
        y: Meters(here.y.0 + sin * x + cos * y),
        theta: Radians(then.theta.0 + turned),
    }
}

fn square(place: Point) -> (i64, i64) {
    let number = |metres: f64| libm::floor(metres / SQUARE) as i64;
    (number(place.x), number(place.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ping_is_drawn_where_it_was_taken_whatever_odometry_says() {
        let pose = |x, y, degrees| Pose { x: Meters(x), y: Meters(y), theta: Radians::from_degrees(degrees) };
        // Half a metre back along the path, in both frames.
        let then = on_the_floor(&pose(1.0, 0.0, 0.0), &pose(5.0, 5.0, 90.0), &pose(1.5, 0.0, 0.0));
        assert!(then.distance(&pose(5.0, 4.5, 0.0)).0 < 1e-12 && (then.theta.degrees() - 90.0).abs() < 1e-12);
        let same = pose(0.3, -0.2, 17.0);
        assert_eq!(on_the_floor(&same, &same, &same), same);
    }
}
