//! Warns about a `stuck` that never fires, because no law in its scope has a goal (W0203).

use crate::diagnostic::{Code, Diagnostic};
use crate::plan::{Condition, Interrupt, Node, Plan};

/// Laws of the common alphabet that report no progress towards a goal. Laws of a robot's own may report it.
const WITHOUT_GOAL: [&str; 9] = ["go", "stop", "rotate", "turn", "advance", "align", "Follow", "slot", "path"];

/// Warns about every `stuck` that never fires.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    let mut lint = Goals { plan, found };
    let has_goal = lint.sequence(&plan.root.body);
    lint.interrupt(&plan.root.interrupt, has_goal, "no law in here has a goal");
}

struct Goals<'p, 'f> {
    plan: &'p Plan,
    found: &'f mut Vec<Diagnostic>,
}

impl Goals<'_, '_> {
    /// Checks a sequence, and returns `true` if a law in the sequence may have a goal.
    fn sequence(&mut self, body: &[Node]) -> bool {
        let mut has_goal = false;
        for node in body {
            has_goal |= self.node(node);
        }
        has_goal
    }

    fn node(&mut self, node: &Node) -> bool {
        match node {
            Node::Loop(repeated) => self.sequence(&repeated.body),
            Node::Scope(scope) => {
                let has_goal = self.sequence(&scope.body);
                self.interrupt(&scope.interrupt, has_goal, "no law in here has a goal");
                has_goal
            }
            Node::Atom(atom) => {
                let law = self.plan.quark(atom.law);
                // A `goAvoid` that follows a module has no goal, and does not complete.
                let follows = law.name == "goAvoid" && !law.completes;
                let has_goal = !follows && !WITHOUT_GOAL.contains(&law.name.as_str());
                self.interrupt(&atom.interrupt, has_goal, "this law has no goal");
                has_goal
            }
        }
    }

    fn interrupt(&mut self, interrupt: &Interrupt, has_goal: bool, here: &str) {
        let Some(text) = self.stuck(&interrupt.condition).filter(|_| !has_goal) else { return };
        let lint = Diagnostic::new(Code::W0203, format!("`{text}` is never true"), interrupt.span, here);
        self.found.push(
            lint.help("`stuck` asks for the progress of a `goAvoid` to a point; a time ends every law: `wait 30s`"),
        );
    }

    /// Returns the first `stuck` in a condition; `None` if there is none.
    fn stuck(&self, condition: &Condition) -> Option<String> {
        // The causes that `after` asks for are no operands: their elements have ended before.
        if let Condition::Quark(id) = condition {
            let quark = self.plan.quark(*id);
            return (quark.name == "stuck").then(|| quark.text.clone());
        }
        condition.children().iter().find_map(|operand| self.stuck(operand))
    }
}
