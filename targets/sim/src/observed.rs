//! The simulated robot with the observers of its run: pictures, the live view, and the table of its poses.

use std::sync::Arc;

use mdle_host::{
    Ended, Judgement, Microphones, Observer, PlanPosition, RobotSettings, Unfinished, Watch, WholeFile, sonar_order,
};
use mdle_runtime::capability::Bumpers as _;
use mdle_runtime::{Nanos, PathStore, Pose, Robot, Sensed, Twist};
use mdle_simulator::{Charger, Drawing, Fault, Goal, RobotEars, Simulated, World};

/// A simulated robot with the observers of its run, which do not affect its motion.
pub struct Observed {
    robot: Simulated,
    goal: Option<Goal>,
    touches: bool,
    contacts: u64,
    pictures: Option<Pictures>,
    table: Option<Table>,
    watch: Option<Watch>,
    /// Sounds of the world, and their random seed; `None` before they are set.
    sounds: Option<Sounds>,
    ears: Option<(RobotEars, Microphones)>,
}

/// Sound sources of a world, which the robot receives as soon as it has ears.
pub(crate) struct Sounds {
    pub(crate) world: Arc<World>,
    pub(crate) seed: u64,
}

/// Pictures to be drawn at the end, and their data.
struct Pictures {
    plot: Option<WholeFile>,
    record: Option<WholeFile>,
    drawing: Drawing,
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
    /// Returns a robot whose run is neither drawn nor recorded.
    fn from(robot: Simulated) -> Self {
        Self {
            robot,
            goal: None,
            touches: false,
            contacts: 0,
            pictures: None,
            table: None,
            watch: None,
            sounds: None,
            ears: None,
        }
    }
}

impl Observed {
    /// Returns the robot's true pose on the floor, which only the simulator knows.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.robot.pose()
    }

    /// Returns the distance between the robot's body and the nearest obstacle, in metres, or `reach` if that is less;
    /// negative if they overlap.
    #[must_use]
    pub fn gap(&self, reach: f64) -> f64 {
        self.robot.gap(reach)
    }

    /// Returns `true` if the bumper reported a contact in the last exchange.
    #[must_use]
    pub fn touches(&self) -> bool {
        self.touches
    }

    /// Sets the charge of the robot's battery from now on, from 0 to 1.
    pub fn set_charge(&mut self, charge: f64) {
        self.robot.set_charge(charge);
    }

    /// Sets the robot's supply from now on: the charge of its battery, from 0 to 1, and the charger of its world, which
    /// is `None` if the world has no charger.
    pub fn supply(&mut self, charge: f64, charger: Option<Charger>) {
        self.robot.supply(charge, charger);
    }

    /// Sets the sounds that the robot receives as soon as it has ears.
    pub(crate) fn among(self, sounds: Sounds) -> Self {
        Self { sounds: Some(sounds), ..self }
    }

    /// Gives the robot ears on a head of this radius, in metres.
    ///
    /// # Errors
    /// Returns a sentence if the world has no sound source.
    pub(crate) fn take_ears(&mut self, microphones: Microphones, radius: f64) -> Result<(), String> {
        let ears = self.sounds.as_ref().and_then(|Sounds { world, seed }| RobotEars::new(world, radius, *seed));
        let silent = "--ears robot: the world has no source of sound\n\
                      help: add one to a world file, as `[[sound]]` and `at = [5, 3]`";
        self.ears = Some((ears.ok_or(silent)?, microphones));
        Ok(())
    }

    /// Sets the recorded paths that the plan can replay.
    pub(crate) fn take_paths(&mut self, paths: PathStore) {
        self.robot.paths = paths;
    }

    /// Sets the goal that decides whether the run succeeds; `None` for no goal.
    pub(crate) fn judged_by(self, goal: Option<Goal>) -> Self {
        Self { goal, ..self }
    }

    /// Makes the robot draw its path, after the run has ended, as a still picture and as an animation; `setup`
    /// describes the world, the body and the seed in the titles of the pictures.
    pub(crate) fn drawn(
        mut self,
        (plot, record): (Option<WholeFile>, Option<WholeFile>),
        world: &World,
        setup: String,
    ) -> Self {
        if plot.is_some() || record.is_some() {
            let drawing = Drawing::of(&self.robot, world, setup, record.is_some());
            self.pictures = Some(Pictures { plot, record, drawing });
        }
        self
    }

    /// Shows the run on `watch` while it runs; `None` for no live view.
    pub(crate) fn watched(self, watch: Option<Watch>) -> Self {
        Self { watch, ..self }
    }

    /// Writes the robot's poses to `file` during the run, as lines `t,x,y,heading` in seconds, metres and degrees. With
    /// `None`, no poses are written.
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
        if let Some((ears, microphones)) = &mut self.ears {
            microphones.put(now, ears.heard(&pose, now));
        }
        if let Some(table) = &mut self.table {
            table.went(now, &pose);
        }
        if let Some(Pictures { drawing, .. }) = &mut self.pictures {
            drawing.exchanged(&self.robot, &sensed, now, comes_into_contact);
        }
        if let Some(watch) = &mut self.watch {
            watch.sensed(&self.robot.footprint(), &sensed, now, self.robot.gone());
            watch.touched(self.touches, self.contacts);
        }
        Ok(sensed)
    }

    fn stop(&mut self) -> Result<(), Fault> {
        let stopped = self.robot.stop();
        if let Some(watch) = &mut self.watch {
            watch.leave();
        }
        if let Some(Pictures { drawing, .. }) = &mut self.pictures {
            drawing.stopped(&self.robot);
        }
        stopped
    }
}

/// Name of the setting that selects the order of the sonars.
const SONARS: &str = "sonars";

impl RobotSettings for Observed {
    fn settings(&self) -> &'static [(&'static str, &'static str)] {
        if self.robot.sonar_order().is_some() { &[(SONARS, "sonars that ping, in their order")] } else { &[] }
    }

    fn setting(&self, name: &str) -> Option<String> {
        let order = self.robot.sonar_order().filter(|_| name == SONARS)?;
        Some(order.iter().map(u8::to_string).collect::<Vec<_>>().join(" "))
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        if self.setting(name).is_none() {
            return Err(format!("this body has no setting `{name}`"));
        }
        self.robot.order_sonars(&sonar_order(value)?);
        Ok(())
    }
}

impl Observer for Observed {
    fn began(&mut self, number: u64, law: &str, t: Nanos) {
        if let Some(Pictures { drawing, .. }) = &mut self.pictures {
            drawing.began(number, law, t);
        }
    }

    fn ended(&mut self, ended: &Ended<'_>) {
        if let Some(Pictures { drawing, .. }) = &mut self.pictures {
            drawing.ended(ended.plan, ended.is_over, ended.by, ended.t);
        }
    }

    fn looks(&self) -> bool {
        self.watch.is_some()
    }

    fn turned(&mut self, standing: &PlanPosition<'_>) {
        if let Some(watch) = &mut self.watch {
            watch.turned(standing, &[]);
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
        let Some(Pictures { plot, record, drawing }) = &self.pictures else { return Ok(()) };
        if let Some(file) = plot {
            file.write("plot", &drawing.picture())?;
        }
        if let Some(file) = record {
            file.write("record", &drawing.animation())?;
        }
        Ok(())
    }
}
