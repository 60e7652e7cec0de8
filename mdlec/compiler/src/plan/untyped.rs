//! Infers the types of parameters that a plan declares without types, and reports one error for each list of such
//! parameters.

use std::collections::BTreeSet;

use crate::alphabet::{Alphabet, DeclarationKind, ParameterKind};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::{Arg, Call, Condition, ConditionNode, Count, Element, Name, Param, Plan, Primary, Spanned};
use crate::syntax::{Arena, Files};

/// Infers the types of parameters without a type, and reports these parameters.
pub(crate) fn complete<'s>(files: &mut Files<'s>, arena: &'s Arena, alphabet: &Alphabet) -> Vec<Diagnostic> {
    let plans: BTreeSet<&str> = files.plans.iter().map(|plan| plan.name.node).collect();
    let called: BTreeSet<&str> = files.plans.iter().flat_map(|plan| called_with_arguments(plan.elements)).collect();
    let mut found = Vec::new();
    for plan in files.plans.iter_mut().filter(|plan| plan.params.is_empty()) {
        let Some(header) = ParameterList::of(plan) else { continue };
        let is_known = |name: &str| {
            let mut declarations = alphabet.declarations_of(name);
            plans.contains(name) || declarations.any(|declaration| declaration.kind != DeclarationKind::Signal)
        };
        let uses = UseFinder { alphabet, elements: header.elements };
        let is_used =
            called.contains(plan.name.node) || header.names.iter().any(|name| uses.kind_of(name.node).is_some());
        if header.names.iter().any(|name| is_known(name.node)) || !is_used {
            continue;
        }
        let kind = |name: &Name<'s>| header.kind.or_else(|| uses.kind_of(name.node)).unwrap_or(ParameterKind::Length);
        let typed: Vec<_> =
            header.names.iter().map(|name| format!("{}: {}", name.node, type_name(kind(name)))).collect();
        let params = header.names.iter().map(|name| Param {
            name: *name,
            type_name: Spanned { node: arena.alloc_str(&type_name(kind(name))), span: name.span },
        });
        let message = match header.names.as_slice() {
            [only] => format!("the parameter `{}` of `{}` has no type", only.node, plan.name.node),
            _ => format!("the parameters of `{}` have no types", plan.name.node),
        };
        let diagnostic = Diagnostic::new(Code::E0102, message, header.span, "a colon and a type follow each name");
        found.push(diagnostic.fix("write {}", header.span, format!("({})", typed.join(", "))));
        plan.params = arena.alloc_slice_fill_iter(params.collect::<Vec<_>>());
        plan.elements = header.elements;
        plan.condition = None;
    }
    found
}

/// The parentheses after the name of a plan that may contain parameters.
struct ParameterList<'s> {
    names: Vec<Name<'s>>,
    /// Type that is written before the name, if there is only one name.
    kind: Option<ParameterKind>,
    span: Span,
    /// Elements of the plan without the header.
    elements: &'s [Element<'s>],
}

impl<'s> ParameterList<'s> {
    fn of(plan: &Plan<'s>) -> Option<Self> {
        let Some(condition) = plan.condition else { return Self::of_formal(plan) };
        let ConditionNode::Call(call) = condition.node else { return None };
        let (names, kind) = match call.args {
            [] => (vec![named(call)], None),
            [Arg::Name(name)] => (vec![*name], Some(ParameterKind::from_name(call.name)?)),
            _ => return None,
        };
        Some(Self { names, kind, span: condition.span, elements: plan.elements })
    }

    /// Interprets `(d, v)`, which resembles formal notation, as a header.
    fn of_formal(plan: &Plan<'s>) -> Option<Self> {
        let [Element { primary: Primary::Formal(formal), marks: None, span }, elements @ ..] = plan.elements else {
            return None;
        };
        let [Element { primary: Primary::Ref(first), marks: None, .. }] = formal.body else { return None };
        let ConditionNode::Call(second) = formal.condition.node else { return None };
        let third = match formal.time {
            None => None,
            Some(Arg::Name(name)) => Some(name),
            Some(_) => return None,
        };
        let names = [named(first), named(second)].into_iter().chain(third).collect();
        let are_bare = first.args.is_empty() && second.args.is_empty();
        are_bare.then_some(Self { names, kind: None, span: *span, elements })
    }
}

fn named<'s>(call: &Call<'s>) -> Name<'s> {
    Spanned { node: call.name, span: call.name_span() }
}

/// Returns the kind that is required where a parameter is first used in its plan.
pub(super) fn kind_by_use(plan: &Plan<'_>, name: &str, alphabet: &Alphabet) -> Option<ParameterKind> {
    UseFinder { alphabet, elements: plan.elements }.kind_of(name)
}

/// Returns the name of a type, as plans write it.
pub(super) fn type_name(kind: ParameterKind) -> String {
    let name = ParameterKind::NAMES.iter().find(|name| ParameterKind::from_name(name) == Some(kind));
    if let ParameterKind::Bits(length) = kind {
        return format!("bits[{length}]");
    }
    name.map_or_else(String::new, |name| (*name).to_owned())
}

/// Returns the names of the plans that these elements call with arguments.
fn called_with_arguments<'s>(elements: &[Element<'s>]) -> Vec<&'s str> {
    let mut called = Vec::new();
    calls(elements, &mut |call| {
        if !call.args.is_empty() {
            called.push(call.name);
        }
        None::<()>
    });
    called
}

/// Finds the uses of names in the elements of a plan.
struct UseFinder<'a, 's> {
    alphabet: &'a Alphabet,
    elements: &'s [Element<'s>],
}

impl UseFinder<'_, '_> {
    /// Returns the kind that a name must have. For a loop count, this is a count; otherwise, it is the kind of the
    /// first parameter to which the name is passed; `None` if the name is not used in these ways.
    fn kind_of(&self, name: &str) -> Option<ParameterKind> {
        let is_name = |arg: &Arg<'_>| matches!(arg, Arg::Name(given) if given.node == name);
        if counts(self.elements, name) {
            return Some(ParameterKind::Count);
        }
        calls(self.elements, &mut |call| {
            let at = call.args.iter().position(is_name)?;
            let mut declarations = self.alphabet.declarations_of(call.name);
            declarations.find_map(|declaration| {
                let param = declaration.params.get(at)?;
                (call.args.len() <= declaration.params.len()).then_some(param.kind)
            })
        })
    }
}

/// Returns `true` if a loop in these elements has `name` as its loop count.
fn counts(elements: &[Element<'_>], name: &str) -> bool {
    let is_count = |count: &Count<'_>| matches!(count, Count::Name(given) if given.node == name);
    elements.iter().any(|element| {
        element.power().is_some_and(is_count)
            || match element.primary {
                Primary::Exec(exec) => is_count(&exec.count) || counts(exec.body, name),
                Primary::Plan(plan) => counts(plan.elements, name),
                Primary::String(body) => counts(body, name),
                Primary::Formal(formal) => counts(formal.body, name),
                Primary::Atom(_) | Primary::Ref(_) | Primary::Broken => false,
            }
    })
}

/// Calls `visit` with each call in these elements until a result is not `None`, and returns this result.
fn calls<'s, T>(elements: &[Element<'s>], visit: &mut impl FnMut(&Call<'s>) -> Option<T>) -> Option<T> {
    elements.iter().find_map(|element| match element.primary {
        Primary::Atom(atom) => visit(atom.control).or_else(|| calls_of(&atom.condition, visit)),
        Primary::Ref(call) => visit(call),
        Primary::Plan(plan) => {
            let condition = plan.condition.as_ref().and_then(|condition| calls_of(condition, visit));
            condition.or_else(|| calls(plan.elements, visit))
        }
        Primary::Exec(exec) => calls(exec.body, visit),
        Primary::String(body) => calls(body, visit),
        Primary::Formal(formal) => calls(formal.body, visit).or_else(|| calls_of(&formal.condition, visit)),
        Primary::Broken => None,
    })
}

/// Calls `visit` with each call in a condition until a result is not `None`, and returns this result.
fn calls_of<'s, T>(condition: &Condition<'s>, visit: &mut impl FnMut(&Call<'s>) -> Option<T>) -> Option<T> {
    match condition.node {
        ConditionNode::Or(operands) | ConditionNode::And(operands) => {
            operands.iter().find_map(|operand| calls_of(operand, visit))
        }
        ConditionNode::Not(operand) | ConditionNode::Rising(operand) => calls_of(operand, visit),
        ConditionNode::Call(call) => visit(call),
        ConditionNode::Comparison(_) | ConditionNode::After(_) => None,
        ConditionNode::Null | ConditionNode::Broken => None,
    }
}
