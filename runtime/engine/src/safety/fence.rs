//! A fence: a polygon that the centre of the robot must not leave. It limits only the speed.
//!
//! The input of a turn acts for a period, and its effect is measured only after that period, so two periods at
//! the new speed and the braking distance have to fit before the fence: `v·2T + v²/2a <= d`. A rule that
//! stopped the robot at a fixed distance would release it as soon as it stands still, and then stop it again,
//! turn by turn.

use mdle_runtime::Pose;

/// A polygon that the centre of the robot must not leave, in the axes of its odometry.
#[derive(Debug, Clone, PartialEq)]
pub struct Fence {
    /// Name of the fence in reports: `fence`, or `fence 2`.
    pub name: String,
    /// Corners in order, as x and y in metres: at least three, around an area.
    pub corners: Vec<[f64; 2]>,
    /// Distance from the edges at which the robot has to stop, in metres; at least 0.
    pub margin: f64,
    /// Deceleration that the robot is sure to reach when it brakes, in metres per second squared; above 0.
    pub deceleration: f64,
}

/// A vector or a point in the plane.
type Point = [f64; 2];

impl Fence {
    /// Returns the maximum speed, in metres per second, of a robot at this pose that has the speed `v` and the turn
    /// rate `omega`; `period` is in seconds. A negative `v` drives backwards.
    ///
    /// The robot continues to turn while it brakes, so every direction that it can have until it stands still
    /// counts.
    pub(super) fn fastest(&self, pose: &Pose, v: f64, omega: f64, period: f64) -> f64 {
        let here = [pose.x.0, pose.y.0];
        let backwards = if v < 0.0 { core::f64::consts::PI } else { 0.0 };
        let heading = pose.theta.0 + backwards;
        let late = 2.0 * period;
        if !self.contains(here) {
            // Back in is the only way.
            let is_inward = self.edges().any(|edge| hit(here, direction(heading), edge).is_some());
            return if is_inward { f64::INFINITY } else { 0.0 };
        }
        let turned = omega * (late + v.abs() / self.deceleration);
        let room = (self.room(here, heading, turned) - self.margin).max(0.0);
        self.deceleration * (libm::sqrt(late * late + 2.0 * room / self.deceleration) - late)
    }

    /// Returns the distance to the nearest point of the fence in the directions from `heading` to `heading + turned`.
    fn room(&self, here: Point, heading: f64, turned: f64) -> f64 {
        let (from, to) = if turned < 0.0 { (heading + turned, heading) } else { (heading, heading + turned) };
        let (first, last) = (direction(from), direction(to));
        let is_all = turned.abs() >= core::f64::consts::PI;
        let is_ahead =
            |[x, y]: Point| is_all || cross(first, [x, y]) >= 0.0 && cross([x, y], last) >= 0.0 && turned != 0.0;
        self.edges().fold(f64::INFINITY, |least, edge| {
            let along = [first, last].into_iter().filter_map(|way| hit(here, way, edge));
            let near = [nearest(here, edge), edge.0].into_iter().map(|point| [point[0] - here[0], point[1] - here[1]]);
            let near = near.filter(|way| is_ahead(*way)).map(|[x, y]| libm::hypot(x, y));
            along.chain(near).fold(least, f64::min)
        })
    }

    /// Returns `true` if the point is inside.
    pub(super) fn contains(&self, [x, y]: Point) -> bool {
        let crosses =
            |([ax, ay], [bx, by]): (Point, Point)| (ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay);
        self.edges().filter(|edge| crosses(*edge)).count() % 2 == 1
    }

    /// Returns the edges, from corner to corner.
    fn edges(&self) -> impl Iterator<Item = (Point, Point)> {
        self.corners.iter().copied().zip(self.corners.iter().copied().cycle().skip(1))
    }

    /// Returns the reason why the fence is invalid; `None` if it is valid.
    pub(super) fn fault(&self) -> Option<String> {
        let edges: Vec<_> = self.edges().collect();
        if let Some(number) = edges.iter().position(|(from, to)| from == to) {
            let [x, y] = self.corners.get(number).copied().unwrap_or_default();
            return Some(format!("the corner [{x}, {y}] comes twice in a row"));
        }
        for (number, one) in edges.iter().enumerate() {
            for (other, edge) in edges.iter().enumerate().skip(number + 2) {
                let are_neighbours = number == 0 && other == edges.len() - 1;
                if !are_neighbours && cross_over(*one, *edge) {
                    return Some(format!(
                        "the edge after corner {} crosses that after corner {}",
                        number + 1,
                        other + 1
                    ));
                }
            }
        }
        let area: f64 = edges.iter().map(|(from, to)| cross(*from, *to)).sum();
        if area.abs() < 1e-9 {
            return Some("there is no area inside".to_owned());
        }
        let side = |axis: usize| {
            let all = || self.corners.iter().map(|corner| corner[axis]);
            all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
        };
        let width = f64::min(side(0), side(1));
        (2.0 * self.margin >= width)
            .then(|| format!("a margin of {} m leaves no room: the fence is {width} m wide", self.margin))
    }
}

fn direction(heading: f64) -> Point {
    [libm::cos(heading), libm::sin(heading)]
}

fn cross([ax, ay]: Point, [bx, by]: Point) -> f64 {
    ax * by - ay * bx
}

/// Returns the distance from `here` along `way`, a unit vector, to the edge; `None` if the edge is not in that
/// direction.
fn hit(here: Point, way: Point, (from, to): (Point, Point)) -> Option<f64> {
    let edge = [to[0] - from[0], to[1] - from[1]];
    let between = [from[0] - here[0], from[1] - here[1]];
    let across = cross(way, edge);
    let along = cross(between, edge) / across;
    let part = cross(between, way) / across;
    (across != 0.0 && along >= 0.0 && (0.0..=1.0).contains(&part)).then_some(along)
}

/// Returns the point of the edge that is nearest to `here`.
fn nearest(here: Point, (from, to): (Point, Point)) -> Point {
    let edge = [to[0] - from[0], to[1] - from[1]];
    let length = edge[0] * edge[0] + edge[1] * edge[1];
    let part = ((here[0] - from[0]) * edge[0] + (here[1] - from[1]) * edge[1]) / length;
    let part = part.clamp(0.0, 1.0);
    [from[0] + part * edge[0], from[1] + part * edge[1]]
}

/// Returns `true` if the edges have a point in common.
fn cross_over(one: (Point, Point), other: (Point, Point)) -> bool {
    let side = |(from, to): (Point, Point), point: Point| {
        let way = cross([to[0] - from[0], to[1] - from[1]], [point[0] - from[0], point[1] - from[1]]);
        if way == 0.0 {
            0
        } else if way > 0.0 {
            1
        } else {
            -1
        }
    };
    let sides = (side(one, other.0), side(one, other.1), side(other, one.0), side(other, one.1));
    if sides == (0, 0, 0, 0) {
        let overlap = |axis: usize| {
            let [a, b, c, d] = [one.0, one.1, other.0, other.1].map(|point| point[axis]);
            a.max(b) >= c.min(d) && c.max(d) >= a.min(b)
        };
        return overlap(0) && overlap(1);
    }
    sides.0 * sides.1 <= 0 && sides.2 * sides.3 <= 0
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Meters, Radians};

    use super::*;

    fn hall() -> Fence {
        let corners = vec![[-0.5, -0.5], [2.0, -0.5], [2.0, 0.5], [-0.5, 0.5]];
        Fence { name: "fence".to_owned(), corners, margin: 0.03, deceleration: 0.5 }
    }

    fn at(x: f64, y: f64, degrees: f64) -> Pose {
        Pose { x: Meters(x), y: Meters(y), theta: Radians::from_degrees(degrees) }
    }

    #[test]
    fn two_periods_and_the_way_to_brake_fit() {
        for (x, y, degrees, v, distance) in [
            (0.0, 0.0, 0.0, 1.0, 2.0),
            (1.5, 0.0, 0.0, -1.0, 2.0),
            (1.9, 0.0, 0.0, 1.0, 0.1),
            (0.0, 0.0, 90.0, 1.0, 0.5),
        ] {
            let fastest = hall().fastest(&at(x, y, degrees), v, 0.0, 0.1);
            let way = fastest * 0.2 + fastest * fastest;
            assert!((way - (distance - 0.03)).abs() < 1e-9, "{x} {degrees}: {way}");
        }
        assert_eq!(hall().fastest(&at(1.98, 0.0, 0.0), 1.0, 0.0, 0.1), 0.0, "inside the margin");
    }

    #[test]
    fn a_robot_that_turns_keeps_clear_on_its_side() {
        // Along the upper edge, 10 cm from it.
        let fastest = |omega| hall().fastest(&at(0.0, 0.4, 0.0), 0.4, omega, 0.1);
        assert!(fastest(-0.5) > 1.2 && fastest(0.5) < 0.35, "away from the edge, and towards it");
        assert!(fastest(2.0) < 0.2 && fastest(2.0) > 0.1, "{}", fastest(2.0));
        assert!(fastest(0.1) > fastest(0.3) && fastest(0.3) > fastest(2.0));
    }

    #[test]
    fn from_outside_the_way_is_back() {
        assert_eq!(hall().fastest(&at(2.1, 0.0, 0.0), 0.3, 0.0, 0.1), 0.0);
        assert_eq!(hall().fastest(&at(2.1, 0.0, 0.0), -0.3, 0.0, 0.1), f64::INFINITY);
        assert_eq!(hall().fastest(&at(2.1, 0.0, 180.0), 0.3, 0.0, 0.1), f64::INFINITY);
    }

    #[test]
    fn an_impossible_fence_is_found() {
        let fault = |corners: &[Point], margin| {
            Fence { name: String::new(), corners: corners.to_vec(), margin, deceleration: 1.0 }
                .fault()
                .unwrap_or_default()
        };
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(fault(&square, 0.0), "");
        assert_eq!(fault(&square, 0.5), "a margin of 0.5 m leaves no room: the fence is 1 m wide");
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(fault(&bow, 0.0), "the edge after corner 1 crosses that after corner 3");
        assert_eq!(fault(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], 0.0), "there is no area inside");
        assert_eq!(fault(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]], 0.0), "the corner [1, 0] comes twice in a row");
        assert_eq!(
            fault(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.0], [0.0, 1.0]], 0.0),
            "the edge after corner 1 crosses that after corner 3"
        );
        // A concave fence is one.
        assert_eq!(fault(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]], 0.0), "");
    }
}
