//! The simulated robot with its observers: pictures, the live view, and the table of its poses.

use mdle_host::{Ended, Judgement, Observer, PlanPosition};
use mdle_runtime::capability::Bumpers as _;
use mdle_runtime::{Nanos, PathStore, Pose, Robot, Sensed, Twist};

use crate::charger::Charger;
use crate::frames::Frames;
use crate::goal::Goal;
use crate::plot;
use crate::robot::{Fault, Simulated};
use crate::trail::Trail;
use crate::watch::Watch;
use crate::whole_file::{Unfinished, WholeFile};
use crate::world::World;

/// A simulated robot and the observers of its run; it drives as it would unobserved.
pub struct Observed {
    robot: Simulated,
    goal: Option<Goal>,
    touches: bool,
    contacts: u64,
    pictures: Option<Pictures>,
    table: Option<Table>,
    watch: Option<Watch>,
}

/// The pictures to be drawn at the end, and their data.
struct Pictures {
    plot: Option<WholeFile>,
    record: Option<WholeFile>,
    world: World,
    trail: Trail,
}

/// A table of the robot's poses: one line of comma-separated values for each exchange, written during the run.
struct Table {
    file: WholeFile,
    /// Lines of the table; `None` before the first exchange.
    lines: Option<Unfinished>,
}

impl Table {
    fn went(&mut self, t: Nanos, pose: &Pose) {
        let Pose { x, y, theta } = pose;
        let lines = self.lines.get_or_insert_with(|| {
            let mut lines = Unfinished::new(self.file.clone());
            lines.write("t,x,y,heading\n");
            lines
        });
        lines.write(&format!("{},{},{},{}\n", t.seconds(), x.0, y.0, theta.degrees()));
    }
}

impl From<Simulated> for Observed {
    /// The robot with nobody looking on.
    fn from(robot: Simulated) -> Self {
        Self { robot, goal: None, touches: false, contacts: 0, pictures: None, table: None, watch: None }
    }
}

impl Observed {
    /// Returns the true pose of the robot on the floor, which only the simulator knows.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.robot.pose()
    }

    /// Sets the robot's supply from now on: the charge of its battery, from 0 to 1, and the charger of its world.
    pub fn supply(&mut self, charge: f64, charger: Option<Charger>) {
        self.robot.supply(charge, charger);
    }

    /// Takes the paths that the plan replays.
    pub(crate) fn take_paths(&mut self, paths: PathStore) {
        self.robot.paths = paths;
    }

    /// Lets `goal` judge the end of the run.
    pub(crate) fn judged_by(self, goal: Option<Goal>) -> Self {
        Self { goal, ..self }
    }

    /// Draws the robot's way when the run is finished, as a still picture and as a moving one; `setup` names the world,
    /// the body and the seed in their titles.
    pub(crate) fn drawn(
        mut self,
        (plot, record): (Option<WholeFile>, Option<WholeFile>),
        world: &World,
        setup: String,
    ) -> Self {
        if plot.is_some() || record.is_some() {
            let mut trail = Trail::from(&self.robot.pose(), self.robot.radius());
            trail.things.extend(self.robot.gone());
            trail.about.setup = setup;
            trail.frames = record.is_some().then(Frames::new);
            self.pictures = Some(Pictures { plot, record, world: world.clone(), trail });
        }
        self
    }

    /// Shows the run on `watch` as it goes.
    pub(crate) fn watched(self, watch: Option<Watch>) -> Self {
        Self { watch, ..self }
    }

    /// Writes the robot's poses to `file` during the run: `t,x,y,heading` in seconds, metres and degrees.
    pub(crate) fn written_down(mut self, file: Option<WholeFile>) -> Self {
        self.table = file.map(|file| Table { file, lines: None });
        self
    }
}

impl Robot for Observed {
    type Output = Sensed;
    type Input = Twist;
    type Error = Fault;

    fn exchange(&mut self, input: &Twist) -> Result<Sensed, Fault> {
        let now = self.robot.now();
        let sensed = self.robot.exchange(input)?;
        let comes_into_contact = sensed.pressed() && !self.touches;
        self.contacts += u64::from(comes_into_contact);
        self.touches = sensed.pressed();
        let pose = self.robot.pose();
        if let Some(table) = &mut self.table {
            table.went(now, &pose);
        }
        if let Some(Pictures { trail, .. }) = &mut self.pictures {
            trail.went(&pose);
            trail.things.clear();
            trail.things.extend(self.robot.gone());
            trail.sensed(&sensed, now);
            if comes_into_contact {
                trail.touched(self.robot.touched(), now);
            }
        }
        if let Some(watch) = &mut self.watch {
            watch.sensed(&pose, &sensed, now, self.robot.gone());
            watch.touched(self.touches, self.contacts);
        }
        Ok(sensed)
    }

    fn stop(&mut self) -> Result<(), Fault> {
        let stopped = self.robot.stop();
        if let Some(watch) = &mut self.watch {
            watch.leave();
        }
        if let Some(Pictures { trail, .. }) = &mut self.pictures {
            trail.went(&self.robot.pose());
        }
        stopped
    }
}

impl Observer for Observed {
    fn began(&mut self, number: u64, law: &str, t: Nanos) {
        if let Some(Pictures { trail, .. }) = &mut self.pictures {
            trail.began(number, law, t);
        }
    }

    fn ended(&mut self, ended: &Ended<'_>) {
        if let Some(Pictures { trail, .. }) = &mut self.pictures {
            trail.ended(ended);
        }
    }

    fn looks(&self) -> bool {
        self.watch.is_some()
    }

    fn turned(&mut self, standing: &PlanPosition<'_>) {
        if let Some(watch) = &mut self.watch {
            watch.turned(standing);
        }
    }

    fn judged(&self) -> Option<Judgement> {
        let pose = self.robot.pose();
        let goal = self.goal?;
        Some(if self.touches {
            Judgement::Bumped
        } else if goal.holds(&pose) {
            Judgement::Arrived
        } else {
            let (x, y, heading) = (pose.x.0, pose.y.0, pose.theta.degrees());
            Judgement::Astray(format!("({x:.2}, {y:.2}) heading {:.0}", libm::round(heading) + 0.0))
        })
    }

    fn contacts(&self) -> u64 {
        self.contacts
    }

    fn finish(&mut self) -> Result<(), String> {
        if let Some(lines) = self.table.take().and_then(|table| table.lines) {
            lines.finish("trail")?;
        }
        let Some(Pictures { plot, record, world, trail }) = &self.pictures else { return Ok(()) };
        if let Some(file) = plot {
            file.write("plot", &plot::svg(world, trail))?;
        }
        if let Some(file) = record {
            file.write("record", &plot::animated(world, trail))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::robot::Make;
    use crate::world::Place;
    use mdle_runtime::{MetersPerSecond, RadiansPerSecond};

    /// Returns the trail of a robot that goes ahead at 20 cm/s from the origin for `turns` turns of 100 ms.
    fn ahead(world: &str, turns: usize) -> Trail {
        let world = World::parse("a test's world", world).expect("a good world");
        let robot = Simulated::with(&Make::default(), &world, Pose::ORIGIN, Duration::from_millis(100));
        let robot = Observed::from(robot.expect("a start on the floor"));
        let folder = std::env::temp_dir();
        let mut robot =
            robot.drawn((WholeFile::at("plot", &folder.join("never written.svg")).ok(), None), &world, String::new());
        for _ in 0..turns {
            robot.exchange(&Twist { v: MetersPerSecond(0.2), omega: RadiansPerSecond(0.0) }).expect("finite inputs");
        }
        robot.pictures.expect("pictures").trail
    }

    #[test]
    fn a_contact_is_where_the_body_touched_whether_that_moves_or_stands() {
        let wall = ahead("[[wall]]\npoints = [[1, -1], [1, 0.1]]", 60);
        let walker = "[[box]]\nsize = [0.4, 4]\nschedule = [[0, 2, 0], [4, 0.2, 0], [8, 2, 0]]\nrepeat = true";
        let moving = ahead(walker, 100);
        assert_eq!((wall.contacts.len(), wall.contacts[0].0), (1, Place { x: 1.0, y: 0.0 }));
        let (Place { x, y }, t) = moving.contacts[0];
        assert!((0.4..0.9).contains(&x) && y == 0.0 && (1.0..3.0).contains(&t.seconds()), "{:?}", moving.contacts);
        assert!(moving.things[0].is_some_and(|gone| gone.x < 0.0), "{:?}", moving.things);
    }

    #[test]
    fn the_echoes_of_sonars_that_fire_between_turns_are_where_they_were_heard() {
        let world = World::parse("a wall ahead", "[[wall]]\npoints = [[3, -9], [3, 9]]").expect("a good world");
        let make = Make { body: crate::model::Body::Scout, without: vec![crate::model::Part::Steps], seed: None };
        let robot = Simulated::with(&make, &world, Pose::ORIGIN, Duration::from_secs(1)).expect("a start");
        let file = WholeFile::at("plot", &std::env::temp_dir().join("never written.svg")).ok();
        let mut robot = Observed::from(robot).drawn((file, None), &world, String::new());
        for _ in 0..5 {
            robot.exchange(&Twist { v: MetersPerSecond(0.4), omega: RadiansPerSecond(0.0) }).expect("finite inputs");
        }
        // The sonar in front hears the wall itself, its neighbours something nearer than where their axes meet it.
        let echoes = robot.pictures.expect("pictures").trail.echoes;
        let greatest = echoes.iter().map(|echo| echo.x).fold(0.0, f64::max);
        assert!((greatest - 3.0).abs() < 1e-6 && robot.robot.pose().x.0 > 1.0, "{echoes:?}");
    }
}
