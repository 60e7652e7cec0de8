//! The turns of a plan on a robot, and their recipients.

use std::io::{self, Write};

use mdle_runtime::fsm::Kind;
use mdle_runtime::{Nanos, Turn};

use crate::cause::place;
use crate::clock::{Clock, Instants};
use crate::cycle::{Limits, Step, Turns, cycle};
use crate::drive::{Drive, Position};
use crate::log::{Entry, Log};
use crate::paths::Recorder;
use crate::progress::Progress;
use crate::report::Report;
use crate::run_end::{RunEnd, say};
use crate::signals::Signals;
use crate::timing::Timing;
use crate::transitions::Transitions;
use crate::{Around, Ended, Observer, PlanPosition};

/// Recipients of the turns' reports.
pub(crate) struct Witnesses<'a, 'o> {
    /// The lines on standard output.
    pub(crate) report: &'a mut Report<'o>,
    /// The run log, if one was asked for.
    pub(crate) log: Option<&'a mut Log>,
    /// The path that is driven, if it is to be recorded.
    pub(crate) path: Option<&'a mut Recorder>,
    /// The line that shows that a fast run goes on, if standard error is a terminal.
    pub(crate) progress: Option<Progress<'a>>,
    /// Standard error, where it does not show that line.
    pub(crate) err: Option<&'a mut dyn Write>,
}

/// Makes the turns of a plan on its robot: see [`cycle`].
pub(crate) fn run<I: Instants>(
    drive: &mut dyn Drive,
    limits: Limits,
    clock: &mut Clock<I>,
    signals: &Signals,
    witnesses: &mut Witnesses<'_, '_>,
) -> RunEnd {
    let mut turns = OnePlan { drive, witnesses, transitions: Transitions::default(), fresh: true };
    cycle(&mut turns, limits, clock, signals)
}

/// The turns of a plan, with those who follow them.
struct OnePlan<'t, 'a, 'o> {
    drive: &'t mut dyn Drive,
    witnesses: &'t mut Witnesses<'a, 'o>,
    /// The transitions of the last turn.
    transitions: Transitions,
    /// `true` if the current atom has been entered since a law was applied last.
    fresh: bool,
}

impl Turns for OnePlan<'_, '_, '_> {
    fn exchange(&mut self) -> Result<(), String> {
        self.drive.exchange()
    }

    fn turn(&mut self, t: Nanos, number: u64) -> Result<Step, RunEnd> {
        let Self { drive, witnesses, transitions, fresh } = self;
        if let (Some(path), Some((heading, speed))) = (&mut witnesses.path, drive.motion()) {
            path.take(heading, speed, t);
        }
        transitions.clear();
        let turn = drive.turn(t, number, transitions);
        drive.messages(&mut |message| witnesses.say(message));
        let turn = turn?;
        let zero = drive.zero();
        *fresh |= !transitions.is_empty();
        if let (observer, Some(position)) = drive.parts() {
            let written = witnesses.tell(position, turn, number, t, transitions);
            written.map_err(|error| RunEnd::Log(error.to_string()))?;
            let has_begun = turn == Turn::Law(()) && std::mem::take(fresh);
            if let Some(observer) = observer {
                watched(observer, position, turn, has_begun, (t, zero), witnesses.report);
            }
        }
        Ok(if turn == Turn::Over { Step::Over } else { Step::Next })
    }

    fn tell_timing(&mut self, timing: &Timing) {
        if let Some(err) = &mut self.witnesses.err {
            say(err, format_args!("{timing}"));
        }
    }

    fn ended(&mut self, ending: &RunEnd, t: Nanos) {
        if let (Some(observer), Some(position)) = self.drive.parts() {
            ended(observer, position, ending, self.witnesses.report, t);
        }
    }
}

/// Tells the observer about a turn at time `t` of a plan that began at `zero`, and first which atom `has_begun` in it.
fn watched(
    observer: &mut dyn Observer,
    position: &dyn Position,
    turn: Turn<()>,
    has_begun: bool,
    (t, zero): (Nanos, Nanos),
    report: &Report<'_>,
) {
    let plan = position.texts();
    let atom = position.atom().and_then(|atom| Some((atom, plan.fsm().atoms.get(atom as usize)?)));
    if let Some((atom, written)) = atom.filter(|_| has_begun) {
        observer.began(written.state, plan.law(atom), t);
    }
    if turn != Turn::Over && observer.looks() {
        observer.turned(&standing(position, t, zero, report));
    }
}

/// Tells the observer that the turns have ended, and by what.
fn ended(observer: &mut dyn Observer, position: &dyn Position, ending: &RunEnd, report: &Report<'_>, t: Nanos) {
    let by = report.over().map_or_else(|| ending.brief(), |over| over.cause.clone());
    observer.ended(&Ended { plan: position.texts().name(0), is_over: *ending == RunEnd::Over, by: &by, t });
}

/// Returns the state of a plan that is not over, and that began at time `zero`.
fn standing<'m>(position: &'m dyn Position, t: Nanos, zero: Nanos, report: &'m Report<'_>) -> PlanPosition<'m> {
    let (plan, fsm) = (position.texts(), position.texts().fsm());
    let atom = position.atom().and_then(|atom| fsm.atoms.get(atom as usize));
    let own = atom.and_then(|atom| fsm.brackets.get(atom.scope as usize)).map(|bracket| bracket.kind);
    let levels = match own {
        Some(Kind::Scope { level }) => 0..=level,
        Some(Kind::Loop { .. }) | None => 0..=0,
    };
    let scopes = levels.map(|level| {
        let scope = position.scope(level);
        Around { name: plan.name(scope), condition: plan.condition(scope), since: position.since(level, t.since(zero)) }
    });
    let law = position.atom().map_or("", |atom| plan.law(atom));
    let place = position.atom().map_or_else(String::new, |atom| place(plan, report.passes(), atom));
    PlanPosition { t, state: position.state(), law, place, since: report.since(), scopes: scopes.collect() }
}

impl Witnesses<'_, '_> {
    /// Reports a message for the operator.
    fn say(&mut self, message: &str) {
        match (&mut self.progress, &mut self.err) {
            (Some(progress), _) => progress.say(message),
            (None, Some(err)) => say(err, format_args!("{message}")),
            (None, None) => {}
        }
    }

    /// Reports a turn to the recipients.
    fn tell(
        &mut self,
        position: &dyn Position,
        turn: Turn<()>,
        number: u64,
        t: Nanos,
        transitions: &Transitions,
    ) -> io::Result<()> {
        let plan = position.texts();
        self.report.turn(plan, t, transitions);
        if let Some(progress) = &mut self.progress {
            let law = position.atom().map_or("", |atom| plan.law(atom));
            progress.run(t, law, self.report);
        }
        let Some(log) = self.log.as_mut() else { return Ok(()) };
        let applied = match turn {
            Turn::Law(()) => position.atom(),
            Turn::Cut | Turn::Over => None,
        };
        let frame = position.frame().filter(|_| applied.is_some());
        log.turn(&Entry { plan, turn: number, t, state: position.state(), applied, frame, transitions })
    }
}
