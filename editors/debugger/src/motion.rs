//! Motions of a run: continue, step forward, and step back.

use mdle_compiler::plan::PlanPart;
use serde_json::{Value, json};

use crate::ServeError;
use crate::breakpoints::Id;
use crate::run::StepKind;
use crate::session::DebugSession;

/// Number of steps of a run between two checks for a request that interrupts it.
const LOOK: u64 = 4_096;

/// A motion of the run that the client requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RequestedMotion {
    /// Forward to the next breakpoint or to the end.
    Continue,
    /// Forward to the end of the current turn, or of the next turn if the current one has ended.
    Turn,
    /// Forward to the next transition.
    Transition,
    /// Forward to the end of the innermost scope that encloses the atom.
    Out,
    /// Back to the end of the previous turn.
    TurnBack,
    /// Back to the previous transition.
    TransitionBack,
    /// Back to the previous breakpoint or to the start.
    ContinueBack,
}

impl RequestedMotion {
    /// Returns the motion that a command requests; `None` if the command is not a motion.
    pub(crate) fn of(command: &str, arguments: &Value) -> Option<Self> {
        let is_fine = arguments.get("granularity").and_then(Value::as_str) == Some("instruction");
        match (command, is_fine) {
            ("continue", _) => Some(Self::Continue),
            ("next", false) => Some(Self::Turn),
            ("next", true) | ("stepIn", _) => Some(Self::Transition),
            ("stepOut", _) => Some(Self::Out),
            ("stepBack", false) => Some(Self::TurnBack),
            ("stepBack", true) => Some(Self::TransitionBack),
            ("reverseContinue", _) => Some(Self::ContinueBack),
            _ => None,
        }
    }
}

impl DebugSession<'_, '_, '_> {
    /// Starts the run.
    pub(crate) fn start(&mut self, stops_on_entry: bool) -> Result<(), ServeError> {
        if stops_on_entry {
            return self.stopped("entry", "The plan is entered", &[]);
        }
        match self.breakpoints.hits(&self.run, &self.loaded.compiled.plan, None).as_slice() {
            [] => self.go(RequestedMotion::Continue),
            hits => self.stopped("breakpoint", "Breakpoint", hits),
        }
    }

    /// Performs a motion, and reports the position at which the run has stopped.
    pub(crate) fn go(&mut self, motion: RequestedMotion) -> Result<(), ServeError> {
        self.lists.clear();
        match motion {
            RequestedMotion::Continue | RequestedMotion::Turn | RequestedMotion::Transition | RequestedMotion::Out => {
                self.forward(motion)
            }
            RequestedMotion::TurnBack => self.back("step", |_, step| step == Some(StepKind::End)),
            RequestedMotion::TransitionBack => {
                self.back("step", |_, step| matches!(step, Some(StepKind::Transition { .. })))
            }
            RequestedMotion::ContinueBack => self.back("breakpoint", |hits, _| !hits.is_empty()),
        }
    }

    fn forward(&mut self, motion: RequestedMotion) -> Result<(), ServeError> {
        let is_scope = |part: PlanPart<'_>| matches!(part, PlanPart::Scope(_));
        let scope = self.run.open().enumerate().filter(|(_, open)| is_scope(open.part())).map(|(at, _)| at).next_back();
        let mut steps = 0_u64;
        loop {
            steps += 1;
            if steps.is_multiple_of(LOOK) && self.client.interrupts()? {
                return Ok(());
            }
            let Some(step) = self.run.step() else {
                // The client has already been shown the end: this step ends the session.
                return if steps == 1 { self.client.event("terminated", json!({})) } else { self.ended() };
            };
            let hits = self.breakpoints.hits(&self.run, &self.loaded.compiled.plan, Some(step));
            if !hits.is_empty() {
                return self.stopped("breakpoint", "Breakpoint", &hits);
            }
            let is_there = match (motion, step) {
                (RequestedMotion::Turn, StepKind::End) | (RequestedMotion::Transition, StepKind::Transition { .. }) => {
                    true
                }
                (RequestedMotion::Out, StepKind::Transition { ended, .. }) => scope.is_none_or(|scope| ended <= scope),
                _ => false,
            };
            if is_there {
                return self.stopped("step", "Step", &[]);
            }
        }
    }

    fn ended(&mut self) -> Result<(), ServeError> {
        let text = if self.run.is_over() { "The plan has ended" } else { "The script has ended" };
        self.stopped("end", text, &[])
    }

    /// Moves the run back to the last earlier position that `is_there` accepts, or to the start of the run if there is
    /// none, and reports the stop. `is_there` gets the breakpoints at a position and the step that leads to it.
    fn back(&mut self, reason: &str, is_there: impl Fn(&[Id], Option<StepKind>) -> bool) -> Result<(), ServeError> {
        let (breakpoints, plan) = (&self.breakpoints, &self.loaded.compiled.plan);
        self.run.back(|run, step| is_there(&breakpoints.hits(run, plan, step), step));
        if self.run.at().steps == 0 {
            return self.stopped("entry", "The start of the run", &[]);
        }
        self.stopped(reason, if reason == "step" { "Step back" } else { "Breakpoint" }, &[])
    }

    /// Reports to the client that the run has stopped.
    pub(crate) fn stopped(&mut self, reason: &str, description: &str, hits: &[Id]) -> Result<(), ServeError> {
        self.lists.clear();
        let body = json!({
            "reason": reason,
            "description": description,
            "threadId": crate::requests::THREAD,
            "allThreadsStopped": true,
            "hitBreakpointIds": hits,
        });
        self.client.event("stopped", body)
    }
}
