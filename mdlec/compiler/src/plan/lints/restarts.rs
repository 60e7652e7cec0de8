//! Warns about a `stuck` that never fires, because every `goAvoid` in its scope ends sooner and each new one begins to
//! count anew (W0203; docs/src/reference/semantics.md, 3.5).

use super::goals::{stucks, towards_goal};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::plan::{Condition, Interrupt, Node, Plan, Quark, QuarkId};

/// Minimum time, in nanoseconds, by which a drive has to end sooner. If both times were over in the same turn, the
/// `stuck` of the outer scope would fire first. With a longer period of turns than this, it may still do so.
const TURN: u64 = 1_000_000_000;

/// Warns about every `stuck` whose time is longer than that of every drive in its scope.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    let mut lint = Restarts { plan, found };
    let longest = lint.sequence(&plan.root.body);
    lint.enclosed(&plan.root.interrupt, longest);
}

struct Restarts<'p, 'f> {
    plan: &'p Plan,
    found: &'f mut Vec<Diagnostic>,
}

/// Maximum time for which a drive can go without progress before an interrupt ends it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Longest {
    /// An interrupt ends the drive after this time, in nanoseconds.
    Limited(u64, QuarkId, Span),
    /// A `goAvoid` that no interrupt is certain to end.
    Unlimited,
    /// A law of a robot's own, whose report may outlast its atom.
    Unknown,
}

impl Restarts<'_, '_> {
    /// Checks a sequence, and returns the maximum over its drives; `None` if it has no drives.
    fn sequence(&mut self, body: &[Node]) -> Option<Longest> {
        body.iter().filter_map(|node| self.node(node)).max()
    }

    fn node(&mut self, node: &Node) -> Option<Longest> {
        match node {
            Node::Loop(repeated) => self.sequence(&repeated.body),
            Node::Scope(scope) => {
                let longest = self.sequence(&scope.body);
                self.enclosed(&scope.interrupt, longest)
            }
            Node::Atom(atom) => {
                let law = self.plan.quark(atom.law);
                let own = if law.name == "goAvoid" { Longest::Unlimited } else { Longest::Unknown };
                self.enclosed(&atom.interrupt, (towards_goal(law) > 0.0).then_some(own))
            }
        }
    }

    /// Checks an interrupt whose scope has `longest`, and returns the maximum that the interrupt leaves.
    fn enclosed(&mut self, interrupt: &Interrupt, longest: Option<Longest>) -> Option<Longest> {
        let longest = longest?;
        let own = self.limit(&interrupt.condition).map(|(nanos, by)| Longest::Limited(nanos, by, interrupt.span));
        let left = own.filter(|_| longest != Longest::Unknown).map_or(longest, |own| own.min(longest));
        if let Longest::Limited(nanos, by, span) = left {
            let outlasts = |(_, time): &(&Quark, u64)| *time >= nanos.saturating_add(TURN);
            let never = stucks(self.plan, &interrupt.condition).into_iter().find(outlasts);
            if let Some((stuck, _)) = never {
                self.found.push(warning(stuck, interrupt.span, self.plan.quark(by), span));
            }
        }
        Some(left)
    }

    /// Returns the time, in nanoseconds, after which a condition is certain to have ended a drive without progress, and
    /// the quark that ends it; `None` if nothing is certain.
    fn limit(&self, condition: &Condition) -> Option<(u64, QuarkId)> {
        if let Some((quark, nanos)) = condition.lasting() {
            return (self.plan.quark(quark).name == "stuck").then_some((nanos, quark));
        }
        match condition {
            Condition::Wait { nanos, quark } => Some((*nanos, *quark)),
            Condition::Elapsed { from, until: None, quark } => Some((*from, *quark)),
            Condition::Or(operands) => operands.iter().filter_map(|operand| self.limit(operand)).min(),
            Condition::And(operands) => {
                let limits: Option<Vec<_>> = operands.iter().map(|operand| self.limit(operand)).collect();
                limits?.into_iter().max()
            }
            Condition::Null | Condition::Quark(_) | Condition::Elapsed { until: Some(_), .. } => None,
            Condition::Driven { .. } | Condition::Not(_) | Condition::Rising { .. } | Condition::After(_) => None,
        }
    }
}

/// Reports a `stuck` whose drives are ended sooner by the quark `by` in the interrupt at `place`.
fn warning(stuck: &Quark, interrupt: Span, by: &Quark, place: Span) -> Diagnostic {
    let (stuck, by) = (&stuck.text, &by.text);
    let lint = |here| Diagnostic::new(Code::W0203, format!("`{stuck}` is never true"), interrupt, here);
    if place == interrupt {
        let help = format!("remove `{stuck}`, or give it less time than `{by}`");
        return lint(format!("`{by}` fires sooner")).help(help);
    }
    lint(format!("each new `goAvoid` in this scope begins the time of `{stuck}` anew"))
        .also(place, format!("`{by}` ends a `goAvoid` sooner"))
        .help("to limit all of them together, write a timer, such as `wait 2min`")
}
