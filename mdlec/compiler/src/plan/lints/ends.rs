//! Warns about atoms that never end, and about elements that are never reached because an earlier element never ends
//! (W0201 and W0202).

use crate::diagnostic::{Code, Diagnostic, Span};
use crate::plan::{Atom, Condition, Interrupt, Node, Plan};

/// Warns about atoms that never end, and about elements that are never reached.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    let mut ends = EndsLint { plan, pause: 10.0, found };
    ends.enter(&plan.root.interrupt);
    if let (Some(Endless { atom: Some(atom), is_reported: false }), Condition::Null) =
        (ends.sequence(&plan.root.body), &plan.root.interrupt.condition)
    {
        let lint = ends.nothing_ends(atom);
        ends.found.push(lint);
    }
}

struct EndsLint<'p, 'f> {
    plan: &'p Plan,
    /// Duration, in seconds, that is proposed for an atom. It is shorter than the timers of all enclosing scopes.
    pause: f64,
    found: &'f mut Vec<Diagnostic>,
}

/// Reason why an element never ends by itself.
#[derive(Clone, Copy)]
struct Endless<'p> {
    /// Atom that never ends; `None` for an endless loop, which is assumed to be intended.
    atom: Option<&'p Atom>,
    /// `true` if the warning has already been given.
    is_reported: bool,
}

impl<'p> EndsLint<'p, '_> {
    /// Reduces the proposed duration to a value below the timers of this scope's interrupt.
    fn enter(&mut self, interrupt: &Interrupt) {
        for operand in interrupt.condition.operands() {
            if let Condition::Wait { nanos, .. } = operand
                && *nanos as f64 / 1e9 <= self.pause
            {
                self.pause = *nanos as f64 / 2e9;
            }
        }
    }

    /// Returns the reason why a sequence never ends; `None` if it can end.
    fn sequence(&mut self, body: &'p [Node]) -> Option<Endless<'p>> {
        let mut nodes = body.iter();
        let (place, endless) = nodes.by_ref().find_map(|node| Some((node.part().span(), self.node(node)?)))?;
        let Some(next) = nodes.next() else { return Some(endless) };
        self.unreachable(["this is never reached", "never runs"], next.part().span(), endless, place);
        Some(Endless { is_reported: true, ..endless })
    }

    fn node(&mut self, node: &'p Node) -> Option<Endless<'p>> {
        match node {
            Node::Atom(atom) => {
                let ends = can_end(&atom.interrupt) || self.plan.quark(atom.law).completes;
                (!ends).then_some(Endless { atom: Some(atom), is_reported: false })
            }
            Node::Scope(scope) => {
                let pause = self.pause;
                self.enter(&scope.interrupt);
                let endless = self.sequence(&scope.body).filter(|_| !can_end(&scope.interrupt));
                self.pause = pause;
                endless
            }
            Node::Loop(repeated) => match (self.sequence(&repeated.body), repeated.times) {
                (None, None) => Some(Endless { atom: None, is_reported: false }),
                (None, Some(_)) => None,
                (Some(endless), times) => {
                    let once = times == Some(1) || endless.is_reported || endless.atom.is_none();
                    if !once {
                        let atom = endless.atom.map_or(repeated.span, |atom| atom.span);
                        let words = ["the second pass of this loop is never reached", "runs only once"];
                        self.unreachable(words, repeated.span, endless, atom);
                    }
                    Some(Endless { is_reported: endless.is_reported || !once, ..endless })
                }
            },
        }
    }

    fn unreachable(&mut self, [message, here]: [&str; 2], span: Span, endless: Endless<'_>, place: Span) {
        let lint = Diagnostic::new(Code::W0202, message, span, here);
        self.found.push(match endless.atom {
            Some(atom) => {
                let law = &self.plan.quark(atom.law).text;
                let help = if atom.interrupt.removed {
                    format!("its own interrupt `{0}` was removed: end `{law}` by another one, or remove `{0}` from the enclosing scope", atom.interrupt.text)
                } else {
                    format!("say when `{law}` ends: `(Atom (wait {}) {law})`", self.pause)
                };
                lint.also(atom.span, format!("`{law}` never ends by itself")).help(help)
            }
            None => lint
                .also(place, "this loop runs for ever")
                .help("give it a count, or put it into a behavior with an interrupt: `{ Repeat (bumper) … }`"),
        });
    }

    fn nothing_ends(&self, atom: &Atom) -> Diagnostic {
        let law = &self.plan.quark(atom.law).text;
        let name = &self.plan.root.name;
        Diagnostic::new(
            Code::W0201,
            format!("nothing ever ends `{law}`, so the plan `{name}` never ends"),
            atom.span,
            "neither this nor an enclosing scope has an interrupt that can fire",
        )
        .help(format!("say when it ends, `(Atom (wait 10) {law})`, or what ends the plan, `{{ {name} (bumper) … }}`"))
    }
}

/// Returns `true` if the interrupt can fire.
fn can_end(interrupt: &Interrupt) -> bool {
    interrupt.condition != Condition::Null
}
