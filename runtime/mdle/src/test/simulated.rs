//! Runs a plan on the simulated robot of a test.

use std::ffi::OsString;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use mdle_compiler::load::{Loaded, LoadedPlan};
use mdle_engine::{Engine, Library};
use mdle_host::{
    Call, Microphones, Pace, Pilot, PilotFault, PilotTurn, Program, RecordedPlan, RunTerms, StopRequest, Time,
    Transitions, Trials, cause_words, trials,
};
use mdle_runtime::{Cause, Machine, Nanos, Plan as _, Robot as _, Sensed, Turn, Twist};
use mdle_sim::alphabet::Alphabet as SimAlphabet;
use mdle_sim::{Observed, Sim};

use super::course::{CourseRecorder, TestCourse, TestEnd};
use super::coverage::Coverage;
use super::expected::{Expected, ForbiddenState};
use super::faults::{self, TimedFault};
use super::file::{TestFileError, TestText};
use super::subject::{Subject, TestCondition};

/// Time after which a run ends by default.
const TIMEOUT: Duration = Duration::from_secs(3600);

/// The robots of a test, and its plan for them.
pub(super) struct Simulation {
    pub(super) trials: Trials<Observed>,
    loaded: Arc<Loaded<SimAlphabet>>,
    faults: Vec<TimedFault>,
    /// The options with which `mdle run` creates the same robot.
    pub(super) options: Vec<String>,
    /// Time at which a run ends.
    pub(super) timeout: Duration,
}

/// Message about a run that could not be made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum RunError {
    /// A module is refused, which happens in every run of the plan.
    Module(String),
    /// The robot of this run could not be made, or the code panicked.
    Own(String),
}

/// The conditions of a test during a run. Each runs as a plan that never leaves its only atom.
type TestConditions = Vec<Option<Machine<LoadedPlan<SimAlphabet>>>>;

impl Simulation {
    /// Reads the robot of a test in the file `path`.
    ///
    /// # Errors
    /// Fails with a message and a place if the world, the start or another option is invalid.
    pub(super) fn read(test: &TestText, path: &Path, subject: &Subject) -> Result<Self, TestFileError> {
        let Some(loaded) = &subject.loaded else {
            let name = &subject.target_name;
            let message = format!("`{name}` cannot be simulated: a test without `script` needs the target `sim`");
            let help = "write `target = \"sim\"` above the tests, if the plan fits that robot, or give a `script`";
            return Err(TestFileError::at(test.name.span(), message).help(help));
        };
        if let Some(noise) = test.start_noise.as_ref().filter(|_| test.seed.is_none() && test.seeds.is_none()) {
            let message = "`start-noise` draws the start at random, and the test has no seed";
            let help = "add `seed = 1`, or `seeds = 20` for 20 runs";
            return Err(TestFileError::at(noise.span(), message).help(help));
        }
        let given = test.options();
        let options: Vec<_> = given.iter().map(|(name, value, _)| word(name, value, path)).collect();
        let is_given = |word: &&String| !given.iter().any(|(name, ..)| word.starts_with(&format!("--{name}=")));
        let options: Vec<_> = subject.options.iter().filter(is_given).cloned().chain(options).collect();
        let call = Call {
            words: vec!["mdle".into()],
            options: options.iter().map(OsString::from).collect(),
            read: Vec::new(),
            recorded: RecordedPlan::default(),
            later_path: None,
            own_options: Vec::new(),
        };
        let plan = loaded.plan();
        let program = Program { plan: plan.name(0), version: "" };
        let trials = trials::<Sim>(program, &call, plan.paths()).map_err(|text| refused(&text, test))?;
        let faults = test.faults.iter().map(faults::read).collect::<Result<_, _>>()?;
        let timeout = trials.timeout.unwrap_or(TIMEOUT);
        Ok(Self { trials, loaded: Arc::clone(loaded), faults, options, timeout })
    }

    /// Returns `true` if the run has faults, which `mdle run` cannot repeat.
    pub(super) fn has_faults(&self) -> bool {
        !self.faults.is_empty()
    }

    /// Runs the plan on the robot of a seed.
    ///
    /// # Errors
    /// Fails if the run cannot begin.
    pub(super) fn run(
        &self,
        subject: &Subject,
        expected: &Expected,
        seed: Option<u64>,
        library: &Library<Sensed>,
        coverage: &mut Coverage,
    ) -> Result<TestCourse, RunError> {
        let terms = RunTerms {
            time: Time::Stepped(Pace::Max),
            period: self.trials.period,
            request: StopRequest::default(),
            microphones: Microphones::default(),
        };
        let library = subject.modules(library).map_err(RunError::Module)?;
        let engine = Engine::new(self.loaded.plan(), &library, &terms);
        let engine = engine.map_err(|refusal| RunError::Module(refusal.to_string()))?;
        let mut drive = DrivenRobot {
            simulation: self,
            robot: self.trials.robot(seed).map_err(RunError::Own)?,
            engine,
            input: Twist::default(),
            transitions: Transitions::default(),
            watched: Vec::new(),
        };
        let mut recorder = CourseRecorder::new(subject.machine());
        recorder.course.ending = drive.turns(subject, expected, &mut recorder, coverage);
        // After a fault, the state of the robot is unknown, so it is always stopped.
        let _ = drive.robot.stop();
        recorder.course.pose = Some(drive.robot.pose());
        Ok(recorder.course)
    }
}

/// A robot that is driven by the plan.
struct DrivenRobot<'s> {
    simulation: &'s Simulation,
    robot: Observed,
    engine: Engine<SimAlphabet>,
    input: Twist,
    transitions: Transitions,
    watched: TestConditions,
}

impl DrivenRobot<'_> {
    /// Makes turns until the end of the run.
    fn turns(
        &mut self,
        subject: &Subject,
        expected: &Expected,
        recorder: &mut CourseRecorder<'_>,
        coverage: &mut Coverage,
    ) -> TestEnd {
        let nanos = |time: Duration| u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        let (period, timeout) = (nanos(self.simulation.trials.period), nanos(self.simulation.timeout));
        for number in 0.. {
            let t = Nanos(u64::saturating_mul(number, period));
            // A fault in this turn is reported with this time.
            recorder.course.t = t;
            let y = match self.exchange(t) {
                Ok(y) => y,
                Err(fault) => return TestEnd::Failed(fault),
            };
            let turn = match self.turn(y, t, number) {
                Ok(turn) => turn,
                Err(fault) => return TestEnd::Failed(fault),
            };
            self.follow(subject, (t, y), recorder, coverage);
            self.breaches(expected, (t, y), recorder);
            if turn == Turn::Over {
                return self.exchange(t).map_or_else(TestEnd::Failed, |_| TestEnd::Over);
            }
            if t.0 >= timeout {
                break;
            }
        }
        TestEnd::Running
    }

    fn exchange(&mut self, t: Nanos) -> Result<Sensed, String> {
        let faults = &self.simulation.faults;
        let input = faults::before(faults, &mut self.robot, self.input, t)?;
        let mut y = self.robot.exchange(&input).map_err(|fault| fault.to_string())?;
        faults::after(faults, &mut y, t);
        self.engine.complete(&mut y, t);
        Ok(y)
    }

    fn turn(&mut self, y: Sensed, t: Nanos, number: u64) -> Result<Turn<()>, String> {
        self.transitions.clear();
        let turn =
            self.engine.turn(PilotTurn { y: &y, t, number }, &mut self.transitions).map_err(|fault| match fault {
                PilotFault::Stopped(sentence) => sentence,
                PilotFault::Panicked(message) => format!("a panic, which is a bug: {message}"),
            })?;
        self.input = turn.input();
        Ok(match turn {
            Turn::Law(_) => Turn::Law(()),
            Turn::Cut => Turn::Cut,
            Turn::Over => Turn::Over,
        })
    }

    fn follow(
        &self,
        subject: &Subject,
        (t, y): (Nanos, Sensed),
        recorder: &mut CourseRecorder<'_>,
        coverage: &mut Coverage,
    ) {
        // A plan that reads modules waits for their first values.
        let Some(machine) = self.engine.machine() else { return recorder.waits(t) };
        let (plan, cursor) = (machine.plan(), machine.cursor());
        let words = |transition: &_, operands: &[_]| cause_words(plan, transition, operands);
        recorder.turn(t, machine.atom(), &self.transitions, words);
        let own = t.since(self.engine.zero());
        coverage.turn(subject.machine(), machine.atom(), &self.transitions, |scope, tell| {
            plan.operands(cursor, scope, &y, own, &mut |number, _| tell(number));
        });
    }

    /// Records the forbidden states that occur in a turn.
    fn breaches(&mut self, expected: &Expected, (t, y): (Nanos, Sensed), recorder: &mut CourseRecorder<'_>) {
        if expected.never.is_empty() {
            return;
        }
        if self.watched.is_empty() {
            self.watched.extend(expected.never.iter().map(|(_, never)| watched(never, &y, t)));
        }
        let atom = self.engine.machine().and_then(Machine::atom);
        for (number, ((_, never), condition)) in expected.never.iter().zip(&self.watched).enumerate() {
            if recorder.course.breaches.iter().any(|breach| breach.number == number) {
                continue;
            }
            match never {
                ForbiddenState::Closer(least) => {
                    let gap = self.robot.gap(*least);
                    if gap < *least {
                        recorder.breach(number, Some(gap));
                    }
                }
                ForbiddenState::While { atoms, .. } => {
                    let runs = atoms.as_ref().is_none_or(|atoms| atom.is_some_and(|atom| atoms.holds(atom)));
                    let is_true = |machine: &Machine<LoadedPlan<SimAlphabet>>| {
                        let ending = machine.plan().next(machine.cursor(), &y, t);
                        // The law of the condition's plan may complete as well.
                        ending.is_some_and(|ending| matches!(ending.cause, Cause::Fired(_)))
                    };
                    if runs && condition.as_ref().is_none_or(is_true) {
                        recorder.breach(number, None);
                    }
                }
            }
        }
    }
}

/// Starts the plan of an expectation's condition; returns `None` if the expectation has no condition.
fn watched(never: &ForbiddenState, y: &Sensed, t: Nanos) -> Option<Machine<LoadedPlan<SimAlphabet>>> {
    let ForbiddenState::While { condition: Some(condition), .. } = never else { return None };
    let TestCondition { loaded, .. } = &**condition;
    loaded.as_ref().map(|loaded| Machine::begin(loaded.plan(), y, t))
}

/// Returns an option of a test as an argument. A file of a world or a folder of paths is relative to the folder of the
/// test.
fn word(name: &str, value: &str, path: &Path) -> String {
    let file = path.with_file_name(value);
    if ["world", "paths"].contains(&name) && !value.is_empty() && file.exists() {
        return format!("--{name}={}", file.display());
    }
    format!("--{name}={value}")
}

/// Returns the error for an option that was refused, at the place of its value.
fn refused(text: &str, test: &TestText) -> TestFileError {
    let is_about_option = |line: &&str| !line.starts_with("Usage:") && !line.starts_with("For more information");
    let lines = text.lines().take_while(is_about_option).filter(|line| !line.trim().is_empty());
    let lines: Vec<_> = lines.map(|line| line.strip_prefix("error: ").unwrap_or(line).trim()).collect();
    let message = lines.join("; ");
    let place = test.options().into_iter().find(|(name, ..)| message.contains(&format!("--{name}")));
    let place = place.map_or(test.name.span(), |(.., place)| place);
    TestFileError::at(place, message.trim_start_matches("--"))
}
