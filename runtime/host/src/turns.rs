//! The turns of a plan on a robot: exchange, time, machine, and the wait for the next (docs/src/reference/semantics.md,
//! 5.1).

use std::io::{self, Write};
use std::time::Duration;

use mdle_runtime::fsm::Kind;
use mdle_runtime::{Nanos, Turn};

use crate::cause::place;
use crate::clock::{Clock, Instants, nanos};
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

/// Limits at which a run ends whose plan is not over.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Time of the plan at which the run ends. The turn at that time is still made: the plan may be over in it.
    pub(crate) timeout: Option<Duration>,
    /// Number of turns after which the run ends.
    pub(crate) turns: Option<u64>,
}

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

/// Makes the turns of a plan on its robot, from the exchange of turn 0 until something ends them.
///
/// The robot still executes its last input: the caller has to send the null input and the stop, also after a panic.
pub(crate) fn run<I: Instants>(
    drive: &mut dyn Drive,
    limits: Limits,
    clock: &mut Clock<I>,
    signals: &Signals,
    witnesses: &mut Witnesses<'_, '_>,
) -> RunEnd {
    if let Some(signal) = signals.caught() {
        return RunEnd::Signal(signal);
    }
    if let Err(fault) = drive.exchange() {
        return RunEnd::Unstarted(fault);
    }
    let mut t = clock.zero();
    let mut transitions = Transitions::default();
    // Whether the current atom has been entered since a law was applied last.
    let mut fresh = true;
    let mut number: u64 = 0;
    let ending = loop {
        if let (Some(path), Some((heading, speed))) = (&mut witnesses.path, drive.motion()) {
            path.take(heading, speed, t);
        }
        transitions.clear();
        let turn = drive.turn(t, &mut transitions);
        fresh |= !transitions.is_empty();
        if let (observer, Some(position)) = drive.parts() {
            if let Err(error) = witnesses.tell(position, turn, number, t, &transitions) {
                break RunEnd::Log(error.to_string());
            }
            let has_begun = turn == Turn::Law(()) && std::mem::take(&mut fresh);
            if let Some(observer) = observer {
                watched(observer, position, turn, has_begun, t, witnesses.report);
            }
        }
        if turn == Turn::Over {
            break RunEnd::Over;
        }
        number = number.saturating_add(1);
        if let Some(ending) = limits.reached(number, t) {
            break ending;
        }
        if signals.timing_is_asked_for() {
            witnesses.tell_timing(clock.timing());
        }
        if let Err(ending) = clock.next_turn(signals) {
            break ending;
        }
        if let Err(fault) = drive.exchange() {
            break RunEnd::Robot(fault);
        }
        t = clock.taken();
    };
    if let (Some(observer), Some(position)) = drive.parts() {
        ended(observer, position, &ending, witnesses.report, t);
    }
    ending
}

/// Tells the observer about a turn, and first which atom `has_begun` in it.
fn watched(
    observer: &mut dyn Observer,
    position: &dyn Position,
    turn: Turn<()>,
    has_begun: bool,
    t: Nanos,
    report: &Report<'_>,
) {
    let plan = position.texts();
    let atom = position.atom().and_then(|atom| Some((atom, plan.fsm().atoms.get(atom as usize)?)));
    if let Some((atom, written)) = atom.filter(|_| has_begun) {
        observer.began(written.state, plan.law(atom), t);
    }
    if turn != Turn::Over && observer.looks() {
        observer.turned(&standing(position, t, report));
    }
}

/// Tells the observer that the turns have ended, and by what.
fn ended(observer: &mut dyn Observer, position: &dyn Position, ending: &RunEnd, report: &Report<'_>, t: Nanos) {
    let by = report.over().map_or_else(|| ending.brief(), |over| over.cause.clone());
    observer.ended(&Ended { plan: position.texts().name(0), is_over: *ending == RunEnd::Over, by: &by, t });
}

/// Returns the state of a plan that is not over.
fn standing<'m>(position: &'m dyn Position, t: Nanos, report: &'m Report<'_>) -> PlanPosition<'m> {
    let (plan, fsm) = (position.texts(), position.texts().fsm());
    let atom = position.atom().and_then(|atom| fsm.atoms.get(atom as usize));
    let own = atom.and_then(|atom| fsm.brackets.get(atom.scope as usize)).map(|bracket| bracket.kind);
    let levels = match own {
        Some(Kind::Scope { level }) => 0..=level,
        Some(Kind::Loop { .. }) | None => 0..=0,
    };
    let scopes = levels.map(|level| {
        let scope = position.scope(level);
        Around { name: plan.name(scope), condition: plan.condition(scope), since: position.since(level, t) }
    });
    let law = position.atom().map_or("", |atom| plan.law(atom));
    let place = position.atom().map_or_else(String::new, |atom| place(plan, report.passes(), atom));
    PlanPosition { t, state: position.state(), law, place, since: report.since(), scopes: scopes.collect() }
}

impl Limits {
    /// Returns the limit that a plan has reached, if it is not over after `turns` turns, the last one at time `t`.
    fn reached(&self, turns: u64, t: Nanos) -> Option<RunEnd> {
        let timeout = self.timeout.filter(|limit| t.0 >= nanos(*limit)).map(RunEnd::Timeout);
        timeout.or(self.turns.filter(|limit| turns >= *limit).map(RunEnd::Turns))
    }
}

impl Witnesses<'_, '_> {
    /// Reports how late turns begin and how long they take.
    fn tell_timing(&mut self, timing: Option<&Timing>) {
        if let (Some(err), Some(timing)) = (&mut self.err, timing) {
            say(err, format_args!("{timing}"));
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
