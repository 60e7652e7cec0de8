//! Moving parts of a world: doors that open and close, and boxes and discs that move on a schedule.
//!
//! No object moves into the robot. A door that would close on the robot stays open. A box or disc that would move into
//! the robot stops in contact with it until the robot has left. Then the object continues its schedule with this delay.

use crate::footprint::{Footprint, Form};
use crate::grid::{Hit, Segment};
use crate::outline::Outline;
use crate::point::Point;
use crate::surfaces::{Ends, Surface, apart, ends, surface};

/// Minimum distance, in metres, between a moving object and the robot. The bumper detects an object at this distance.
const STOPS_AT: f64 = 1e-4;
/// Distance, in metres, from which an object is treated as far from the robot. It exceeds `STOPS_AT` by more than
/// rounding errors.
const FAR: f64 = 0.01;

/// A moving object.
#[derive(Debug, Clone, PartialEq)]
pub struct Thing {
    /// Outline of a closed door, or of a box or disc at the beginning of its schedule.
    pub outline: Outline,
    /// Motion of the object.
    pub schedule: Schedule,
}

/// Motion of an object over time, in seconds since the robot was switched on.
#[derive(Debug, Clone, PartialEq)]
pub enum Schedule {
    /// A door, which is closed except at certain times.
    Open {
        /// Intervals in which the door is open, each given by its beginning and its end in seconds. The intervals do
        /// not overlap.
        times: Vec<[f64; 2]>,
        /// Period with which the intervals repeat, in seconds; `None` if they do not repeat.
        every: Option<f64>,
    },
    /// A box or disc that moves straight from stop to stop.
    Way {
        /// Stops of the centre, each with its time and position, in order. There is at least one stop. The object rests
        /// before the first stop and after the last one.
        stops: Vec<Waypoint>,
        /// `true` if the object continues with the first stop after the last stop.
        repeats: bool,
    },
}

/// Position of a moving object at a certain time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// Time of the stop, in seconds.
    pub t: f64,
    /// Position of the object's centre.
    pub at: Point,
}

impl Thing {
    /// Returns the corners of the object after it has moved by `gone` from its first position.
    pub fn corners(&self, gone: Point) -> impl Iterator<Item = Point> {
        self.outline.points.iter().map(move |point| Point { x: point.x + gone.x, y: point.y + gone.y })
    }

    /// Returns the positions between which the centre of the object moves; empty for a door.
    pub(crate) fn way(&self) -> impl Iterator<Item = Point> {
        let stops = match &self.schedule {
            Schedule::Open { .. } => [].as_slice(),
            Schedule::Way { stops, .. } => stops.as_slice(),
        };
        stops.iter().map(|stop| stop.at)
    }

    /// Returns the corners of the object at each of its stops.
    pub(crate) fn places(&self) -> impl Iterator<Item = Point> {
        let still = Point { x: 0.0, y: 0.0 };
        let first = self.way().next();
        let gone = self.way().filter_map(move |at| first.map(|first| Point { x: at.x - first.x, y: at.y - first.y }));
        [still].into_iter().chain(gone.skip(1)).flat_map(|gone| self.corners(gone))
    }
}

impl Schedule {
    /// Returns the displacement at time `t` from the object's first position; `None` for an open door.
    fn moved(&self, t: f64) -> Option<Point> {
        match self {
            Self::Open { times, every } => {
                let t = every.map_or(t, |every| libm::fmod(t, every));
                let open = times.iter().any(|[from, to]| *from <= t && t < *to);
                (!open).then_some(Point { x: 0.0, y: 0.0 })
            }
            Self::Way { stops, repeats } => {
                let (first, last) = (stops.first()?, stops.last()?);
                let t = if *repeats && t > last.t && last.t > first.t {
                    first.t + libm::fmod(t - first.t, last.t - first.t)
                } else {
                    t
                };
                let Point { x, y } = at(stops, t).unwrap_or(if t < first.t { first.at } else { last.at });
                Some(Point { x: x - first.at.x, y: y - first.at.y })
            }
        }
    }
}

/// Returns the position at time `t` between two stops; `None` before the first stop, and from the last stop on.
fn at(stops: &[Waypoint], t: f64) -> Option<Point> {
    let (from, to) = stops.iter().zip(stops.iter().skip(1)).find(|(from, to)| from.t <= t && t < to.t)?;
    let part = (t - from.t) / (to.t - from.t);
    let between = |from: f64, to: f64| from + part * (to - from);
    Some(Point { x: between(from.at.x, to.at.x), y: between(from.at.y, to.at.y) })
}

/// State of a moving object.
#[derive(Debug, Clone)]
pub(crate) struct Moving {
    schedule: Schedule,
    /// Time of the object's own clock, in seconds. The clock stops while the object waits for the robot.
    t: f64,
    /// Sides of the object at its first position.
    first: Vec<Segment>,
    ends: Vec<Ends>,
    /// Roughness of the sides, from 0 to 1.
    rough: f64,
    /// Sides of the object at its current position; empty for an open door.
    now: Vec<Segment>,
    /// Centre of a circle around the object at its first position. `moved` is the displacement from this position.
    centre: Point,
    radius: f64,
    moved: Option<Point>,
}

impl Moving {
    pub(crate) fn of(thing: &Thing) -> Self {
        let points = &thing.outline.points;
        let first: Vec<_> =
            points.iter().zip(points.iter().skip(1)).map(|(from, to)| Segment::between(*from, *to)).collect();
        let bound =
            |of: fn(&Point) -> f64, pick: fn(f64, f64) -> f64| points.iter().map(of).reduce(pick).unwrap_or(0.0);
        let middle = |of: fn(&Point) -> f64| (bound(of, f64::min) + bound(of, f64::max)) / 2.0;
        let centre = Point { x: middle(|place| place.x), y: middle(|place| place.y) };
        let radius = points.iter().map(|point| apart(centre, *point)).fold(0.0, f64::max);
        let ends = first.iter().map(|segment| ends(segment, first.iter())).collect();
        let mut moving = Self {
            schedule: thing.schedule.clone(),
            t: 0.0,
            first,
            ends,
            rough: thing.outline.rough,
            now: Vec::new(),
            centre,
            radius,
            moved: None,
        };
        moving.put(moving.schedule.moved(0.0));
        moving
    }

    /// Returns the displacement from the object's first position; `None` for an open door.
    pub(crate) fn gone(&self) -> Option<Point> {
        self.moved
    }

    /// Returns the sides of the object at its current position.
    pub(crate) fn segments(&self) -> impl Iterator<Item = &Segment> {
        self.now.iter()
    }

    fn put(&mut self, moved: Option<Point>) {
        self.now.clear();
        if let Some(Point { x, y }) = moved {
            let there = |place: Point| Point { x: place.x + x, y: place.y + y };
            self.now.extend(self.first.iter().map(|segment| Segment { from: there(segment.from), ..*segment }));
        }
        self.moved = moved;
    }

    /// Advances the object's clock, unless the object would then move into `body`.
    pub(crate) fn advance(&mut self, seconds: f64, body: &Footprint) {
        let moved = self.schedule.moved(self.t + seconds);
        if moved == self.moved {
            self.t += seconds;
            return;
        }
        let mut part = 1.0;
        // The step is halved until the object can make it: its position before the step was free. A door has no partial
        // step.
        while part > 1e-3 {
            if self.is_put(self.schedule.moved(self.t + seconds * part), body) {
                self.t += seconds * part;
                return;
            }
            part /= 2.0;
        }
    }

    /// Moves the object to the displacement `moved`, unless it would then be too close to `body`. Returns `true` if it
    /// has moved. An object that is already too close may move if it does not get closer.
    fn is_put(&mut self, moved: Option<Point>, body: &Footprint) -> bool {
        let was = self.moved;
        self.put(moved);
        let gap = self.gap(body, FAR);
        if gap >= STOPS_AT {
            return true;
        }
        self.put(was);
        let is_no_closer = gap >= self.gap(body, f64::INFINITY);
        if is_no_closer {
            self.put(moved);
        }
        is_no_closer
    }

    /// Returns the current centre of the circle around the object; `None` for an open door.
    pub(crate) fn around(&self) -> Option<Point> {
        let Point { x, y } = self.moved?;
        Some(Point { x: self.centre.x + x, y: self.centre.y + y })
    }

    /// Returns the distance of the object from `at`; infinite for an open door. The distance is exact if it is below
    /// `most`.
    pub(crate) fn distance(&self, at: Point, most: f64) -> f64 {
        match self.around() {
            Some(around) if apart(around, at) - self.radius < most => {
                self.now.iter().fold(f64::INFINITY, |least, segment| least.min(apart(segment.nearest(at), at)))
            }
            Some(_) | None => f64::INFINITY,
        }
    }

    /// Returns the distance between the object and a body; infinite for an open door. The distance is exact if it is
    /// below `most`.
    pub(crate) fn gap(&self, body: &Footprint, most: f64) -> f64 {
        if let Form::Disc { radius } = body.form {
            return self.distance(body.at(), most + radius) - radius;
        }
        match self.around() {
            Some(around) if apart(around, body.at()) - self.radius - body.form.radius() < most => {
                self.now.iter().fold(f64::INFINITY, |least, segment| least.min(body.contact(segment).gap))
            }
            Some(_) | None => f64::INFINITY,
        }
    }

    /// Returns the first side of the object that a ray hits; `None` if there is no hit within `most` metres.
    pub(crate) fn ray(&self, from: Point, way: Point, most: f64) -> Option<Hit> {
        let around = self.around()?;
        let (x, y) = (around.x - from.x, around.y - from.y);
        let (along, across) = (x * way.x + y * way.y, x * way.y - y * way.x);
        if across.abs() > self.radius || along < -self.radius || along - self.radius > most {
            return None;
        }
        let mut best = None;
        for (number, segment) in self.now.iter().enumerate() {
            let nearer = best.map_or(most, |hit: Hit| hit.range);
            if let Some(range) = segment.met(from, way, nearer) {
                best = Some(Hit { range, segment: number });
            }
        }
        best
    }

    /// Returns the surface of the object that a ray hits; `None` if there is no hit within `most` metres.
    pub(crate) fn found(&self, from: Point, way: Point, most: f64) -> Option<Surface> {
        let Hit { range, segment } = self.ray(from, way, most)?;
        let at = Point { x: from.x + range * way.x, y: from.y + range * way.y };
        let smooth = surface(self.now.get(segment)?, self.ends.get(segment)?, at, way, range);
        Some(Surface { rough: self.rough, ..smooth })
    }
}
