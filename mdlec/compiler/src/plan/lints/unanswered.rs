//! Warns about an atom that waits for another robot without a time limit. If that robot is off, the atom never ends
//! (W0209).

use crate::diagnostic::{Code, Diagnostic};
use crate::plan::{Atom, Condition, Interrupt, Node, Plan};

/// Warns about every atom that waits for another robot without a time limit.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    let mut lint = Unanswered { plan, found };
    let is_limited = is_timed(&plan.root.interrupt);
    lint.sequence(&plan.root.body, is_limited);
}

struct Unanswered<'p, 'f> {
    plan: &'p Plan,
    found: &'f mut Vec<Diagnostic>,
}

impl<'p> Unanswered<'p, '_> {
    /// Checks a sequence; `is_limited` is `true` if a timer of an enclosing scope ends the sequence.
    fn sequence(&mut self, body: &'p [Node], is_limited: bool) {
        for node in body {
            match node {
                Node::Atom(atom) => {
                    // A law that completes ends its atom even without the other robot.
                    let is_limited = is_limited || is_timed(&atom.interrupt) || self.plan.quark(atom.law).completes;
                    if let Some(text) = self.waits(&atom.interrupt.condition).filter(|_| !is_limited) {
                        self.warn(atom, &text);
                    }
                }
                Node::Scope(scope) => self.sequence(&scope.body, is_limited || is_timed(&scope.interrupt)),
                Node::Loop(repeated) => self.sequence(&repeated.body, is_limited),
            }
        }
    }

    /// Returns the first quark by which a condition waits for another robot; `None` if there is no such quark. A quark
    /// under NOT is ignored, because it ends the atom even without that robot.
    fn waits(&self, condition: &Condition) -> Option<String> {
        match condition {
            Condition::Quark(id) => {
                let quark = self.plan.quark(*id);
                ["sync", "rendezvous"].contains(&quark.name.as_str()).then(|| quark.text.clone())
            }
            Condition::Or(operands) | Condition::And(operands) => {
                operands.iter().find_map(|operand| self.waits(operand))
            }
            Condition::Rising { operand, .. } => self.waits(operand),
            Condition::Null | Condition::Not(_) | Condition::After(_) => None,
            Condition::Wait { .. } | Condition::Elapsed { .. } | Condition::Driven { .. } => None,
        }
    }

    fn warn(&mut self, atom: &Atom, waits: &str) {
        let (span, text) = (atom.interrupt.span, &atom.interrupt.text);
        let message = format!("if that robot is off, `{waits}` waits for ever");
        let lint = Diagnostic::new(Code::W0209, message, span, "neither this nor an enclosing scope has a timer");
        let joined = format!("({text} OR wait 2min)");
        self.found.push(lint.fix("give it a time: {}", span, joined));
    }
}

/// Returns `true` if a timer alone can end a scope.
fn is_timed(interrupt: &Interrupt) -> bool {
    interrupt.condition.operands().iter().any(|operand| match operand {
        Condition::Wait { .. } | Condition::Elapsed { .. } => true,
        Condition::Null | Condition::Quark(_) | Condition::Driven { .. } | Condition::Or(_) => false,
        Condition::And(_) | Condition::Not(_) | Condition::Rising { .. } | Condition::After(_) => false,
    })
}
