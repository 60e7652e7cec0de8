//! Warns about a `FRAME here` if no law inside it turns to a heading or drives at a bearing (W0207).

use crate::alphabet::has_direction;
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::{Atom, Node, Plan, Quark, Value};

/// Warns about every `FRAME here` that no law uses.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    FrameLint { plan, found }.sequence(&plan.root.body);
}

struct FrameLint<'p, 'f> {
    plan: &'p Plan,
    found: &'f mut Vec<Diagnostic>,
}

impl<'p> FrameLint<'p, '_> {
    /// Returns the first atom of a sequence, and `true` if a law in the sequence may use the frame.
    fn sequence(&mut self, body: &'p [Node]) -> (Option<&'p Atom>, bool) {
        body.iter().fold((None, false), |(first, is_used), node| {
            let (own, uses) = self.node(node);
            (first.or(own), is_used || uses)
        })
    }

    fn node(&mut self, node: &'p Node) -> (Option<&'p Atom>, bool) {
        let (span, here, (first, is_used)) = match node {
            Node::Atom(atom) => (atom.span, atom.here, (Some(atom), names_a_direction(self.plan.quark(atom.law)))),
            Node::Scope(scope) => (scope.span, scope.here, self.sequence(&scope.body)),
            Node::Loop(repeated) => return self.sequence(&repeated.body),
        };
        if !here {
            return (first, is_used);
        }
        if let Some(atom) = first.filter(|_| !is_used) {
            let law = &self.plan.quark(atom.law).text;
            let message = format!("`FRAME here` changes nothing: `{law}` has neither a heading nor a bearing");
            self.found.push(
                Diagnostic::new(Code::W0207, message, span, "no law in here uses its frame")
                    .help("remove `FRAME here`; laws such as `goAvoid` and `rotate` use it"),
            );
        }
        // A law inside this frame does not use the enclosing frame.
        (first, false)
    }
}

/// Returns `true` if `law` may use a direction that is relative to the frame of its atom.
fn names_a_direction(law: &Quark) -> bool {
    let kinds = law.args.iter().filter_map(|argument| match argument {
        Value::Quantity { kind, .. } | Value::Name(kind, _) => Some(*kind),
        Value::Infinity(_) | Value::Bits(_) | Value::Integer(_) | Value::Sonar(_) => None,
    });
    has_direction(&law.name, kinds)
}
