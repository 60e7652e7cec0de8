//! Records a run, and draws its pictures after the run has ended.

use mdle_runtime::{Nanos, Pose, Sensed};

use crate::footprint::{Footprint, Form};
use crate::frames::Frames;
use crate::plot;
use crate::point::Point;
use crate::robot::Simulated;
use crate::trail::Trail;
use crate::world::World;

/// Record of a run in a world. The pictures of the run are drawn from it.
#[derive(Debug, Clone)]
pub struct Drawing {
    world: World,
    trail: Trail,
}

impl Drawing {
    /// Begins the record of `robot` in `world`. `setup` describes the world, the body and the seed in titles. The data
    /// for an animation are recorded only if `animated` is `true`.
    #[must_use]
    pub fn of(robot: &Simulated, world: &World, setup: String, animated: bool) -> Self {
        let mut trail = Trail::from(&robot.footprint());
        trail.things.extend(robot.gone());
        trail.about.setup = setup;
        trail.frames = animated.then(Frames::new);
        Self { world: world.clone(), trail }
    }

    /// Begins the record of a robot whose world is unknown. `y` is the robot's first output; the driven path is
    /// measured by odometry. `setup` describes the run in titles. The data for an animation are recorded only if
    /// `animated` is `true`.
    #[must_use]
    pub fn without_world(y: &Sensed, setup: String, animated: bool) -> Self {
        let mut trail = Trail::from(&Footprint { pose: y.odometry, form: Form::of(&y.shape) });
        trail.about.setup = setup;
        trail.frames = animated.then(Frames::new);
        Self { world: World::empty(), trail }
    }

    /// Records the output `y` at time `t`, for a robot whose world is not known. `touches` is `true` if a contact
    /// begins with this output.
    pub fn sensed(&mut self, y: &Sensed, t: Nanos, touches: bool) {
        self.trail.went(&y.odometry);
        self.trail.sensed(y, t);
        if touches {
            self.trail.touched(Point::of(&y.odometry), t);
        }
    }

    /// Records the final pose of a robot whose world is not known.
    pub fn rests_at(&mut self, pose: &Pose) {
        self.trail.went(pose);
    }

    /// Returns the positions of the echoes so far. In each square of 4 cm, there is at most one position.
    #[must_use]
    pub fn echoes(&self) -> &[Point] {
        &self.trail.echoes
    }

    /// Records the exchange of `robot` at time `t` that returned the output `sensed`. `touches` is `true` if a contact
    /// begins with this exchange.
    pub fn exchanged(&mut self, robot: &Simulated, sensed: &Sensed, t: Nanos, touches: bool) {
        self.trail.went(&robot.pose());
        self.trail.things.clear();
        self.trail.things.extend(robot.gone());
        self.trail.sensed(sensed, t);
        if touches {
            self.trail.touched(robot.touched(), t);
        }
    }

    /// Records the pose at which `robot` was stopped.
    pub fn stopped(&mut self, robot: &Simulated) {
        self.trail.went(&robot.pose());
    }

    /// Records that an atom with this law begins at the robot's current pose. `number` is the number of the atom's
    /// state in the first pass of all enclosing loops.
    pub fn began(&mut self, number: u64, law: &str, t: Nanos) {
        self.trail.began(number, law, t);
    }

    /// Records that the turns of `plan` have ended at time `t`; `by` is the cause. `is_over` is `false` if the plan was
    /// stopped.
    pub fn ended(&mut self, plan: &str, is_over: bool, by: &str, t: Nanos) {
        self.trail.ended(plan, is_over, by, t);
    }

    /// Draws the run as an SVG picture.
    #[must_use]
    pub fn picture(&self) -> String {
        plot::svg(&self.world, &self.trail)
    }

    /// Draws the run as an animated SVG picture, for a browser.
    #[must_use]
    pub fn animation(&self) -> String {
        plot::animated(&self.world, &self.trail)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use mdle_runtime::capability::Bumpers as _;
    use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Robot as _, Twist};

    use super::*;
    use crate::model::{Body, ModelPart};
    use crate::robot::Make;

    /// Returns the trail of a robot that drives ahead from the origin at `speed`, in m/s, for `turns` periods,
    /// and the robot itself.
    fn ahead(world: &str, make: &Make, speed: f64, turns: usize, period: Duration) -> (Trail, Simulated) {
        let world = World::parse("a test's world", world).expect("a good world");
        let mut robot = Simulated::with(make, &world, Pose::ORIGIN, period).expect("a start on the floor");
        let mut drawing = Drawing::of(&robot, &world, String::new(), false);
        let mut touches = false;
        for _ in 0..turns {
            let now = robot.now();
            let input = Twist { v: MetersPerSecond(speed), omega: RadiansPerSecond(0.0) };
            let sensed = robot.exchange(&input).expect("finite inputs");
            drawing.exchanged(&robot, &sensed, now, sensed.pressed() && !touches);
            touches = sensed.pressed();
        }
        (drawing.trail, robot)
    }

    #[test]
    fn a_contact_is_where_the_body_touched_whether_that_moves_or_stands() {
        let period = Duration::from_millis(100);
        let ahead = |world, turns| ahead(world, &Make::default(), 0.2, turns, period).0;
        let wall = ahead("[[wall]]\npoints = [[1, -1], [1, 0.1]]", 60);
        let walker = "[[box]]\nsize = [0.4, 4]\nschedule = [[0, 2, 0], [4, 0.2, 0], [8, 2, 0]]\nrepeat = true";
        let moving = ahead(walker, 100);
        assert_eq!((wall.contacts.len(), wall.contacts[0].0), (1, Point { x: 1.0, y: 0.0 }));
        let (Point { x, y }, t) = moving.contacts[0];
        assert!((0.4..0.9).contains(&x) && y == 0.0 && (1.0..3.0).contains(&t.seconds()), "{:?}", moving.contacts);
        assert!(moving.things[0].is_some_and(|gone| gone.x < 0.0), "{:?}", moving.things);
    }

    #[test]
    fn the_echoes_of_sonars_that_fire_between_turns_are_where_they_were_heard() {
        let make = Make { body: Body::Scout, without: vec![ModelPart::Steps], seed: None };
        let (trail, robot) = ahead("[[wall]]\npoints = [[3, -9], [3, 9]]", &make, 0.4, 5, Duration::from_secs(1));
        // The front sonar hears the wall itself; its neighbours hear points of the wall that are nearer than where
        // their axes meet it.
        let greatest = trail.echoes.iter().map(|echo| echo.x).fold(0.0, f64::max);
        assert!((greatest - 3.0).abs() < 1e-6 && robot.pose().x.0 > 1.0, "{:?}", trail.echoes);
    }
}
