//! Lists all names and numbers in the plans, with their meanings. Definition, references, rename, hover, hints, lenses
//! and semantic tokens use this list.

use std::collections::BTreeMap;

use mdle_compiler::alphabet::{Alphabet, Declaration, DeclarationKind, ParameterKind, Unit};
use mdle_compiler::diagnostic::Span;
use mdle_compiler::syntax::Files;
use mdle_compiler::syntax::tree::{
    Arg, Call, Condition, ConditionNode, Count, Element, Formal, Frame, Name, Number, Operand, Param, Plan, Primary,
};

/// Meaning of a name or a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Role {
    /// A plan, or a behavior in a plan.
    Plan,
    /// A parameter of a plan.
    Parameter,
    /// A label of an element.
    Label,
    /// A quark or a signal of this kind.
    Quark(DeclarationKind),
    /// The type of a parameter.
    Type,
    /// A number, with the unit that a number without a unit would have at this place; `None` if this unit is unknown.
    Number(Option<Unit>),
    /// A text in quotes, or a name that is an entire argument.
    Text,
}

/// An occurrence of a name or a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mention<'s> {
    /// Span of the occurrence.
    pub span: Span,
    /// The name, or the number with its unit.
    pub text: &'s str,
    /// Meaning of the name or number.
    pub role: Role,
    /// Span of the name in its definition; equal to `span` at the definition itself; `None` if no plan defines the
    /// name.
    pub defined: Option<Span>,
}

impl Mention<'_> {
    /// Returns `true` if this occurrence defines the name.
    #[must_use]
    pub fn is_definition(&self) -> bool {
        self.defined == Some(self.span)
    }
}

/// Returns all names and numbers in the plans of a file, and of the files that it uses.
#[must_use]
pub fn mentions<'s>(files: &Files<'s>, alphabet: &Alphabet) -> Vec<Mention<'s>> {
    let plans = files.plans.iter().rev().map(|plan| (plan.name.node, plan)).collect();
    let mut list = MentionFinder { plans, alphabet, params: Vec::new(), labels: BTreeMap::new(), mentions: Vec::new() };
    for plan in &files.plans {
        list.labels.clear();
        list.params.clear();
        labels(plan.elements, &mut list.labels);
        list.plan(plan);
    }
    list.mentions
}

/// Collects the labels in a definition; `after` in the same definition can refer to them.
fn labels<'s>(elements: &[Element<'s>], found: &mut BTreeMap<&'s str, Span>) {
    for element in elements {
        if let Some(label) = element.label() {
            found.entry(label.node).or_insert(label.span);
        }
        labels(inside(&element.primary), found);
    }
}

/// Returns the elements inside an element.
pub(crate) fn inside<'s>(primary: &Primary<'s>) -> &'s [Element<'s>] {
    match primary {
        Primary::Plan(plan) => plan.elements,
        Primary::Exec(exec) => exec.body,
        Primary::String(elements) => elements,
        Primary::Formal(formal) => formal.body,
        Primary::Atom(_) | Primary::Ref(_) | Primary::Broken => &[],
    }
}

/// Returns the name under which the alphabet declares a quark. The name of a signal may end in a sonar number, as in
/// `r0` for `r`.
#[must_use]
pub fn quark_name<'n>(alphabet: &Alphabet, name: &'n str, kind: DeclarationKind) -> &'n str {
    let is_declared = alphabet.declarations_of(name).any(|found| found.kind == kind);
    if is_declared || kind != DeclarationKind::Signal {
        name
    } else {
        name.trim_end_matches(|digit: char| digit.is_ascii_digit())
    }
}

/// Returns the declaration of the called quark. If several declarations have this name, the number of arguments selects
/// one of them.
#[must_use]
pub fn declaration<'a>(alphabet: &'a Alphabet, call: &Call<'_>, kind: DeclarationKind) -> Option<&'a Declaration> {
    let name = quark_name(alphabet, call.name, kind);
    let of_kind = || alphabet.declarations_of(name).filter(|found| found.kind == kind);
    let needed = |found: &Declaration| found.params.iter().filter(|param| param.default.is_none()).count();
    let fits = |found: &&Declaration| (needed(found)..=found.params.len()).contains(&call.args.len());
    of_kind().find(fits).or_else(|| of_kind().next())
}

/// Returns the unit that a number without a unit has if it is the argument for this parameter.
fn unit_of(param: &mdle_compiler::alphabet::Param) -> Option<Unit> {
    param.unit.or_else(|| param.kind.base_unit())
}

/// Returns the unit that a number without a unit has if it is the argument for a plan's parameter of this type
/// (docs/src/reference/language.md, 3.4).
#[must_use]
pub fn bare_unit(type_name: &str) -> Option<Unit> {
    let kind = ParameterKind::from_name(type_name)?;
    if kind == ParameterKind::Speed {
        return Unit::from_name("cm/s");
    }
    if kind == ParameterKind::Angle { Unit::from_name("deg") } else { kind.base_unit() }
}

struct MentionFinder<'l, 's> {
    plans: BTreeMap<&'s str, &'l Plan<'s>>,
    alphabet: &'l Alphabet,
    /// Parameters of the definition.
    params: Vec<Param<'s>>,
    /// Labels of the definition.
    labels: BTreeMap<&'s str, Span>,
    mentions: Vec<Mention<'s>>,
}

impl<'s> MentionFinder<'_, 's> {
    fn add(&mut self, name: Name<'s>, role: Role, defined: Option<Span>) {
        // The parser inserts empty names that do not occur in the text.
        if name.span.start < name.span.end {
            self.mentions.push(Mention { span: name.span, text: name.node, role, defined });
        }
    }

    fn number(&mut self, number: &Number<'s>, bare: Option<Unit>) {
        self.add(Name { node: number.digits(), span: number.span }, Role::Number(bare), None);
    }

    fn plan(&mut self, plan: &Plan<'s>) {
        self.add(plan.name, Role::Plan, Some(plan.name.span));
        for param in plan.params {
            self.add(param.name, Role::Parameter, Some(param.name.span));
            self.add(param.type_name, Role::Type, None);
        }
        self.params.extend(plan.params);
        plan.condition.iter().for_each(|condition| self.condition(condition));
        self.elements(plan.elements);
    }

    fn elements(&mut self, elements: &[Element<'s>]) {
        for element in elements {
            if let Some(label) = element.label() {
                self.add(label, Role::Label, Some(label.span));
            }
            if let Some(Frame::Turned(number)) = element.frame() {
                self.number(number, Unit::from_name("deg"));
            }
            self.primary(&element.primary);
            if let Some(count) = element.power() {
                self.count(count);
            }
        }
    }

    fn primary(&mut self, primary: &Primary<'s>) {
        match primary {
            Primary::Atom(atom) => {
                self.condition(&atom.condition);
                self.quark(atom.control, DeclarationKind::Control);
            }
            Primary::Plan(plan) => self.plan(plan),
            Primary::Ref(call) => self.reference(call),
            Primary::Exec(exec) => {
                self.count(&exec.count);
                self.elements(exec.body);
            }
            Primary::String(elements) => self.elements(elements),
            Primary::Formal(formal) => self.formal(formal),
            Primary::Broken => {}
        }
    }

    fn formal(&mut self, formal: &Formal<'s>) {
        match formal.body {
            [Element { primary: Primary::Ref(law), marks: None, .. }] if !self.plans.contains_key(law.name) => {
                self.quark(law, DeclarationKind::Control);
            }
            elements => self.elements(elements),
        }
        self.condition(&formal.condition);
        if let Some(time) = &formal.time {
            self.argument(time, ParameterKind::Time.base_unit());
        }
    }

    /// Records the name of a plan in a call.
    fn reference(&mut self, call: &Call<'s>) {
        let defined = self.plans.get(call.name).map(|plan| plan.name.span);
        self.add(Name { node: call.name, span: call.name_span() }, Role::Plan, defined);
        let params = self.plans.get(call.name).map_or(&[][..], |plan| plan.params);
        for (at, arg) in call.args.iter().enumerate() {
            self.argument(arg, params.get(at).and_then(|param| bare_unit(param.type_name.node)));
        }
    }

    fn quark(&mut self, call: &Call<'s>, kind: DeclarationKind) {
        self.add(Name { node: call.name, span: call.name_span() }, Role::Quark(kind), None);
        let declaration = declaration(self.alphabet, call, kind);
        let params = declaration.map_or(&[][..], |declaration| &declaration.params);
        for (at, arg) in call.args.iter().enumerate() {
            self.argument(arg, params.get(at).and_then(unit_of));
        }
    }

    fn argument(&mut self, arg: &Arg<'s>, bare: Option<Unit>) {
        match arg {
            Arg::Number(number) => self.number(number, bare),
            Arg::Infinity(_) => {}
            Arg::Name(name) if self.parameter(name.node).is_some() => {
                self.add(*name, Role::Parameter, self.parameter(name.node));
            }
            Arg::String(name) | Arg::Name(name) | Arg::Module(name) => self.add(*name, Role::Text, None),
        }
    }

    /// Returns the place of the parameter with this name.
    fn parameter(&self, name: &str) -> Option<Span> {
        self.params.iter().find(|param| param.name.node == name).map(|param| param.name.span)
    }

    fn count(&mut self, count: &Count<'s>) {
        match count {
            Count::Number(number) => self.number(number, None),
            Count::Infinity(_) => {}
            Count::Name(name) => self.add(*name, Role::Parameter, self.parameter(name.node)),
        }
    }

    fn condition(&mut self, condition: &Condition<'s>) {
        match condition.node {
            ConditionNode::Or(operands) | ConditionNode::And(operands) => {
                operands.iter().for_each(|operand| self.condition(operand));
            }
            ConditionNode::Not(operand) | ConditionNode::Rising(operand) => self.condition(operand),
            ConditionNode::Call(call) => self.quark(call, DeclarationKind::Interrupt),
            ConditionNode::Comparison(compared) => {
                self.quark(compared.left, DeclarationKind::Signal);
                let signal = declaration(self.alphabet, compared.left, DeclarationKind::Signal);
                let unit = signal.and_then(|signal| signal.unit).map(|(unit, _)| unit);
                match &compared.right {
                    Operand::Number(number) => self.number(number, unit),
                    Operand::Infinity(_) => {}
                    Operand::Signal(call) => match self.parameter(call.name) {
                        Some(defined) => {
                            let name = Name { node: call.name, span: call.name_span() };
                            self.add(name, Role::Parameter, Some(defined));
                        }
                        None => self.quark(call, DeclarationKind::Signal),
                    },
                }
            }
            ConditionNode::After(after) => {
                self.add(after.label, Role::Label, self.labels.get(after.label.node).copied());
                after.cause.iter().for_each(|cause| self.condition(cause));
            }
            ConditionNode::Null | ConditionNode::Broken => {}
        }
    }
}
