//! Writes finite loops out (paper, section II-A: `(s1 s2)^3 → s1 s2 s1 s2 s1 s2`), so that every state has a number.

use super::algorithm1;
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::plan::{Loop, Node, Nondegenerate, Scope};

/// The most states that an expanded form is made for.
const EXPANDED: u64 = 100_000;

/// The plan with its finite loops written out; a loop without end is left as it is.
///
/// # Errors
/// E0501 for a plan that cannot be lowered, E0502 for one of more than 100,000 states.
pub fn expand(plan: &Nondegenerate) -> Result<Nondegenerate, Diagnostic> {
    expanded_states(plan)?;
    Ok(plan.map(expand_scope))
}

/// The number of states of a plan with its finite loops written out, the termination state included.
///
/// # Errors
/// As [`expand`]: E0501 for a plan that cannot be lowered, E0502 for one of more than 100,000 states.
pub fn expanded_states(plan: &Nondegenerate) -> Result<u64, Diagnostic> {
    let states = algorithm1(plan)?.termination;
    if states > EXPANDED { Err(too_large(states, plan)) } else { Ok(states) }
}

fn expand_scope(scope: &Scope) -> Scope {
    Scope { body: expand_sequence(&scope.body), ..scope.clone() }
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

fn too_large(states: u64, plan: &Nondegenerate) -> Diagnostic {
    let message = format!("expanded, this plan has {states} states; an expanded form has at most {EXPANDED}");
    let help = "the executable, `--emit rust` and `trace` with its usual machine need no expansion: their size does not \
                depend on loop counts";
    match largest_loop(&plan.plan().root.body).1 {
        Some((states, span)) => {
            let here = format!("this loop makes {states} of them");
            Diagnostic::new(Code::E0502, message, span, here).help(help)
        }
        None => {
            Diagnostic::new(Code::E0502, message, plan.plan().root.span, "this plan").help("cut it into several plans")
        }
    }
}

/// The states of a sequence, and the loop that makes the most of them, with its own.
fn largest_loop(body: &[Node]) -> (u64, Option<(u64, Span)>) {
    let mut all = 0_u64;
    let mut largest: Option<(u64, Span)> = None;
    for node in body {
        let (states, inside) = match node {
            Node::Atom(_) => (1, None),
            Node::Scope(scope) => largest_loop(&scope.body),
            Node::Loop(Loop { times, body, span, .. }) => {
                let (pass, inside) = largest_loop(body);
                let states = pass.saturating_mul(times.unwrap_or(1));
                (states, if times.is_some_and(|times| times > 1) { Some((states, *span)) } else { inside })
            }
        };
        all = all.saturating_add(states);
        if inside.is_some_and(|(states, _)| largest.is_none_or(|(most, _)| states > most)) {
            largest = inside;
        }
    }
    (all, largest)
}
