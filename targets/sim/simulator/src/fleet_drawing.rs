//! Draws several robots in one world: the floor, and the driven path of each robot.

use mdle_runtime::{Nanos, Pose};

use crate::footprint::{Footprint, Form};
use crate::plot;
use crate::point::Point;
use crate::robot::Simulated;
use crate::trail::{Companion, Trail};
use crate::world::World;

/// Record of several robots in a world. Their picture is drawn from it.
#[derive(Debug, Clone)]
pub struct FleetDrawing {
    world: World,
    title: String,
    robots: Vec<RobotWay>,
    /// Positions and times at which a robot came into contact with an obstacle.
    contacts: Vec<(Point, Nanos)>,
}

/// A robot, and the path that it has driven.
#[derive(Debug, Clone)]
struct RobotWay {
    name: String,
    form: Form,
    start: Pose,
    here: Pose,
    way: Vec<Point>,
    until: Nanos,
    touches: bool,
}

impl FleetDrawing {
    /// Begins the record of robots in `world`; `title` describes the run.
    #[must_use]
    pub fn of(world: &World, title: &str) -> Self {
        Self { world: world.clone(), title: title.to_owned(), robots: Vec::new(), contacts: Vec::new() }
    }

    /// Records the current pose of the robot `name`; `touches` is `true` if the robot touches an obstacle.
    pub fn went(&mut self, name: &str, robot: &Simulated, touches: bool) {
        let Footprint { pose, form } = robot.footprint();
        let place = Point::of(&pose);
        let number = self.robots.iter().position(|robot| robot.name == name).unwrap_or_else(|| {
            let name = name.to_owned();
            let way = vec![place];
            self.robots.push(RobotWay { name, form, start: pose, here: pose, way, until: Nanos::ZERO, touches: false });
            self.robots.len() - 1
        });
        let Some(way) = self.robots.get_mut(number) else { return };
        if touches && !way.touches {
            self.contacts.push((robot.touched(), robot.now()));
        }
        if way.way.last().is_none_or(|last| libm::hypot(last.x - place.x, last.y - place.y) >= 0.01) {
            way.way.push(place);
            way.until = robot.now();
        }
        (way.here, way.touches) = (pose, touches);
    }

    /// Draws the run as an SVG picture.
    #[must_use]
    pub fn picture(&self) -> String {
        let Some(first) = self.robots.first() else { return String::new() };
        let mut trail = Trail::from(&Footprint { pose: first.start, form: first.form });
        trail.here = first.here;
        trail.kind = "robot";
        trail.about.setup.clone_from(&self.title);
        trail.about.plan = format!("{} robots", self.robots.len());
        for (number, robot) in (1..).zip(&self.robots) {
            trail.ways.drove(number, &robot.name, &robot.way, robot.until);
            if number > 1 {
                trail.companions.push(Companion { form: robot.form, start: robot.start, here: robot.here });
            }
        }
        trail.contacts.clone_from(&self.contacts);
        plot::svg(&self.world, &trail)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use mdle_runtime::{Meters, MetersPerSecond, Robot as _, Twist};

    use super::*;

    #[test]
    fn each_robot_has_a_way_of_its_colour_and_a_line_of_the_legend() {
        let world = World::parse("a test's world", "").expect("a good world");
        let robot = |y: f64| {
            let start = Pose { y: Meters(y), ..Pose::ORIGIN };
            Simulated::new(&world, start, None, Duration::from_millis(100)).expect("a start on the floor")
        };
        let mut robots = [("ada", robot(0.0)), ("bob", robot(1.0))];
        let mut drawing = FleetDrawing::of(&world, "world empty");
        for _ in 0..20 {
            for (name, robot) in &mut robots {
                let input = Twist { v: MetersPerSecond(0.3), ..Twist::default() };
                robot.exchange(&input).expect("finite inputs");
                drawing.went(name, robot, false);
            }
        }
        let picture = drawing.picture();
        let has = |text: &str| picture.lines().any(|line| line == text);
        assert!(has("ada") && has("bob") && has("robot") && has("2 robots"), "{picture}");
        assert!(picture.contains("class=\"way0\"") && picture.contains("class=\"way1\""), "{picture}");
    }
}
