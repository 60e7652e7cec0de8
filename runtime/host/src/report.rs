//! Report of a run on standard output: a line for each transition, and finally the reason why the plan has ended. See
//! docs/src/reference/interfaces.md, 6.2.

use std::io::{self, Write};

use mdle_runtime::trace::COMPLETED;
use mdle_runtime::{Cause, Measured, Nanos, Printable, Transition};

use crate::Clocked;
use crate::cause::{CauseText, place};
use crate::holds::Holds;
use crate::position::Texts;
use crate::standing::RunCourse;
use crate::supervised::Supervised;
use crate::transitions::{Operand, Transitions};
use crate::{Judgement, Verdict};

/// Writer of the report of a run; it stops writing when its reader closes the stream.
pub(crate) struct ReportWriter<'a> {
    out: &'a mut dyn Write,
    /// `true` if lines are shown immediately; `false` at the fastest pace.
    prompt: bool,
    /// State of the report. After an error, nothing more is written. The error is kept, unless the reader has closed
    /// the stream.
    state: ReportState,
    course: RunCourse,
    /// Cause of the plan's end; `None` while the plan has not ended.
    over: Option<Over>,
    /// Strength and rule of the intervention in the last turn; `None` if there was no intervention, or if it only
    /// limited an input.
    last_verdict: Option<(Verdict, String)>,
    /// The rules that have limited an input.
    limiting: Vec<String>,
    /// Counters of the rules that have held the robot, so that only the first times are reported.
    holds: Holds,
}

/// End of a plan, with its cause.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Over {
    /// Cause of the end, as a report shows it.
    pub(crate) cause: String,
    /// Text of the interrupt's condition, or `completed`.
    pub(crate) by: String,
    /// Texts of the operands that fired.
    pub(crate) operands: Vec<String>,
    /// Cause of the end as a report shows it, but without measured values.
    pub(crate) words: String,
    /// Bracket of the scope that ended.
    pub(crate) bracket: u32,
    /// Numbers of the operands that fired.
    pub(crate) numbers: Vec<u32>,
}

/// State of a report: open or closed.
enum ReportState {
    Open,
    Closed(Option<io::Error>),
}

impl<'a> ReportWriter<'a> {
    /// Creates a report that is written to `out`.
    pub(crate) fn new(out: &'a mut dyn Write, prompt: bool) -> Self {
        Self {
            out,
            prompt,
            state: ReportState::Open,
            course: RunCourse::default(),
            over: None,
            last_verdict: None,
            limiting: Vec::new(),
            holds: Holds::default(),
        }
    }

    /// Returns the end of the plan; `None` if the plan has not ended.
    pub(crate) fn over(&self) -> Option<&Over> {
        self.over.as_ref()
    }

    /// Returns the course of the run up to the last turn.
    pub(crate) fn course(&self) -> &RunCourse {
        &self.course
    }

    /// Reports the transitions of the turn at time `t`.
    pub(crate) fn turn(&mut self, plan: &dyn Texts, t: Nanos, transitions: &Transitions) {
        for (transition, operands) in transitions.iter() {
            self.course.passes.step(plan.fsm(), transition);
            let cause = Printable(CauseText { plan, transition, operands }).to_string();
            let written = match (&self.state, transition.atom) {
                (ReportState::Closed(_), _) => Ok(()),
                (ReportState::Open, Some(atom)) => {
                    let (law, place) = (Printable(plan.law(atom)), place(plan, &self.course.passes, atom));
                    let place = if place.is_empty() { place } else { format!(" ({place})") };
                    writeln!(self.out, "{}  {law}{}  <- {cause}", Clocked(t), Printable(&place))
                }
                (ReportState::Open, None) => writeln!(self.out, "{}  plan over: {cause}", Clocked(t)),
            };
            self.note(written);
            if transition.atom.is_none() {
                self.over = Some(Over::of(plan, transition, operands, cause.clone()));
            }
            self.course.since = cause;
        }
        if self.prompt && !transitions.is_empty() {
            self.flush();
        }
    }

    /// Reports that `plan` has replaced another plan in the turn at time `t`, with the reason for the replacement and
    /// the plan's current atom, `atom`. Prints nothing if `atom` is `None`, because the plan has then ended already.
    pub(crate) fn begins(&mut self, plan: &dyn Texts, t: Nanos, atom: Option<u32>, reason: &str) {
        self.course = RunCourse { since: reason.to_owned(), ..RunCourse::default() };
        self.over = None;
        let Some(atom) = atom else { return };
        let (law, place) = (plan.law(atom), place(plan, &self.course.passes, atom));
        let place = if place.is_empty() { place } else { format!(" ({place})") };
        let line = format!("{law}{place}  <- {reason}");
        self.line(t, &line);
    }

    /// Reports the supervisor's intervention in the turn at time `t`, unless it is the same as in the previous turn. A
    /// rule that limits inputs is reported only once, because it may start and stop with every turn. A rule that holds
    /// the robot repeatedly is reported only for the first few holds.
    pub(crate) fn supervised(&mut self, t: Nanos, supervised: &Supervised) {
        let intervention = supervised.intervention();
        if let Some(limit) = intervention.filter(|it| it.verdict == Verdict::Limited)
            && !self.limiting.iter().any(|rule| rule == limit.rule)
        {
            self.limiting.push(limit.rule.to_owned());
            self.line(t, &format!("safety: {limit}"));
        }
        let intervention = intervention.filter(|it| it.verdict > Verdict::Limited);
        let last_verdict = self.last_verdict.as_ref().map(|(verdict, rule)| (*verdict, rule.as_str()));
        if intervention.map(|it| (it.verdict, it.rule)) == last_verdict {
            return;
        }
        let is_followed = self.holds.is_followed();
        self.last_verdict = intervention.map(|it| (it.verdict, it.rule.to_owned()));
        match intervention {
            Some(held) if matches!(held.verdict, Verdict::HeldForward | Verdict::Held) => {
                if let Some(repeats) = self.holds.begins(held.rule, t) {
                    self.line(t, &format!("safety: {held}{repeats}"));
                }
            }
            Some(intervention) => self.line(t, &format!("safety: {intervention}")),
            None if supervised.begins.is_some() || self.over.is_some() || !is_followed => {}
            None => self.line(t, "safety: the plan goes on"),
        }
    }

    /// Writes a line about the turn at time `t`.
    fn line(&mut self, t: Nanos, line: &str) {
        let written = match self.state {
            ReportState::Open => writeln!(self.out, "{}  {}", Clocked(t), Printable(line)),
            ReportState::Closed(_) => Ok(()),
        };
        self.note(written);
        if self.prompt {
            self.flush();
        }
    }

    /// Reports the result of a run with a goal.
    pub(crate) fn judged(&mut self, judgement: &Judgement) {
        let written = match self.state {
            ReportState::Open => writeln!(self.out, "{}", Printable(judgement)),
            ReportState::Closed(_) => Ok(()),
        };
        self.note(written);
    }

    /// Shows the lines that have been written so far.
    pub(crate) fn flush(&mut self) {
        match self.state {
            ReportState::Open => {
                let flushed = self.out.flush();
                self.note(flushed);
            }
            ReportState::Closed(_) => {}
        }
    }

    /// Shows the remaining lines.
    ///
    /// # Errors
    /// Returns the error that prevented lines from being written, unless the reader has closed the stream.
    pub(crate) fn close(mut self) -> io::Result<()> {
        self.flush();
        match self.state {
            ReportState::Open | ReportState::Closed(None) => Ok(()),
            ReportState::Closed(Some(error)) => Err(error),
        }
    }

    /// Closes the report if writing failed. The robot is not stopped for this reason.
    fn note(&mut self, written: io::Result<()>) {
        if let Err(error) = written {
            self.state = ReportState::Closed((error.kind() != io::ErrorKind::BrokenPipe).then_some(error));
        }
    }
}

impl Over {
    /// Describes the end of `plan`, which `transition` has caused. `cause` is the cause as the report shows it.
    fn of(plan: &dyn Texts, transition: &Transition, operands: &[Operand], cause: String) -> Self {
        let source = plan.source();
        let unmeasured: Vec<Operand> = operands.iter().map(|(number, _)| (*number, Measured::Nothing)).collect();
        let words = Printable(CauseText { plan, transition, operands: &unmeasured }).to_string();
        let numbers: Vec<u32> = operands.iter().map(|(number, _)| *number).collect();
        let operands = numbers.iter().filter_map(|number| source.operand(transition.scope, *number));
        Self {
            cause,
            words,
            by: match transition.cause {
                Cause::Fired(_) => plan.condition(transition.scope).to_owned(),
                Cause::Completed(_) => COMPLETED.to_owned(),
            },
            operands: operands.map(|words| words.text.to_owned()).collect(),
            bracket: transition.scope,
            numbers,
        }
    }
}
