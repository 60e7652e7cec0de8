//! Draws the trips of several robots: one floor per robot, and one line per trip, as in the paper's Fig. 12.

use mdle_runtime::Pose;
use svg::Document;
use svg::node::element::{Group, Path, Rectangle, Style, Title};

use super::colours::{class, style};
use super::layout::round_step;
use super::shapes::{Pixel, circle, line, polyline, simplified, tenths, text};
use super::sizes::MARGIN;
use super::view::range;
use crate::point::Point;

/// Width of a picture, in pixels.
const WIDTH: f64 = 960.0;
/// Width of the labels to the left of a drawn floor, and width of the list of trips to its right, in pixels.
const SIDES: (f64, f64) = (40.0, 230.0);
/// Maximum height of a floor, in pixels.
const HIGH: f64 = 420.0;
/// Height of the labels below a floor, in pixels.
const BELOW: f64 = 34.0;
/// Height of a line of text, in pixels.
const LINE: f64 = 20.0;
/// Maximum number of trips in the list.
const LISTED: usize = 16;
/// Minimum distance between two circles on the first trip, in pixels.
const CIRCLES: f64 = 14.0;
/// Minimum length of a trip, in metres; a shorter trip is not listed.
const SHORTEST: f64 = 0.2;
/// Minimum distance between two labels of an axis, in pixels.
const APART: f64 = 50.0;

/// Trips of several robots. A trip is the path that a robot drives under the law `path` or `Follow`.
#[derive(Debug, Clone)]
pub struct TripDrawing {
    title: String,
    robots: Vec<RobotTrips>,
}

/// Trips of a robot.
#[derive(Debug, Clone)]
struct RobotTrips {
    name: String,
    trips: Vec<Vec<Point>>,
    /// `true` while `path` or `Follow` runs.
    is_on_trip: bool,
}

/// Returns the length of a path, in metres, and the percentage by which it exceeds the distance between its ends.
fn figures(way: &[Point]) -> (f64, f64) {
    let apart = |one: &Point, other: &Point| libm::hypot(one.x - other.x, one.y - other.y);
    let length: f64 = way.windows(2).map(|pair| apart(&pair[0], &pair[1])).sum();
    let chord = way.first().zip(way.last()).map_or(0.0, |(first, last)| apart(first, last));
    (length, (length / chord.max(f64::MIN_POSITIVE) - 1.0) * 100.0)
}

impl TripDrawing {
    /// Begins the record; `title` describes the run.
    #[must_use]
    pub fn of(title: &str) -> Self {
        Self { title: title.to_owned(), robots: Vec::new() }
    }

    /// Records that the robot `name` is at `pose` while `law` runs; `begins` is `true` if the law has just begun.
    pub fn went(&mut self, name: &str, pose: &Pose, law: &str, begins: bool) {
        let number = self.robots.iter().position(|robot| robot.name == name).unwrap_or_else(|| {
            self.robots.push(RobotTrips { name: name.to_owned(), trips: Vec::new(), is_on_trip: false });
            self.robots.len() - 1
        });
        let Some(robot) = self.robots.get_mut(number) else { return };
        let is_trip = law.starts_with("path ") || law.starts_with("Follow ");
        let has_ended = robot.is_on_trip && (begins || !is_trip);
        if let Some(trip) = robot.trips.last_mut().filter(|_| robot.is_on_trip) {
            trip.push(Point::of(pose));
        }
        if has_ended && robot.trips.last().is_some_and(|trip| figures(trip).0 < SHORTEST) {
            robot.trips.pop();
        }
        if is_trip && (begins || !robot.is_on_trip) {
            robot.trips.push(vec![Point::of(pose)]);
        }
        robot.is_on_trip = is_trip;
    }

    /// Draws the trips as an SVG picture.
    #[must_use]
    pub fn picture(&self) -> String {
        let places = || self.robots.iter().flat_map(|robot| robot.trips.iter().flatten());
        let (x, y) = (range(places().map(|place| place.x)), range(places().map(|place| place.y)));
        let is_empty = places().next().is_none();
        let grown = |(least, most): (f64, f64)| if is_empty { (0.0, 1.0) } else { (least - 0.2, most + 0.2) };
        let floor = Floor::of(grown(x), grown(y));
        let panel = floor.height + BELOW + LINE + MARGIN;
        let height = MARGIN + LINE + self.robots.len() as f64 * panel;
        let document = Document::new().set("viewBox", (0, 0, WIDTH, tenths(height))).set("width", WIDTH);
        let document = document.set("height", tenths(height)).set("font-family", "sans-serif").set("font-size", 13);
        let paper = Rectangle::new().set("width", WIDTH).set("height", tenths(height)).set("class", "paper");
        let document = document.add(Title::new(&self.title)).add(Style::new(style())).add(paper);
        let document = document.add(text(&self.title, (MARGIN, MARGIN), "start"));
        let document = self.robots.iter().enumerate().fold(document, |document, (number, robot)| {
            document.add(floor.drawn(robot, MARGIN + LINE + number as f64 * panel))
        });
        format!("{document}\n")
    }
}

/// Part of the floor that all panels show, and its size in pixels.
struct Floor {
    x: (f64, f64),
    y: (f64, f64),
    scale: f64,
    height: f64,
}

impl Floor {
    fn of(x: (f64, f64), y: (f64, f64)) -> Self {
        let wide = WIDTH - 2.0 * MARGIN - SIDES.0 - SIDES.1;
        let scale = (wide / (x.1 - x.0)).min(HIGH / (y.1 - y.0));
        Self { x, y, scale, height: ((y.1 - y.0) * scale).max(LINE * LISTED as f64 / 2.0) }
    }

    /// Returns the pixel of a point on the floor; `top` is the height of the upper edge of the drawn floor.
    fn at(&self, place: &Point, top: f64) -> Pixel {
        (MARGIN + SIDES.0 + (place.x - self.x.0) * self.scale, top + (self.y.1 - place.y) * self.scale)
    }

    /// Draws the floor of a robot, with its upper edge at `top`.
    fn drawn(&self, robot: &RobotTrips, top: f64) -> Group {
        let name = text(&robot.name, (MARGIN + SIDES.0, top + LINE / 2.0), "start").set("font-weight", "bold");
        let top = top + LINE;
        let group = Group::new().add(name).add(self.axes(top));
        let right = MARGIN + SIDES.0 + (self.x.1 - self.x.0) * self.scale + 16.0;
        robot.trips.iter().enumerate().fold(group, |group, (number, trip)| {
            let pixels: Vec<Pixel> = trip.iter().map(|place| self.at(place, top)).collect();
            let way = polyline(simplified(pixels.iter().copied()));
            let way = way.set("class", class("way", number)).set("stroke-width", 2);
            let group = group.add(way).add(if number == 0 { circles(&pixels) } else { Group::new() });
            if number < LISTED {
                group.add(listed(number, trip, (right, top + LINE * (number as f64 + 0.5))))
            } else {
                group
            }
        })
    }

    fn axes(&self, top: f64) -> Group {
        let step = round_step(APART / self.scale);
        let corner = |x: f64, y: f64| self.at(&Point { x, y }, top);
        let mut group = Group::new().set("font-size", 12);
        let multiples = |(least, most): (f64, f64)| {
            let (first, last) = (libm::ceil(least / step) as i64, libm::floor(most / step) as i64);
            (first..=last).map(move |times| times as f64 * step)
        };
        let number = |value: f64| format!("{} m", libm::round(value * 100.0) / 100.0 + 0.0);
        for x in multiples(self.x) {
            let (low, high) = (corner(x, self.y.0), corner(x, self.y.1));
            group = group.add(line(low, high).set("class", "grid"));
            group = group.add(text(&number(x), (low.0, low.1 + 13.0), "middle"));
        }
        for y in multiples(self.y) {
            let (left, right) = (corner(self.x.0, y), corner(self.x.1, y));
            group = group.add(line(left, right).set("class", "grid"));
            group = group.add(text(&number(y), (left.0 - 6.0, left.1), "end"));
        }
        group
    }
}

/// Draws small circles along the first trip.
fn circles(pixels: &[Pixel]) -> Group {
    let mut last: Option<Pixel> = None;
    pixels.iter().fold(Group::new().set("class", "ink").set("fill", "none"), |group, at| {
        if last.is_some_and(|last| libm::hypot(last.0 - at.0, last.1 - at.1) < CIRCLES) {
            return group;
        }
        last = Some(*at);
        group.add(circle(*at, 3.0))
    })
}

/// Draws the entry of a trip in the list.
fn listed(number: usize, trip: &[Point], (x, y): Pixel) -> Group {
    let (length, excess) = figures(trip);
    let words = format!("trip {}: {length:.2} m, {excess:.1} % longer", number + 1);
    let sample = Path::new().set("d", format!("M{} {}h18", tenths(x), tenths(y)));
    let sample = sample.set("class", class("way", number)).set("stroke-width", 3);
    Group::new().add(sample).add(text(&words, (x + 26.0, y), "start"))
}

#[cfg(test)]
mod tests {
    use mdle_runtime::Meters;

    use super::*;

    #[test]
    fn a_trip_is_a_way_of_path_or_follow() {
        let mut drawing = TripDrawing::of("a run");
        let mut went = |x: f64, y: f64, law: &str, begins: bool| {
            let pose = Pose { x: Meters(x), y: Meters(y), ..Pose::ORIGIN };
            drawing.went("ada", &pose, law, begins);
        };
        went(0.0, 0.0, "path lastPath", true);
        went(1.0, 1.0, "path lastPath", false);
        went(2.0, 0.0, "go 50 0", true);
        went(3.0, 0.0, "Follow bob", true);
        went(4.0, 0.0, "Follow bob", false);
        went(5.0, 0.0, "stop", true);
        went(5.0, 0.0, "Follow bob", true);
        went(5.1, 0.0, "stop", true);
        let picture = drawing.picture();
        let has = |words: &str| picture.lines().any(|line| line == words);
        assert!(has("trip 1: 2.83 m, 41.4 % longer") && has("trip 2: 2.00 m, 0.0 % longer"), "{picture}");
        assert!(!picture.contains("trip 3"), "10 cm are no trip: {picture}");
        assert!(TripDrawing::of("nothing").picture().contains("nothing"));
    }
}
