//! A running robot of a scenario: makes the robot's turns, and records its way back.

use std::collections::VecDeque;
use std::fmt::Write as _;

use mdle_compiler::load::{Loaded, LoadedPlan};
use mdle_engine::link::{Air, StateLink};
use mdle_engine::{Engine, Library, Recorder as _};
use mdle_host::{
    Microphones, Pace, Passes, Pilot as _, PilotFault, PilotTurn, RobotTurn, RunTerms, StopRequest, Target as _, Time,
    Transitions, cause_words, place,
};
use mdle_record::RecordedChange;
use mdle_runtime::{Machine, Nanos, PathStore, Plan as _, Robot as _, Sensed, Setpoint, StoredPath, Turn, Twist};
use mdle_sim::alphabet::Alphabet as SimAlphabet;
use mdle_sim::{RobotEars, Sim, Simulated};

use super::sent_plan::SentPlan;
use super::setup::{Scenario, ScenarioRobot};
use crate::modules::{AudioSource, SoundInput};
use crate::plans;
use crate::way_recorder::{WayRecorder, WayTurn};

/// A running robot.
pub(super) struct Runner {
    pub(super) name: String,
    pub(super) robot: Simulated,
    pub(super) standing: MemberState,
    engine: Engine<SimAlphabet>,
    input: Twist,
    transitions: Transitions,
    passes: Passes,
    /// Number of the plan that made the last turn, counting from 1.
    plan_number: u64,
    killed: Option<Nanos>,
    recorder: Option<WayRecorder>,
    /// Path that was recorded in the previous turn and has replaced an earlier path; `None` if no path was recorded.
    replaced: Option<StoredPath>,
    /// Ears of the robot, and the microphones that pass their samples to the module `heading`; `None` for a robot
    /// without ears.
    ears: Option<(RobotEars, Microphones)>,
    /// Plans that the robot has not sent yet.
    sends: VecDeque<SentPlan>,
}

/// State of a robot in a scenario.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum MemberState {
    /// The robot's plan runs.
    Drives,
    /// The robot's plan is over.
    Over,
    /// The robot's program was killed.
    Killed,
    /// A fault has stopped the robot; contains the message about the fault.
    Failed(String),
}

/// Data of a robot's turn, for the log.
pub(super) struct MemberTurn {
    /// Lines for the report, without the time and the robot's name.
    pub(super) lines: Vec<String>,
    /// Number of the atom's state, and its law; `None` if no law was applied.
    pub(super) law: Option<(u64, String)>,
    /// Name and text of the path that was recorded in this turn; `None` if no path was recorded.
    pub(super) path: Option<(&'static str, String)>,
    /// `true` if a plan has replaced another one in this turn.
    pub(super) begins: bool,
    /// Source of the input; `None` if the robot was not driven.
    pub(super) kind: Option<Turn<()>>,
    /// Changes in this turn, which a record needs in addition to the robot's output.
    pub(super) changes: Vec<RecordedChange>,
}

impl Runner {
    /// Returns a robot before its first turn.
    ///
    /// # Errors
    /// Fails with a message if a module is refused.
    pub(super) fn new(
        member: ScenarioRobot,
        air: Air,
        scenario: &Scenario,
        library: &Library<Sensed>,
        is_recorded: bool,
    ) -> Result<Self, String> {
        let ScenarioRobot {
            name,
            mut robot,
            start,
            loaded,
            paths,
            records,
            killed,
            ears,
            shares,
            plans_from,
            sends,
            ..
        } = member;
        let microphones = Microphones::default();
        let terms = RunTerms {
            time: Time::Stepped(Pace::Max),
            period: scenario.period,
            request: StopRequest::default(),
            microphones: microphones.clone(),
        };
        let plan = Loaded::plan(&loaded);
        let hearing = ears.as_ref().map(|(_, radius)| SoundInput { source: AudioSource::Robot, radius: *radius });
        let added = hearing.map(|hearing| hearing.added(library, &microphones));
        let engine = Engine::new(plan, added.as_ref().unwrap_or(library), &terms);
        let engine = engine.map_err(|refusal| refusal.to_string())?;
        let (takes_plans, others) = (!plans_from.is_empty(), air.others());
        let link =
            StateLink::new(Box::new(air), &name, start).sharing(&shares).exchanging_plans(plans_from, Vec::new());
        let mut engine = engine.linked(link).map_err(|refusal| format!("the robot `{name}`: {refusal}"))?;
        if takes_plans {
            plans::begin_at_once(engine.plans_mut(), &scenario.target, others);
        }
        if is_recorded {
            engine.record();
        }
        let stored =
            |(name, setpoints): (&'static str, Vec<Setpoint>)| StoredPath { name, setpoints: setpoints.leak() };
        let mut stored: Vec<StoredPath> = paths.into_iter().map(stored).collect();
        stored.sort_by_key(|path| path.name);
        robot.paths = PathStore::new(stored.leak());
        Ok(Self {
            name,
            robot,
            standing: MemberState::Drives,
            engine,
            input: Twist::default(),
            transitions: Transitions::default(),
            passes: Passes::default(),
            plan_number: 1,
            killed,
            recorder: records.zip(Sim::PATHS).map(|(path, replays)| WayRecorder::new(path, replays.fastest)),
            replaced: None,
            ears: ears.map(|(ears, _)| (ears, microphones)),
            sends: sends.into(),
        })
    }

    /// Returns the running plan; `None` if no plan has begun.
    pub(super) fn machine(&self) -> Option<&Machine<LoadedPlan<SimAlphabet>>> {
        self.engine.machine()
    }

    /// Returns a turn for the robot's record; `None` if the robot was not driven.
    pub(super) fn recorded<'t>(&'t self, moment: PilotTurn<'t, Sensed>, made: &MemberTurn) -> Option<RobotTurn<'t>> {
        let PilotTurn { y, t, number } = moment;
        let plan = self.machine().map(|machine| (machine.plan() as &dyn mdle_host::Texts, machine.state()));
        let (sent, transitions, changes) = (self.input, &self.transitions, made.changes.clone());
        let (kind, plan_number) = (made.kind?, self.engine.plan_number());
        let begins = made.begins.then(|| self.engine.reason());
        Some(RobotTurn { number, t, y, sent, kind, plan, plan_number, begins, transitions, changes })
    }

    /// Stops the robot.
    pub(super) fn stop(&mut self) {
        // A simulated robot always obeys.
        let _ = self.robot.stop();
    }

    /// Moves the robot for one period.
    pub(super) fn moves(&mut self) {
        if let Err(fault) = self.robot.moves(&self.input) {
            self.fails(fault.to_string());
        }
    }

    /// Stops the robot because of a fault.
    fn fails(&mut self, sentence: String) {
        self.standing = MemberState::Failed(sentence);
        self.input = Twist::default();
    }

    /// Makes turn `number` at time `t` with the output `y`. A robot that is no longer driven does not move.
    pub(super) fn turn(&mut self, y: &Sensed, t: Nanos, number: u64) -> MemberTurn {
        let (lines, changes) = (Vec::new(), Vec::new());
        let mut made = MemberTurn { lines, law: None, path: None, begins: false, kind: None, changes };
        if self.standing == MemberState::Drives && self.killed.is_some_and(|killed| t >= killed) {
            self.standing = MemberState::Killed;
            made.lines.push("its program was killed".to_owned());
        }
        self.input = Twist::default();
        if self.standing != MemberState::Drives {
            return made;
        }
        if let Some((ears, microphones)) = &mut self.ears {
            microphones.put(t, ears.heard(&self.robot.pose(), t));
        }
        while let Some(SentPlan { to, name, text, when, .. }) = self.sends.pop_front_if(|plan| plan.at <= t) {
            if let Err(sentence) = self.engine.send_plan(&to, (&name, &text, when), t) {
                made.lines.push(format!("warning: no plan is sent to {to}: {sentence}"));
            }
        }
        self.transitions.clear();
        let mut complete = *y;
        self.engine.complete(&mut complete, t);
        match self.engine.turn(PilotTurn { y: &complete, t, number }, &mut self.transitions) {
            Ok(turn) => {
                made.kind = Some(match turn {
                    Turn::Law(_) => Turn::Law(()),
                    Turn::Cut => Turn::Cut,
                    Turn::Over => Turn::Over,
                });
                self.reports(&mut made);
                if turn == Turn::Over {
                    self.standing = MemberState::Over;
                }
                self.input = turn.input();
            }
            Err(PilotFault::Stopped(sentence)) => self.fails(sentence),
            Err(PilotFault::Panicked(message)) => self.fails(format!("a panic, which is a bug: {message}")),
        }
        made.changes = self.engine.take_changes();
        // The path recorded in the previous turn is part of this turn's output.
        let replaced = self.replaced.take();
        made.changes.extend(replaced.map(|StoredPath { name, setpoints }| RecordedChange::Path {
            name: name.to_owned(),
            setpoints: setpoints.to_vec(),
        }));
        self.engine.messages(&mut |message| made.lines.push(message.to_owned()));
        if let MemberState::Failed(sentence) = &self.standing {
            made.lines.push(format!("error: {sentence}"));
        }
        made.path = self.records(y, made.law.as_ref().map(|(_, law)| law.as_str()), &mut made.lines);
        made
    }

    /// Records the transitions of the turn, and the current law.
    fn reports(&mut self, made: &mut MemberTurn) {
        let Self { engine, transitions, passes, plan_number, .. } = self;
        made.begins = std::mem::replace(plan_number, engine.plan_number()) != engine.plan_number();
        let Some(machine) = engine.machine() else { return };
        let plan = machine.plan();
        if made.begins {
            *passes = Passes::default();
            let begun = machine.atom().map(|atom| format!("{} ({})", plan.law(atom), place(plan, passes, atom)));
            made.lines.extend(begun.map(|begun| format!("{begun}  <- {}", engine.reason())));
        }
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

    /// Records the path that the robot drives under `path` and `Follow`. If the way back has replaced a path, returns
    /// the name and the new text of this path.
    fn records(&mut self, y: &Sensed, law: Option<&str>, lines: &mut Vec<String>) -> Option<(&'static str, String)> {
        let recorder = self.recorder.as_mut()?;
        let has_changed = !self.transitions.is_empty();
        let turn = WayTurn { here: &y.odometry, paths: self.robot.paths, law, has_changed };
        let taken = recorder.take(&turn);
        self.robot.paths = recorder.store().unwrap_or(self.robot.paths);
        self.replaced = recorder.take_replaced();
        match taken {
            Ok(text) => Some((recorder.path(), text?)),
            Err(sentence) => {
                lines.push(format!("warning: {sentence}"));
                None
            }
        }
    }
}

impl MemberState {
    /// Returns a short description of the robot's state at the end of a run. `law` is the law that still runs; `None`
    /// if no law runs.
    pub(super) fn words(&self, law: Option<&str>) -> String {
        let mut words = match self {
            Self::Drives => "still runs".to_owned(),
            Self::Over => "plan over".to_owned(),
            Self::Killed => "killed".to_owned(),
            // The help text follows the message on separate lines.
            Self::Failed(sentence) => format!("failed: {}", sentence.lines().next().unwrap_or_default()),
        };
        if let (Self::Drives, Some(law)) = (self, law) {
            // Writing to a string cannot fail.
            let _ = write!(words, " {law}");
        }
        words
    }
}
