//! The stack of a run: the current atom and its enclosing scopes, with the passes of their loops.

use mdle_compiler::diagnostic::Span;
use mdle_compiler::plan::{Plan, PlanPart};

use crate::run::DebugRun;

/// A frame of the stack: an atom or a scope.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct StackFrame {
    /// Name of the frame as shown to users.
    pub(crate) name: String,
    /// Place of the atom or of the scope's definition.
    pub(crate) span: Span,
    /// Index of the frame's element in the run's list of open elements.
    pub(crate) open: usize,
    /// Loops that directly enclose the element, from the outermost to the innermost, as indices into the run's list of
    /// open elements.
    pub(crate) loops: Vec<usize>,
}

/// Returns the frames from the current atom to the plan; the list is empty if the plan has ended.
pub(crate) fn frames(run: &DebugRun<'_>, plan: &Plan) -> Vec<StackFrame> {
    let (mut frames, mut loops, mut passes) = (Vec::new(), Vec::new(), String::new());
    for (open, element) in run.open().enumerate() {
        let (name, span) = match element.part() {
            PlanPart::Loop(repeated) => {
                let of = repeated.times.map_or_else(|| "without end".to_owned(), |times| format!("of {times}"));
                passes += &format!(", pass {} {of}", element.pass());
                loops.push(open);
                continue;
            }
            PlanPart::Scope(scope) if scope.name.is_empty() => (format!("({})", scope.interrupt.text), scope.span),
            PlanPart::Scope(scope) => (scope.name.clone(), scope.span),
            PlanPart::Atom(atom) => (plan.quark(atom.law).text.clone(), atom.span),
        };
        let (name, loops) = (name + &std::mem::take(&mut passes), std::mem::take(&mut loops));
        frames.push(StackFrame { name, span, open, loops });
    }
    frames.reverse();
    frames
}
