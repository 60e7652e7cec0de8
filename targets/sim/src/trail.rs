//! Where the robot went and where each atom began, kept for the plot.

use mdle_runtime::{Nanos, Pose};

use crate::world::Place;

/// Places nearer to the last than this, in metres, are not kept: less than a pixel.
const APART: f64 = 0.01;

/// The way of a robot.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trail {
    pub(crate) start: Pose,
    /// Where the robot is now.
    pub(crate) here: Pose,
    /// The way before the first atom began, then the way of each.
    pub(crate) before: Vec<Place>,
    pub(crate) marks: Vec<Mark>,
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
    /// A trail that begins here.
    pub(crate) fn from(pose: &Pose) -> Self {
        Self { start: *pose, here: *pose, before: vec![Place::of(pose)], marks: Vec::new() }
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
