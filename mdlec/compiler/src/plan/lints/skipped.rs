//! Warns about loops that can be skipped within one turn, because no pass takes time while certain conditions hold
//! (W0301).

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::{Code, Diagnostic};
use crate::plan::families::{Family, Readings, at_once, family};
use crate::plan::{Condition, Interrupt, Loop, Node, Plan, Quark, QuarkId, RecordId, Scope, Situation};

/// Maximum number of quarks in a loop for which all combinations of values are tried. Loops with more quarks are not
/// checked.
const QUARKS: usize = 8;
/// Maximum number of elements in a loop that is checked.
const ELEMENTS: usize = 64;

/// Warns about loops that can be skipped.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    let mut skipped = Skipped { plan, known: BTreeMap::new(), found };
    skipped.inside(&plan.root);
}

struct Skipped<'p, 'f> {
    plan: &'p Plan,
    /// Values of quarks that are certain because no enclosing scope has ended.
    known: BTreeMap<QuarkId, bool>,
    found: &'f mut Vec<Diagnostic>,
}

impl Skipped<'_, '_> {
    /// Checks the body of a scope, assuming that no operand of the scope's interrupt has fired. Returns `true` if the
    /// body contains a reported loop.
    fn inside(&mut self, scope: &Scope) -> bool {
        let known = self.known.clone();
        for operand in scope.interrupt.condition.operands() {
            match operand {
                Condition::Quark(id) => drop(self.known.insert(*id, false)),
                Condition::Not(operand) => {
                    if let Condition::Quark(id) = **operand {
                        self.known.insert(id, true);
                    }
                }
                Condition::Null | Condition::Wait { .. } | Condition::Elapsed { .. } | Condition::Driven { .. } => {}
                Condition::Or(_) | Condition::And(_) | Condition::Rising { .. } | Condition::After(_) => {}
            }
        }
        let is_reported = self.sequence(&scope.body);
        self.known = known;
        is_reported
    }

    /// Checks a sequence. Returns `true` if it contains a reported loop, because an enclosing loop can be skipped for
    /// the same reason and need not be reported.
    fn sequence(&mut self, body: &[Node]) -> bool {
        body.iter().fold(false, |is_reported, node| {
            is_reported
                | match node {
                    Node::Atom(_) => false,
                    Node::Scope(scope) => self.inside(scope),
                    Node::Loop(repeated) => self.sequence(&repeated.body) || self.repeated(repeated),
                }
        })
    }

    fn repeated(&mut self, repeated: &Loop) -> bool {
        if repeated.times == Some(1) {
            return false;
        }
        let Some(holding) = self.skips(&repeated.body) else { return false };
        let message = format!("while `{holding}` is true, every pass of this loop is skipped in one turn");
        let lint = Diagnostic::new(Code::W0301, message, repeated.span, "no pass takes time then");
        let rising = if holding.contains(' ') { format!("RISING ({holding})") } else { format!("RISING {holding}") };
        self.found.push(
            lint.help("let each pass take some time, as `(Atom (wait 0.5) stop)` does")
                .help(format!("or let a pass wait until it becomes true: `{rising}`")),
        );
        true
    }

    /// Returns the condition under which a pass takes no time; `None` if a pass always takes time or never
    /// does.
    fn skips(&self, body: &[Node]) -> Option<String> {
        let skip = all(body, &mut ELEMENTS.clone())?;
        // The elements that ended last differ from pass to pass.
        if skip.any(&|part| matches!(part, Condition::After(_))) {
            return None;
        }
        let mut quarks = BTreeSet::new();
        skip.each_quark(&mut |id| {
            quarks.insert(id);
        });
        let quarks: Vec<QuarkId> = quarks.into_iter().collect();
        if quarks.is_empty() || quarks.len() > QUARKS {
            return None;
        }
        let value =
            |choice: u32, id| quarks.iter().position(|quark| *quark == id).is_some_and(|bit| choice >> bit & 1 == 1);
        let skips = |choice: u32| skip.fired(&AtOnce(|id| value(choice, id)));
        let choices = || 0..1_u32 << quarks.len();
        // A loop that is always skipped has a condition that is always true, which W0203 reports.
        if choices().all(skips) {
            return None;
        }
        let can_be = |choice: &u32| self.can_be(quarks.iter().map(|id| (*id, value(*choice, *id))));
        let choice =
            choices().filter(|choice| skips(*choice) && can_be(choice)).min_by_key(|choice| choice.count_ones())?;
        // The message contains only the quarks whose values matter.
        let mut matters = (1_u32 << quarks.len()) - 1;
        for bit in (0..quarks.len()).map(|bit| 1 << bit) {
            let without = matters & !bit;
            if choices().filter(|other| (other ^ choice) & without == 0 && can_be(other)).all(skips) {
                matters = without;
            }
        }
        let literals = quarks.iter().enumerate().filter(|(bit, _)| matters >> bit & 1 == 1);
        let words = literals.map(|(_, id)| {
            let not = if value(choice, *id) { "" } else { "NOT " };
            format!("{not}{}", self.plan.quark(*id).text)
        });
        Some(words.collect::<Vec<_>>().join(" AND "))
    }

    /// Returns `true` if these quarks can have these values in one turn.
    fn can_be(&self, values: impl Iterator<Item = (QuarkId, bool)>) -> bool {
        let mut families: BTreeMap<Family<'_>, Vec<(&Quark, bool)>> = BTreeMap::new();
        let mut all = self.known.clone();
        for (id, value) in values {
            if all.insert(id, value).is_some_and(|known| known != value) {
                return false;
            }
        }
        for (id, value) in all {
            let quark = self.plan.quark(id);
            if let Some(family) = family(quark) {
                families.entry(family).or_default().push((quark, value));
            }
        }
        families.values().all(|members| {
            let values: Vec<bool> = members.iter().map(|(_, value)| *value).collect();
            at_once(members.iter().map(|(quark, _)| *quark), Readings::Any).contains(&values)
        })
    }
}

/// State of a scope that has just been entered, for evaluating conditions. Contains a function that returns the value
/// of each quark.
struct AtOnce<F>(F);

impl<F: Fn(QuarkId) -> bool> Situation for AtOnce<F> {
    fn quark(&self, quark: QuarkId) -> bool {
        (self.0)(quark)
    }

    fn waited(&self, nanos: u64) -> bool {
        nanos == 0
    }

    fn driven(&self, nanometers: u64) -> bool {
        nanometers == 0
    }

    fn remembers(&self, _: u32) -> bool {
        false
    }

    fn recorded(&self, _: RecordId, _: u32) -> bool {
        // Not used, because loops with `after` are not checked.
        false
    }
}

/// Returns the condition under which a sequence takes no time; `None` if there is no such condition. Checks at most
/// `left` elements. A law may complete at once, but is assumed to take time.
fn all(body: &[Node], left: &mut usize) -> Option<Condition> {
    let mut conditions = Vec::new();
    for node in body {
        *left = left.checked_sub(1)?;
        conditions.push(match node {
            Node::Atom(atom) => own(&atom.interrupt)?,
            Node::Loop(repeated) => all(&repeated.body, left)?,
            Node::Scope(scope) => match (own(&scope.interrupt), all(&scope.body, left)) {
                (Some(own), Some(all)) => Condition::Or(vec![own, all]),
                (own, all) => own.or(all)?,
            },
        });
    }
    Some(Condition::And(conditions))
}

/// Returns the condition of the interrupt if it can be true when its scope is entered; `None` otherwise.
fn own(interrupt: &Interrupt) -> Option<Condition> {
    let condition = &interrupt.condition;
    let never = matches!(
        condition,
        Condition::Null
            | Condition::Wait { nanos: 1.., .. }
            | Condition::Driven { from: 1.., .. }
            | Condition::Rising { .. }
    );
    (!never).then(|| condition.clone())
}
