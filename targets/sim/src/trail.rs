//! What a run leaves behind for its pictures: the way, where each atom began, what the sonars heard, where the body touched.

use std::collections::BTreeSet;

use mdle_runtime::capability::{Odometry as _, SonarRing as _};
use mdle_runtime::{Meters, Nanos, Pose, Radians, SONARS, Sensed, SonarId};

use crate::frames::{Frame, Frames};
use crate::world::Place;

/// Places nearer to the last than this, in metres, are not kept: less than a pixel.
const APART: f64 = 0.01;
/// The most places of the way that are kept; when there are more, every second one goes.
const PLACES_MOST: usize = 100_000;
/// The most atoms whose beginnings are kept.
const MARKS_MOST: usize = 10_000;
/// Of the echoes in a square with this side, in metres, one is kept: however long a run, a floor has only so many.
const SQUARE: f64 = 0.04;

/// The way of a robot.
#[derive(Debug, Clone)]
pub(crate) struct Trail {
    /// The radius of the body, in metres.
    pub(crate) radius: f64,
    pub(crate) start: Pose,
    /// Where the robot is now.
    pub(crate) here: Pose,
    /// How far each thing of the world has gone now; `None` for an open door.
    pub(crate) things: Vec<Option<Place>>,
    /// The way before the first atom began, then the way of each.
    pub(crate) before: Vec<Place>,
    pub(crate) marks: Vec<Mark>,
    /// How many atoms began besides, whose ways are the last one's.
    pub(crate) unmarked: usize,
    /// How many places there are, and how far apart they are at least, in metres.
    count: usize,
    apart: f64,
    /// Where the sonars heard something, at most one in a square of 4 cm.
    pub(crate) echoes: Vec<Place>,
    heard: BTreeSet<(i64, i64)>,
    /// Where the body touched something when it came into contact, and when; at most one in such a square.
    pub(crate) contacts: Vec<(Place, Nanos)>,
    touched: BTreeSet<(i64, i64)>,
    /// When it last sensed anything.
    sensed: Option<Nanos>,
    /// For a picture that moves.
    pub(crate) frames: Option<Frames>,
}

/// An atom that began, and the way driven in it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mark {
    pub(crate) state: u64,
    pub(crate) law: String,
    pub(crate) t: Nanos,
    /// From where it began.
    pub(crate) way: Vec<Place>,
}

impl Trail {
    /// The trail of a body of this radius, in metres, that begins here.
    pub(crate) fn from(pose: &Pose, radius: f64) -> Self {
        Self {
            radius,
            start: *pose,
            here: *pose,
            things: Vec::new(),
            before: vec![Place::of(pose)],
            marks: Vec::new(),
            unmarked: 0,
            count: 1,
            apart: APART,
            echoes: Vec::new(),
            heard: BTreeSet::new(),
            contacts: Vec::new(),
            touched: BTreeSet::new(),
            sensed: None,
            frames: None,
        }
    }

    /// The robot has come to `pose`.
    pub(crate) fn went(&mut self, pose: &Pose) {
        self.here = *pose;
        let place = Place::of(pose);
        let way = self.marks.last_mut().map_or(&mut self.before, |mark| &mut mark.way);
        if way.last().is_none_or(|last| libm::hypot(last.x - place.x, last.y - place.y) >= self.apart) {
            way.push(place);
            self.count += 1;
        }
        if self.count > PLACES_MOST {
            self.thin();
        }
    }

    /// Leaves out every second place, but for those where an atom began or ended.
    fn thin(&mut self) {
        self.apart *= 2.0;
        self.count = 0;
        for way in std::iter::once(&mut self.before).chain(self.marks.iter_mut().map(|mark| &mut mark.way)) {
            let last = way.len().saturating_sub(1);
            let mut number = 0;
            way.retain(|_| {
                number += 1;
                number % 2 == 1 || number > last
            });
            self.count += way.len();
        }
    }

    /// Where it is, it senses this, at time `t`.
    pub(crate) fn sensed(&mut self, sensed: &Sensed, t: Nanos) {
        let echoes = echoes(&self.here, sensed, self.sensed.replace(t));
        for echo in echoes.into_iter().flatten() {
            if self.heard.insert(square(echo)) {
                self.echoes.push(echo);
            }
        }
        if let Some(frames) = &mut self.frames {
            frames.push(Frame { t, pose: self.here, echoes, things: self.things.clone() });
        }
    }

    /// The body comes into contact with something here, at time `t`.
    pub(crate) fn touched(&mut self, place: Place, t: Nanos) {
        if self.touched.insert(square(place)) {
            self.contacts.push((place, t));
        }
    }

    /// An atom begins where the robot is.
    pub(crate) fn began(&mut self, state: u64, law: &str, t: Nanos) {
        if self.marks.len() >= MARKS_MOST {
            self.unmarked = self.unmarked.saturating_add(1);
            return;
        }
        let way = self.marks.last_mut().map_or(&mut self.before, |mark| &mut mark.way);
        let place = Place::of(&self.here);
        if way.last() != Some(&place) {
            way.push(place);
            self.count += 1;
        }
        self.count += 1;
        self.marks.push(Mark { state, law: law.to_owned(), t, way: vec![place] });
    }

    /// All places kept.
    pub(crate) fn places(&self) -> impl Iterator<Item = Place> {
        self.before.iter().chain(self.marks.iter().flat_map(|mark| &mark.way)).copied().chain([Place::of(&self.here)])
    }
}

/// Where the newest pings had their echoes on the floor, if they had any, by sonar: on the axes of their cones. A sonar
/// that has not pinged since the turn before has none.
pub(crate) fn echoes(pose: &Pose, sensed: &Sensed, before: Option<Nanos>) -> [Option<Place>; SONARS] {
    let mut echoes = [None; SONARS];
    for (echo, number) in echoes.iter_mut().zip(0..) {
        let sonar = SonarId::new(number);
        let newest =
            sensed.pings(sonar).newest_first().next().filter(|ping| before.is_none_or(|before| ping.at > before));
        let Some((ping, Meters(range))) = newest.and_then(|ping| Some((ping, ping.range?))) else { continue };
        let from = on_the_floor(&ping.pose, pose, &sensed.pose());
        let axis = Radians(from.theta.0 + sonar.bearing().0);
        *echo = Some(Place::of(&from.towards(axis, Meters(sensed.ring_radius().0 + range))));
    }
    echoes
}

/// Where a pose by odometry was on the floor, when the robot, which is `here`, is at `odometry` by the same reckoning.
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

fn square(place: Place) -> (i64, i64) {
    let number = |metres: f64| libm::floor(metres / SQUARE) as i64;
    (number(place.x), number(place.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ping_is_drawn_where_it_was_taken_whatever_odometry_says() {
        let pose = |x, y, degrees| Pose { x: Meters(x), y: Meters(y), theta: Radians::from_degrees(degrees) };
        // Half a metre back along the way, in both reckonings.
        let then = on_the_floor(&pose(1.0, 0.0, 0.0), &pose(5.0, 5.0, 90.0), &pose(1.5, 0.0, 0.0));
        assert!(then.distance(&pose(5.0, 4.5, 0.0)).0 < 1e-12 && (then.theta.degrees() - 90.0).abs() < 1e-12);
        let same = pose(0.3, -0.2, 17.0);
        assert_eq!(on_the_floor(&same, &same, &same), same);
    }

    #[test]
    fn a_long_way_is_thinned_and_keeps_its_ends() {
        let mut trail = Trail::from(&Pose::ORIGIN, 0.2);
        let place = |x: f64| Pose { x: Meters(x), ..Pose::ORIGIN };
        for metre in 0..20_000_u32 {
            trail.began(1, "go 20 0", Nanos(0));
            (0..50).for_each(|cm| trail.went(&place(f64::from(metre) + f64::from(cm) / 50.0)));
        }
        let kept = trail.places().count();
        assert!((PLACES_MOST / 3..=PLACES_MOST + 1).contains(&kept), "{kept}");
        assert_eq!((trail.marks.len(), trail.unmarked), (MARKS_MOST, 20_000 - MARKS_MOST));
        let ends = (trail.before.first().map(|place| place.x), trail.places().last().map(|place| place.x));
        assert_eq!(ends, (Some(0.0), Some(19_999.98)));
    }
}
