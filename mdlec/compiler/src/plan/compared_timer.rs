//! Writes the message about an interrupt that is compared with its own argument, a time.

use super::Operator;
use super::quarks::ResolvedQuarks;
use crate::alphabet::{DeclarationKind, ParameterKind, Unit};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::{self, Operand};

/// Reports an interrupt whose only argument is a time, and which is compared with this time, as in `stuck > 30s`.
pub(super) fn compared_timer(written: &tree::Compared, span: Span, quarks: &ResolvedQuarks<'_>) -> Option<Diagnostic> {
    let (Operator::Greater | Operator::GreaterOrEqual, Operand::Number(time)) = (written.operator, &written.right)
    else {
        return None;
    };
    let name = written.left.name;
    let mut declarations = quarks.alphabet().declarations_of(name);
    let (declaration, None) = (declarations.next()?, declarations.next()) else { return None };
    let takes_time = matches!(declaration.params.as_slice(), [only] if only.kind == ParameterKind::Time);
    let unit = time.unit().unwrap_or_default();
    let is_positive = time.digits().parse::<f64>().is_ok_and(|time| time > 0.0);
    let is_time =
        is_positive && (unit.is_empty() || Unit::from_name(unit).is_some_and(|unit| unit.kind == ParameterKind::Time));
    if declaration.kind != DeclarationKind::Interrupt || !takes_time || !is_time || !written.left.args.is_empty() {
        return None;
    }
    let message = format!("`{name}` is an interrupt, but a signal is expected here");
    let report = Diagnostic::new(Code::E0204, message, written.left.name_span(), "an interrupt");
    Some(report.fix("the time is its argument: {}", span, format!("{name} {}{unit}", time.digits())))
}
