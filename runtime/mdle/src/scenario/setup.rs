//! A scenario that is ready to run: its plans are compiled, and its robots are in their world.

use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::load::Loaded;
use mdle_engine::link::Faults;
use mdle_files::Target;
use mdle_host::Target as _;
use mdle_runtime::{Nanos, Plan as _, Pose, Setpoint};
use mdle_sim::alphabet::Alphabet;
use mdle_sim::{Body, Make, RobotEars, Sim, Simulated, Start, StartNoise, Walls, World};

use super::file::{At, RobotText, ScenarioError, ScenarioText, body, duration};
use super::robot_plan::{check_peers, names, plan};
use super::sent_plan::{SentPlan, sent_by};
use super::setup_error::SetupError;
use super::values::{faults, paths, recorded, world};
use crate::arguments::head;
use crate::input_files::InputFiles;

/// Default time limit of a scenario.
pub(super) const TIMEOUT: Duration = Duration::from_secs(3600);

/// A scenario.
pub(super) struct Scenario {
    pub(super) world: World,
    /// Name of the world.
    pub(super) world_name: String,
    pub(super) seed: Option<u64>,
    pub(super) timeout: Duration,
    pub(super) period: Duration,
    /// Faults of the link.
    pub(super) faults: Faults,
    pub(super) members: Vec<ScenarioRobot>,
    /// The target of all robots.
    pub(super) target: Arc<Target>,
}

/// A robot of a scenario.
pub(super) struct ScenarioRobot {
    pub(super) name: String,
    /// Body of the robot.
    pub(super) body: Body,
    pub(super) robot: Simulated,
    /// Nominal pose in the world at which the robot's odometry is zero.
    pub(super) start: Pose,
    pub(super) loaded: Arc<Loaded<Alphabet>>,
    /// Names and texts of the plan's files; the plan's own file comes first.
    pub(super) files: Vec<(String, String)>,
    /// Paths that the plan replays; a path that the robot records may be missing.
    pub(super) paths: Vec<(&'static str, Vec<Setpoint>)>,
    /// Name of the path that the robot records.
    pub(super) records: Option<&'static str>,
    /// Time at which the robot's program is killed.
    pub(super) killed: Option<Nanos>,
    /// Ears of the robot, and the radius of its head in metres; `None` for a robot without ears.
    pub(super) ears: Option<(RobotEars, f64)>,
    /// Names of the modules whose attributes the robot shares.
    pub(super) shares: Vec<String>,
    /// Names of the robots whose plans the robot accepts.
    pub(super) plans_from: Vec<String>,
    /// Plans that the robot sends, sorted by time.
    pub(super) sends: Vec<SentPlan>,
}

impl Scenario {
    /// Creates the robots of the scenario that these files describe. Messages about plans go to standard error.
    ///
    /// # Errors
    /// Fails if a value in the scenario file is invalid, if a file that it names cannot be read, or if a plan has
    /// errors.
    pub(super) fn read(text: ScenarioText, files: &InputFiles, seed: Option<u64>) -> Result<Self, SetupError> {
        let seed = seed.or(text.seed.as_ref().map(|seed| *seed.get_ref()));
        let period = text.period.as_ref().map(|period| duration(period, 0.001, 1.0)).transpose()?;
        let timeout = text.timeout.as_ref().map(|timeout| duration(timeout, 0.0, 1e9)).transpose()?;
        let (world, world_name) = world(text.world.as_ref(), files)?;
        let faults = faults(&text.link)?;
        let mut scenario = Self {
            world,
            world_name,
            seed,
            timeout: timeout.unwrap_or(TIMEOUT),
            period: period.unwrap_or(Sim::PERIOD),
            faults,
            members: Vec::new(),
            target: Arc::new(files.settings(&files.path)?.target(Some(Sim::NAME))?),
        };
        for robot in &text.robot {
            let mut member = scenario.member(robot, files, &text.robot)?;
            member.sends = sent_by(&member.name, &text, files)?;
            scenario.members.push(member);
        }
        Ok(scenario)
    }

    /// Creates a robot. It must not overlap with the robots that were created before.
    fn member(&self, text: &RobotText, from: &InputFiles, robots: &[RobotText]) -> Result<ScenarioRobot, SetupError> {
        let (name, names) = (text.name.get_ref(), &names(robots)[..]);
        let (loaded, files) = plan(&text.file, text.plan.as_ref(), from, Some((text, robots)))?;
        let plan = loaded.plan();
        check_peers(text, plan.robots(), names)?;
        let body = body(text.body.as_ref())?;
        let number = self.members.len() as u64;
        let own_seed = self.seed.map(|seed| seed.wrapping_mul(names.len() as u64).wrapping_add(number));
        let seed = text.seed.as_ref().map(|seed| *seed.get_ref()).or(own_seed);
        let make = Make { body, without: Vec::new(), seed };
        let start: Result<Start, _> = text.start.get_ref().parse();
        let Start(start) = start.map_err(|error| ScenarioError::at(text.start.span(), error.to_string()))?;
        let begins = self.begins(text, &make, start, seed.unwrap_or_default())?;
        let robot = Simulated::with(&make, &self.world, begins, self.period);
        let robot = robot.map_err(|error| ScenarioError::at(text.start.span(), error.to_string()))?;
        let footprint = robot.footprint();
        if let Some(other) = self.members.iter().find(|other| other.robot.footprint().overlaps(&footprint)) {
            let message = format!("the robot `{name}` would stand in the robot `{}`", other.name);
            let help = "begin with a gap between them: a Scout is 0.41 m across";
            return Err(ScenarioError::at(text.start.span(), message).help(help).into());
        }
        let records = text.records.as_ref().map(|records| recorded(records, plan.paths())).transpose()?;
        let paths = paths(text, from, plan.paths(), records)?;
        let killed = text.killed.as_ref().map(|killed| self.killed(killed)).transpose()?;
        let ears = text.ears.as_ref().map(|ears| self.ears(ears, seed.unwrap_or_default())).transpose()?;
        let plans_from = text.plans_from.iter().map(|other| other.get_ref().clone()).collect();
        let (name, shares, sends) = (name.clone(), text.shares.clone(), Vec::new());
        Ok(ScenarioRobot {
            name,
            body,
            robot,
            start,
            loaded,
            files,
            paths,
            records,
            killed,
            ears,
            shares,
            plans_from,
            sends,
        })
    }

    /// Returns the time at which a robot's program is killed.
    fn killed(&self, text: &At<String>) -> Result<Nanos, ScenarioError> {
        let killed = duration(text, 0.0, 1e9)?;
        if killed > self.timeout {
            let [killed, end] = [killed, self.timeout].map(|time| time.as_secs_f64());
            let message = format!("the scenario ends after {end} s, before the robot is killed at {killed} s");
            return Err(ScenarioError::at(text.span(), message).help("give `timeout` a later time"));
        }
        Ok(Nanos(u64::try_from(killed.as_nanos()).unwrap_or(u64::MAX)))
    }

    /// Returns the ears of a robot, and the radius of its head.
    fn ears(&self, text: &At<String>, seed: u64) -> Result<(RobotEars, f64), ScenarioError> {
        let radius = head(text.get_ref()).map_err(|sentence| ScenarioError::at(text.span(), sentence))?;
        let ears = RobotEars::new(&self.world, radius, seed);
        let silent = ScenarioError::at(text.span(), "the world has no source of sound");
        let help = "write one into its file, as `[[sound]]`";
        Ok((ears.ok_or_else(|| silent.help(help))?, radius))
    }

    /// Returns the initial pose of a robot whose nominal pose is `start`.
    fn begins(&self, text: &RobotText, make: &Make, start: Pose, seed: u64) -> Result<Pose, ScenarioError> {
        let Some(noise) = &text.start_noise else { return Ok(start) };
        let read = StartNoise::read(noise.get_ref());
        let read = read.map_err(|sentence| ScenarioError::at(noise.span(), sentence))?;
        let pose = read.pose(&start, seed, make.form(), &self.world, &Walls::of(&self.world));
        pose.map_err(|error| ScenarioError::at(noise.span(), error.to_string()))
    }
}
