//! The stack of a run: the current atom, and the scopes that enclose it, each with the passes of the loops around it.

use mdle_compiler::diagnostic::Span;
use mdle_compiler::plan::{Part, Plan};

use crate::run::Run;

/// A frame of the stack.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Frame {
    /// Text for people.
    pub(crate) name: String,
    /// Place of the atom, or of the scope's definition.
    pub(crate) span: Span,
    /// Index among the open elements of the run.
    pub(crate) open: usize,
    /// Indices of the loops directly around the element, the innermost last.
    pub(crate) loops: Vec<usize>,
}

/// Returns the frames, the current atom first and the plan last; none when the plan has ended.
pub(crate) fn frames(run: &Run<'_>, plan: &Plan) -> Vec<Frame> {
    let (mut frames, mut loops, mut passes) = (Vec::new(), Vec::new(), String::new());
    for (open, element) in run.open().enumerate() {
        let (name, span) = match element.part() {
            Part::Loop(repeated) => {
                let of = repeated.times.map_or_else(|| "without end".to_owned(), |times| format!("of {times}"));
                passes += &format!(", pass {} {of}", element.pass());
                loops.push(open);
                continue;
            }
            Part::Scope(scope) if scope.name.is_empty() => (format!("({})", scope.interrupt.text), scope.span),
            Part::Scope(scope) => (scope.name.clone(), scope.span),
            Part::Atom(atom) => (plan.quark(atom.law).text.clone(), atom.span),
        };
        let (name, loops) = (name + &std::mem::take(&mut passes), std::mem::take(&mut loops));
        frames.push(Frame { name, span, open, loops });
    }
    frames.reverse();
    frames
}
