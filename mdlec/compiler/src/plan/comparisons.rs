//! Resolves comparisons of signals. The signals include `t` and `way`, which are the time and the length of the driven
//! path since the scope was entered (docs/src/reference/semantics.md, 2.4).

use super::arguments::{Fitted, value};
use super::compared_timer::compared_timer;
use super::parameters::{DefinitionNames, Parameter};
use super::quarks::ResolvedQuarks;
use super::{Compared, Comparison, Condition, Operator, Quark, QuarkId, Value};
use crate::alphabet::{self, Decimal, Declaration, DeclarationKind, ParameterKind, Unit, family_to_si};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::{self, Arg, Call, Number, Operand};

/// Name of the signal for the time.
const TIME: &str = "t";
/// Name of the signal for the length of the driven path.
const WAY: &str = "way";

type Resolved<T> = Result<T, Vec<Diagnostic>>;

/// A signal with its arguments.
#[derive(Clone, Copy)]
struct SignalCall<'a> {
    quark: QuarkId,
    declaration: &'a Declaration,
    unit: Unit,
    /// Tolerance of `==`, in the unit `unit`.
    tolerance: f64,
}

impl SignalCall<'_> {
    /// Returns the tolerance as an exact value.
    fn tolerance(&self) -> Value {
        let exact = Decimal::parse(&self.tolerance.to_string()).unwrap_or_else(Decimal::zero);
        let exact = exact.scaled(self.unit.factor, self.unit.exponent);
        Value::Quantity { kind: self.unit.kind, exact, family: self.unit.family }
    }
}

/// Returns `true` if a declaration is the signal `t`, the time since a scope was entered.
#[must_use]
pub fn is_time(declaration: &Declaration) -> bool {
    declaration.name == TIME
        && declaration.params.is_empty()
        && declaration.unit.is_some_and(|(unit, _)| unit.kind == ParameterKind::Time)
}

/// Returns `true` if a declaration is the signal `way`, the length of the driven path since a scope was entered.
#[must_use]
pub fn is_way(declaration: &Declaration) -> bool {
    declaration.name == WAY
        && declaration.params.is_empty()
        && declaration.unit.is_some_and(|(unit, _)| unit.kind == ParameterKind::Length)
}

/// Resolves a comparison to a condition.
pub(super) fn resolve(
    written: &tree::Compared,
    span: Span,
    quarks: &mut ResolvedQuarks<'_>,
    names: DefinitionNames<'_, '_>,
) -> Resolved<Condition> {
    if let Some(found) = compared_timer(written, span, quarks) {
        return Err(vec![found]);
    }
    let signal = signal(written.left, quarks, names);
    if let (Ok(_), Operand::Signal(call)) = (&signal, &written.right)
        && let Some(found) = like_parameter(call, quarks, names)
    {
        return Err(vec![found]);
    }
    let parameter = match &written.right {
        Operand::Signal(call) if call.args.is_empty() => names.parameters.get(call.name),
        Operand::Signal(_) | Operand::Number(_) | Operand::Infinity(_) => None,
    };
    // Errors of both sides are reported together.
    let right = match (&written.right, parameter) {
        (Operand::Signal(call), None) if names.parameters.is_untyped(call.name) => Some(Err(Vec::new())),
        (Operand::Signal(call), None) => Some(self::signal(call, quarks, names)),
        (Operand::Signal(_), Some(_)) | (Operand::Number(_) | Operand::Infinity(_), _) => None,
    };
    let (signal, right) = match (signal, right.transpose()) {
        (Ok(signal), Ok(right)) => (signal, right),
        (Err(mut found), Err(more)) => {
            found.extend(more);
            return Err(found);
        }
        (Err(found), _) | (_, Err(found)) => return Err(found),
    };
    let (with, text, tolerance) = match (right, &written.right) {
        (Some(other), _) => {
            let text = quarks.get(other.quark).map(|quark| quark.text.clone()).unwrap_or_default();
            (Compared::Signal(other.quark), text, same_kind(signal, other, span)?)
        }
        (None, right) => {
            let fitted = match (*right, parameter) {
                (Operand::Number(number), _) => value(&number, signal.unit, signal.unit, signal.declaration),
                (Operand::Infinity(span), _) => without_end(span, signal),
                (Operand::Signal(call), Some(parameter)) => given(parameter, call.span, signal),
                (Operand::Signal(_), None) => return Err(Vec::new()),
            };
            let (value, text) = fitted.map_err(|found| vec![*found])?;
            (Compared::Value(value), text, signal.tolerance())
        }
    };
    let operator = written.operator;
    let left = quarks.get(signal.quark).map(|quark| quark.text.as_str()).unwrap_or_default();
    let text = format!("{left} {} {text}", operator.symbol());
    let comparison = Comparison { signal: signal.quark, unit: signal.unit, operator, with, tolerance };
    let counted = match signal.declaration {
        time if is_time(time) => Some((EntrySignal::Time, interval(&comparison, EntrySignal::Time, span)?)),
        way if is_way(way) => Some((EntrySignal::Way, interval(&comparison, EntrySignal::Way, span)?)),
        _ => None,
    };
    let quark = quarks.add(Quark {
        name: operator.symbol().to_owned(),
        overload: 0,
        args: Vec::new(),
        completes: false,
        remembers: false,
        exclusive: false,
        comparison: Some(comparison),
        text,
    });
    Ok(match counted {
        Some((EntrySignal::Time, (from, until))) => Condition::Elapsed { from, until, quark },
        Some((EntrySignal::Way, (from, until))) => Condition::Driven { from, until, quark },
        None => Condition::Quark(quark),
    })
}

/// Reports an unknown signal whose name is similar to the name of a parameter.
fn like_parameter(call: &Call, quarks: &ResolvedQuarks<'_>, names: DefinitionNames<'_, '_>) -> Option<Diagnostic> {
    let name = call.name;
    let is_known = names.parameters.get(name).is_some() || names.parameters.is_untyped(name);
    let is_signal = is_signal(name, quarks) || indexed(call, quarks).1.is_some();
    let near = alphabet::nearest(name, names.parameters.names()).filter(|_| !is_known && !is_signal)?;
    let message = format!("there is no parameter or signal called `{name}`");
    let found = Diagnostic::new(Code::E0201, message, call.name_span(), "neither of them");
    call.args.is_empty().then(|| found.fix("did you mean {}?", call.name_span(), near))
}

/// Converts the argument that was passed for a parameter to the value with which `signal` is compared.
fn given(parameter: &Parameter<'_>, at: Span, signal: SignalCall<'_>) -> Fitted {
    let SignalCall { unit, declaration, .. } = signal;
    if parameter.kind != unit.kind {
        return Err(parameter.mismatch(unit.kind, at).into());
    }
    match parameter.given {
        Some(Arg::Number(number)) => value(&number, parameter.unit().unwrap_or(unit), unit, declaration),
        Some(Arg::Infinity(_)) => without_end(at, signal),
        // Until the plan is used, the parameter has no argument, and its name is its value.
        Some(Arg::String(_) | Arg::Name(_) | Arg::Module(_)) | None => {
            let name = parameter.name.node.to_owned();
            Ok((Value::Name(unit.kind, name.clone()), name))
        }
    }
}

/// Converts `inf`, which is allowed only in a comparison of a time, to a value.
fn without_end(at: Span, SignalCall { unit, declaration, .. }: SignalCall<'_>) -> Fitted {
    if unit.kind == ParameterKind::Time {
        return Ok((Value::Infinity(unit.kind), "inf".into()));
    }
    let message = format!("expected {}, found infinity", unit.kind.words());
    let here = format!("`{}` is {}", declaration.name, unit.kind.words());
    Err(Diagnostic::new(Code::E0302, message, at, here).help("only a time is without end, as in `t > inf`").into())
}

/// Returns the tolerance for a comparison of two signals, which is the larger one of their tolerances.
fn same_kind(one: SignalCall<'_>, other: SignalCall<'_>, span: Span) -> Resolved<Value> {
    let refused = |message: String, help: &str| {
        let [here, there] =
            [one, other].map(|signal| format!("`{}` is {}", signal.declaration.name, signal.unit.kind.words()));
        let found = Diagnostic::new(Code::E0302, message, span, format!("{here}, {there}"));
        vec![if help.is_empty() { found } else { found.help(help) }]
    };
    if is_time(one.declaration) || is_time(other.declaration) {
        let message = "`t`, the time since the scope was entered, is compared with a number".to_owned();
        return Err(refused(message, "as in `t > 5s`"));
    }
    if is_way(one.declaration) || is_way(other.declaration) {
        let message = "`way`, the path driven since the scope was entered, is compared with a number".to_owned();
        return Err(refused(message, "as in `way > 3m`"));
    }
    if one.unit.kind != other.unit.kind {
        let message = format!("{} cannot be compared with {}", one.unit.kind.words(), other.unit.kind.words());
        return Err(refused(message, ""));
    }
    let si = |signal: SignalCall<'_>| match signal.tolerance() {
        Value::Quantity { exact, family, .. } => exact.to_f64() * family_to_si(family),
        Value::Infinity(_) | Value::Bits(_) | Value::Integer(_) | Value::Sonar(_) | Value::Name(..) => 0.0,
    };
    Ok(if si(one) >= si(other) { one.tolerance() } else { other.tolerance() })
}

/// A signal whose value is zero when its scope is entered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum EntrySignal {
    /// The signal `t`, which is compared in nanoseconds.
    Time,
    /// The signal `way`, which is compared in nanometres.
    Way,
}

/// Returns the interval in which a comparison of `t` or `way` is true, in nanoseconds or nanometres. The start belongs
/// to the interval, the end does not; the end is `None` if the interval has no end.
fn interval(comparison: &Comparison, counted: EntrySignal, span: Span) -> Resolved<(u64, Option<u64>)> {
    let nanos = |value: &Value| match value {
        Value::Quantity { exact, .. } => exact.to_nanos(),
        Value::Infinity(_) => Some(u64::MAX),
        Value::Bits(_) | Value::Integer(_) | Value::Sonar(_) | Value::Name(..) => None,
    };
    let time = match &comparison.with {
        // A parameter without an argument yet.
        Compared::Value(Value::Name(..)) => Some(0),
        Compared::Value(value) => nanos(value),
        Compared::Signal(_) => None,
    };
    let (Some(time), Some(tolerance)) = (time, nanos(&comparison.tolerance)) else {
        let message = match counted {
            EntrySignal::Time => "`t` is the time since the scope was entered: from 0 to some hundred years",
            EntrySignal::Way => {
                "`way` is the length of the path driven since the scope was entered: from 0 to some million kilometres"
            }
        };
        return Err(vec![Diagnostic::new(Code::E0304, message, span, "out of range")]);
    };
    let behind = |time: u64| time.saturating_add(1);
    Ok(match comparison.operator {
        Operator::Equal => (time.saturating_sub(tolerance), Some(behind(time.saturating_add(tolerance)))),
        Operator::Less => (0, Some(time)),
        Operator::LessOrEqual => (0, Some(behind(time))),
        Operator::Greater => (behind(time), None),
        Operator::GreaterOrEqual => (time, None),
    })
}

/// Resolves `call` to a signal. Accepts `x` and `x(t)` for a signal without arguments, and `r 3`, `r3`, `r_3` and
/// `r_3(t)` for a signal with one.
fn signal<'a>(
    call: &Call,
    quarks: &mut ResolvedQuarks<'a>,
    names: DefinitionNames<'_, '_>,
) -> Resolved<SignalCall<'a>> {
    let args = match call.args {
        [args @ .., Arg::Name(name)] if name.node == TIME => args,
        args => args,
    };
    let (name, index) = if is_signal(call.name, quarks) { (call.name, None) } else { indexed(call, quarks) };
    let index: Vec<Arg> = index.into_iter().map(Arg::Number).collect();
    let args = if index.is_empty() { args } else { index.as_slice() };
    let quark = quarks.resolve(&Call { name, args, span: call.span }, DeclarationKind::Signal, names)?;
    let overload = quarks.get(quark).map_or(0, |quark| quark.overload);
    let declaration = quarks.alphabet().declarations_of(name).nth(overload);
    match declaration.and_then(|declaration| Some((declaration, declaration.unit?))) {
        Some((declaration, (unit, tolerance))) => Ok(SignalCall { quark, declaration, unit, tolerance }),
        // A signal without a unit is an error in the alphabet, which has been reported.
        None => Err(Vec::new()),
    }
}

fn is_signal(name: &str, quarks: &ResolvedQuarks<'_>) -> bool {
    quarks.alphabet().declarations_of(name).any(|declaration| declaration.kind == DeclarationKind::Signal)
}

/// Interprets `r_3` as the signal `r` with the number 3, if there is a signal `r` whose only parameter is a sonar.
fn indexed<'s>(call: &Call<'s>, quarks: &ResolvedQuarks<'_>) -> (&'s str, Option<Number<'s>>) {
    let base = call.name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let digits = &call.name[base.len()..];
    let name = base.strip_suffix('_').unwrap_or(base);
    let of_sonar = |declaration: &Declaration| {
        declaration.kind == DeclarationKind::Signal
            && matches!(declaration.params.as_slice(), [only] if only.kind == ParameterKind::Sonar)
    };
    if digits.is_empty() || !quarks.alphabet().declarations_of(name).any(of_sonar) {
        return (call.name, None);
    }
    (name, Some(Number::new(digits, call.name_span())))
}
