//! What a run leaves behind for its pictures: the way, where each atom began, what the sonars heard, where the body touched.

use std::collections::BTreeSet;

use mdle_runtime::capability::SonarRing as _;
use mdle_runtime::{Meters, Nanos, Pose, Radians, SONARS, SonarId};

use crate::frames::Frames;
use crate::output::Sensed;
use crate::world::Place;

/// Places nearer to the last than this, in metres, are not kept: less than a pixel.
const APART: f64 = 0.01;
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
    /// The way before the first atom began, then the way of each.
    pub(crate) before: Vec<Place>,
    pub(crate) marks: Vec<Mark>,
    /// Where the sonars heard something, at most one in a square of 4 cm.
    pub(crate) echoes: Vec<Place>,
    heard: BTreeSet<(i64, i64)>,
    /// Where the body touched something when it came into contact, and when; at most one in such a square.
    pub(crate) contacts: Vec<(Place, Nanos)>,
    touched: BTreeSet<(i64, i64)>,
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
            before: vec![Place::of(pose)],
            marks: Vec::new(),
            echoes: Vec::new(),
            heard: BTreeSet::new(),
            contacts: Vec::new(),
            touched: BTreeSet::new(),
            frames: None,
        }
    }

    /// The robot has come to `pose`.
    pub(crate) fn went(&mut self, pose: &Pose) {
        self.here = *pose;
        let place = Place::of(pose);
        let way = self.marks.last_mut().map_or(&mut self.before, |mark| &mut mark.way);
        if way.last().is_none_or(|last| libm::hypot(last.x - place.x, last.y - place.y) >= APART) {
            way.push(place);
        }
    }

    /// Where it is, it senses this, at time `t`.
    pub(crate) fn sensed(&mut self, sensed: &Sensed, t: Nanos) {
        let echoes = echoes(&self.here, sensed, t);
        for echo in echoes.into_iter().flatten() {
            if self.heard.insert(square(echo)) {
                self.echoes.push(echo);
            }
        }
        if let Some(frames) = &mut self.frames {
            frames.push(t, &self.here, &echoes);
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
        let way = self.marks.last_mut().map_or(&mut self.before, |mark| &mut mark.way);
        let place = Place::of(&self.here);
        if way.last() != Some(&place) {
            way.push(place);
        }
        self.marks.push(Mark { state, law: law.to_owned(), t, way: vec![place] });
    }

    /// All places kept.
    pub(crate) fn places(&self) -> impl Iterator<Item = Place> {
        self.before.iter().chain(self.marks.iter().flat_map(|mark| &mark.way)).copied().chain([Place::of(&self.here)])
    }
}

/// Where the pings of time `t` had their echoes on the floor, if they had any, by sonar: on the axes of their cones.
pub(crate) fn echoes(pose: &Pose, sensed: &Sensed, t: Nanos) -> [Option<Place>; SONARS] {
    let mut echoes = [None; SONARS];
    for (echo, number) in echoes.iter_mut().zip(0..) {
        let sonar = SonarId::new(number);
        let newest = sensed.pings(sonar).newest_first().next().filter(|ping| ping.at == t);
        let Some(Meters(range)) = newest.and_then(|ping| ping.range) else { continue };
        let axis = Radians(pose.theta.0 + sonar.bearing().0);
        *echo = Some(Place::of(&pose.towards(axis, Meters(sensed.ring_radius().0 + range))));
    }
    echoes
}

fn square(place: Place) -> (i64, i64) {
    let number = |metres: f64| libm::floor(metres / SQUARE) as i64;
    (number(place.x), number(place.y))
}
