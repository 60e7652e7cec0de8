//! Checks the contents of a world file and converts them to metres.

use mdle_runtime::{Meters, Pose, Radians};
use toml::Spanned;

use super::Wrong;
use super::text::{BoxText, ChargerText, DiscText, DoorText, GoalText, Numbers, StartText, TomlTable, WallText};
use crate::charger::Charger;
use crate::goal::{Goal, Zone};
use crate::moving::{Schedule, Thing, Waypoint};
use crate::outline::Outline;
use crate::point::Point;

/// Maximum coordinate, in metres; beyond it, rounding would lose millimetres.
const FURTHEST: f64 = 1e6;
/// Number of corners of the polygon that approximates a disc; for a radius of 1 m, the error is 2 mm.
const CORNERS: u32 = 48;
/// Default reach of a charger, in metres.
const REACH: f64 = 0.1;
/// Units of length, in metres.
const UNITS: [(&str, f64); 5] = [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254), ("ft", 0.3048)];

/// Unit of length of a file, in metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit(f64);

/// A fixed outline or a moving object of a world file.
pub(super) enum Stands {
    Still(Outline),
    Never(Thing),
}

impl Unit {
    pub(super) fn of(written: Option<&Spanned<String>>) -> Result<Self, Wrong> {
        let Some(name) = written else { return Ok(Self(1.0)) };
        let found = UNITS.iter().find(|(unit, _)| unit == name.get_ref());
        found.map(|(_, metres)| Self(*metres)).ok_or_else(|| {
            let names = UNITS.map(|(unit, _)| format!("`{unit}`")).join(", ");
            Wrong::at(name, format!("{:?} is no unit of length; expected one of {names}", name.get_ref()))
        })
    }

    pub(super) fn start(self, text: &StartText) -> Result<Pose, Wrong> {
        let value =
            |written: &Option<Spanned<f64>>, unit: Self| written.as_ref().map_or(Ok(0.0), |text| unit.length(text));
        Ok(Pose {
            x: Meters(value(&text.x, self)?),
            y: Meters(value(&text.y, self)?),
            theta: Radians::from_degrees(value(&text.heading, Self(1.0))?).wrapped(),
        })
    }

    pub(super) fn goal(self, text: &Spanned<TomlTable<GoalText>>) -> Result<Goal, Wrong> {
        let TomlTable(written) = text.get_ref();
        let (min, max) = (self.pair(&written.min, "`min`")?, self.pair(&written.max, "`max`")?);
        if min.x >= max.x || min.y >= max.y {
            let what = format!("a goal without an inside: it would reach from {min} to {max}");
            return Err(Wrong::at(&written.max, what));
        }
        let heading = match (&written.heading, &written.tolerance) {
            (Some(heading), Some(tolerance)) if (0.0..=180.0).contains(tolerance.get_ref()) => {
                let tolerance = Radians::from_degrees(*tolerance.get_ref());
                Some((Radians::from_degrees(Self(1.0).length(heading)?).wrapped(), tolerance))
            }
            (None, None) => None,
            (Some(_), Some(tolerance)) => return Err(Wrong::at(tolerance, "a tolerance is from 0 to 180 degrees")),
            (Some(_), None) | (None, Some(_)) => {
                let what = "a goal's `heading` needs a `tolerance` and the other way round, as in `heading = 90, tolerance = 15`";
                return Err(Wrong::at(text, what));
            }
        };
        Ok(Goal { zone: Zone::Rectangle { min, max }, heading })
    }

    pub(super) fn charger(self, text: &Spanned<TomlTable<ChargerText>>) -> Result<Charger, Wrong> {
        let TomlTable(ChargerText { at, heading, reach }) = text.get_ref();
        let Point { x, y } = self.pair(at, "`at`")?;
        let theta = Radians::from_degrees(Self(1.0).length(heading)?).wrapped();
        let metres = reach.as_ref().map_or(Ok(REACH), |reach| self.length(reach))?;
        match reach {
            Some(reach) if metres <= 0.0 => Err(Wrong::at(reach, "a charger without a reach: expected one above 0")),
            Some(_) | None => Ok(Charger { pose: Pose { x: Meters(x), y: Meters(y), theta }, reach: metres }),
        }
    }

    pub(super) fn wall(self, number: usize, text: &WallText, whole: f64) -> Result<Outline, Wrong> {
        let written = text.points.get_ref();
        if written.len() < 2 {
            let what = "a wall needs at least two points, as in `points = [[0, 0], [2.5, 0]]`";
            return Err(Wrong::at(&text.points, what));
        }
        let mut points: Vec<Point> = Vec::with_capacity(written.len());
        for point in written {
            let place = self.pair(point, "a point")?;
            if points.last() == Some(&place) {
                return Err(Wrong::at(point, format!("a wall of length zero: the point before it is {place} too")));
            }
            points.push(place);
        }
        let rough = rough(text.rough.as_ref(), whole)?;
        Ok(Outline { name: named(text.name.as_ref(), "wall", number), points, solid: false, rough })
    }

    pub(super) fn box_(self, number: usize, text: &Spanned<TomlTable<BoxText>>, whole: f64) -> Result<Stands, Wrong> {
        let TomlTable(written) = text.get_ref();
        let stops = self.schedule(written.schedule.as_ref())?;
        let first = stops.first().map(|stop| stop.at);
        let around = |Point { x, y }: Point, size: &Numbers| {
            let half = self.pair(size, "`size`")?;
            let (w, h) = (half.x / 2.0, half.y / 2.0);
            Ok((Point { x: x - w, y: y - h }, Point { x: x + w, y: y + h }))
        };
        let ((min, max), place) = match (&written.min, &written.max, &written.centre, &written.size, first) {
            (Some(min), Some(max), None, None, None) => ((self.pair(min, "`min`")?, self.pair(max, "`max`")?), max),
            (None, None, Some(centre), Some(size), None) => (around(self.pair(centre, "`centre`")?, size)?, size),
            (None, None, None, Some(size), Some(first)) => (around(first, size)?, size),
            (_, _, _, _, None) => {
                let what = "a box is given by its corners `min` and `max`, or by `centre` and `size`";
                return Err(Wrong::at(text, what));
            }
            (_, _, _, _, Some(_)) => {
                return Err(Wrong::at(text, "a box that moves is given by `size` and the centres of its `schedule`"));
            }
        };
        if min.x >= max.x || min.y >= max.y {
            return Err(Wrong::at(place, format!("a box without an inside: it would reach from {min} to {max}")));
        }
        let points = vec![min, Point { x: max.x, y: min.y }, max, Point { x: min.x, y: max.y }, min];
        let rough = rough(written.rough.as_ref(), whole)?;
        let outline = Outline { name: named(written.name.as_ref(), "box", number), points, solid: true, rough };
        Ok(standing(outline, stops, written.repeat))
    }

    pub(super) fn disc(self, number: usize, text: &Spanned<TomlTable<DiscText>>, whole: f64) -> Result<Stands, Wrong> {
        let TomlTable(written) = text.get_ref();
        let stops = self.schedule(written.schedule.as_ref())?;
        let centre = match (&written.centre, stops.first()) {
            (Some(centre), None) => self.pair(centre, "`centre`")?,
            (None, Some(first)) => first.at,
            (Some(_), Some(_)) | (None, None) => {
                return Err(Wrong::at(text, "a disc has a `radius` and a `centre`, or a `schedule` if it moves"));
            }
        };
        let radius = self.length(&written.radius)?;
        if radius <= 0.0 {
            return Err(Wrong::at(&written.radius, "a disc without an inside: expected a radius above 0"));
        }
        let corner = |number: u32| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(number % CORNERS) / f64::from(CORNERS));
            Point { x: centre.x + radius * cos, y: centre.y + radius * sin }
        };
        let points = (0..=CORNERS).map(corner).collect();
        let rough = rough(written.rough.as_ref(), whole)?;
        let outline = Outline { name: named(written.name.as_ref(), "disc", number), points, solid: true, rough };
        Ok(standing(outline, stops, written.repeat))
    }

    pub(super) fn door(self, number: usize, text: &TomlTable<DoorText>, whole: f64) -> Result<Thing, Wrong> {
        let TomlTable(written) = text;
        if written.points.get_ref().len() != 2 {
            return Err(Wrong::at(&written.points, "a door has two points, as in `points = [[0, 0], [0.9, 0]]`"));
        }
        let (points, rough) = (written.points.clone(), written.rough.clone());
        let wall = self.wall(number, &WallText { name: written.name.clone(), points, rough }, whole)?;
        let outline = Outline { name: named(written.name.as_ref(), "door", number), ..wall };
        let every = written.every.as_ref().map(|every| seconds(every).map(|value| (every, value))).transpose()?;
        let mut times: Vec<[f64; 2]> = Vec::new();
        for written in written.open.get_ref() {
            let [from, to] = written.get_ref().as_slice() else {
                return Err(Wrong::at(written, "a door is open from one time to another, as in `open = [[10, 25.5]]`"));
            };
            let (from, to) = (seconds(from)?, seconds(to)?);
            if from >= to || times.last().is_some_and(|[_, before]| from < *before) {
                return Err(Wrong::at(written, "times must follow one another"));
            }
            times.push([from, to]);
        }
        if let Some((every, value)) = every
            && (value <= 0.0 || times.last().is_some_and(|[_, last]| *last > value))
        {
            return Err(Wrong::at(every, "`every` must be after all the times it repeats, and above 0"));
        }
        Ok(Thing { outline, schedule: Schedule::Open { times, every: every.map(|(_, value)| value) } })
    }

    /// Returns the stops of a schedule; empty for an object without a schedule.
    fn schedule(self, written: Option<&Spanned<Vec<Numbers>>>) -> Result<Vec<Waypoint>, Wrong> {
        let Some(written) = written else { return Ok(Vec::new()) };
        if written.get_ref().is_empty() {
            return Err(Wrong::at(written, "a schedule needs a stop, as in `schedule = [[0, 1, 2], [5, 4, 2]]`"));
        }
        let mut stops: Vec<Waypoint> = Vec::new();
        for stop in written.get_ref() {
            let [t, x, y] = stop.get_ref().as_slice() else {
                return Err(Wrong::at(stop, "a stop is three numbers: seconds, and x and y of the centre"));
            };
            let (t, at) = (seconds(t)?, Point { x: self.length(x)?, y: self.length(y)? });
            if stops.last().is_some_and(|before| before.t >= t) {
                return Err(Wrong::at(stop, "the stops of a schedule must follow one another in time"));
            }
            stops.push(Waypoint { t, at });
        }
        Ok(stops)
    }

    pub(super) fn pair(self, written: &Numbers, what: &str) -> Result<Point, Wrong> {
        match written.get_ref().as_slice() {
            [x, y] => Ok(Point { x: self.length(x)?, y: self.length(y)? }),
            other => Err(Wrong::at(written, format!("{what} is two numbers, x and y in metres, not {}", other.len()))),
        }
    }

    fn length(self, written: &Spanned<f64>) -> Result<f64, Wrong> {
        let value = *written.get_ref() * self.0;
        if value.is_finite() && value.abs() <= FURTHEST {
            return Ok(value);
        }
        let kilometres = FURTHEST / 1000.0;
        let value = written.get_ref();
        Err(Wrong::at(written, format!("{value:e} is no coordinate: expected a number, at most {kilometres} km")))
    }
}

/// Returns the roughness given for the whole file or for one obstacle; `whole` if it is absent.
pub(super) fn rough(written: Option<&Spanned<f64>>, whole: f64) -> Result<f64, Wrong> {
    let Some(written) = written else { return Ok(whole) };
    let value = *written.get_ref();
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(Wrong::at(
        written,
        format!("`rough` is {value}; expected 0, for smooth surfaces, to 1, for those heard at any angle"),
    ))
}

fn seconds(written: &Spanned<f64>) -> Result<f64, Wrong> {
    let value = *written.get_ref();
    if (0.0..=1e9).contains(&value) {
        return Ok(value);
    }
    Err(Wrong::at(written, format!("{value:e} is no time: expected seconds since the start, from 0 on")))
}

fn standing(outline: Outline, stops: Vec<Waypoint>, repeats: bool) -> Stands {
    if stops.is_empty() {
        return Stands::Still(outline);
    }
    Stands::Never(Thing { outline, schedule: Schedule::Way { stops, repeats } })
}

fn named(given: Option<&String>, what: &str, number: usize) -> String {
    given.cloned().unwrap_or_else(|| format!("{what} {number}"))
}
