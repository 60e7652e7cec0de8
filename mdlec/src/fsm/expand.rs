//! Writes finite loops out (paper, section II-A: `(s1 s2)^3 → s1 s2 s1 s2 s1 s2`), so that every state has a number.

use super::{Lowered, algorithm1};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::plan::{Loop, Node, Nondegenerate, Scope};

/// The most states that an expanded form is made for.
const EXPANDED: u64 = 100_000;

/// The plan with its finite loops written out; a loop without end is left as it is.
///
/// # Errors
/// E0501 for a plan that cannot be lowered, E0502 for one of more than 100,000 states.
pub fn expand(plan: &Nondegenerate) -> Result<Nondegenerate, Diagnostic> {
    let lowered = algorithm1(plan)?;
    if lowered.termination > EXPANDED {
        return Err(too_large(&lowered, plan));
    }
    Ok(plan.map(expand_scope))
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
            Node::Loop(Loop { times, body, span }) => {
                let body = expand_sequence(body);
                match times {
                    Some(times) => (0..*times).for_each(|_| expanded.extend(body.iter().cloned())),
                    None => expanded.push(Node::Loop(Loop { times: None, body, span: *span })),
                }
            }
        }
    }
    expanded
}

fn too_large(lowered: &Lowered, plan: &Nondegenerate) -> Diagnostic {
    let states = lowered.termination;
    let message = format!("expanded, this plan has {states} states; an expanded form has at most {EXPANDED}");
    let (span, here) = match largest_loop(&plan.plan().root.body) {
        Some((span, times)) => (span, format!("this loop of {times} passes makes most of them")),
        None => (plan.plan().root.span, "this plan".to_owned()),
    };
    Diagnostic::new(Code::E0502, message, span, here)
        .help("the executable and `--emit rust` need no expansion: their size does not depend on loop counts")
}

/// The loop with the most passes.
fn largest_loop(body: &[Node]) -> Option<(Span, u64)> {
    body.iter()
        .filter_map(|node| match node {
            Node::Atom(_) => None,
            Node::Scope(scope) => largest_loop(&scope.body),
            Node::Loop(repeated) => {
                let here = repeated.times.map(|times| (repeated.span, times));
                here.into_iter().chain(largest_loop(&repeated.body)).max_by_key(|(_, times)| *times)
            }
        })
        .max_by_key(|(_, times)| *times)
}
