//! A scenario that is ready to run: its plans are compiled, and its robots are in their world.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::diagnostic::judged;
use mdle_compiler::load::{self, Loaded};
use mdle_engine::link::Faults;
use mdle_files::{InputError, RobotGroup, Spelling, Target};
use mdle_host::{Quantity, Target as _, setpoints};
use mdle_runtime::{Alphabet, Nanos, Plan as _, Pose, Setpoint};
use mdle_sim::alphabet::Alphabet as SimAlphabet;
use mdle_sim::{Body, Make, RobotEars, Sim, Simulated, Start, StartNoise, Walls, World};

use super::file::{At, LinkText, RobotText, ScenarioError, ScenarioText, body, duration};
use super::room;
use super::sent_plan::{SentPlan, sent_by};
use crate::arguments::head;
use crate::failure::{self, Failure};
use crate::input_files::InputFiles;
use crate::plans::texts;

/// Maximum size of a path file or a world file, in bytes.
const LARGEST: u64 = 10_000_000;
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
    pub(super) loaded: Arc<Loaded<SimAlphabet>>,
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

/// Error of a scenario: either in its own file, or in a plan whose error has been reported.
pub(super) enum SetupError {
    File(ScenarioError),
    Plan(Failure),
}

impl From<ScenarioError> for SetupError {
    fn from(error: ScenarioError) -> Self {
        Self::File(error)
    }
}

impl<F: Into<Failure>> From<F> for SetupError {
    fn from(failure: F) -> Self {
        Self::Plan(failure.into())
    }
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
        for other in plan.robots() {
            if other == name || !names.contains(other) {
                return Err(unknown_peer(text, other, names).into());
            }
        }
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
        let killed = text.killed.as_ref().map(|killed| duration(killed, 0.0, 1e9)).transpose()?;
        if let (Some(killed), Some(place)) = (killed.filter(|killed| *killed > self.timeout), &text.killed) {
            let [killed, end] = [killed, self.timeout].map(|time| time.as_secs_f64());
            let message = format!("the scenario ends after {end} s, before the robot is killed at {killed} s");
            return Err(ScenarioError::at(place.span(), message).help("give `timeout` a later time").into());
        }
        let killed = killed.map(|killed| Nanos(u64::try_from(killed.as_nanos()).unwrap_or(u64::MAX)));
        let ears = text.ears.as_ref().map(|ears| self.ears(ears, seed.unwrap_or_default())).transpose()?;
        for other in &text.plans_from {
            if other.get_ref() == name || !names.contains(&other.get_ref().as_str()) {
                return Err(no_other_robot(other, name, names).into());
            }
        }
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

/// A plan, and the names and texts of its files; the plan's own file comes first.
pub(super) type PlanWithFiles<A> = (Arc<Loaded<A>>, Vec<(String, String)>);

/// Compiles and loads the plan of a robot; if the file contains a group's plan, the plan for this robot of the group.
/// `robot` contains the robot and all robots of the scenario; `None` for a crowd. `A` is bound to the alphabet of the
/// simulated robot.
pub(super) fn plan<A: Alphabet>(
    file: &At<PathBuf>,
    plan_name: Option<&At<String>>,
    files: &InputFiles,
    robot: Option<(&RobotText, &[RobotText])>,
) -> Result<PlanWithFiles<A>, SetupError> {
    let (place, file) = (file.span(), files.named(file.get_ref()));
    let target = files.settings(&file)?.target(Some(Sim::NAME))?;
    let mut input = files.plan(&file, &target).map_err(|error| placed(place.clone(), error))?;
    let named = plan_name.map(|plan| plan.get_ref().as_str());
    if let (None, Some(group)) = (robot, input.group(named)) {
        let message = format!("the robots of the group `{}` have names, and those of a crowd have none", group.name);
        let help = "write a `[[robot]]` with this file for each of them, in place of the crowd";
        return Err(ScenarioError::at(place, message).help(help).into());
    }
    let group = robot.and_then(|robot| Some((robot, input.group(named)?)));
    let part = group.map(|((text, robots), group)| part(text, &names(robots), &group)).transpose()?;
    let wanted = part.as_deref().or(named);
    if let Some(name) = wanted {
        let place = plan_name.map_or(place.clone(), At::span);
        input.must_have(name).map_err(|error| placed(place, error))?;
    }
    let (plans, diagnostics) = input.compile(&target.alphabet, wanted);
    files.compiled(&input, &diagnostics);
    if let Err(sentence) = judged(&diagnostics, false) {
        failure::error(&sentence);
        return Err(SetupError::Plan(Failure::Plan));
    }
    let named = plans.into_iter().map(|compiled| (compiled.plan.root.name, compiled.machine)).collect();
    let machine = input.only(named).map_err(|error| placed(place, error))?;
    if let Some((text, robots)) = robot {
        room::check(&machine, text, robots)?;
    }
    Ok((Arc::new(load::load(&machine, &input.sources, &target.alphabet)?), texts(&input)))
}

fn names(robots: &[RobotText]) -> Vec<&str> {
    robots.iter().map(|robot| robot.name.get_ref().as_str()).collect()
}

/// Returns the error with its place in the scenario, unless the error is in the plan's own file.
fn placed(place: Range<usize>, error: InputError) -> SetupError {
    if let InputError::Faulty(_) | InputError::NamedAt { .. } = error {
        return SetupError::Plan(error.into());
    }
    let message = error.message(Spelling::Entry);
    let (message, help) = message.split_once("\nhelp: ").unwrap_or((&message, ""));
    ScenarioError::at(place, message).help(help).into()
}

/// Returns the name of the plan for this robot in a group's plan. The scenario must have all robots of the group.
fn part(text: &RobotText, names: &[&str], group: &RobotGroup) -> Result<String, ScenarioError> {
    let (own, name) = (text.name.get_ref(), &group.name);
    let robots = group.robots.join(", ");
    let Some(part) = group.plan_of(own) else {
        let known: Vec<&str> = group.robots.iter().map(String::as_str).collect();
        let message = format!("the group `{name}` has no robot `{own}`{}", did_you_mean(own, &known));
        return Err(ScenarioError::at(text.name.span(), message).help(format!("the robots of the group are {robots}")));
    };
    match group.robots.iter().find(|robot| !names.contains(&robot.as_str())) {
        None => Ok(part),
        Some(lacking) => {
            // Another robot of the group is in the scenario under its own name, so it cannot be meant.
            let is_own = |name: &str| group.robots.iter().any(|robot| robot == name);
            let strangers: Vec<&str> = names.iter().copied().filter(|name| !is_own(name)).collect();
            let near = did_you_mean(lacking, &strangers);
            let message = format!("the group `{name}` has the robot `{lacking}`, and the scenario has none{near}");
            Err(ScenarioError::at(text.file.span(), message).help(format!("the robots of the group are {robots}")))
        }
    }
}

/// Returns the error about a name that is not the name of another robot of the scenario.
fn no_other_robot(other: &At<String>, own: &str, names: &[&str]) -> ScenarioError {
    let others: Vec<&str> = names.iter().copied().filter(|name| *name != own).collect();
    let near = did_you_mean(other.get_ref(), &others);
    let message = format!("there is no other robot `{}`{near}", other.get_ref());
    ScenarioError::at(other.span(), message).help(format!("the other robots of the scenario are {}", others.join(", ")))
}

/// Returns the error about a robot that a plan names but that the scenario does not contain.
fn unknown_peer(text: &RobotText, other: &str, names: &[&str]) -> ScenarioError {
    let name = text.name.get_ref();
    if other == name {
        return ScenarioError::at(text.file.span(), format!("the plan of the robot `{name}` names that robot itself"));
    }
    let others: Vec<&str> = names.iter().copied().filter(|known| known != name).collect();
    let near = did_you_mean(other, &others);
    let message = format!("the plan of `{name}` names the robot `{other}`, and the scenario has none{near}");
    ScenarioError::at(text.file.span(), message).help(format!("the robots of the scenario are {}", names.join(", ")))
}

/// Returns the world that `text` describes by its name or its file, and the name of the world.
pub(super) fn world(text: Option<&At<String>>, files: &InputFiles) -> Result<(World, String), ScenarioError> {
    let Some(text) = text else {
        let world = World::parse("the empty floor", "");
        let world =
            world.map_err(|error| ScenarioError { place: None, message: error.to_string(), help: String::new() });
        return Ok((world?, "empty".to_owned()));
    };
    let refused = |message: String| ScenarioError::at(text.span(), message);
    let name = text.get_ref();
    let file = files.path.with_file_name(name);
    let world = match World::named(name).filter(|_| !files.exists(&file)) {
        Some(world) => world,
        None if !files.exists(&file) => {
            let worlds = World::names().collect::<Vec<_>>();
            let near = did_you_mean(name, &worlds);
            let message = format!("there is no world or file `{name}`{near}");
            return Err(refused(message).help(format!("the worlds are {}", worlds.join(", "))));
        }
        None => {
            let shown = file.display().to_string();
            let text =
                files.text(&file, LARGEST).map_err(|error| refused(format!("{shown} cannot be read: {error}")))?;
            World::parse(&shown, &text)
        }
    };
    let world = world.map_err(|error| refused(error.to_string()))?;
    if !world.things.is_empty() {
        return Err(refused("a world with things that move is for one robot".to_owned()).help("leave them out"));
    }
    Ok((world, name.clone()))
}

fn faults(text: &LinkText) -> Result<Faults, ScenarioError> {
    let share = |share: &Option<At<f64>>| {
        let Some(text) = share else { return Ok(0.0) };
        let is_share = (0.0..=1.0).contains(text.get_ref());
        is_share
            .then_some(*text.get_ref())
            .ok_or_else(|| ScenarioError::at(text.span(), "expected a number from 0 to 1"))
    };
    let latency = text.latency.as_ref().map(latency).transpose()?.unwrap_or_default();
    Ok(Faults { latency, loss: share(&text.loss)?, duplication: share(&text.duplication)? })
}

/// Parses a time, or a minimum and a maximum with `..` between them.
fn latency(text: &At<String>) -> Result<(Nanos, Nanos), ScenarioError> {
    let (least, most) = text.get_ref().split_once("..").unwrap_or((text.get_ref(), text.get_ref()));
    let time = |part: &str| {
        let read = Quantity::duration(part.trim(), "s", Duration::ZERO, Duration::from_secs(60));
        let read = read.map_err(|sentence| ScenarioError::at(text.span(), sentence));
        read.map(|time| Nanos(u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)))
    };
    let (least, most) = (time(least)?, time(most)?);
    if most < least {
        return Err(ScenarioError::at(text.span(), "the least latency comes first, as in `0ms..200ms`"));
    }
    Ok((least, most))
}

/// Returns the name of the path to record, which must be a path that the plan replays.
fn recorded(text: &At<String>, replayed: &[&'static str]) -> Result<&'static str, ScenarioError> {
    let name = text.get_ref();
    replayed.iter().copied().find(|path| path == name).ok_or_else(|| {
        let near = did_you_mean(name, replayed);
        ScenarioError::at(text.span(), format!("the plan replays no path `{name}`{near}"))
    })
}

/// Reads the paths that a plan replays. The file of a path that the run records may be missing.
fn paths(
    text: &RobotText,
    files: &InputFiles,
    names: &[&'static str],
    records: Option<&'static str>,
) -> Result<Vec<(&'static str, Vec<Setpoint>)>, ScenarioError> {
    let folder = files.named(text.paths.as_ref().map_or(Path::new(""), |own| own.get_ref()));
    let place = text.paths.as_ref().map_or(text.file.span(), At::span);
    let Some(fastest) = Sim::PATHS.map(|replays| replays.fastest) else { return Ok(Vec::new()) };
    let mut paths = Vec::new();
    for name in names {
        let file =
            folder.join(if Path::new(name).extension().is_some() { (*name).to_owned() } else { format!("{name}.csv") });
        if !files.exists(&file) && records == Some(name) {
            continue;
        }
        let shown = file.display().to_string();
        let bytes = files.read(&file, LARGEST).map_err(|error| {
            let message = format!("the path {shown} cannot be read: {error}");
            ScenarioError::at(place.clone(), message).help("the plan replays it; `paths = \"FOLDER\"` says where it is")
        })?;
        let read = setpoints(&shown, &bytes, fastest).map_err(|sentence| ScenarioError::at(place.clone(), sentence))?;
        paths.push((*name, read));
    }
    Ok(paths)
}
