//! The simulated robot with whoever looks on: its pictures, and the table of where it was.

use mdle_host::{Hosted, Judgement, Standing};
use mdle_runtime::capability::Bumpers as _;
use mdle_runtime::{Nanos, Pose, Robot, Twist};

use crate::frames::Frames;
use crate::goal::Goal;
use crate::output::Sensed;
use crate::plot;
use crate::robot::{Fault, Simulated};
use crate::trail::Trail;
use crate::watch::Watch;
use crate::whole_file::WholeFile;
use crate::world::World;

/// A simulated robot and what is made of its run; it drives as it would unobserved.
pub struct Observed {
    robot: Simulated,
    goal: Option<Goal>,
    touches: bool,
    contacts: u64,
    pictures: Option<Pictures>,
    table: Option<Table>,
    watch: Option<Watch>,
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
        Self { robot, goal: None, touches: false, contacts: 0, pictures: None, table: None, watch: None }
    }
}

impl Observed {
    /// Where it is on the floor, which only the simulator knows.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.robot.pose()
    }

    /// Has its run judged by where it ends.
    pub(crate) fn judged_by(self, goal: Option<Goal>) -> Self {
        Self { goal, ..self }
    }

    /// Has its way drawn when the run is finished: as a picture, and as one that moves.
    pub(crate) fn drawn(mut self, plot: Option<WholeFile>, record: Option<WholeFile>, world: &World) -> Self {
        if plot.is_some() || record.is_some() {
            let mut trail = Trail::from(&self.robot.pose(), self.robot.radius());
            trail.frames = record.is_some().then(Frames::new);
            self.pictures = Some(Pictures { plot, record, world: world.clone(), trail });
        }
        self
    }

    /// Has its run shown as it goes.
    pub(crate) fn watched(self, watch: Option<Watch>) -> Self {
        Self { watch, ..self }
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
        let comes_into_contact = sensed.pressed() && !self.touches;
        self.contacts += u64::from(comes_into_contact);
        self.touches = sensed.pressed();
        let pose = self.robot.pose();
        if let Some(table) = &mut self.table {
            table.went(now, &pose);
        }
        if let Some(Pictures { trail, .. }) = &mut self.pictures {
            trail.went(&pose);
            trail.sensed(&sensed, now);
            if comes_into_contact {
                trail.touched(self.robot.touched(), now);
            }
        }
        if let Some(watch) = &mut self.watch {
            watch.sensed(&pose, &sensed, now, self.touches, self.contacts);
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

impl Hosted for Observed {
    fn began(&mut self, state: u64, law: &str, t: Nanos) {
        if let Some(Pictures { trail, .. }) = &mut self.pictures {
            trail.began(state, law, t);
        }
    }

    fn looks(&self) -> bool {
        self.watch.is_some()
    }

    fn turned(&mut self, standing: &Standing<'_>) {
        if let Some(watch) = &mut self.watch {
            watch.turned(standing);
        }
    }

    fn judged(&self) -> Judgement {
        let pose = self.robot.pose();
        if self.touches {
            Judgement::Bumped
        } else if self.goal.is_none_or(|goal| goal.holds(&pose)) {
            Judgement::Arrived
        } else {
            let (x, y, heading) = (pose.x.0, pose.y.0, pose.theta.degrees());
            Judgement::Astray(format!("({x:.2}, {y:.2}) heading {:.0}", libm::round(heading) + 0.0))
        }
    }

    fn contacts(&self) -> u64 {
        self.contacts
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
