//! The words of a transition: the operands that have fired with their values, as the plan's author wrote them, and
//! their places.

use std::fmt::{self, Write as _};

use mdle_quantity::operand_words;
use mdle_runtime::fsm::Kind;
use mdle_runtime::trace::COMPLETED;
use mdle_runtime::{Cause, Plan, SourceLine, Transition};

use crate::passes::{Passes, outwards};
use crate::position::Texts;
use crate::transitions::Operand;

/// Cause of a scope's end in a report: `r1 = 0.38 m < 40cm (wall.mdle:7)`.
pub struct CauseText<'a> {
    /// The plan.
    pub plan: &'a dyn Texts,
    /// The end of the scope.
    pub transition: &'a Transition,
    /// The operands that had fired.
    pub operands: &'a [Operand],
}

impl fmt::Display for CauseText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { plan, transition, operands } = *self;
        let Transition { scope, cause, .. } = *transition;
        let source = plan.source();
        let Some(bracket) = source.bracket(scope) else {
            // A plan that was written in Rust has no text.
            let name = plan.name(scope);
            let by = cause.by(plan.condition(scope));
            return if name.is_empty() { f.write_str(by) } else { write!(f, "{by} ({name})") };
        };
        if matches!(cause, Cause::Completed(_)) {
            return write!(f, "{COMPLETED} ({})", FileLine(source.file(bracket.at), bracket.at));
        }
        let mut words: Vec<String> = Vec::new();
        let mut at = bracket.at;
        for (number, measured) in operands {
            let Some(operand) = source.operand(scope, *number) else { continue };
            let text = operand_words(&operand, *measured, true);
            if words.is_empty() {
                at = operand.at;
            }
            if !words.contains(&text) {
                words.push(text);
            }
        }
        write!(f, "{} ({}", words.join(" and "), FileLine(source.file(at), at))?;
        if bracket.count > 1 {
            write!(f, ", of \"{}\"", bracket.condition)?;
        }
        f.write_char(')')
    }
}

/// Returns the cause of a transition of `plan` with the values of the operands that had fired, as a report has it:
/// `r1 = 0.38 m < 40cm (wall.mdle:7)`.
#[must_use]
pub fn cause_words(plan: &impl Plan, transition: &Transition, operands: &[Operand]) -> String {
    CauseText { plan, transition, operands }.to_string()
}

/// Returns the place of an atom in a report: its line, the names of its enclosing scopes and the passes of loops.
#[must_use]
pub fn place(plan: &dyn Texts, passes: &Passes, atom: u32) -> String {
    let (fsm, source) = (plan.fsm(), plan.source());
    let Some(own) = fsm.atoms.get(atom as usize).map(|atom| atom.scope) else { return String::new() };
    let around = outwards(fsm, own).filter_map(|(number, bracket)| match bracket.kind {
        // The plan itself is around every atom.
        Kind::Scope { .. } => Some(plan.name(number)).filter(|name| number > 0 && !name.is_empty()).map(str::to_owned),
        Kind::Loop { times: 0, .. } => Some(format!("pass {}", passes.of(number))),
        Kind::Loop { times, .. } => Some(format!("pass {} of {times}", passes.of(number))),
    });
    let mut words: Vec<String> = around.collect();
    words.extend(source.bracket(own).map(|own| FileLine(source.file(own.at), own.at).to_string()));
    words.reverse();
    words.join(", ")
}

/// A line of a file: `wall.mdle:7`.
struct FileLine<'a>(&'a str, SourceLine);

impl fmt::Display for FileLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.0, self.1.line)
    }
}
