//! Makes the turns of a plan on a robot, and passes reports of them to all recipients.

use std::io::{self, Write};

use mdle_runtime::{Nanos, Turn};

use crate::clock::Clock;
use crate::cycle::{RunLimits, TurnEnd, Turns, cycle};
use crate::drive::Drive;
use crate::instants::Instants;
use crate::log::LogEntry;
use crate::paths::PathRecording;
use crate::pilot::AfterPlan;
use crate::position::Position;
use crate::progress::ProgressLine;
use crate::record::UnmadeTurn;
use crate::report::ReportWriter;
use crate::run_end::{RunEnd, say};
use crate::run_log::RunLog;
use crate::signals::Signals;
use crate::standing::standing;
use crate::supervised::Supervised;
use crate::timing::Timing;
use crate::transitions::Transitions;
use crate::turn_watch::WatchedRun;
use crate::views::ByOdometry;
use crate::{BreakOrders, Ended, Observer, Pace, Verdict};

/// Recipients of the reports about turns.
pub(crate) struct Witnesses<'a, 'o> {
    /// Report on standard output.
    pub(crate) report: &'a mut ReportWriter<'o>,
    /// Run log; `None` if the options do not request it.
    pub(crate) log: Option<&'a mut RunLog>,
    /// Recorder of the driven path; `None` if the options do not request it.
    pub(crate) path: Option<&'a mut PathRecording>,
    /// Views by odometry; `None` if the options do not request them.
    pub(crate) views: Option<&'a mut ByOdometry>,
    /// Line that shows the progress of a fast run; `None` if standard error is not a terminal.
    pub(crate) progress: Option<ProgressLine<'a>>,
    /// Standard error; `None` if it shows the progress line.
    pub(crate) err: Option<&'a mut dyn Write>,
}

/// Makes the turns of a plan on its robot; see [`cycle`].
pub(crate) fn run<I: Instants>(
    drive: &mut dyn Drive,
    limits: RunLimits,
    clock: &mut Clock<I>,
    signals: &Signals,
    witnesses: &mut Witnesses<'_, '_>,
    limit: &WatchedRun,
) -> RunEnd {
    let transitions = Transitions::default();
    let supervised = Supervised::default();
    if witnesses.log.as_ref().is_some_and(|log| log.is_record()) {
        drive.record();
    }
    let mut turns =
        OnePlan { drive, witnesses, limit, transitions, fresh: true, plan: 1, supervised, pace: None, number: 0 };
    cycle(&mut turns, limits, clock, signals)
}

/// The turns of a plan, with the recipients of their reports.
struct OnePlan<'t, 'a, 'o> {
    drive: &'t mut dyn Drive,
    witnesses: &'t mut Witnesses<'a, 'o>,
    /// Watchdog that limits the time of each turn.
    limit: &'t WatchedRun,
    /// Transitions of the last turn.
    transitions: Transitions,
    /// `true` if no law has been applied since the current atom was entered.
    fresh: bool,
    /// Number of the current plan, counted from 1; a supervisor may replace the plan.
    plan: u64,
    /// The supervisor's intervention in the last turn.
    supervised: Supervised,
    /// Pace that the supervisor has requested.
    pace: Option<Pace>,
    /// Number of the last turn.
    number: u64,
}

impl OnePlan<'_, '_, '_> {
    /// Calls the supervisor at the break after `turns` turns.
    fn at_break(&mut self, turns: u64, t: Nanos, is_over: bool, timing: Option<&Timing>) -> Result<(), RunEnd> {
        let BreakOrders { pace, end } = self.drive.at_break((turns, t, is_over), self.witnesses.report, timing);
        self.pace = pace.or(self.pace);
        if end && !is_over { Err(RunEnd::Quit) } else { Ok(()) }
    }

    /// Returns the continuation of the run after a turn, as determined by the plan and the supervisor's intervention.
    fn step(&mut self, turn: Turn<()>) -> Result<TurnEnd, RunEnd> {
        let Supervised { verdict, rule, diverted_by, .. } = &self.supervised;
        let after = match turn {
            Turn::Over => self.drive.after_plan(),
            Turn::Law(()) | Turn::Cut => AfterPlan::Continues,
        };
        match after {
            _ if *verdict == Some(Verdict::Ended) && self.drive.ended_by(rule) => Ok(TurnEnd::Next),
            _ if *verdict == Some(Verdict::Ended) => Err(RunEnd::Safety(rule.clone())),
            AfterPlan::Continues => Ok(TurnEnd::Next),
            AfterPlan::Fails(sentence) => Err(RunEnd::Failed(sentence)),
            AfterPlan::Ends if !diverted_by.is_empty() => Err(RunEnd::Safety(diverted_by.clone())),
            AfterPlan::Ends => Ok(TurnEnd::Over),
        }
    }
}

impl Turns for OnePlan<'_, '_, '_> {
    fn exchange(&mut self) -> Result<(), String> {
        self.drive.exchange()
    }

    fn turn(&mut self, t: Nanos, number: u64, timing: Option<&Timing>) -> Result<TurnEnd, RunEnd> {
        self.number = number;
        if number == 0 {
            self.at_break(0, t, false, timing)?;
        }
        let Self { drive, witnesses, limit, transitions, fresh, plan, supervised, .. } = self;
        if let (Some(path), Some((heading, speed))) = (&mut witnesses.path, drive.motion()) {
            path.take(heading, speed, t);
        }
        transitions.clear();
        let turn = limit.make(number, || drive.turn(t, number, transitions));
        drive.messages(&mut |message| witnesses.say(message));
        let turn = turn?;
        let zero = drive.zero();
        let (number_of_plan, reason) = drive.plan();
        let begins = std::mem::replace(plan, number_of_plan) != number_of_plan;
        supervised.note(drive.intervention(), begins.then_some(reason));
        supervised.requests = drive.take_requests();
        *fresh |= !transitions.is_empty() || begins;
        if let Some(log) = &mut witnesses.log {
            let changes = drive.take_changes();
            log.take(drive.exact(), changes);
        }
        if let (Some(views), Some(y)) = (&mut witnesses.views, drive.sensed()) {
            views.sensed(y, t);
        }
        if let (observer, Some(position)) = drive.parts() {
            let written = witnesses.tell(position, MadeTurn { turn, number, t, plan: *plan }, transitions, supervised);
            written.map_err(|error| RunEnd::Log(error.to_string()))?;
            let has_begun = turn == Turn::Law(()) && std::mem::take(fresh);
            let views = witnesses.views.as_deref_mut().map(|views| views as &mut dyn Observer);
            for observer in [observer, views].into_iter().flatten() {
                watched(observer, position, turn, has_begun, (t, zero), witnesses.report);
            }
        } else if let Some(log) = &mut witnesses.log {
            let written = log.turn_without_plan(&UnmadeTurn { number, t, plan: *plan, supervised });
            written.map_err(|error| RunEnd::Log(error.to_string()))?;
        }
        if let Some(message) = witnesses.log.as_mut().and_then(|log| log.take_message()) {
            witnesses.say(&message);
        }
        let step = self.step(turn)?;
        self.at_break(number.saturating_add(1), t, step == TurnEnd::Over, timing)?;
        Ok(step)
    }

    fn pace(&mut self) -> Option<Pace> {
        self.pace.take()
    }

    fn tell_timing(&mut self, timing: &Timing) {
        if let Some(err) = &mut self.witnesses.err {
            say(err, format_args!("{timing}"));
        }
    }

    fn ended(&mut self, ending: &RunEnd, t: Nanos, timing: Option<&Timing>) {
        if *ending != RunEnd::Over {
            self.drive.at_end(self.number.saturating_add(1), t, self.witnesses.report, timing);
        }
        if let Some(log) = &mut self.witnesses.log {
            let cause = cause(ending, self.witnesses.report);
            log.ended(self.number, t, &cause);
        }
        if let (observer, Some(position)) = self.drive.parts() {
            let views = self.witnesses.views.as_deref_mut().map(|views| views as &mut dyn Observer);
            for observer in [observer, views].into_iter().flatten() {
                ended(observer, position, ending, self.witnesses.report, t);
            }
        }
    }
}

/// Informs the observer about a turn at time `t`, in a plan that began at `zero`. If `has_begun` is `true`, first
/// informs it about the atom that began in this turn.
fn watched(
    observer: &mut dyn Observer,
    position: &dyn Position,
    turn: Turn<()>,
    has_begun: bool,
    (t, zero): (Nanos, Nanos),
    report: &ReportWriter<'_>,
) {
    let plan = position.texts();
    let atom = position.atom().and_then(|atom| Some((atom, plan.fsm().atoms.get(atom as usize)?)));
    if let Some((atom, written)) = atom.filter(|_| has_begun) {
        observer.began(written.state, plan.law(atom), t);
    }
    if turn != Turn::Over && observer.looks() {
        observer.turned(&standing(position, t, zero, report.course()));
    }
}

/// Returns the cause of a run's end, in words.
fn cause(ending: &RunEnd, report: &ReportWriter<'_>) -> String {
    match (ending, report.over()) {
        (RunEnd::Failed(sentence), _) => sentence.clone(),
        (_, Some(over)) => over.cause.clone(),
        (_, None) => ending.brief(),
    }
}

/// Informs the observer that the turns have ended, and about the cause of the end.
fn ended(observer: &mut dyn Observer, position: &dyn Position, ending: &RunEnd, report: &ReportWriter<'_>, t: Nanos) {
    let by = cause(ending, report);
    observer.ended(&Ended { plan: position.texts().name(0), is_over: *ending == RunEnd::Over, by: &by, t });
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

    /// Reports a turn to all recipients.
    fn tell(
        &mut self,
        position: &dyn Position,
        latest: MadeTurn,
        transitions: &Transitions,
        supervised: &Supervised,
    ) -> io::Result<()> {
        let plan = position.texts();
        let MadeTurn { turn, number, t, plan: plan_number } = latest;
        if let Some(reason) = &supervised.begins {
            self.report.begins(plan, t, position.atom(), reason);
        }
        self.report.turn(plan, t, transitions);
        self.report.supervised(t, supervised);
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
        let state = position.state();
        let kind = turn;
        log.turn(&LogEntry { plan, turn: number, t, state, kind, applied, frame, transitions, plan_number, supervised })
    }
}

/// Data of a turn.
#[derive(Debug, Clone, Copy)]
struct MadeTurn {
    turn: Turn<()>,
    /// Number of the turn, counted from 0.
    number: u64,
    t: Nanos,
    /// Number of the plan that made the turn, counted from 1.
    plan: u64,
}
