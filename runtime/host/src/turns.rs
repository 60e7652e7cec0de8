//! The turns of a plan on a robot: exchange, time, machine, and the wait for the next (docs/src/reference/semantics.md,
//! 5.1).

use std::io::{self, Write};
use std::time::Duration;

use mdle_runtime::fsm::Kind;
use mdle_runtime::{Machine, Nanos, Plan, Robot, Turn};

use crate::cause::place;
use crate::clock::{Clock, Instants, nanos};
use crate::ending::{Ending, say};
use crate::log::{Entry, Log};
use crate::observer::Followed;
use crate::paths::Recorder;
use crate::progress::Progress;
use crate::report::Report;
use crate::signals::Signals;
use crate::timing::Timing;
use crate::transitions::Transitions;
use crate::{Around, Ended, Standing};

/// Limits at which a run ends whose plan is not over.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Time of the plan at which the run ends. The turn at that time is still made: the plan may be over in it.
    pub(crate) timeout: Option<Duration>,
    /// Number of turns after which the run ends.
    pub(crate) turns: Option<u64>,
}

/// Recipients of the turns' reports.
pub(crate) struct Witnesses<'a, 'o, Y> {
    /// The lines on standard output.
    pub(crate) report: &'a mut Report<'o>,
    /// The run log, if one was asked for.
    pub(crate) log: Option<&'a mut Log>,
    /// The path that is driven, if it is to be recorded.
    pub(crate) path: Option<&'a mut Recorder<Y>>,
    /// The line that shows that a fast run goes on, if standard error is a terminal.
    pub(crate) progress: Option<Progress<'a>>,
    /// Standard error, where it does not show that line.
    pub(crate) err: Option<&'a mut dyn Write>,
}

/// Runs `plan` on `robot`, from the exchange of turn 0 until something ends it.
///
/// The robot still executes its last input: the caller has to send the null input and the stop, also after a panic.
pub(crate) fn run<R: Robot, P, I: Instants>(
    robot: &mut Followed<R>,
    plan: P,
    limits: Limits,
    clock: &mut Clock<I>,
    signals: &Signals,
    witnesses: &mut Witnesses<'_, '_, R::Output>,
) -> Ending
where
    P: Plan<Output = R::Output, Input = R::Input>,
{
    if let Some(signal) = signals.caught() {
        return Ending::Signal(signal);
    }
    let mut y = match exchange(&mut robot.robot, &R::Input::default()) {
        Ok(output) => output,
        Err(ending) => return ending,
    };
    let mut t = clock.zero();
    let mut machine = Machine::begin(plan, &y, t);
    let mut transitions = Transitions::default();
    // Whether the current atom has been entered since a law was applied last.
    let mut fresh = true;
    let mut number: u64 = 0;
    let ending = loop {
        if let Some(path) = &mut witnesses.path {
            path.take(&y, t);
        }
        transitions.clear();
        let turn = machine.turn(&y, t, &mut transitions);
        fresh |= !transitions.is_empty();
        if let Err(error) = witnesses.tell(&machine, &turn, number, t, &transitions) {
            break Ending::Log(error.to_string());
        }
        match turn {
            Turn::Law(_) if std::mem::take(&mut fresh) => {
                began(robot, &machine, t);
            }
            Turn::Law(_) | Turn::Cut => {}
            Turn::Over => break Ending::Over,
        }
        if let Some(observer) = robot.observer().filter(|observer| observer.looks()) {
            observer.turned(&standing(&machine, t, witnesses.report));
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
        y = match exchange(&mut robot.robot, &turn.input()) {
            Ok(output) => output,
            Err(ending) => break ending,
        };
        t = clock.taken();
    };
    ended(robot, &machine, &ending, witnesses.report, t);
    ending
}

/// Tells the observer which atom has begun.
fn began<R, P: Plan>(robot: &mut Followed<R>, machine: &Machine<P>, t: Nanos) {
    let Some(observer) = robot.observer() else { return };
    let plan = machine.plan();
    let atom = machine.atom().and_then(|atom| Some((atom, plan.fsm().atoms.get(atom as usize)?)));
    if let Some((atom, written)) = atom {
        observer.began(written.state, plan.law(atom), t);
    }
}

/// Tells the observer that the turns have ended, and by what.
fn ended<R, P: Plan>(robot: &mut Followed<R>, machine: &Machine<P>, ending: &Ending, report: &Report<'_>, t: Nanos) {
    let Some(observer) = robot.observer() else { return };
    let by = report.over().map_or_else(|| ending.brief(), |over| over.cause.clone());
    observer.ended(&Ended { plan: machine.plan().name(0), is_over: *ending == Ending::Over, by: &by, t });
}

/// Returns the state of a plan that is not over.
fn standing<'m, P: Plan>(machine: &'m Machine<P>, t: Nanos, report: &'m Report<'_>) -> Standing<'m> {
    let (plan, fsm) = (machine.plan(), machine.plan().fsm());
    let atom = machine.atom().and_then(|atom| fsm.atoms.get(atom as usize));
    let own = atom.and_then(|atom| fsm.brackets.get(atom.scope as usize)).map(|bracket| bracket.kind);
    let levels = match own {
        Some(Kind::Scope { level }) => 0..=level,
        Some(Kind::Loop { .. }) | None => 0..=0,
    };
    let scopes = levels.map(|level| {
        let scope = machine.cursor().scope(fsm, level);
        Around { name: plan.name(scope), condition: plan.condition(scope), since: machine.cursor().since(level, t) }
    });
    let law = machine.atom().map_or("", |atom| plan.law(atom));
    let place = machine.atom().map_or_else(String::new, |atom| place(plan, report.passes(), atom));
    Standing { t, state: machine.state(), law, place, since: report.since(), scopes: scopes.collect() }
}

/// Exchanges an input for the output that follows it.
pub(crate) fn exchange<R: Robot>(robot: &mut R, input: &R::Input) -> Result<R::Output, Ending> {
    robot.exchange(input).map_err(|fault| Ending::Robot(fault.to_string()))
}

impl Limits {
    /// Returns the limit that a plan has reached, if it is not over after `turns` turns, the last one at time `t`.
    fn reached(&self, turns: u64, t: Nanos) -> Option<Ending> {
        let timeout = self.timeout.filter(|limit| t.0 >= nanos(*limit)).map(Ending::Timeout);
        timeout.or(self.turns.filter(|limit| turns >= *limit).map(Ending::Turns))
    }
}

impl<Y> Witnesses<'_, '_, Y> {
    /// Reports how late turns begin and how long they take.
    fn tell_timing(&mut self, timing: Option<&Timing>) {
        if let (Some(err), Some(timing)) = (&mut self.err, timing) {
            say(err, format_args!("{timing}"));
        }
    }

    /// Reports a turn to the recipients.
    fn tell<P: Plan>(
        &mut self,
        machine: &Machine<P>,
        turn: &Turn<P::Input>,
        number: u64,
        t: Nanos,
        transitions: &Transitions,
    ) -> io::Result<()> {
        let plan = machine.plan();
        self.report.turn(plan, t, transitions);
        if let Some(progress) = &mut self.progress {
            let law = machine.atom().map_or("", |atom| plan.law(atom));
            progress.run(t, law, self.report);
        }
        let Some(log) = self.log.as_mut() else { return Ok(()) };
        let applied = match turn {
            Turn::Law(_) => machine.atom(),
            Turn::Cut | Turn::Over => None,
        };
        let frame = machine.frame().filter(|_| applied.is_some());
        log.turn(&Entry { plan, turn: number, t, state: machine.state(), applied, frame, transitions })
    }
}
