//! The simulated robot with whoever looks on: its pictures, and the table of where it was.

use mdle_host::Hosted;
use mdle_runtime::{Nanos, Pose, Robot, Twist};

use crate::frames::Frames;
use crate::output::Sensed;
use crate::plot;
use crate::robot::{Fault, Simulated};
use crate::trail::Trail;
use crate::whole_file::WholeFile;
use crate::world::World;

/// A simulated robot and what is made of its run; it drives as it would unobserved.
pub struct Observed {
    robot: Simulated,
    pictures: Option<Pictures>,
    table: Option<Table>,
}

/// What is drawn in the end, and of what.
struct Pictures {
    plot: Option<WholeFile>,
    record: Option<WholeFile>,
    world: World,
    trail: Trail,
}

/// Where the robot was in each turn: a line of commas for each exchange.
struct Table {
    file: WholeFile,
    lines: String,
}

impl Table {
    fn went(&mut self, t: Nanos, pose: &Pose) {
        let Pose { x, y, theta } = pose;
        self.lines += &format!("{},{},{},{}\n", t.seconds(), x.0, y.0, theta.degrees());
    }
}

impl From<Simulated> for Observed {
    /// The robot with nobody looking on.
    fn from(robot: Simulated) -> Self {
        Self { robot, pictures: None, table: None }
    }
}

impl Observed {
    /// Where it is on the floor, which only the simulator knows.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.robot.pose()
    }

    /// Has its way drawn when the run is finished: as a picture, and as one that moves.
    pub(crate) fn drawn(mut self, plot: Option<WholeFile>, record: Option<WholeFile>, world: &World) -> Self {
        if plot.is_some() || record.is_some() {
            let mut trail = Trail::from(&self.robot.pose());
            trail.frames = record.is_some().then(Frames::new);
            self.pictures = Some(Pictures { plot, record, world: world.clone(), trail });
        }
        self
    }

    /// Has its way written down when the run is finished: `t,x,y,heading` in seconds, metres and degrees.
    pub(crate) fn written_down(mut self, file: Option<WholeFile>) -> Self {
        self.table = file.map(|file| Table { file, lines: "t,x,y,heading\n".into() });
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
        let pose = self.robot.pose();
        if let Some(table) = &mut self.table {
            table.went(now, &pose);
        }
        if let Some(Pictures { trail, .. }) = &mut self.pictures {
            trail.went(&pose);
            trail.sensed(&sensed, now);
        }
        Ok(sensed)
    }

    fn stop(&mut self) -> Result<(), Fault> {
        let stopped = self.robot.stop();
        if let Some(Pictures { trail, .. }) = &mut self.pictures {
            trail.went(&self.robot.pose());
        }
        stopped
    }
}

impl Hosted for Observed {
    fn began(&mut self, state: u64, law: &str, t: Nanos) {
        if let Some(Pictures { trail, .. }) = &mut self.pictures {
            trail.began(state, law, t);
        }
    }

    fn finish(&mut self) -> Result<(), String> {
        if let Some(Table { file, lines }) = &self.table {
            file.write("trail", lines)?;
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
