//! Warns about an `align` of two sonars whose ranges do not tell the direction of a wall (W0210).

use mdle_runtime::SONARS;

use crate::diagnostic::{Code, Diagnostic};
use crate::plan::arguments::walls;
use crate::plan::{Atom, Node, Plan, Value};

/// Warns about every `align` that compares a sonar with itself or with the one that looks in the opposite direction.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    sequence(plan, &plan.root.body, found);
}

fn sequence(plan: &Plan, body: &[Node], found: &mut Vec<Diagnostic>) {
    for node in body {
        match node {
            Node::Atom(atom) => found.extend(warning(plan, atom)),
            Node::Scope(scope) => sequence(plan, &scope.body, found),
            Node::Loop(repeated) => sequence(plan, &repeated.body, found),
        }
    }
}

fn warning(plan: &Plan, atom: &Atom) -> Option<Diagnostic> {
    let law = plan.quark(atom.law);
    let [Value::Sonar(first), Value::Sonar(second)] = law.args.as_slice() else { return None };
    let (text, apart) = (&law.text, usize::from(first.abs_diff(*second)));
    let message = match apart {
        _ if law.name != "align" => return None,
        0 => format!("`{text}` compares a sonar with itself, which says nothing about a wall"),
        _ if apart * 2 == SONARS => format!("`{text}` compares two walls: the sonars look in opposite directions"),
        _ => return None,
    };
    let lint = Diagnostic::new(Code::W0210, message, atom.span, "write two sonars that look at the same wall");
    Some(lint.help(walls(&law.name)))
}
