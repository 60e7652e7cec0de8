//! Parameters of a plan: their types, and their arguments (docs/src/reference/language.md, 3.4).

use std::collections::{BTreeMap, BTreeSet};

use super::untyped;
use crate::alphabet::{self, Alphabet, ParameterKind, Unit};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::{self, Arg, Name};

/// Names that a definition can use, in addition to the names in its alphabet.
#[derive(Debug, Clone, Copy)]
pub(super) struct DefinitionNames<'n, 's> {
    /// Plans of the file.
    pub(super) plans: &'n [&'s str],
    /// Parameters of the definition.
    pub(super) parameters: &'n Parameters<'s>,
}

/// The parameters of a definition by name.
#[derive(Debug, Clone, Default)]
pub(super) struct Parameters<'s> {
    known: BTreeMap<&'s str, Parameter<'s>>,
    /// Parameters whose type is unknown. This error has been reported, so uses of these parameters are not reported.
    untyped: BTreeSet<&'s str>,
}

/// A parameter with its argument.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parameter<'s> {
    pub(super) name: Name<'s>,
    pub(super) kind: ParameterKind,
    /// Argument of the parameter; `None` while the definition is checked by itself.
    pub(super) given: Option<Arg<'s>>,
}

impl Parameter<'_> {
    /// Returns the unit that is assumed for a number without a unit. This is the paper's unit for the kind, which the
    /// quarks of `mdle-atoms` also use; `None` if the kind has no unit.
    pub(super) fn unit(&self) -> Option<Unit> {
        if self.kind == ParameterKind::Speed {
            return Unit::from_name("cm/s");
        }
        if self.kind == ParameterKind::Angle {
            return Unit::from_name("deg");
        }
        self.kind.base_unit()
    }

    /// Reports that this parameter is used at `span` although the kind `expected` is required there.
    pub(super) fn mismatch(&self, expected: ParameterKind, span: Span) -> Diagnostic {
        let (name, kind) = (self.name.node, self.kind.words());
        let message = format!("expected {}, found `{name}`, which is {kind}", expected.words());
        Diagnostic::new(Code::E0302, message, span, format!("has to be {}", expected.words()))
            .also(self.name.span, format!("the parameter `{name}` is {kind}"))
    }
}

impl<'s> Parameters<'s> {
    /// Returns the parameters that a plan declares, without arguments.
    pub(super) fn declared(plan: &tree::Plan<'s>, alphabet: &Alphabet, found: &mut Vec<Diagnostic>) -> Self {
        let mut parameters = Self::default();
        for tree::Param { name, type_name } in plan.params {
            let Some(kind) = kind_of(type_name.node) else {
                found.push(unknown_type(*type_name, untyped::kind_by_use(plan, name.node, alphabet)));
                parameters.untyped.insert(name.node);
                continue;
            };
            let parameter = Parameter { name: *name, kind, given: None };
            if let Some(first) = parameters.known.insert(name.node, parameter) {
                let message = format!("there are two parameters called `{}`", name.node);
                let second = Diagnostic::new(Code::E0203, message, name.span, "the second one");
                found.push(second.also(first.name.span, "the first one").help("give one of them another name"));
            }
        }
        parameters
    }

    /// Returns the number of parameters that have a type.
    pub(super) fn len(&self) -> usize {
        self.known.len()
    }

    /// Sets the argument of the parameter `name`.
    pub(super) fn give(&mut self, name: &str, arg: Option<Arg<'s>>) {
        if let Some(parameter) = self.known.get_mut(name) {
            parameter.given = arg;
        }
    }

    /// Returns the parameter `name`; `None` if there is no such parameter.
    pub(super) fn get(&self, name: &str) -> Option<&Parameter<'s>> {
        self.known.get(name)
    }

    /// Returns `true` if the type of the parameter `name` is unknown.
    pub(super) fn is_untyped(&self, name: &str) -> bool {
        self.untyped.contains(name)
    }

    /// Returns the parameter that an argument names; `None` if the argument does not name a parameter.
    pub(super) fn of(&self, arg: &Arg<'_>) -> Option<&Parameter<'s>> {
        match arg {
            Arg::Name(name) => self.get(name.node),
            Arg::Module(name) => self.get(name.node).filter(|parameter| parameter.kind == ParameterKind::Module),
            Arg::Number(_) | Arg::Infinity(_) | Arg::String(_) => None,
        }
    }

    /// Adds the parameters of a behavior.
    pub(super) fn extend(&mut self, others: Self) {
        self.known.extend(others.known);
        self.untyped.extend(others.untyped);
    }

    /// Returns the names of the parameters.
    pub(super) fn names(&self) -> impl Iterator<Item = &'s str> {
        self.known.keys().copied()
    }
}

/// Returns the kind that a type name such as `bits[4]` denotes; `None` if there is no such type.
fn kind_of(name: &str) -> Option<ParameterKind> {
    let length = name.strip_prefix("bits[").and_then(|rest| rest.strip_suffix(']'));
    match length {
        Some(length) => length.parse().ok().map(ParameterKind::Bits),
        None => ParameterKind::from_name(name),
    }
}

/// Reports an unknown type; `by_use` is the kind that the uses of the parameter require.
fn unknown_type(name: Name<'_>, by_use: Option<ParameterKind>) -> Diagnostic {
    let message = format!("there is no type of parameter called `{}`", name.node);
    let found = Diagnostic::new(Code::E0201, message, name.span, "not a type");
    if let Some(unit) = Unit::from_name(name.node) {
        let kind = ParameterKind::NAMES.iter().find(|name| ParameterKind::from_name(name) == Some(unit.kind));
        return kind.iter().fold(found, |found, kind| found.fix("a type is what is measured: {}", name.span, **kind));
    }
    if matches!(name.node, "int" | "Int" | "uint" | "unsigned" | "u32" | "i32" | "times" | "repeats") {
        return found.fix("if it is how often something is repeated, write {}", name.span, "count").fix(
            "for another whole number write {}",
            name.span,
            "integer",
        );
    }
    let meant = match name.node {
        "distance" | "range" | "metres" | "meters" => Some("length"),
        "duration" | "seconds" => Some("time"),
        "velocity" => Some("speed"),
        "degrees" | "heading" => Some("angle"),
        "string" | "path" => Some("file"),
        other => alphabet::nearest(other, ParameterKind::NAMES.iter().copied()),
    };
    match meant {
        Some(near) => found.fix("did you mean {}?", name.span, near),
        None => {
            let found = match by_use {
                Some(kind) => found.fix("where it is used it has to be {}", name.span, untyped::type_name(kind)),
                None => found,
            };
            found.help(format!("the types are {} and bits[N]", ParameterKind::NAMES.join(", ")))
        }
    }
}

/// Reports a plan that has parameters but gets no arguments; `why` is the reason.
pub(super) fn missing(plan: &tree::Plan<'_>, why: &str) -> Diagnostic {
    let name = plan.name.node;
    let first = plan.params.first().map_or(plan.name.span, |param| param.name.span);
    let message = format!("plan `{name}` takes parameters, and {why}");
    let params: Vec<_> = plan.params.iter().map(|param| format!("<{}>", param.name.node)).collect();
    Diagnostic::new(Code::E0301, message, plan.name.span, "nothing gives their values")
        .also(first, "the first one")
        .help(format!("write a plan that uses it by name: `{{ Main {name}({}) }}`", params.join(", ")))
}

/// Reports a loop count `name` that is not a parameter with the type `count`.
pub(super) fn no_count(name: Name<'_>, parameters: &Parameters<'_>) -> Diagnostic {
    if let Some(parameter) = parameters.get(name.node) {
        return parameter
            .mismatch(ParameterKind::Count, name.span)
            .help(format!("declare it as `{}: count`", name.node));
    }
    let message = format!("there is no parameter called `{}`", name.node);
    let found = Diagnostic::new(Code::E0201, message, name.span, "not a count");
    match alphabet::nearest(name.node, parameters.names()) {
        Some(near) => found.fix("did you mean {}?", name.span, near),
        None => found.help(format!("write a number, or declare it after the plan's name: `({}: count)`", name.node)),
    }
}
