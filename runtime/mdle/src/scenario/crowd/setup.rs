//! A crowd that is ready to run: its plan is compiled, and its robots are in their world.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::load::Loaded;
use mdle_host::{Quantity, Target as _};
use mdle_runtime::{Nanos, Plan as _};
use mdle_sim::{Make, Sim, Simulated};

use super::super::arguments::ScenarioOptions;
use super::super::file::{At, CrowdText, ScenarioError, ScenarioText, body, duration};
use super::super::records::begin;
use super::super::robot_plan;
use super::super::setup::TIMEOUT;
use super::super::setup_error::SetupError;
use super::super::values::world;
use super::alphabet::CrowdAlphabet;
use super::member::Member;
use super::places::{Places, hall};
use super::recorded::RecordedMember;
use crate::input_files::InputFiles;

/// Maximum number of robots.
const ROBOTS_MOST: u64 = 100_000;
/// Maximum number of robots that are recorded. The limit is needed because each record is an open file.
const RECORDED_MOST: usize = 250;
/// Default distance between two robots at the start, in metres. It gives each robot an area of 4 m².
const SPACING: f64 = 2.0;

/// A crowd.
pub(in super::super) struct CrowdSetup {
    pub(super) robots: Vec<Member>,
    pub(super) plan: Arc<Loaded<CrowdAlphabet>>,
    /// Names and texts of the plan's files, the plan's own file first.
    files: Vec<(String, String)>,
    pub(super) period: Nanos,
    pub(super) timeout: Nanos,
    pub(super) threads: usize,
}

impl CrowdSetup {
    /// Creates the crowd that these files describe. Messages about the plan go to standard error.
    ///
    /// # Errors
    /// Fails if a value in the scenario file is invalid, if a file that it names cannot be read, if the plan has errors
    /// or needs something that a crowd lacks, or if the world has too little room.
    pub(in super::super) fn read(
        crowd: &CrowdText,
        file: &ScenarioText,
        from: &InputFiles,
        options: &ScenarioOptions,
    ) -> Result<Self, SetupError> {
        let count = *crowd.robots.get_ref();
        if !(1..=ROBOTS_MOST).contains(&count) {
            let message = format!("a crowd has from 1 to {ROBOTS_MOST} robots");
            return Err(ScenarioError::at(crowd.robots.span(), message).into());
        }
        let (plan, files) = robot_plan::plan(&crowd.file, crowd.plan.as_ref(), from, None)?;
        check(&plan, crowd)?;
        let period = file.period.as_ref().map(|period| duration(period, 0.001, 1.0)).transpose()?;
        let period = period.unwrap_or(Sim::PERIOD);
        let timeout = file.timeout.as_ref().map(|timeout| duration(timeout, 0.0, 1e9)).transpose()?;
        let seed = options.seed.or(file.seed.as_ref().map(|seed| *seed.get_ref()));
        let robots = robots(crowd, file, from, seed, period)?;
        let processors = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Ok(Self {
            robots,
            plan,
            files,
            period: nanos(period),
            timeout: nanos(options.timeout.or(timeout).unwrap_or(TIMEOUT)),
            threads: options.threads.unwrap_or_else(processors),
        })
    }

    /// Creates a record for each robot of the crowd. The name of the record contains the robot's number, which is
    /// counted from 1. `command` is the command that repeats the run.
    ///
    /// # Errors
    /// Fails with a message if there are too many robots, or if a record cannot be written; in this case, the records
    /// that were created are removed.
    pub(super) fn records(&self, log: &Path, command: &str) -> Result<Vec<RecordedMember>, String> {
        let count = self.robots.len();
        if count > RECORDED_MOST {
            return Err(format!(
                "--log writes a record of each robot, for at most {RECORDED_MOST} robots, and this crowd has {count}\n\
                 help: leave it out; `--trail FILE.csv` has the poses of a crowd"
            ));
        }
        let begin = begin(&self.plan.plan(), &self.files, command, self.period);
        let mut records = Vec::new();
        for number in 1..=count {
            match RecordedMember::create(log, number, begin.clone()) {
                Ok(record) => records.push(record),
                Err(sentence) => {
                    records.into_iter().for_each(RecordedMember::remove);
                    return Err(sentence);
                }
            }
        }
        Ok(records)
    }
}

fn nanos(time: Duration) -> Nanos {
    Nanos(u64::try_from(time.as_nanos()).unwrap_or(u64::MAX))
}

/// Checks that a plan needs nothing that the robots of a crowd lack.
fn check(plan: &Arc<Loaded<CrowdAlphabet>>, crowd: &CrowdText) -> Result<(), ScenarioError> {
    let plan = plan.plan();
    let refused = |message: String| Err(ScenarioError::at(crowd.file.span(), message));
    if let Some(robot) = plan.robots().first() {
        return refused(format!("the plan names the robot `{robot}`, and the robots of a crowd have no names"));
    }
    if let Some(path) = plan.paths().first() {
        return refused(format!("the plan replays the path `{path}`, and the robots of a crowd have no paths"));
    }
    if let Some(read) = plan.reads().first() {
        return refused(format!("the plan reads the module `{}`, and a crowd has no modules", read.module));
    }
    Ok(())
}

/// Creates the robots at their start poses.
fn robots(
    crowd: &CrowdText,
    file: &ScenarioText,
    from: &InputFiles,
    seed: Option<u64>,
    period: Duration,
) -> Result<Vec<Member>, SetupError> {
    let body = body(crowd.body.as_ref())?;
    let count = *crowd.robots.get_ref();
    let spacing = crowd.spacing.as_ref().map(spacing).transpose()?.unwrap_or(SPACING);
    let seeded = |number: u64| seed.map(|seed| seed.wrapping_mul(count).wrapping_add(number));
    let make = Make { body, without: Vec::new(), seed: seeded(0) };
    let width = 2.0 * make.form().radius();
    if let Some(text) = crowd.spacing.as_ref().filter(|_| spacing <= width) {
        let message = format!("two robots would overlap: each is {width:.2} m across");
        return Err(ScenarioError::at(text.span(), message).into());
    }
    let world = match &file.world {
        Some(_) => world(file.world.as_ref(), from)?.0,
        None => hall(count, spacing)?,
    };
    let mut places = Places::of(&world, spacing, seed.unwrap_or_default());
    let first = places.find_map(|start| Simulated::with(&make, &world, start, period).ok());
    let Some(first) = first else { return Err(no_room(crowd, 0, spacing).into()) };
    let mut robots = vec![Member::new(first)];
    while (robots.len() as u64) < count {
        let (number, first) = (robots.len() as u64, robots.first());
        let next = first.and_then(|first| places.find_map(|start| first.another(&world, start, seeded(number))));
        let Some(robot) = next else { return Err(no_room(crowd, number, spacing).into()) };
        robots.push(robot);
    }
    Ok(robots)
}

fn no_room(crowd: &CrowdText, count: u64, spacing: f64) -> ScenarioError {
    let message = format!("the world has room for {count} robots that are {spacing} m apart");
    ScenarioError::at(crowd.robots.span(), message).help("ask for fewer, or for a smaller `spacing`")
}

fn spacing(text: &At<String>) -> Result<f64, ScenarioError> {
    let read = Quantity::Length.read(text.get_ref(), "m");
    let read = read.map_err(|sentence| ScenarioError::at(text.span(), sentence))?;
    let is_length = (0.1..=1000.0).contains(&read);
    is_length.then_some(read).ok_or_else(|| ScenarioError::at(text.span(), "expected a length from 10 cm to 1 km"))
}
