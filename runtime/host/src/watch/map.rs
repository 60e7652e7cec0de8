//! Draws the floor as dots: first the walls and the goal, then the driven path, and on top of these the robot with its
//! echoes.

use mdle_runtime::{Meters, Radians};
use mdle_simulator::{Footprint, Form, Point, Thing, World, Zone, edge};

use super::canvas::{Canvas, Ink};

/// Margin around the drawing, in metres.
const AROUND: f64 = 0.3;
/// Minimum radius of a body whose edge is drawn, in dots.
const BODY_LEAST: f64 = 2.5;
/// Number of dots of a body's edge.
const BODY_DOTS: u32 = 60;
/// Arrows for eight headings of a robot, counter-clockwise from the direction of the x axis.
const ARROWS: [char; 8] = ['→', '↗', '↑', '↖', '←', '↙', '↓', '↘'];

/// A map for one size of the terminal.
#[derive(Debug, Clone)]
pub(super) struct Map {
    canvas: Canvas,
    /// Position of the upper left corner, in metres.
    corner: Point,
    /// Number of dots per metre.
    scale: f64,
    /// Number of positions of the driven path that have been drawn.
    way_count: usize,
    /// Number of positions of earlier echoes that have been drawn.
    echo_count: usize,
}

impl Map {
    /// Returns a map that is `columns` wide and `rows` high, and shows a floor with the positions in `way` and
    /// `echoes`.
    pub(super) fn of(world: &World, way: &[Point], echoes: &[Point], columns: usize, rows: usize) -> Self {
        let places = || world.places().chain(way.iter().chain(echoes).copied());
        let range = |of: fn(&Point) -> f64| {
            let least = places().map(|place| of(&place)).fold(f64::INFINITY, f64::min);
            let most = places().map(|place| of(&place)).fold(f64::NEG_INFINITY, f64::max);
            (least - AROUND, most + AROUND)
        };
        let ((left, right), (low, high)) = (range(|place| place.x), range(|place| place.y));
        let (wide, tall) = (2.0 * columns as f64, 4.0 * rows as f64);
        let scale = (wide / (right - left)).min(tall / (high - low));
        // Centres the drawing.
        let corner = Point { x: (left + right) / 2.0 - wide / scale / 2.0, y: (low + high) / 2.0 + tall / scale / 2.0 };
        let mut map = Self { canvas: Canvas::new(columns, rows), corner, scale, way_count: 0, echo_count: 0 };
        match world.goal.map(|goal| goal.zone) {
            Some(Zone::Rectangle { min, max }) => map.rectangle(min, max),
            Some(Zone::Circle { center, radius }) => {
                edge(center, radius).for_each(|place| map.dot(place, Ink::Goal));
            }
            None => {}
        }
        if let Some(charger) = &world.charger {
            charger.circle().for_each(|place| map.dot(place, Ink::Charger));
        }
        for (_, from, to) in world.segments() {
            map.line(from, to, Ink::Wall);
        }
        map
    }

    /// Returns `true` if the map has this size.
    pub(super) fn is_of(&self, columns: usize, rows: usize) -> bool {
        (self.canvas.columns, self.canvas.rows) == (columns, rows)
    }

    /// Returns `true` if a position is on the map.
    pub(super) fn shows(&self, place: Point) -> bool {
        let (x, y) = self.at(place);
        (0.0..2.0 * self.canvas.columns as f64).contains(&x) && (0.0..4.0 * self.canvas.rows as f64).contains(&y)
    }

    /// Returns `true` if all echoes that have not been drawn yet are on the map.
    pub(super) fn shows_new(&self, echoes: &[Point]) -> bool {
        echoes.iter().skip(self.echo_count).all(|place| self.shows(*place))
    }

    /// Draws the earlier echoes that have not been drawn yet.
    pub(super) fn draw_echoes(&mut self, echoes: &[Point]) {
        for place in echoes.iter().skip(self.echo_count) {
            self.dot(*place, Ink::Wall);
        }
        self.echo_count = echoes.len();
    }

    /// Draws the part of the driven path that has not been drawn yet.
    pub(super) fn draw_way(&mut self, way: &[Point]) {
        for place in way.iter().skip(self.way_count) {
            self.dot(*place, Ink::Way);
        }
        self.way_count = way.len();
    }

    /// Returns a copy of the map with the moving objects drawn, each at its displacement.
    pub(super) fn with<'t>(&self, things: impl Iterator<Item = (&'t Thing, Point)>) -> Self {
        let mut map = self.clone();
        for (thing, displacement) in things {
            for (from, to) in thing.corners(displacement).zip(thing.corners(displacement).skip(1)) {
                map.line(from, to, Ink::Wall);
            }
        }
        map
    }

    /// Draws the echoes that the robot receives at present.
    pub(super) fn draw_current_echoes(&mut self, echoes: &[Point]) {
        for echo in echoes {
            self.dot(*echo, Ink::Echo);
        }
    }

    /// Returns the rows of the map with the robot on it.
    pub(super) fn rows(mut self, robot: &Footprint, touches: bool) -> Vec<String> {
        let pose = &robot.pose;
        self.body(robot);
        let eighths = libm::round(pose.theta.degrees() / 45.0) as i64;
        let arrow = usize::try_from(eighths.rem_euclid(8)).ok().and_then(|eighth| ARROWS.get(eighth)).unwrap_or(&'?');
        // Red if the robot touches an obstacle.
        let sign = format!("\x1b[0;1;97;{}m{arrow}", if touches { 41 } else { 44 });
        let (x, y) = self.at(Point::of(pose));
        self.canvas.text(Some((((x / 2.0).max(0.0) as usize, (y / 4.0).max(0.0) as usize), &sign)))
    }

    /// Converts a position to dots from the upper left corner.
    fn at(&self, place: Point) -> (f64, f64) {
        ((place.x - self.corner.x) * self.scale, (self.corner.y - place.y) * self.scale)
    }

    fn dot(&mut self, place: Point, ink: Ink) {
        let (x, y) = self.at(place);
        self.canvas.dot(libm::floor(x) as i64, libm::floor(y) as i64, ink);
    }

    fn line(&mut self, from: Point, to: Point, ink: Ink) {
        let ((x1, y1), (x2, y2)) = (self.at(from), self.at(to));
        let steps = libm::ceil((x2 - x1).abs().max((y2 - y1).abs())).max(1.0);
        for step in 0..=steps as u32 {
            let part = f64::from(step) / steps;
            let (x, y) = (x1 + (x2 - x1) * part, y1 + (y2 - y1) * part);
            self.canvas.dot(libm::floor(x) as i64, libm::floor(y) as i64, ink);
        }
    }

    /// Draws the edge of the body, unless the body is so small that the robot's arrow covers it.
    fn body(&mut self, robot: &Footprint) {
        if robot.form.radius() * self.scale < BODY_LEAST {
            return;
        }
        for (from, to) in robot.edges() {
            self.line(from, to, Ink::Wall);
        }
        let Form::Disc { radius } = robot.form else { return };
        for number in 0..BODY_DOTS {
            let bearing = Radians::from_degrees(f64::from(number) * (360.0 / f64::from(BODY_DOTS)));
            self.dot(Point::of(&robot.pose.towards(bearing, Meters(radius))), Ink::Wall);
        }
    }

    /// Draws every second dot of the edge of a rectangular goal.
    fn rectangle(&mut self, min: Point, max: Point) {
        let ((left, low), (right, high)) = (self.at(min), self.at(max));
        let within = |value: f64, most: usize| value.clamp(0.0, most as f64) as i64;
        let (left, right) = (within(left, 2 * self.canvas.columns), within(right, 2 * self.canvas.columns));
        let (high, low) = (within(high, 4 * self.canvas.rows), within(low, 4 * self.canvas.rows));
        for x in (left..=right).step_by(2) {
            self.canvas.dot(x, high, Ink::Goal);
            self.canvas.dot(x, low, Ink::Goal);
        }
        for y in (high..=low).step_by(2) {
            self.canvas.dot(left, y, Ink::Goal);
            self.canvas.dot(right, y, Ink::Goal);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mdle_runtime::Pose;

    fn shown(columns: usize, rows: usize) -> String {
        let world = World::office().unwrap();
        let way: Vec<Point> = (0..430).map(|step| Point { x: 0.0, y: f64::from(step) * 0.01 }).collect();
        let mut map = Map::of(&world, &way, &[], columns, rows);
        map.draw_way(&way);
        let pose = Pose { x: Meters(0.0), y: Meters(4.3), theta: Radians::from_degrees(90.0) };
        assert!(map.shows(Point::of(&pose)) && map.is_of(columns, rows));
        map.draw_current_echoes(&[Point { x: 0.0, y: 8.0 }]);
        let text = map.rows(&Footprint { pose, form: Form::Disc { radius: 0.205 } }, false).join("\n");
        // Removes the colour codes.
        let mut plain = text.split('\x1b').map(|part| part.split_once('m').map_or(part, |(_, rest)| rest));
        plain.by_ref().collect()
    }

    #[test]
    fn the_office_is_seen_whole() {
        insta::assert_snapshot!(shown(78, 20));
    }

    #[test]
    fn a_floor_of_unknown_walls_has_the_echoes_so_far() {
        let place = |x, y| Point { x, y };
        let (way, mut echoes) = (vec![place(0.0, 0.0), place(1.0, 0.0)], vec![place(1.5, 1.0), place(1.5, -1.0)]);
        let mut map = Map::of(&World::empty(), &way, &echoes, 40, 20);
        assert!(echoes.iter().all(|echo| map.shows(*echo)) && !map.shows(place(5.0, 0.0)));
        map.draw_echoes(&echoes);
        let dots = |map: Map| map.canvas.text(None).concat().chars().filter(|letter| *letter > '\u{2800}').count();
        assert_eq!((map.echo_count, dots(map.clone())), (2, 2));
        echoes.push(place(5.0, 0.0));
        assert!(!map.shows_new(&echoes));
        assert!(Map::of(&World::empty(), &way, &echoes, 40, 20).shows_new(&echoes));
    }

    #[test]
    fn every_size_will_do() {
        for (columns, rows) in [(1, 1), (2, 50), (300, 1), (200, 100)] {
            assert!(shown(columns, rows).contains('↑'), "{columns} {rows}");
        }
        let nothing = Map::of(&World::empty(), &[], &[], 0, 0);
        assert!(nothing.rows(&Footprint { pose: Pose::ORIGIN, form: Form::Disc { radius: 0.205 } }, true).is_empty());
    }
}
