//! Prints the projected plans of groups as text that can be compiled by itself.

use super::project;
use crate::alphabet::Alphabet;
use crate::diagnostic::SourceId;
use crate::syntax::tree::{Arg, Call, Condition, ConditionNode, Element, Frame, Number, Operand, Plan, Primary};
use crate::syntax::{self, Loader, arena_for, parse_with};

/// Returns the plans of all robots in the groups of a file as MDLe text; if `wanted` is given, only the plan with this
/// name. The text is empty if there is no such plan.
#[must_use]
pub fn projected(
    source: SourceId,
    text: &str,
    alphabet: &Alphabet,
    wanted: Option<&str>,
    loader: &mut dyn Loader,
) -> String {
    let arena = arena_for(text);
    let (mut files, _) = parse_with(source, text, &arena, loader);
    let (parts, _) = project(&mut files, &arena, alphabet);
    let is_wanted = |plan: &&Plan<'_>| {
        let name = plan.name.node;
        wanted.is_none_or(|wanted| wanted == name) && parts.iter().any(|part| part.plan == name)
    };
    let plans: Vec<String> = files.plans.iter().take(files.own).filter(is_wanted).map(printed).collect();
    let text = plans.join("\n");
    syntax::format(source, &text).unwrap_or(text)
}

fn printed(plan: &Plan<'_>) -> String {
    let docs: String = plan.docs.iter().map(|line| format!("///{line}\n")).collect();
    format!("{docs}{}\n", braces(plan))
}

fn braces(plan: &Plan<'_>) -> String {
    // Without a condition, the elements of a plan must not look like one.
    let head = plan.condition.as_ref().map_or_else(String::new, |when| format!(" ({})", condition(when)));
    let label = plan.label.map_or_else(String::new, |label| format!("{} = ", label.node));
    format!("{label}{{ {}{head} {} }}", plan.name.node, elements(plan.elements))
}

fn elements(elements: &[Element<'_>]) -> String {
    elements.iter().map(element).collect::<Vec<_>>().join("\n")
}

fn element(element: &Element<'_>) -> String {
    let label = element.label().map_or_else(String::new, |label| format!("{}: ", label.node));
    let frame = element.frame().map_or_else(String::new, |frame| match frame {
        Frame::Turned(angle) => format!("FRAME {} ", number(angle)),
        Frame::Here => "FRAME here ".to_owned(),
    });
    let primary = match element.primary {
        Primary::Atom(atom) if atom.control.args.is_empty() => {
            format!("(Atom ({}) {})", condition(&atom.condition), call(atom.control))
        }
        Primary::Atom(atom) => format!("(Atom ({}) ({}))", condition(&atom.condition), call(atom.control)),
        Primary::Plan(plan) => braces(plan),
        Primary::String(body) => format!("({})", elements(body)),
        // A projected plan has no other elements.
        Primary::Ref(_) | Primary::Exec(_) | Primary::Formal(_) | Primary::Broken => String::new(),
    };
    format!("{label}{frame}{primary}")
}

fn condition(written: &Condition<'_>) -> String {
    let joined = |operands: &[Condition<'_>], word: &str| {
        operands.iter().map(|operand| operand_of(operand, word)).collect::<Vec<_>>().join(word)
    };
    match written.node {
        ConditionNode::Or(operands) => joined(operands, " OR "),
        ConditionNode::And(operands) => joined(operands, " AND "),
        ConditionNode::Not(operand) => format!("NOT {}", operand_of(operand, "")),
        ConditionNode::Rising(operand) => format!("RISING {}", operand_of(operand, "")),
        ConditionNode::Call(quark) => call(quark),
        ConditionNode::Comparison(compared) => {
            let right = match &compared.right {
                Operand::Signal(signal) => call(signal),
                Operand::Number(value) => number(value),
                Operand::Infinity(_) => "inf".to_owned(),
            };
            format!("{} {} {right}", call(compared.left), compared.operator.symbol())
        }
        ConditionNode::Null => "null".to_owned(),
        ConditionNode::After(after) => {
            let cause = after.cause.as_ref().map_or_else(String::new, |cause| format!(" ({})", condition(cause)));
            format!("after {}{cause}", after.label.node)
        }
        ConditionNode::Broken => String::new(),
    }
}

/// Prints an operand of a condition whose operator is `word`, in parentheses if the operand binds less tightly than the
/// operator.
fn operand_of(operand: &Condition<'_>, word: &str) -> String {
    let text = condition(operand);
    let is_looser = match operand.node {
        ConditionNode::Or(_) => true,
        ConditionNode::And(_) => word != " OR ",
        ConditionNode::Not(_) | ConditionNode::Rising(_) | ConditionNode::After(_) => word.is_empty(),
        ConditionNode::Call(_) | ConditionNode::Comparison(_) | ConditionNode::Null | ConditionNode::Broken => false,
    };
    if is_looser { format!("({text})") } else { text }
}

fn call(written: &Call<'_>) -> String {
    let args = written.args.iter().map(|arg| match arg {
        Arg::Number(value) => number(value),
        Arg::Infinity(_) => "inf".to_owned(),
        Arg::String(text) => format!("\"{}\"", text.node),
        Arg::Name(name) => name.node.to_owned(),
        Arg::Module(name) => format!("{} module", name.node),
    });
    std::iter::once(written.name.to_owned()).chain(args).collect::<Vec<_>>().join(" ")
}

fn number(written: &Number<'_>) -> String {
    format!("{}{}", written.digits(), written.unit().unwrap_or_default())
}
