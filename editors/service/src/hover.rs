//! Text, in Markdown, that an editor shows for the name or number under the pointer.

use std::fmt::Write as _;
use std::ops::Range;

use mdle_compiler::alphabet::{Alphabet, Declaration, DeclarationKind, Unit};
use mdle_compiler::diagnostic::Span;
use mdle_compiler::plan::signature;
use mdle_compiler::syntax::tree::{Condition, ConditionNode, Element, Plan, Primary};

use crate::mentions::{Mention, Role, inside, mentions, quark_name};
use crate::view::View;
use crate::words::{WordKind, words};

/// A text about a name or a number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hover {
    /// Byte range of the name or number.
    pub range: Range<usize>,
    /// Text in Markdown.
    pub text: String,
}

/// Returns the text about the name or number at a byte offset; `None` if there is none.
#[must_use]
pub fn hover(view: &View<'_>, byte: usize) -> Option<Hover> {
    let mentions = mentions(view.files, view.alphabet);
    let Some(mention) = mentions.iter().find(|mention| view.contains(mention.span, byte)) else {
        return keyword(view.text, byte);
    };
    let text = match mention.role {
        Role::Plan => plan(view, mention),
        Role::Parameter => parameter(view, mention),
        Role::Label => Some(label(view, &mentions, mention)),
        Role::Quark(kind) => quark(view.alphabet, mention.text, kind),
        Role::Number(bare) => number(view.sources.slice(mention.span), bare),
        Role::Type | Role::Text => None,
    }?;
    Some(Hover { range: view.range(mention.span)?, text })
}

/// Keywords with their form and meaning.
const KEYWORDS: &[(&str, &str, &str)] = &[
    (
        "Atom",
        "(Atom (interrupt) (law))",
        "Applies the law in every turn, until the interrupt fires or the law completes.",
    ),
    (
        "ExecPlan",
        "ExecPlan 3 { … }",
        "Repeats the elements in braces as often as the number says, or without end with `inf`.",
    ),
    (
        "FRAME",
        "FRAME 90deg element",
        "Turns direction 0 of the headings and bearings in the element counter-clockwise by the angle. `FRAME here` makes \
         the robot's heading at the entry of the element direction 0.",
    ),
    ("null", "null", "Never fires: only the law, or the last element, ends what has this interrupt."),
    ("RISING", "RISING interrupt", "Fires when the interrupt begins to hold."),
    (
        "after",
        "after label (interrupt)",
        "Has fired if the element with this label was the last to end, by this interrupt.",
    ),
];

/// Returns the form and meaning of the keyword at a byte offset; `None` if there is none.
fn keyword(text: &str, byte: usize) -> Option<Hover> {
    let mut near = words(text).take_while(|word| word.range.start <= byte);
    let found = near.find(|word| word.range.end >= byte && word.kind == WordKind::Name)?;
    let (_, form, meaning) = KEYWORDS.iter().find(|(name, ..)| *name == found.text)?;
    Some(Hover { range: found.range, text: format!("```text\n{form}\n```\n{meaning}") })
}

/// Returns the signatures, meanings and required capabilities of the quarks with this name; `None` if there are none.
pub(crate) fn quark(alphabet: &Alphabet, name: &str, kind: DeclarationKind) -> Option<String> {
    let name = quark_name(alphabet, name, kind);
    let declarations = alphabet.declarations_of(name).filter(|declaration| declaration.kind == kind);
    let texts: Vec<_> = declarations.map(|declaration| about(alphabet, declaration)).collect();
    (!texts.is_empty()).then(|| texts.join("\n\n---\n\n"))
}

fn about(alphabet: &Alphabet, declaration: &Declaration) -> String {
    let kind = match declaration.kind {
        DeclarationKind::Control => "law",
        DeclarationKind::Interrupt => "interrupt",
        DeclarationKind::Signal => "signal",
    };
    let mut text = format!("```text\n{kind} {}\n```\n{}", signature(declaration), declaration.docs);
    if let Some((unit, tolerance)) = declaration.unit {
        let _ = write!(text, "\n\nMeasured in {}; `==` allows a difference of {tolerance}.", unit.name);
    }
    for param in &declaration.params {
        let unit = param.unit.map(|unit| format!(" {}", unit.name)).unwrap_or_default();
        let range = param.range.map(|(least, most)| format!(", {least} to {most}{unit}")).unwrap_or_default();
        let except = param.except.map(|except| format!(", not {except}")).unwrap_or_default();
        let default = param.default.as_ref().map(|value| format!(", {value}{unit} if left out")).unwrap_or_default();
        let _ = write!(text, "\n- `{}`: {}{range}{except}{default}", param.name, param.kind.words());
    }
    for (holds, sentence) in [
        (declaration.completes, "Can complete by itself."),
        (declaration.remembers, "Has a memory, which begins anew with its scope."),
        (declaration.exclusive, "Fires for at most one value of its arguments in a turn."),
    ] {
        if holds {
            let _ = write!(text, "\n\n{sentence}");
        }
    }
    if !declaration.needs.is_empty() {
        let needs: Vec<_> = declaration.needs.iter().map(|need| format!("`{need}`")).collect();
        let robots = alphabet.robots_with(&declaration.needs).join(", ");
        let robots = if robots.is_empty() { "none of the robots of mdlec".to_owned() } else { robots };
        let _ = write!(text, "\n\nNeeds {}: {robots}.", needs.join(", "));
    }
    text
}

/// Returns a text with the value of a number in its own unit, in the unit `bare` and in the base unit. `bare` is the
/// unit that a number without a unit would have at this place. Returns `None` if a unit is unknown or does not fit.
fn number(written: &str, bare: Option<Unit>) -> Option<String> {
    let bare = bare?;
    let digits = written.trim_end_matches(|letter: char| !letter.is_ascii_digit());
    let value: f64 = digits.parse().ok()?;
    let unit = written.get(digits.len()..).filter(|unit| !unit.is_empty());
    let own = unit.map_or(Some(bare), Unit::from_name).filter(|own| own.kind == bare.kind)?;
    let si = own.to_si(value);
    let mut values = vec![format!("{digits} {}", own.name)];
    let base = bare.kind.base_unit();
    for other in [Some(bare), base].into_iter().flatten() {
        let text = format!("{} {}", rounded(si / other.to_si(1.0)), other.name);
        if !values.contains(&text) {
            values.push(text);
        }
    }
    let note =
        if unit.is_none() { format!("\n\nA number without a unit is in {} here.", bare.name) } else { String::new() };
    Some(format!("{}{note}", values.join(" = ")))
}

/// Formats a number with at most six decimal places.
fn rounded(value: f64) -> String {
    let text = format!("{value:.6}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short.is_empty() || short == "-0" { "0".to_owned() } else { short.to_owned() }
}

fn parameter(view: &View<'_>, mention: &Mention<'_>) -> Option<String> {
    let defined = mention.defined?;
    let params = view.files.plans.iter().flat_map(|plan| plan.params.iter().map(move |param| (plan, param)));
    let (plan, param) = params.into_iter().find(|(_, param)| param.name.span == defined)?;
    let unit = crate::mentions::bare_unit(param.type_name.node);
    let unit = unit.map(|unit| format!("; a number without a unit is in {}", unit.name)).unwrap_or_default();
    let (name, of) = (param.name.node, plan.name.node);
    Some(format!("```text\n{name}: {}\n```\nParameter of `{of}`{unit}.", param.type_name.node))
}

/// Returns a text about a label, with the lines of the `after` conditions that refer to it.
fn label(view: &View<'_>, mentions: &[Mention<'_>], mention: &Mention<'_>) -> String {
    let asks = mentions.iter().filter(|other| {
        other.role == Role::Label
            && other.defined.is_some()
            && other.defined == mention.defined
            && !other.is_definition()
    });
    let lines: Vec<_> = asks.map(|ask| view.sources.line(ask.span).1.to_string()).collect();
    let asked = match lines.as_slice() {
        [] => "No `after` asks for it.".to_owned(),
        [line] => format!("`after` asks for it in line {line}."),
        lines => format!("`after` asks for it in lines {}.", lines.join(", ")),
    };
    format!("Label `{}`: the plan records which operand ended its element. {asked}", mention.text)
}

/// Returns the text about a plan or a behavior. It contains the parameters, the doc comment, the condition, the timers
/// and the next element.
fn plan(view: &View<'_>, mention: &Mention<'_>) -> Option<String> {
    let defined = mention.defined?;
    let found = view.files.plans.iter().find_map(|plan| {
        if plan.name.span == defined { Some((*plan, None)) } else { behavior(plan.elements, defined) }
    });
    let (plan, next) = found?;
    let params: Vec<_> =
        plan.params.iter().map(|param| format!("{}: {}", param.name.node, param.type_name.node)).collect();
    let params = if params.is_empty() { String::new() } else { format!("({})", params.join(", ")) };
    let mut text = format!("```text\n{}{params}\n```\n", plan.name.node);
    let docs: Vec<_> = plan.docs.iter().map(|line| line.trim()).collect();
    if !docs.is_empty() {
        let _ = write!(text, "{}\n\n", docs.join(" "));
    }
    match &plan.condition {
        None => text += "Ends with its last element: it has no interrupt of its own.",
        Some(condition) => {
            let _ = write!(text, "Ends with its last element, or when `{}` fires.", operands(view, condition));
            let mut timers = Vec::new();
            waits(view, condition, &mut timers);
            if !timers.is_empty() {
                let _ = write!(text, "\n\nTimers, from its own start: `{}`.", timers.join("`, `"));
            }
        }
    }
    if let Some(next) = next {
        let _ = write!(text, "\n\nFollowed by `{}`.", first_words(&view.words(next)));
    }
    Some(text)
}

/// Returns the behavior whose name is at `defined`, and the place of the next element.
fn behavior<'s>(elements: &[Element<'s>], defined: Span) -> Option<(Plan<'s>, Option<Span>)> {
    elements.iter().enumerate().find_map(|(at, element)| {
        if let Primary::Plan(plan) = element.primary
            && plan.name.span == defined
        {
            return Some((*plan, elements.get(at + 1).map(|next| next.span)));
        }
        behavior(inside(&element.primary), defined)
    })
}

/// Returns the text of a condition without its outer parentheses.
fn operands(view: &View<'_>, condition: &Condition<'_>) -> String {
    let text = view.words(condition.span);
    let inner = text.strip_prefix('(').and_then(|text| text.strip_suffix(')'));
    inner.filter(|inner| !inner.contains(['(', ')'])).unwrap_or(&text).to_owned()
}

/// Appends the timers of a condition.
fn waits(view: &View<'_>, condition: &Condition<'_>, found: &mut Vec<String>) {
    match condition.node {
        ConditionNode::Or(operands) | ConditionNode::And(operands) => {
            operands.iter().for_each(|operand| waits(view, operand, found));
        }
        ConditionNode::Not(operand) | ConditionNode::Rising(operand) => waits(view, operand, found),
        ConditionNode::Call(call) if call.name == "wait" => found.push(view.words(call.span)),
        ConditionNode::Call(_)
        | ConditionNode::Comparison(_)
        | ConditionNode::After(_)
        | ConditionNode::Null
        | ConditionNode::Broken => {}
    }
}

/// Shortens a text to about eight words.
fn first_words(text: &str) -> String {
    let words: Vec<_> = text.split(' ').collect();
    match words.get(..8) {
        Some(first) if words.len() > 8 => format!("{} …", first.join(" ")),
        Some(_) | None => text.to_owned(),
    }
}
