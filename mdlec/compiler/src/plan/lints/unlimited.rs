//! Warns about a `goAvoid` to a point if it ends only on arrival or contact. It never ends if no path leads to the
//! point (W0208).

use crate::diagnostic::{Code, Diagnostic};
use crate::plan::{Atom, Condition, Node, Plan};

/// Warns about every `goAvoid` that ends only on arrival or contact.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    let mut lint = Unlimited { plan, found };
    let is_limited = lint.limits(&plan.root.interrupt.condition);
    lint.sequence(&plan.root.body, is_limited);
}

struct Unlimited<'p, 'f> {
    plan: &'p Plan,
    found: &'f mut Vec<Diagnostic>,
}

impl<'p> Unlimited<'p, '_> {
    /// Checks a sequence; `is_limited` is `true` if an enclosing scope ends the sequence.
    fn sequence(&mut self, body: &'p [Node], is_limited: bool) {
        for node in body {
            match node {
                Node::Atom(atom) => {
                    let law = self.plan.quark(atom.law);
                    // A `goAvoid` that follows a module never arrives, and does not complete.
                    let arrives = law.name == "goAvoid" && law.completes;
                    if arrives && !is_limited && !self.limits(&atom.interrupt.condition) {
                        self.warn(atom);
                    }
                }
                Node::Scope(scope) => {
                    let is_limited = is_limited || self.limits(&scope.interrupt.condition);
                    self.sequence(&scope.body, is_limited);
                }
                Node::Loop(repeated) => self.sequence(&repeated.body, is_limited),
            }
        }
    }

    /// Returns `true` if a condition may end a drive whose goal cannot be reached. Contact is ignored, because the law
    /// avoids obstacles.
    fn limits(&self, condition: &Condition) -> bool {
        match condition {
            Condition::Null => false,
            Condition::Quark(id) => self.plan.quark(*id).name != "bumper",
            Condition::Or(operands) => operands.iter().any(|operand| self.limits(operand)),
            Condition::And(operands) => operands.iter().all(|operand| self.limits(operand)),
            Condition::Rising { operand, .. } => self.limits(operand),
            Condition::Wait { .. } | Condition::Elapsed { .. } | Condition::Driven { .. } => true,
            Condition::Not(_) | Condition::After(_) => true,
        }
    }

    fn warn(&mut self, atom: &Atom) {
        let law = &self.plan.quark(atom.law).text;
        let (span, text) = (atom.interrupt.span, &atom.interrupt.text);
        let message = format!("where no way leads to its point, `{law}` never ends");
        let lint = Diagnostic::new(Code::W0208, message, span, "neither this nor an enclosing scope limits its time");
        // A removed interrupt keeps its text, which is not to be proposed again because an enclosing scope has it.
        let is_null = atom.interrupt.condition == Condition::Null;
        let with = |limit: &str| if is_null { format!("({limit})") } else { format!("({text} OR {limit})") };
        let lint = lint.fix("end it where it comes no nearer for some time: {}", span, with("stuck 30s"));
        self.found.push(lint.fix("or give it a time: {}", span, with("wait 2min")));
    }
}
