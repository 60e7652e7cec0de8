//! Checks arguments against a signature: their number, types, units and ranges (docs/src/reference/language.md, 6.2).

mod examples;
mod numbers;
mod ranges;
mod sonars;
mod units;
mod wrong_count;

use super::Value;
use super::parameters::Parameters;
use crate::alphabet::{Declaration, DeclarationKind, Param, ParameterKind, Unit};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::tree::{Arg, Call, Number};
use examples::swapped;
pub(super) use examples::{example, sonar};
use numbers::bits;
pub(super) use sonars::walls;
pub(super) use wrong_count::completed;
use wrong_count::wrong_count;

/// The arguments of a quark, and the text of the arguments in the quark text.
pub(super) struct Arguments {
    pub(super) values: Vec<Value>,
    pub(super) words: Vec<String>,
}

/// Converts the arguments of `call` to the types that `declaration` demands, and checks them.
pub(super) fn fit(
    call: &Call,
    declaration: &Declaration,
    robot: &str,
    parameters: &Parameters<'_>,
) -> Result<Arguments, Vec<Diagnostic>> {
    let fits = |call: &Call| fitted(call, declaration, robot, parameters);
    fits(call).map_err(|found| units::apart(call, fits).unwrap_or(found))
}

fn fitted(
    call: &Call,
    declaration: &Declaration,
    robot: &str,
    parameters: &Parameters<'_>,
) -> Result<Arguments, Vec<Diagnostic>> {
    let params = &declaration.params;
    let needed = params.iter().filter(|param| param.default.is_none()).count();
    if call.args.len() < needed || call.args.len() > params.len() {
        return Err(vec![wrong_count(call, declaration, needed)]);
    }
    let (arguments, found) = converted(call, declaration, robot, parameters);
    if found.is_empty() {
        return Ok(arguments);
    }
    let fits = |call: &Call| converted(call, declaration, robot, parameters).1.is_empty();
    let only = swapped(call, &found, fits).or_else(|| sonars::two_names(call, declaration, &found));
    Err(only.map_or(found, |only| vec![only]))
}

/// Converts the arguments of a call that has enough of them. Returns those that fit, and the errors in the others.
fn converted(
    call: &Call,
    declaration: &Declaration,
    robot: &str,
    parameters: &Parameters<'_>,
) -> (Arguments, Vec<Diagnostic>) {
    let mut arguments = Arguments { values: Vec::new(), words: Vec::new() };
    let mut found = Vec::new();
    let fitting = Fitting { declaration, robot };
    let none = Parameters::default();
    for (index, param) in declaration.params.iter().enumerate() {
        let fitted = match (call.args.get(index), &param.default) {
            (Some(arg), _) => fitting.given(arg, param, parameters),
            (None, Some(digits)) => {
                let number = Number::new(digits, call.span);
                fitting.given(&Arg::Number(number), param, &none)
            }
            (None, None) => continue,
        };
        match fitted {
            Ok((value, words)) => {
                arguments.values.push(value);
                arguments.words.push(words);
            }
            Err(diagnostic) => found.push(*diagnostic),
        }
    }
    (arguments, found)
}

/// Returns the number of errors in the call if it is a call of this declaration: arguments that are missing,
/// superfluous, or of the wrong kind.
pub(super) fn complaints(call: &Call, declaration: &Declaration, parameters: &Parameters<'_>) -> usize {
    let params = &declaration.params;
    let needed = params.iter().filter(|param| param.default.is_none()).count();
    let fitting = Fitting { declaration, robot: "" };
    let is_wrong = |(arg, param): &(&Arg, &Param)| {
        fitting.given(arg, param, parameters).is_err_and(|found| !matches!(found.code, Code::E0304 | Code::E0402))
    };
    let wrong = call.args.iter().zip(params).filter(is_wrong).count();
    wrong + needed.saturating_sub(call.args.len()) + call.args.len().saturating_sub(params.len())
}

/// Returns the text of a quark with its parameters and their units, such as `go <v in cm/s> <omega in rad/s>`. Optional
/// parameters are in square brackets.
#[must_use]
pub fn signature(declaration: &Declaration) -> String {
    let mut text = declaration.name.clone();
    for param in &declaration.params {
        let unit = param.unit.map(|unit| format!(" in {}", unit.name)).unwrap_or_default();
        let what = match param.kind {
            ParameterKind::Bits(length) => format!("{length} bits"),
            ParameterKind::Sonar => "sonar 0 to 15".into(),
            ParameterKind::Module => "module".into(),
            ParameterKind::Length
            | ParameterKind::Speed
            | ParameterKind::Angle
            | ParameterKind::AngularRate
            | ParameterKind::Time
            | ParameterKind::Voltage
            | ParameterKind::Frequency
            | ParameterKind::Number
            | ParameterKind::Integer
            | ParameterKind::Count
            | ParameterKind::Robot
            | ParameterKind::File => format!("{}{unit}", param.name),
        };
        let open = if param.default.is_some() { ("[", "]") } else { ("<", ">") };
        text += &format!(" {}{what}{}", open.0, open.1);
    }
    text
}

/// Converts a number to a value in the unit `unit`, and adds the text of the value in this unit. Error messages name
/// `declaration`. A number that is written without a unit has the unit `bare`.
pub(super) fn value(number: &Number, bare: Unit, unit: Unit, declaration: &Declaration) -> Fitted {
    let param = Param {
        name: String::new(),
        kind: unit.kind,
        unit: Some(unit),
        default: None,
        range: None,
        except: None,
        with: Vec::new(),
    };
    let here = format!("`{}` is {}", declaration.name, unit.kind.words());
    Fitting { declaration, robot: "" }.quantity(number, &param, Some(bare)).map_err(|mut found| {
        found.labels.iter_mut().for_each(|label| label.text.clone_from(&here));
        found
    })
}

pub(super) type Fitted = Result<(Value, String), Box<Diagnostic>>;

struct Fitting<'a> {
    declaration: &'a Declaration,
    robot: &'a str,
}

impl Fitting<'_> {
    /// Converts an argument. If the argument is the name of a parameter, converts the argument that was passed for this
    /// parameter.
    fn given(&self, arg: &Arg, param: &Param, parameters: &Parameters<'_>) -> Fitted {
        if let Arg::Name(name) = arg
            && parameters.is_untyped(name.node)
        {
            return Ok((Value::Name(param.kind, name.node.to_owned()), name.node.to_owned()));
        }
        let Some(parameter) = parameters.of(arg) else { return self.argument(arg, param, param.unit) };
        if parameter.kind != param.kind {
            return Err(parameter.mismatch(param.kind, arg.span()).into());
        }
        match &parameter.given {
            Some(given) => self.argument(given, param, parameter.unit()),
            // Until the plan is used, the parameter has no argument, and its name is its value.
            None => Ok((Value::Name(param.kind, parameter.name.node.to_owned()), parameter.name.node.to_owned())),
        }
    }

    /// Converts an argument; `bare` is the unit of a number that is written without a unit.
    fn argument(&self, arg: &Arg, param: &Param, bare: Option<Unit>) -> Fitted {
        if let (Arg::Name(name), ParameterKind::Sonar) = (arg, param.kind)
            && let Some(number) = sonar(name)
        {
            return self.whole(&number, param);
        }
        match (arg, param.kind) {
            (Arg::Number(number), ParameterKind::Bits(length)) => bits(number, length),
            (
                Arg::Number(number),
                ParameterKind::Length
                | ParameterKind::Speed
                | ParameterKind::Angle
                | ParameterKind::AngularRate
                | ParameterKind::Time
                | ParameterKind::Voltage,
            )
            | (Arg::Number(number), ParameterKind::Frequency | ParameterKind::Number) => {
                self.quantity(number, param, bare)
            }
            (Arg::Number(number), ParameterKind::Integer | ParameterKind::Count | ParameterKind::Sonar) => {
                self.whole(number, param)
            }
            (Arg::Infinity(_), ParameterKind::Time | ParameterKind::Count) => {
                Ok((Value::Infinity(param.kind), "inf".into()))
            }
            (Arg::Name(name), ParameterKind::Robot | ParameterKind::File)
            | (Arg::String(name), ParameterKind::File)
            | (Arg::Module(name), ParameterKind::Module) => {
                let words = match arg {
                    Arg::Module(_) => format!("{} module", name.node),
                    Arg::String(_) => format!("\"{}\"", name.node),
                    Arg::Name(_) | Arg::Number(_) | Arg::Infinity(_) => name.node.to_owned(),
                };
                Ok((Value::Name(param.kind, name.node.to_owned()), words))
            }
            (Arg::Name(name), ParameterKind::Module) => Err(self
                .mismatch(arg, param, format!("found the name `{}`", name.node))
                .fix("if it is a module, write {}", name.span, format!("{} module", name.node))
                .into()),
            (Arg::Number(_), ParameterKind::Robot | ParameterKind::Module | ParameterKind::File) => {
                Err(self.mismatch(arg, param, "found a number".into()).into())
            }
            (Arg::Infinity(_), _) => Err(self.endless(arg, param).into()),
            (Arg::Name(name), _) => Err(self.mismatch(arg, param, format!("found the name `{}`", name.node)).into()),
            (Arg::String(_), _) => Err(self.mismatch(arg, param, "found a text in quotes".into()).into()),
            (Arg::Module(_), _) => Err(self.mismatch(arg, param, "found a module".into()).into()),
        }
    }

    /// Reports `inf` for a parameter that must be finite.
    fn endless(&self, arg: &Arg, param: &Param) -> Diagnostic {
        let report = self.mismatch(arg, param, "found infinity".into());
        let is_way = self.declaration.kind == DeclarationKind::Control && param.kind == ParameterKind::Length;
        if !is_way {
            return report;
        }
        report
            .help("only a time or a count is without end: to drive until an interrupt fires, write `go 20cm/s 0rad/s`")
    }

    fn mismatch(&self, arg: &Arg, param: &Param, found: String) -> Diagnostic {
        let message = format!("expected {}, {found}", param.kind.words());
        let here = format!("`{}` of `{}` is {}", param.name, self.declaration.name, param.kind.words());
        let diagnostic = Diagnostic::new(Code::E0302, message, arg.span(), here);
        if param.kind == ParameterKind::Sonar {
            return sonars::looks(diagnostic, arg);
        }
        match (example(param), arg) {
            (Some(example), Arg::Name(here)) if here.node == "here" => diagnostic
                .fix("for instance {}", arg.span(), example)
                .help("`here` is a frame, in front of an element: `FRAME here (Atom (null) rotate 90)`"),
            (Some(example), _) => diagnostic.fix("for instance {}", arg.span(), example),
            (None, Arg::String(name)) if param.kind == ParameterKind::Robot && is_name(name.node) => {
                diagnostic.fix("the name of a robot has no quotes: {}", arg.span(), name.node)
            }
            (None, _) => diagnostic,
        }
    }
}

/// Returns a call as written in the plan, without its parentheses.
pub(super) fn written(call: &Call) -> String {
    let args = call.args.iter().map(|arg| match arg {
        Arg::Number(number) => format!("{}{}", number.digits(), number.unit().unwrap_or_default()),
        Arg::Infinity(_) => "inf".to_owned(),
        Arg::String(text) => format!("\"{}\"", text.node),
        Arg::Name(name) => name.node.to_owned(),
        Arg::Module(name) => format!("{} module", name.node),
    });
    [call.name.to_owned()].into_iter().chain(args).collect::<Vec<_>>().join(" ")
}

/// Returns `true` if a text can be a name in a plan.
fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '_') && text.chars().all(|c| c.is_alphanumeric() || c == '_')
}
/// Returns the name of a kind of quark, for messages.
pub(super) fn kind_words(kind: DeclarationKind) -> &'static str {
    match kind {
        DeclarationKind::Control => "a law",
        DeclarationKind::Interrupt => "an interrupt",
        DeclarationKind::Signal => "a signal",
    }
}
