//! A fence: a polygon that the centre of the robot must not leave. A fence limits only the speed.
//!
//! The input of a turn acts for one period, and its effect is measured only after this period. Therefore, the distance
//! driven in two periods at the new speed plus the braking distance must not exceed the distance to the fence: `v·2T +
//! v²/2a <= d`. A rule that stopped the robot at a fixed distance would release the robot as soon as it has stopped,
//! and then stop it again, turn after turn.

use mdle_runtime::Pose;

use super::plane::{Edge, Point, between, cross, cross_over, direction, dot, hit, nearest, reach};

/// A polygon that the centre of the robot must not leave, in odometry coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Fence {
    /// Name of the fence in reports: `fence`, or `fence 2`.
    pub name: String,
    /// Corners in order, each as x and y in metres. There are at least three corners, and they enclose an area.
    pub corners: Vec<[f64; 2]>,
    /// Distance from the edges at which the robot has to stop, in metres; at least 0.
    pub margin: f64,
    /// Guaranteed braking deceleration of the robot, in metres per second squared; above 0.
    pub deceleration: f64,
}

impl Fence {
    /// Returns the maximum speed, in metres per second, of a robot at this pose with the speed `v` and the turn rate
    /// `omega`; `period` is in seconds. A negative `v` means that the robot drives backwards.
    ///
    /// The robot continues to turn while it brakes, so the result is valid for all directions that the robot can have
    /// until it stops.
    pub(super) fn fastest(&self, pose: &Pose, v: f64, omega: f64, period: f64) -> f64 {
        let here = [pose.x.0, pose.y.0];
        let backwards = if v < 0.0 { core::f64::consts::PI } else { 0.0 };
        let heading = pose.theta.0 + backwards;
        let late = 2.0 * period;
        let turned = omega * (late + v.abs() / self.deceleration);
        let room =
            if self.contains(here) { self.room(here, heading, turned) } else { self.way_in(here, heading, turned) };
        self.deceleration * (libm::sqrt(late * late + 2.0 * room / self.deceleration) - late)
    }

    /// Returns the distance that a robot outside the fence may drive: it may enter the fence, and drive up to the
    /// margin of the edge at which it would leave the fence again. Returns 0 unless the robot approaches the fence in
    /// all directions from `heading` to `heading + turned`.
    fn way_in(&self, here: Point, heading: f64, turned: f64) -> f64 {
        let to_fence = self.edges().map(|edge| between(here, nearest(here, edge)));
        let [x, y] = to_fence
            .min_by(|[ax, ay], [bx, by]| libm::hypot(*ax, *ay).total_cmp(&libm::hypot(*bx, *by)))
            .unwrap_or_default();
        let is_nearer = |heading| dot(direction(heading), [x, y]) > 0.0;
        if turned.abs() >= core::f64::consts::PI || !is_nearer(heading) || !is_nearer(heading + turned) {
            return 0.0;
        }
        let hits = || self.edges().filter_map(|edge| hit(here, direction(heading), edge));
        let entry = hits().fold(f64::INFINITY, f64::min);
        let exit = hits().filter(|distance| *distance > entry).fold(f64::INFINITY, f64::min);
        if exit.is_finite() { (exit - self.margin).max(0.0) } else { 0.0 }
    }

    /// Returns the distance that the robot may drive in any direction from `heading` to `heading + turned` before it
    /// comes within the margin of an edge.
    fn room(&self, here: Point, heading: f64, turned: f64) -> f64 {
        let (from, to) = if turned < 0.0 { (heading + turned, heading) } else { (heading, heading + turned) };
        let (first, last) = (direction(from), direction(to));
        let is_all = turned.abs() >= core::f64::consts::PI;
        let is_ahead =
            |[x, y]: Point| is_all || cross(first, [x, y]) >= 0.0 && cross([x, y], last) >= 0.0 && turned != 0.0;
        self.edges().fold(f64::INFINITY, |least, edge| {
            let along = [first, last].into_iter().filter_map(|way| reach(here, way, edge, self.margin));
            let near = [nearest(here, edge), edge.0].into_iter().map(|point| between(here, point));
            let near = near.filter(|way| is_ahead(*way)).map(|[x, y]| (libm::hypot(x, y) - self.margin).max(0.0));
            along.chain(near).fold(least, f64::min)
        })
    }

    /// Returns `true` if the point is inside.
    pub(super) fn contains(&self, [x, y]: Point) -> bool {
        let crosses = |([ax, ay], [bx, by]): Edge| (ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay);
        self.edges().filter(|edge| crosses(*edge)).count() % 2 == 1
    }

    /// Returns the edges, from corner to corner.
    pub(super) fn edges(&self) -> impl Iterator<Item = Edge> {
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
        // The robot drives along the upper edge, 10 cm from it.
        let fastest = |omega| hall().fastest(&at(0.0, 0.4, 0.0), 0.4, omega, 0.1);
        assert!(fastest(-0.5) > 1.2 && fastest(0.5) < 0.35, "away from the edge, and towards it");
        assert!(fastest(2.0) < 0.2 && fastest(2.0) > 0.1, "{}", fastest(2.0));
        assert!(fastest(0.1) > fastest(0.3) && fastest(0.3) > fastest(2.0));
    }

    #[test]
    fn from_outside_the_way_is_back() {
        assert_eq!(hall().fastest(&at(2.1, 0.0, 0.0), 0.3, 0.0, 0.1), 0.0);
        for (degrees, v) in [(0.0, -0.3), (180.0, 0.3)] {
            let fastest = hall().fastest(&at(2.1, 0.0, degrees), v, 0.0, 0.1);
            let way = fastest * 0.2 + fastest * fastest;
            assert!((way - 2.57).abs() < 1e-9, "so that it stops at the other edge: {way}");
        }
        assert_eq!(hall().fastest(&at(2.1, 0.0, 95.0), 0.3, -0.3, 0.1), 0.0, "it would turn away");
        assert_eq!(hall().fastest(&at(2.1, 0.0, 100.0), 0.3, 0.0, 0.1), 0.0, "past the fence");
    }

    /// In a notch between two arms of the fence, a robot that leaves one arm must not drive on to the other arm.
    #[test]
    fn a_notch_is_not_crossed() {
        let corners =
            vec![[-1.0, -1.0], [4.0, -1.0], [4.0, 1.0], [2.0, 1.0], [2.0, -0.5], [1.0, -0.5], [1.0, 1.0], [-1.0, 1.0]];
        let fence = Fence { corners, margin: 0.0, ..hall() };
        for x in [1.000_01, 1.1, 1.49] {
            assert_eq!(fence.fastest(&at(x, 0.5, 0.0), 0.6, 0.0, 0.1), 0.0, "{x}");
            assert!(fence.fastest(&at(x, 0.5, 0.0), -0.6, 0.0, 0.1) > 0.5, "{x}");
        }
    }

    /// At an edge that the robot approaches at an angle, the margin is measured perpendicular to the edge, not along
    /// the robot's path.
    #[test]
    fn the_margin_is_kept_at_any_angle() {
        let corners = vec![[-1.0, -1.0], [3.0, -1.0], [3.0, -0.3], [-1.0, 0.5]];
        let fence = Fence { corners, margin: 0.1, ..hall() };
        let edge = ([3.0, -0.3], [-1.0, 0.5]);
        for (degrees, omega) in [(0.0, 0.0), (20.0, 0.0), (60.0, 0.0), (90.0, 0.0), (-15.0, 0.0), (0.0, 0.2)] {
            let pose = at(0.0, 0.0, degrees);
            let fastest = fence.fastest(&pose, 0.5, omega, 0.1);
            let way = fastest * 0.2 + fastest * fastest;
            let [x, y] = direction(pose.theta.0);
            let end = [way * x, way * y];
            let left = between(end, nearest(end, edge));
            let left = libm::hypot(left[0], left[1]);
            assert!(left > 0.1 - 1e-9, "{degrees}: {left}");
            assert!(omega != 0.0 || degrees < 0.0 || left < 0.1 + 1e-9, "{degrees}: {left}");
        }
        // The robot is as close as the margin allows: it cannot drive towards the edge, but can still drive away from
        // it.
        let near = at(0.0, 0.21, 0.0);
        assert_eq!(fence.fastest(&near, 0.5, 0.0, 0.1), 0.0);
        assert!(fence.fastest(&near, -0.5, 0.0, 0.1) > 0.5);
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
        // A concave fence is valid.
        assert_eq!(fault(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]], 0.0), "");
    }
}
