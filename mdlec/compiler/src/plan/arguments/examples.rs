//! Example arguments for help texts.

use super::ranges::limit;
use super::written;
use crate::alphabet::{Declaration, Param, ParameterKind, Unit};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::tree::{Arg, Call, Name, Number};

/// Returns an example value for a parameter, which is in its range; `None` if the value is a name that only the user
/// can know.
pub(in crate::plan) fn example(param: &Param) -> Option<String> {
    let (value, unit) = match param.kind {
        ParameterKind::Length => (1.0, "m"),
        ParameterKind::Speed => (20.0, "cm/s"),
        ParameterKind::Angle => (90.0, "deg"),
        ParameterKind::Time => (30.0, "s"),
        ParameterKind::Voltage => (12.0, "V"),
        ParameterKind::Frequency => (10.0, "Hz"),
        ParameterKind::AngularRate | ParameterKind::Number | ParameterKind::Integer | ParameterKind::Sonar => (0.0, ""),
        ParameterKind::Count => (1.0, ""),
        ParameterKind::Bits(length) => return Some(format!("1{}", "0".repeat((length as usize).saturating_sub(1)))),
        ParameterKind::Robot | ParameterKind::Module | ParameterKind::File => return None,
    };
    let own = |value: f64| match (Unit::from_name(unit), param.unit) {
        (Some(unit), Some(own)) => unit.to_si(value) / own.to_si(1.0),
        _ => value,
    };
    let is_allowed = |value: f64| {
        param.except != Some(value) && param.range.is_none_or(|(least, most)| least <= value && value <= most)
    };
    if is_allowed(own(value)) {
        return Some(format!("{value}{unit}"));
    }
    let (least, most) = param.range.unwrap_or((0.0, 1.0));
    let other = [most, least].into_iter().find(|value| is_allowed(*value))?;
    Some(format!("{}{}", limit(other), param.unit.map_or("", |unit| unit.name)))
}

/// Returns the number of the sonar whose range the name denotes, as in the paper's `align r_7 r_9`; `None` if the name
/// does not denote a range.
pub(in crate::plan) fn sonar<'s>(name: &Name<'s>) -> Option<Number<'s>> {
    let digits = name.node.strip_prefix('r').map(|index| index.strip_prefix('_').unwrap_or(index))?;
    let is_index = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    is_index.then(|| Number::new(digits, name.span))
}

/// Proposes `atIsection 1000` for `atIsection 1 0 0 0`.
pub(super) fn bits_apart(call: &Call, declaration: &Declaration) -> Option<String> {
    let [Param { kind: ParameterKind::Bits(length), .. }] = declaration.params.as_slice() else { return None };
    let bits = call.args.iter().map(|arg| match arg {
        Arg::Number(number) if number.unit().is_none() && matches!(number.digits(), "0" | "1") => Some(number.digits()),
        Arg::Number(_) | Arg::Infinity(_) | Arg::String(_) | Arg::Name(_) | Arg::Module(_) => None,
    });
    let bits = bits.collect::<Option<String>>()?;
    (bits.len() == *length as usize).then(|| format!("{} {bits}", call.name))
}

/// Reports two neighbouring arguments that are in the wrong order, as shown by the unit of one of them at least.
pub(super) fn swapped(call: &Call, found: &[Diagnostic], fits: impl Fn(&Call) -> bool) -> Option<Diagnostic> {
    if found.is_empty() || found.iter().any(|found| found.code != Code::E0303) {
        return None;
    }
    let is_wrong = |arg: &Arg<'_>| found.iter().any(|found| found.span() == Some(arg.span()));
    let pair = |at: usize| {
        let (first, second) = (call.args.get(at)?, call.args.get(at + 1)?);
        let wrong = [first, second].into_iter().filter(|arg| is_wrong(arg)).count();
        let mut args = call.args.to_vec();
        args.swap(at, at + 1);
        let swapped = Call { args: &args, ..*call };
        (wrong == found.len() && fits(&swapped)).then_some((first, second))
    };
    let (first, second) = (0..call.args.len()).find_map(pair)?;
    let span = first.span().to(second.span());
    let message = format!("the arguments of `{}` are in the other order", call.name);
    let arguments = written(&Call { args: &[*second, *first], ..*call }).split_once(' ')?.1.to_owned();
    Some(Diagnostic::new(Code::E0303, message, span, "swap these").fix("write {}", span, arguments))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_example_is_allowed() {
        let param = |kind, range, except| Param {
            name: "a".to_owned(),
            kind,
            unit: None,
            default: None,
            range,
            except,
            with: Vec::new(),
        };
        let texts = [
            (ParameterKind::Time, None, None),
            (ParameterKind::Time, Some((0.0, 10.0)), Some(0.0)),
            (ParameterKind::AngularRate, None, Some(0.0)),
            (ParameterKind::Number, Some((0.0, 2.0)), Some(0.0)),
            (ParameterKind::Number, Some((-2.0, 0.0)), Some(0.0)),
        ]
        .map(|(kind, range, except)| example(&param(kind, range, except)).unwrap_or_default());
        assert_eq!(texts, ["30s", "10", "1", "2", "-2"]);
    }
}
