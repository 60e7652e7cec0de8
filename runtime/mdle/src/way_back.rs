//! Computes the way back along a driven path, as a path that the law `path` can replay (paper, section IV-D).

use std::fmt::Write as _;

use mdle_runtime::{Pose, Radians};

/// Minimum distance between two recorded places, in metres. While the robot is closer to the last place, it is treated
/// as standing still.
const APART: f64 = 0.01;
/// Maximum number of neighbouring positions on each side that are averaged with a position.
const SMOOTHED: usize = 2;
/// Speed on the way back, in m/s.
const SPEED: f64 = 0.5;
/// Acceleration at the start of the way back, in m/s². It is limited because a robot that began at full speed would
/// drive beyond the end of the path.
const RAMP: f64 = 1.0;
/// Time between two rows, in seconds.
const ROW: f64 = 0.1;
/// Distance along the line, in metres, from a point to each of the two points that determine the heading at that point.
///
/// A path driven with `Follow` begins with a bend towards the leader, so the way back ends with that bend. A robot that
/// reacts late to a turn overshoots a sharp bend and drives off in that direction, so the next path begins with an even
/// sharper bend. With a distance of 5 cm, the angle between the last heading and the path doubles in each lap that
/// three Scouts drive.
const AHEAD: f64 = 0.2;
/// Length, in metres, below which a path is too short to be recorded.
const SHORTEST: f64 = 0.2;

/// Coordinates of a position, in metres.
type Place = [f64; 2];

/// The path that is being driven.
#[derive(Debug, Default)]
pub(crate) struct DrivenPath {
    places: Vec<Place>,
}

impl DrivenPath {
    /// Records the pose of the robot by odometry.
    pub(crate) fn went(&mut self, here: &Pose) {
        let place = [here.x.0, here.y.0];
        if self.places.last().is_none_or(|last| distance(last, &place) >= APART) {
            self.places.push(place);
        }
    }

    /// Returns the way back as the text of a path, whose headings are relative to `frame`; `None` if the path is too
    /// short.
    pub(crate) fn back(&self, frame: Radians) -> Option<String> {
        let reversed: Vec<Place> = self.places.iter().rev().copied().collect();
        let line = StraightLine::through(smoothed(&reversed));
        (line.length() >= SHORTEST).then(|| rows(&line, frame))
    }
}

fn distance(one: &Place, other: &Place) -> f64 {
    libm::hypot(one[0] - other[0], one[1] - other[1])
}

/// Returns each position as the mean of the positions around it. On both sides, the same number of positions is used,
/// so that the ends do not move.
fn smoothed(places: &[Place]) -> Vec<Place> {
    let mean = |number: usize| {
        let beside = SMOOTHED.min(number).min(places.len() - 1 - number);
        let around = places.get(number - beside..=number + beside).unwrap_or_default();
        [0, 1].map(|axis| around.iter().map(|place| place[axis]).sum::<f64>() / around.len() as f64)
    };
    (0..places.len()).map(mean).collect()
}

/// A line through positions, parameterized by the length along the line.
struct StraightLine {
    places: Vec<Place>,
    /// Length from the start of the line to each position, in metres.
    lengths: Vec<f64>,
}

impl StraightLine {
    fn through(places: Vec<Place>) -> Self {
        let mut lengths = Vec::with_capacity(places.len());
        let (mut length, mut last) = (0.0, None);
        for place in &places {
            length += last.map_or(0.0, |last| distance(last, place));
            lengths.push(length);
            last = Some(place);
        }
        Self { places, lengths }
    }

    fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Returns the position at this length along the line. If the length is outside the line, returns the nearer end.
    fn at(&self, length: f64) -> Place {
        let next = self.lengths.partition_point(|other| *other <= length).clamp(1, self.places.len().max(2) - 1);
        let place = |number: usize| self.places.get(number).copied().unwrap_or_default();
        let of = |number: usize| self.lengths.get(number).copied().unwrap_or_default();
        let (from, to) = (next - 1, next);
        let part = ((length - of(from)) / (of(to) - of(from)).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        [0, 1].map(|axis| place(from)[axis] + part * (place(to)[axis] - place(from)[axis]))
    }

    /// Returns the direction of the line at this length.
    fn heading(&self, length: f64) -> f64 {
        let (from, to) = (self.at((length - AHEAD).max(0.0)), self.at((length + AHEAD).min(self.length())));
        libm::atan2(to[1] - from[1], to[0] - from[0])
    }
}

/// Returns the rows of a path along a line. The path begins at rest and ends at full speed.
fn rows(line: &StraightLine, frame: Radians) -> String {
    let (ramp, length) = (SPEED / RAMP, line.length());
    let on_ramp = RAMP * ramp * ramp / 2.0;
    let end = if length < on_ramp { libm::sqrt(2.0 * length / RAMP) } else { ramp + (length - on_ramp) / SPEED };
    let mut text = "time s, heading deg, speed cm/s\n".to_owned();
    let mut row = |t: f64| {
        let along = if t < ramp { RAMP * t * t / 2.0 } else { on_ramp + SPEED * (t - ramp) };
        let heading = Radians(line.heading(along.min(length)) - frame.0).wrapped().degrees();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{t:.3}, {heading:.4}, {:.4}", (RAMP * t).min(SPEED) * 100.0);
    };
    let count = libm::ceil((end - ROW / 2.0) / ROW) as u32;
    (0..count.max(1)).for_each(|number| row(f64::from(number) * ROW));
    row(end);
    text
}

#[cfg(test)]
mod tests {
    use mdle_host::setpoints;
    use mdle_runtime::{Meters, MetersPerSecond, RadiansPerSecond, Twist};

    use super::*;

    /// Returns a way along these places, on which the robot rests at each place.
    fn way(places: impl Iterator<Item = Place>) -> DrivenPath {
        let mut way = DrivenPath::default();
        for [x, y] in places {
            for _ in 0..3 {
                way.went(&Pose { x: Meters(x), y: Meters(y), theta: Radians(0.0) });
            }
        }
        way
    }

    /// Returns the final position of an ideal robot that drives the path `text` in a frame with the heading `frame`,
    /// and the duration of the path in seconds.
    fn driven(text: &str, frame: f64) -> (Place, f64) {
        let fastest = Twist { v: MetersPerSecond(1.0), omega: RadiansPerSecond(6.0) };
        let path = setpoints("back.csv", text.as_bytes(), fastest).unwrap();
        let mut place = [0.0, 0.0];
        for pair in path.windows(2) {
            let seconds = pair[1].at.since(pair[0].at).seconds();
            let turn = Radians(pair[1].heading.0 - pair[0].heading.0).wrapped().0;
            let (heading, speed) = (pair[0].heading.0 + turn / 2.0 + frame, (pair[0].speed.0 + pair[1].speed.0) / 2.0);
            place[0] += seconds * speed * libm::cos(heading);
            place[1] += seconds * speed * libm::sin(heading);
        }
        (place, path.last().unwrap().at.seconds())
    }

    #[test]
    fn the_way_back_leads_to_where_the_way_began() {
        let bend = |s: f64| {
            let sine = libm::sin(std::f64::consts::PI * s);
            [3.75 * s, 0.75 * s * s * (3.0 - 2.0 * s) + 1.3 * sine * sine]
        };
        let there = || (0..=100).map(|number| bend(f64::from(number) / 100.0));
        for frame in [0.0, 1.0, -3.0] {
            let text = way(there()).back(Radians(frame)).unwrap();
            let (place, seconds) = driven(&text, frame);
            let off = libm::hypot(place[0] + 3.75, place[1] + 0.75);
            assert!(off < 0.03, "{off} m off with {frame}");
            assert!((9.5..10.0).contains(&seconds), "4.75 m at 0.5 m/s, and the ramp: {seconds} s");
        }
    }

    #[test]
    fn a_bend_at_the_end_of_the_way_back_is_smoothed() {
        // The way begins with 10 cm at 40° to the rest of it.
        let (sin, cos) = libm::sincos(Radians::from_degrees(40.0).0);
        let bend = (0..10).map(|number| 0.01 * f64::from(number)).map(|s| [s * cos, s * sin]);
        let rest = (0..200).map(|number| 0.01 * f64::from(number)).map(|s| [0.1 * cos + s, 0.1 * sin]);
        let text = way(bend.chain(rest)).back(Radians::from_degrees(180.0)).unwrap();
        let headings: Vec<f64> =
            text.lines().skip(1).map(|row| row.split(", ").nth(1).unwrap().parse().unwrap()).collect();
        let last = *headings.last().unwrap();
        assert!((5.0..25.0).contains(&last), "{last}");
        let steepest = headings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(steepest < 8.0, "{steepest}° in a tenth of a second: {headings:?}");
    }

    #[test]
    fn a_robot_that_stood_has_no_way_back() {
        assert_eq!(way(std::iter::empty()).back(Radians(0.0)), None);
        assert_eq!(way(std::iter::once([1.0, 1.0])).back(Radians(0.0)), None);
        assert_eq!(way([[0.0, 0.0], [0.1, 0.0]].into_iter()).back(Radians(0.0)), None);
        assert!(way([[0.0, 0.0], [0.3, 0.0]].into_iter()).back(Radians(0.0)).is_some());
    }

    #[test]
    fn a_straight_way_is_straight_and_begins_from_rest() {
        let text = way((0..=200).map(|number| [0.01 * f64::from(number), 0.0])).back(Radians(0.0)).unwrap();
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(
            &rows[..3],
            ["time s, heading deg, speed cm/s", "0.000, 180.0000, 0.0000", "0.100, 180.0000, 10.0000"]
        );
        assert_eq!(rows.last(), Some(&"4.250, 180.0000, 50.0000"));
    }
}
