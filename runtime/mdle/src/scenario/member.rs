//! A robot of a scenario that runs: its turns, and the way back that it records.

use std::fmt::Write as _;

use mdle_compiler::load::{Loaded, LoadedPlan};
use mdle_engine::link::{Air, StateLink};
use mdle_engine::{Engine, Library};
use mdle_host::{
    Moment, Pace, Passes, Pilot as _, PilotFault, RunTerms, StopRequest, Target as _, Time, Transitions, cause_words,
    place, setpoints,
};
use mdle_runtime::{
    Frame, Machine, Nanos, PathStore, Plan as _, Pose, Robot as _, Sensed, Setpoint, StoredPath, Turn, Twist,
};
use mdle_sim::alphabet::Alphabet as SimAlphabet;
use mdle_sim::{Sim, Simulated};

use super::setup::{Member, Scenario};
use super::way_back::Way;

/// Maximum number of setpoints that the recorded paths of all robots have: they stay until the program ends.
const SETPOINTS: usize = 2_000_000;

/// A robot that runs.
pub(super) struct Runner {
    pub(super) name: String,
    pub(super) robot: Simulated,
    pub(super) standing: Standing,
    engine: Engine<SimAlphabet>,
    input: Twist,
    transitions: Transitions,
    passes: Passes,
    killed: Option<Nanos>,
    recorder: Option<Recorder>,
    paths: Vec<StoredPath>,
    /// Number of setpoints that were recorded.
    recorded: usize,
}

/// State of a robot of a scenario: driven or not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Standing {
    /// Its plan runs.
    Drives,
    /// Its plan is over.
    Over,
    /// Its program was killed.
    Killed,
    /// A fault has stopped it: a sentence.
    Failed(String),
}

/// The recorder of a robot.
struct Recorder {
    /// Name of the path that it replaces.
    path: &'static str,
    /// The way of the law that runs, if that is recorded.
    way: Option<Way>,
    /// Frame of the plan.
    frame: Option<Frame>,
}

/// A turn of a robot, for the log.
pub(super) struct MemberTurn {
    /// Lines for the report, without the time and the name.
    pub(super) lines: Vec<String>,
    /// Number of the atom's state, and its law; `None` if no law was applied.
    pub(super) law: Option<(u64, String)>,
    /// Text of the path that was recorded in this turn, by its name.
    pub(super) path: Option<(&'static str, String)>,
}

impl Runner {
    /// Returns a robot before its first turn.
    ///
    /// # Errors
    /// A module is refused: a sentence.
    pub(super) fn new(
        member: Member,
        air: Air,
        scenario: &Scenario,
        library: &Library<Sensed>,
    ) -> Result<Self, String> {
        let Member { name, robot, start, loaded, paths, records, killed, .. } = member;
        let terms =
            RunTerms { time: Time::Stepped(Pace::Max), period: scenario.period, request: StopRequest::default() };
        let plan = Loaded::plan(&loaded);
        let engine = Engine::new(plan, library, &terms).map_err(|refusal| format!("{refusal:?}"))?;
        let engine = engine.linked(StateLink::new(Box::new(air), &name, start));
        let stored =
            |(name, setpoints): (&'static str, Vec<Setpoint>)| StoredPath { name, setpoints: setpoints.leak() };
        let mut runner = Self {
            name,
            robot,
            standing: Standing::Drives,
            engine,
            input: Twist::default(),
            transitions: Transitions::default(),
            passes: Passes::default(),
            killed,
            recorder: records.map(|path| Recorder { path, way: None, frame: None }),
            paths: paths.into_iter().map(stored).collect(),
            recorded: 0,
        };
        runner.store_paths();
        Ok(runner)
    }

    /// Returns the plan that runs, once it has begun.
    pub(super) fn machine(&self) -> Option<&Machine<LoadedPlan<SimAlphabet>>> {
        self.engine.machine()
    }

    /// Stops the robot.
    pub(super) fn stop(&mut self) {
        // A simulated robot always obeys.
        let _ = self.robot.stop();
    }

    /// Drives for one period.
    pub(super) fn moves(&mut self) {
        if let Err(fault) = self.robot.moves(&self.input) {
            self.fails(fault.to_string());
        }
    }

    /// Stops the robot for a fault.
    fn fails(&mut self, sentence: String) {
        self.standing = Standing::Failed(sentence);
        self.input = Twist::default();
    }

    /// Makes turn `number` at time `t` with this output; a robot that is no longer driven stands.
    pub(super) fn turn(&mut self, y: &Sensed, t: Nanos, number: u64) -> MemberTurn {
        let mut made = MemberTurn { lines: Vec::new(), law: None, path: None };
        if self.standing == Standing::Drives && self.killed.is_some_and(|killed| t >= killed) {
            self.standing = Standing::Killed;
            made.lines.push("its program was killed".to_owned());
        }
        self.input = Twist::default();
        if self.standing != Standing::Drives {
            return made;
        }
        self.transitions.clear();
        match self.engine.turn(Moment { y, t, number }, &mut self.transitions) {
            Ok(turn) => {
                self.reports(&mut made);
                if turn == Turn::Over {
                    self.standing = Standing::Over;
                }
                self.input = turn.input();
            }
            Err(PilotFault::Stopped(sentence)) => self.fails(sentence),
            Err(PilotFault::Panicked(message)) => self.fails(format!("a panic, which is a bug: {message}")),
        }
        self.engine.messages(&mut |message| made.lines.push(message.to_owned()));
        if let Standing::Failed(sentence) = &self.standing {
            made.lines.push(format!("error: {sentence}"));
        }
        made.path = self.records(&y.odometry, made.law.as_ref().map(|(_, law)| law.as_str()), &mut made.lines);
        made
    }

    /// Notes the transitions of the turn, and the law that runs.
    fn reports(&mut self, made: &mut MemberTurn) {
        let Self { engine, transitions, passes, .. } = self;
        let Some(machine) = engine.machine() else { return };
        let plan = machine.plan();
        for (transition, operands) in transitions.iter() {
            passes.step(plan.fsm(), transition);
            let cause = cause_words(plan, transition, operands);
            let line = match transition.atom {
                None => format!("plan over: {cause}"),
                Some(atom) => {
                    let place = place(plan, passes, atom);
                    format!("{} ({place})  <- {cause}", plan.law(atom))
                }
            };
            made.lines.push(line);
        }
        made.law = machine.atom().map(|atom| (machine.state(), plan.law(atom).to_owned()));
    }

    /// Records the way of `path` and `Follow`; returns the way back when such a law has ended, and replaces the path
    /// by it.
    fn records(&mut self, here: &Pose, law: Option<&str>, lines: &mut Vec<String>) -> Option<(&'static str, String)> {
        let has_changed = !self.transitions.is_empty();
        let recorder = self.recorder.as_mut()?;
        let frame = *recorder.frame.get_or_insert(Frame(here.theta));
        let is_recorded = law.is_some_and(|law| ["path ", "Follow "].iter().any(|name| law.starts_with(name)));
        let ended = if has_changed { recorder.way.take() } else { None };
        if is_recorded {
            recorder.way.get_or_insert_default().went(here);
        }
        let path = recorder.path;
        let mut way = ended?;
        way.went(here);
        let text = way.back(frame.0)?;
        match self.replace(path, &text) {
            Ok(()) => Some((path, text)),
            Err(sentence) => {
                lines.push(format!("warning: the way back is not recorded: {sentence}"));
                None
            }
        }
    }

    /// Replaces a path by the one of this text.
    fn replace(&mut self, name: &'static str, text: &str) -> Result<(), String> {
        let Some(replays) = Sim::PATHS else { return Ok(()) };
        let setpoints = setpoints(name, text.as_bytes(), replays.fastest)?;
        self.recorded = self.recorded.saturating_add(setpoints.len());
        if self.recorded > SETPOINTS {
            return Err(format!("it has recorded more than {SETPOINTS} rows, which is the most"));
        }
        self.paths.retain(|path| path.name != name);
        self.paths.push(StoredPath { name, setpoints: setpoints.leak() });
        self.store_paths();
        Ok(())
    }

    /// Gives the robot its paths.
    fn store_paths(&mut self) {
        self.paths.sort_by_key(|path| path.name);
        self.robot.paths = PathStore::new(self.paths.clone().leak());
    }
}

impl Standing {
    /// Returns a few words about a robot at the end of a run.
    pub(super) fn words(&self, law: Option<&str>) -> String {
        let mut words = match self {
            Self::Drives => "still runs".to_owned(),
            Self::Over => "plan over".to_owned(),
            Self::Killed => "killed".to_owned(),
            Self::Failed(sentence) => format!("failed: {sentence}"),
        };
        if let (Self::Drives, Some(law)) = (self, law) {
            // Writing to a string cannot fail.
            let _ = write!(words, " {law}");
        }
        words
    }
}
