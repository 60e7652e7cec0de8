//! Expands finite loops (paper, section II-A: `(s1 s2)^3 → s1 s2 s1 s2 s1 s2`), so that every state gets a number.

use super::{STATES, lower};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::plan::{Loop, Node, Nondegenerate, PlanPart, Scope};

/// Maximum number of states of an expanded plan.
const EXPANDED: u64 = 100_000;
/// Maximum number of parts of conditions in an expanded plan, unless the plan as written has more.
const PARTS: u64 = 1 << 20;
/// Maximum number of bytes of conditions and names in an expanded plan, unless the plan as written has more.
const TEXT: u64 = 1 << 26;

/// Returns the plan with its finite loops written out; loops without end are unchanged.
///
/// # Errors
/// Fails with E0501 for a plan that cannot be converted to a state machine. Fails with E0502 for a plan with more than
/// 100,000 states, or with too many conditions or too much text in these states.
pub fn expand(plan: &Nondegenerate) -> Result<Nondegenerate, Diagnostic> {
    expands(plan)?;
    Ok(plan.map(expand_scope))
}

/// Checks that the expanded form of a plan is within the limits of states, conditions and texts.
///
/// # Errors
/// Fails with E0501 or E0502 as [`expand`] does.
pub fn expands(plan: &Nondegenerate) -> Result<(), Diagnostic> {
    expanded_states(plan)?;
    let parts = ElementSum {
        unit: "parts of conditions",
        of: |part| part.interrupt().map_or(0, |interrupt| interrupt.condition.parts() as u64),
    };
    let text = ElementSum {
        unit: "bytes of text",
        of: |part| {
            let name = part.scope().map_or(0, |scope| scope.name.len());
            part.interrupt().map_or(0, |interrupt| (interrupt.text.len() + name) as u64)
        },
    };
    for (count, limit) in [(parts, PARTS), (text, TEXT)] {
        let source_size = Expanded::of(PlanPart::Scope(&plan.plan().root), &count, false).all;
        let expanded = Expanded::of(PlanPart::Scope(&plan.plan().root), &count, true);
        if expanded.all > limit.max(source_size) {
            return Err(too_large(&expanded, &count, limit, plan));
        }
    }
    Ok(())
}

/// Returns the number of states, including the termination state, of a plan with its finite loops written out.
///
/// # Errors
/// Fails with E0501 for a plan that cannot be converted to a state machine, and with E0502 for a plan with more than
/// 100,000 states.
pub fn expanded_states(plan: &Nondegenerate) -> Result<u64, Diagnostic> {
    let count = ElementSum { unit: "states", of: |part| u64::from(part.atom().is_some()) };
    let expanded = Expanded::of(PlanPart::Scope(&plan.plan().root), &count, true);
    let states = expanded.all.saturating_add(1);
    if states <= EXPANDED {
        return Ok(states);
    }
    if states > STATES {
        // Reports the loops whose counts multiply.
        lower(plan)?;
    }
    Err(too_large(&Expanded { all: states, ..expanded }, &count, EXPANDED, plan))
}

fn expand_scope(scope: &Scope) -> Scope {
    // The fields are copied one by one, because a copy of the whole scope would include the body at each level.
    Scope {
        name: scope.name.clone(),
        interrupt: scope.interrupt.clone(),
        body: expand_sequence(&scope.body),
        here: scope.here,
        record: scope.record,
        marks: scope.marks.clone(),
        span: scope.span,
    }
}

fn expand_sequence(body: &[Node]) -> Vec<Node> {
    let mut expanded = Vec::new();
    for node in body {
        match node {
            Node::Atom(atom) => expanded.push(Node::Atom(atom.clone())),
            Node::Scope(scope) => expanded.push(Node::Scope(expand_scope(scope))),
            Node::Loop(Loop { times, body, marks, span }) => {
                let body = expand_sequence(body);
                let (marks, span) = (marks.clone(), *span);
                match times {
                    Some(times) => {
                        (0..*times).for_each(|_| expanded.extend(body.iter().cloned()));
                        // The loop ends with the last element of its last pass.
                        if let Some(last) = expanded.last_mut() {
                            last.marks_mut().extend(marks);
                        }
                    }
                    None => expanded.push(Node::Loop(Loop { times: None, body, marks, span })),
                }
            }
        }
    }
    expanded
}

/// A quantity that is added up over all elements. Contains the function that returns the amount for a single element.
struct ElementSum {
    /// Name of the quantity in the plural.
    unit: &'static str,
    of: fn(PlanPart<'_>) -> u64,
}

/// Total of a quantity over a plan, and the loop that contributes most to the total.
#[derive(Default)]
struct Expanded {
    all: u64,
    largest: Option<(u64, Span)>,
}

impl Expanded {
    /// Adds up the quantity over all passes of finite loops if `passes` is `true`, and over one pass of each loop
    /// otherwise.
    fn of(part: PlanPart<'_>, count: &ElementSum, passes: bool) -> Self {
        let inside = part.body().iter().map(|node| Self::of(node.part(), count, passes));
        let size = |repeated: &Option<(u64, Span)>| repeated.map_or(0, |(size, _)| size);
        let inside = inside.fold(Self { all: (count.of)(part), largest: None }, |sum, Self { all, largest }| {
            let largest = if size(&largest) > size(&sum.largest) { largest } else { sum.largest };
            Self { all: sum.all.saturating_add(all), largest }
        });
        let PlanPart::Loop(Loop { times: Some(times), span, .. }) = part else { return inside };
        let all = inside.all.saturating_mul(if passes { *times } else { 1 });
        Self { all, largest: if *times > 1 { Some((all, *span)) } else { inside.largest } }
    }
}

fn too_large(expanded: &Expanded, count: &ElementSum, limit: u64, plan: &Nondegenerate) -> Diagnostic {
    let (all, unit) = (expanded.all, count.unit);
    let message = format!("expanded, this plan has {all} {unit}; an expanded form has at most {limit}");
    let help = "the executable, `--emit rust` and `trace` with its usual machine need no expansion: their size does not \
                depend on loop counts";
    match expanded.largest {
        Some((size, span)) => {
            let here = format!("this loop makes {size} of them");
            Diagnostic::new(Code::E0502, message, span, here).help(help)
        }
        None => {
            Diagnostic::new(Code::E0502, message, plan.plan().root.span, "this plan").help("cut it into several plans")
        }
    }
}
