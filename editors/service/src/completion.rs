//! Proposes words that are valid at the cursor and that the robot supports.

use std::ops::Range;

use mdle_compiler::alphabet::{Declaration, DeclarationKind, ParameterKind, Unit};
use mdle_compiler::plan::signature;
use mdle_compiler::syntax::tree::Call;

use crate::context::{Context, Expected, OpenCall, context};
use crate::hover;
use crate::mentions::{bare_unit, declaration};
use crate::view::View;

/// Kind of a proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ItemKind {
    /// A law of the robot's alphabet.
    Law,
    /// An interrupt of the robot's alphabet.
    Interrupt,
    /// A signal of the robot's alphabet.
    Signal,
    /// A plan in the document or in a file that it uses.
    Plan,
    /// A unit of a number.
    Unit,
    /// A label of an element.
    Label,
    /// A parameter of the plan.
    Parameter,
    /// The type of a parameter.
    Type,
    /// A keyword of the language.
    Keyword,
    /// Several words with placeholders.
    Snippet,
}

/// A proposal at the cursor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Item {
    /// Kind of the proposal.
    pub kind: ItemKind,
    /// Word that the editor lists and compares with the typed text.
    pub label: String,
    /// Short text shown next to the word.
    pub detail: String,
    /// Documentation of the proposal, in Markdown.
    pub docs: String,
    /// Text to insert; in an [`ItemKind::Snippet`], placeholders such as `${1:name}` mark the words to fill in.
    pub insert: String,
}

/// Proposals, and the byte range that each of them replaces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Completion {
    /// Byte range to replace.
    pub range: Range<usize>,
    /// Proposals at the cursor.
    pub items: Vec<Item>,
}

/// The signature of the innermost call at the cursor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Signature {
    /// Text of the signature, with all parameters.
    pub label: String,
    /// Documentation of the quark or plan, in Markdown.
    pub docs: String,
    /// Parameters, written as in the text of the signature.
    pub params: Vec<String>,
    /// Index of the parameter at the cursor.
    pub active: usize,
}

const ELEMENTS: &[(&str, &str)] = &[
    ("Atom", "(Atom (${1:interrupt}) (${2:law}))"),
    ("ExecPlan", "ExecPlan ${1:3} {\n  $0\n}"),
    ("behavior", "{ ${1:Name} (${2:interrupt})\n  $0\n}"),
    ("FRAME", "FRAME ${1:90deg} $0"),
];
const PLANS: &[(&str, &str)] = &[("plan", "{ ${1:Name} (${2:interrupt})\n  $0\n}"), ("use", "use \"${1:file.mdle}\"")];
const OPERANDS: &[(&str, &str)] =
    &[("after", "after ${1:label} (${2:interrupt})"), ("NOT", "NOT $0"), ("RISING", "RISING $0"), ("null", "null")];

/// Returns the proposals at a byte offset.
#[must_use]
pub fn completion(view: &View<'_>, byte: usize) -> Completion {
    let context = context(view.text, byte);
    let items = match context.expected {
        Expected::Plan => snippets(PLANS),
        Expected::Element => plans(view).into_iter().chain(snippets(ELEMENTS)).collect(),
        Expected::Operand => {
            let quarks = quarks(view, DeclarationKind::Interrupt).chain(quarks(view, DeclarationKind::Signal));
            quarks.chain(snippets(OPERANDS)).collect()
        }
        Expected::Law => quarks(view, DeclarationKind::Control).collect(),
        Expected::Label => context.labels.iter().map(|label| simple(ItemKind::Label, label, "label")).collect(),
        Expected::Type => {
            let types = ParameterKind::NAMES.iter().chain(&["bits[4]"]);
            types.map(|name| simple(ItemKind::Type, name, "type")).collect()
        }
        Expected::Unit => units(view, &context),
        Expected::Argument => arguments(view, &context, byte),
        Expected::Nothing => Vec::new(),
    };
    Completion { range: context.typed, items }
}

fn simple(kind: ItemKind, label: &str, detail: &str) -> Item {
    let (label, insert) = (label.to_owned(), label.to_owned());
    Item { kind, label, detail: detail.to_owned(), docs: String::new(), insert }
}

fn snippets(texts: &[(&str, &str)]) -> Vec<Item> {
    let snippet =
        |(label, insert): &(&str, &str)| Item { insert: (*insert).to_owned(), ..simple(ItemKind::Snippet, label, "") };
    texts.iter().map(snippet).collect()
}

/// Returns the quarks of a kind that the robot supports; each name occurs once.
fn quarks<'v>(view: &'v View<'_>, kind: DeclarationKind) -> impl Iterator<Item = Item> + 'v {
    let mut last = "";
    let declarations = view.alphabet.declarations().filter(move |declaration| declaration.kind == kind);
    let able = declarations.filter(|declaration| declaration.needs.iter().all(|need| view.alphabet.has(need)));
    let once = able.filter(move |declaration| std::mem::replace(&mut last, &declaration.name) != declaration.name);
    once.map(move |declaration| item(view, declaration))
}

fn item(view: &View<'_>, declaration: &Declaration) -> Item {
    let kind = match declaration.kind {
        DeclarationKind::Control => ItemKind::Law,
        DeclarationKind::Interrupt => ItemKind::Interrupt,
        DeclarationKind::Signal => ItemKind::Signal,
    };
    let docs = hover::quark(view.alphabet, &declaration.name, declaration.kind).unwrap_or_default();
    // A sonar number directly follows the name of a signal.
    let is_numbered =
        kind == ItemKind::Signal && declaration.params.iter().any(|param| param.kind == ParameterKind::Sonar);
    let name = if is_numbered { format!("{}0", declaration.name) } else { declaration.name.clone() };
    Item { docs, ..simple(kind, &name, &signature(declaration)) }
}

fn plans(view: &View<'_>) -> Vec<Item> {
    let item = |plan: &mdle_compiler::syntax::tree::Plan<'_>| {
        let docs = plan.docs.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
        let params: Vec<_> =
            plan.params.iter().map(|param| format!("{}: {}", param.name.node, param.type_name.node)).collect();
        let detail = if params.is_empty() { "plan".to_owned() } else { format!("({})", params.join(", ")) };
        Item { docs, ..simple(ItemKind::Plan, plan.name.node, &detail) }
    };
    view.files.plans.iter().filter(|plan| plan.name.span.start < plan.name.span.end).map(item).collect()
}

/// Returns the units for the number at the cursor: the units of the parameter's type if the parameter is known, and all
/// units otherwise.
fn units(view: &View<'_>, context: &Context<'_>) -> Vec<Item> {
    let kind = context.call.as_ref().and_then(|call| kind_of(view, call));
    let fits = |unit: &&Unit| kind.is_none_or(|kind| unit.kind == kind);
    Unit::ALL.iter().filter(fits).map(|unit| simple(ItemKind::Unit, unit.name, &unit.kind.words())).collect()
}

/// Returns the type of the argument at the cursor; `None` if it is not known.
fn kind_of(view: &View<'_>, call: &OpenCall<'_>) -> Option<ParameterKind> {
    if let Some(declaration) = declared(view, call) {
        return declaration.params.get(call.args).map(|param| param.kind);
    }
    let plan = view.files.plans.iter().find(|plan| plan.name.node == call.name)?;
    bare_unit(plan.params.get(call.args)?.type_name.node).map(|unit| unit.kind)
}

/// Returns the declaration of the quark that the user is typing; `None` if it is not declared.
fn declared<'v>(view: &'v View<'_>, call: &OpenCall<'_>) -> Option<&'v Declaration> {
    let kind = if call.is_condition { DeclarationKind::Interrupt } else { DeclarationKind::Control };
    let start = mdle_compiler::diagnostic::Span { start: 0, end: 0 };
    declaration(view.alphabet, &Call { name: call.name, args: &[], span: start }, kind)
        .into_iter()
        .chain(view.alphabet.declarations_of(call.name).filter(|found| found.kind == kind))
        .max_by_key(|found| found.params.len())
}

/// Returns the parameters of the plan that contains the cursor; in a condition, also `OR` and `AND`.
fn arguments(view: &View<'_>, context: &Context<'_>, byte: usize) -> Vec<Item> {
    let around = view.own().iter().filter(|plan| view.contains(plan.span, byte));
    let params = around.flat_map(|plan| plan.params);
    let params = params.map(|param| simple(ItemKind::Parameter, param.name.node, param.type_name.node));
    let joins: &[&str] = match &context.call {
        Some(call) if !call.is_condition => &[],
        Some(_) | None => &["OR", "AND"],
    };
    params.chain(joins.iter().map(|word| simple(ItemKind::Keyword, word, ""))).collect()
}

/// Returns the signature of the call at a byte offset.
#[must_use]
pub fn signature_at(view: &View<'_>, byte: usize) -> Option<Signature> {
    let call = context(view.text, byte).call?;
    if let Some(declaration) = declared(view, &call) {
        let label = signature(declaration);
        let params = label.split(['<', '[']).skip(1).filter_map(|rest| rest.split(['>', ']']).next());
        let params = params.map(str::to_owned).collect();
        return Some(Signature { label: label.clone(), docs: declaration.docs.clone(), params, active: call.args });
    }
    let plan = view.files.plans.iter().find(|plan| plan.name.node == call.name && !plan.params.is_empty())?;
    let params: Vec<_> =
        plan.params.iter().map(|param| format!("{}: {}", param.name.node, param.type_name.node)).collect();
    let docs = plan.docs.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
    Some(Signature { label: format!("{}({})", call.name, params.join(", ")), docs, params, active: call.args })
}
