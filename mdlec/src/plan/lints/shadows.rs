//! W0204: parts of a condition that an equal outer condition shadows: the outer one is read first, so they never are what
//! ends their scope. Whole interrupts that are repeated were removed before, with W0101.

use std::collections::BTreeMap;

use crate::diagnostic::{Code, Diagnostic, Span};
use crate::plan::{Condition, Interrupt, Node, Plan, QuarkId, Scope};

/// Warns of them.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    Shadows { plan, around: BTreeMap::new(), found }.scope(&plan.root);
}

/// An operand that is the same function wherever it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Operand {
    /// A quark, or a timer: one that was entered earlier is over earlier.
    Fired(QuarkId),
    /// A quark that has not fired.
    NotFired(QuarkId),
}

struct Shadows<'p, 'f> {
    plan: &'p Plan,
    /// The operands that end a scope around this place, each with that scope's name and the place of its interrupt.
    around: BTreeMap<Operand, (&'p str, Span)>,
    found: &'f mut Vec<Diagnostic>,
}

impl<'p> Shadows<'p, '_> {
    fn scope(&mut self, scope: &'p Scope) {
        self.interrupt(&scope.interrupt);
        let mut added = Vec::new();
        for operand in self.operands(&scope.interrupt) {
            if let std::collections::btree_map::Entry::Vacant(place) = self.around.entry(operand) {
                place.insert((&scope.name, scope.interrupt.span));
                added.push(operand);
            }
        }
        self.sequence(&scope.body);
        for operand in added {
            self.around.remove(&operand);
        }
    }

    fn sequence(&mut self, body: &'p [Node]) {
        for node in body {
            match node {
                Node::Atom(atom) => self.interrupt(&atom.interrupt),
                Node::Scope(scope) => self.scope(scope),
                Node::Loop(repeated) => self.sequence(&repeated.body),
            }
        }
    }

    fn interrupt(&mut self, interrupt: &Interrupt) {
        let shadowed =
            self.operands(interrupt).into_iter().find_map(|operand| Some((operand, *self.around.get(&operand)?)));
        let Some((operand, (scope, outer))) = shadowed else { return };
        let text = match operand {
            Operand::Fired(id) => self.plan.quark(id).text.clone(),
            Operand::NotFired(id) => format!("NOT {}", self.plan.quark(id).text),
        };
        let whose = if scope.is_empty() { "the enclosing scope".to_owned() } else { format!("`{scope}`") };
        let message = format!("`{text}` can never end this: {whose} ends by it first");
        let lint = Diagnostic::new(Code::W0204, message, interrupt.span, format!("`{text}` has no effect"));
        let lint = lint.also(outer, format!("{whose} ends by this"));
        self.found.push(if interrupt.text == text {
            lint.fix("write {}, or another condition", interrupt.span, "(null)")
        } else {
            lint.help(format!("remove `{text}`"))
        });
    }

    /// The operands of which one is enough, as far as they are the same wherever they stand.
    fn operands(&self, interrupt: &Interrupt) -> Vec<Operand> {
        if let Condition::Or(operands) = &interrupt.condition {
            return operands.iter().filter_map(|operand| self.operand(operand)).collect();
        }
        self.operand(&interrupt.condition).into_iter().collect()
    }

    fn operand(&self, condition: &Condition) -> Option<Operand> {
        let same = |id: QuarkId| !self.plan.quark(id).remembers;
        if let Condition::Wait { quark, .. } = condition {
            return Some(Operand::Fired(*quark));
        }
        if let Condition::Not(operand) = condition
            && let Condition::Quark(id) = **operand
        {
            return same(id).then_some(Operand::NotFired(id));
        }
        if let Condition::Quark(id) = condition { same(*id).then_some(Operand::Fired(*id)) } else { None }
    }
}
