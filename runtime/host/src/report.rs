//! What a run says on standard output: one line a transition, and at last why the plan is over.
//! See docs/src/reference/interfaces.md, 6.2.

use std::fmt;
use std::io::{self, Write};

use mdle_runtime::{Nanos, Plan, Printable, Transition};

/// The report of a run; goes quiet when nobody reads it any more.
pub(crate) struct Report<'a> {
    out: &'a mut dyn Write,
    /// Whether lines are shown as soon as they are written: not at the fastest pace.
    prompt: bool,
    /// Nothing more is written after an error; it is kept unless it says that the reader has gone.
    state: State,
}

/// Whether a report is still written.
enum State {
    Open,
    Closed(Option<io::Error>),
}

impl<'a> Report<'a> {
    /// A report to `out`.
    pub(crate) fn new(out: &'a mut dyn Write, prompt: bool) -> Self {
        Self { out, prompt, state: State::Open }
    }

    /// Reports the transitions of the turn at time `t`.
    pub(crate) fn turn<P: Plan>(&mut self, plan: &P, t: Nanos, transitions: &[Transition]) {
        for transition in transitions {
            let cause = CauseText { plan, transition };
            let written = match (&self.state, transition.atom) {
                (State::Closed(_), _) => return,
                (State::Open, Some(atom)) => {
                    let (to, law) = (transition.to, plan.law(atom));
                    let (law, cause) = (Printable(law), Printable(cause));
                    writeln!(self.out, "{}  atom {to} {law}  <- {cause}", Clocked(t))
                }
                (State::Open, None) => writeln!(self.out, "plan over: {}", Printable(cause)),
            };
            self.note(written);
        }
        if self.prompt && !transitions.is_empty() {
            self.flush();
        }
    }

    /// Shows what has been written so far.
    pub(crate) fn flush(&mut self) {
        match self.state {
            State::Open => {
                let flushed = self.out.flush();
                self.note(flushed);
            }
            State::Closed(_) => {}
        }
    }

    /// Shows the rest.
    ///
    /// # Errors
    /// Why lines are missing, unless the reader has simply gone.
    pub(crate) fn close(mut self) -> io::Result<()> {
        self.flush();
        match self.state {
            State::Open | State::Closed(None) => Ok(()),
            State::Closed(Some(error)) => Err(error),
        }
    }

    /// Goes quiet on an error: a report is no reason to stop a robot.
    fn note(&mut self, written: io::Result<()>) {
        if let Err(error) = written {
            self.state = State::Closed((error.kind() != io::ErrorKind::BrokenPipe).then_some(error));
        }
    }
}

/// A time to the millisecond.
struct Clocked(Nanos);

impl fmt::Display for Clocked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Nanos(nanos) = self.0;
        let millis = nanos / 1_000_000 + u64::from(nanos % 1_000_000 >= 500_000);
        write!(f, "{}.{:03} s", millis / 1000, millis % 1000)
    }
}

/// What ended a scope, and which: `bumper (Lab2ToLab1Plan)`.
pub(crate) struct CauseText<'a, P> {
    pub(crate) plan: &'a P,
    pub(crate) transition: &'a Transition,
}

impl<P: Plan> fmt::Display for CauseText<'_, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Transition { from, scope, .. } = *self.transition;
        write!(f, "{} (", self.transition.by(self.plan))?;
        let name = self.plan.name(scope);
        let fsm = self.plan.fsm();
        let bracket = fsm.brackets.get(scope as usize);
        let first = bracket.and_then(|bracket| fsm.atoms.get(bracket.first as usize));
        let last = bracket.and_then(|bracket| fsm.atoms.get(bracket.last as usize));
        match (first, last) {
            _ if !name.is_empty() => write!(f, "{name}")?,
            // The formal notation names no scopes; loops around this one are counted in their first pass.
            (Some(first), Some(last)) if first.scope != scope => {
                write!(f, "scope of atoms {}-{}", first.state, last.state)?;
            }
            (Some(_) | None, Some(_) | None) => write!(f, "atom {from}")?,
        }
        write!(f, ")")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_rounded_to_milliseconds() {
        let shown = |nanos| Clocked(Nanos(nanos)).to_string();
        assert_eq!(shown(0), "0.000 s");
        assert_eq!(shown(12_300_000_000), "12.300 s");
        assert_eq!(shown(999_499_999), "0.999 s");
        assert_eq!(shown(999_500_000), "1.000 s");
        assert_eq!(shown(u64::MAX), "18446744073.710 s");
    }
}
