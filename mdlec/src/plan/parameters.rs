//! The parameters of a plan: their types, and what they stand for where the plan is used
//! (docs/src/reference/language.md, 3.4).

use std::collections::{BTreeMap, BTreeSet};

use super::arguments::{example, fit};
use crate::alphabet::{self, Declaration, DeclarationKind, Kind, Origin, Param, Unit};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::{self, Arg, Call, Name};

/// The names that mean something in a definition beside those of its alphabet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Names<'n, 's> {
    /// The plans of the file.
    pub(super) plans: &'n [&'s str],
    /// The parameters of the definition.
    pub(super) parameters: &'n Parameters<'s>,
}

/// The parameters of a definition by name.
#[derive(Debug, Clone, Default)]
pub(super) struct Parameters<'s> {
    known: BTreeMap<&'s str, Parameter<'s>>,
    /// Those with a type that is none: that was told, and nothing is wrong with where they stand.
    untyped: BTreeSet<&'s str>,
}

/// A parameter, and what it stands for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parameter<'s> {
    pub(super) name: Name<'s>,
    pub(super) kind: Kind,
    /// Nothing while the definition is looked at by itself.
    pub(super) given: Option<Arg<'s>>,
}

impl Parameter<'_> {
    /// The unit that a bare number has: the paper's for its kind, which is that of our quarks.
    pub(super) fn unit(&self) -> Option<Unit> {
        if self.kind == Kind::Speed {
            return Unit::from_name("cm/s");
        }
        if self.kind == Kind::Angle {
            return Unit::from_name("deg");
        }
        self.kind.base_unit()
    }

    /// This parameter stands where `expected` has to stand, at `span`, and is something else.
    pub(super) fn mismatch(&self, expected: Kind, span: Span) -> Diagnostic {
        let (name, kind) = (self.name.node, self.kind.words());
        let message = format!("expected {}, found `{name}`, which is {kind}", expected.words());
        Diagnostic::new(Code::E0302, message, span, format!("has to be {}", expected.words()))
            .also(self.name.span, format!("the parameter `{name}` is {kind}"))
    }
}

impl<'s> Parameters<'s> {
    /// The parameters that a plan declares, which stand for nothing yet.
    pub(super) fn declared(plan: &tree::Plan<'s>, found: &mut Vec<Diagnostic>) -> Self {
        let mut parameters = Self::default();
        for tree::Param { name, type_name } in plan.params {
            let Some(kind) = kind_of(type_name.node) else {
                found.push(unknown_type(*type_name));
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

    /// The parameters of `plan` as `call` gives them, in a definition that has parameters of its own.
    ///
    /// # Errors
    /// Where count, type or unit are not what the plan declares.
    pub(super) fn given(plan: &tree::Plan<'s>, call: &Call<'s>, around: &Self) -> Result<Self, Vec<Diagnostic>> {
        // What is wrong with the types was told where they stand.
        let mut parameters = Self::declared(plan, &mut Vec::new());
        if parameters.known.len() < plan.params.len() {
            return Ok(parameters);
        }
        let declaration = declaration(plan, &parameters);
        if let Err(found) = fit(call, &declaration, "", around) {
            let told = |mut found: Diagnostic| {
                if found.code == Code::E0301 {
                    found.help.clear();
                    found = usage(found, call, &declaration);
                }
                found.also(plan.name.span, format!("`{}` is written here", plan.name.node))
            };
            return Err(found.into_iter().map(told).collect());
        }
        for (param, arg) in plan.params.iter().zip(call.args) {
            if let Some(parameter) = parameters.known.get_mut(param.name.node) {
                parameter.given = match around.of(arg) {
                    Some(outer) => outer.given,
                    None => Some(*arg),
                };
            }
        }
        Ok(parameters)
    }

    /// The parameter of this name.
    pub(super) fn get(&self, name: &str) -> Option<&Parameter<'s>> {
        self.known.get(name)
    }

    /// Whether a parameter of this name has a type that is none.
    pub(super) fn is_untyped(&self, name: &str) -> bool {
        self.untyped.contains(name)
    }

    /// The parameter that an argument is.
    pub(super) fn of(&self, arg: &Arg<'_>) -> Option<&Parameter<'s>> {
        match arg {
            Arg::Name(name) => self.get(name.node),
            Arg::Module(name) => self.get(name.node).filter(|parameter| parameter.kind == Kind::Module),
            Arg::Number(_) | Arg::Infinity(_) | Arg::String(_) => None,
        }
    }

    /// Adds those of a behavior.
    pub(super) fn extend(&mut self, others: Self) {
        self.known.extend(others.known);
        self.untyped.extend(others.untyped);
    }

    /// Their names.
    pub(super) fn names(&self) -> impl Iterator<Item = &'s str> {
        self.known.keys().copied()
    }
}

/// The kind that a type's name says, `bits[4]` included.
fn kind_of(name: &str) -> Option<Kind> {
    let length = name.strip_prefix("bits[").and_then(|rest| rest.strip_suffix(']'));
    match length {
        Some(length) => length.parse().ok().map(Kind::Bits),
        None => Kind::from_name(name),
    }
}

fn unknown_type(name: Name<'_>) -> Diagnostic {
    let message = format!("there is no type of parameter called `{}`", name.node);
    let found = Diagnostic::new(Code::E0201, message, name.span, "not a type");
    if let Some(unit) = Unit::from_name(name.node) {
        let kind = Kind::NAMES.iter().find(|name| Kind::from_name(name) == Some(unit.kind));
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
        "float" | "double" | "real" | "num" => Some("number"),
        "duration" | "seconds" => Some("time"),
        "velocity" => Some("speed"),
        "degrees" | "heading" => Some("angle"),
        "string" | "path" => Some("file"),
        other => alphabet::nearest(other, Kind::NAMES.iter().copied()),
    };
    match meant {
        Some(near) => found.fix("did you mean {}?", name.span, near),
        None => found.help(format!("the types are {} and bits[N]", Kind::NAMES.join(", "))),
    }
}

/// A plan with parameters as if it were a quark, so that what is given is checked in the same way.
fn declaration(plan: &tree::Plan<'_>, parameters: &Parameters<'_>) -> Declaration {
    let param = |param: &tree::Param<'_>| {
        let parameter = parameters.get(param.name.node)?;
        let (name, unit) = (param.name.node.to_owned(), parameter.unit());
        Some(Param { name, kind: parameter.kind, unit, default: None, range: None, except: None })
    };
    Declaration {
        docs: String::new(),
        kind: DeclarationKind::Control,
        name: plan.name.node.to_owned(),
        params: plan.params.iter().filter_map(param).collect(),
        unit: None,
        completes: false,
        remembers: false,
        needs: Vec::new(),
        origin: Origin::Target,
        span: plan.name.span,
    }
}

/// Adds how a plan with these parameters is used.
fn usage(found: Diagnostic, call: &Call<'_>, declaration: &Declaration) -> Diagnostic {
    let name = &declaration.name;
    if declaration.params.is_empty() {
        return found.fix("write it without parentheses: {}", call.span, name.as_str());
    }
    let params: Vec<_> = declaration.params.iter().map(|param| format!("<{}>", param.name)).collect();
    let found = found.help(format!("write it as `{name}({})`", params.join(", ")));
    match declaration.params.iter().map(example).collect::<Option<Vec<_>>>() {
        Some(examples) if call.args.is_empty() => {
            found.fix("for instance {}", call.span, format!("{name}({})", examples.join(", ")))
        }
        _ => found,
    }
}

/// A plan that takes parameters stands where nothing gives them.
pub(super) fn missing(plan: &tree::Plan<'_>, why: &str) -> Diagnostic {
    let name = plan.name.node;
    let first = plan.params.first().map_or(plan.name.span, |param| param.name.span);
    let message = format!("plan `{name}` takes parameters, and {why}");
    let params: Vec<_> = plan.params.iter().map(|param| format!("<{}>", param.name.node)).collect();
    Diagnostic::new(Code::E0301, message, plan.name.span, "nothing gives their values")
        .also(first, "the first one")
        .help(format!("write a plan that uses it by name: `{{ Main {name}({}) }}`", params.join(", ")))
}

/// A name stands where a count has to, and is no parameter that is one.
pub(super) fn no_count(name: Name<'_>, parameters: &Parameters<'_>) -> Diagnostic {
    if let Some(parameter) = parameters.get(name.node) {
        return parameter.mismatch(Kind::Count, name.span).help(format!("declare it as `{}: count`", name.node));
    }
    let message = format!("there is no parameter called `{}`", name.node);
    let found = Diagnostic::new(Code::E0201, message, name.span, "not a count");
    match alphabet::nearest(name.node, parameters.names()) {
        Some(near) => found.fix("did you mean {}?", name.span, near),
        None => found.help(format!("write a number, or declare it after the plan's name: `({}: count)`", name.node)),
    }
}
