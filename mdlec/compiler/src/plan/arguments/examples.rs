//! Example arguments for help texts.

use super::written;
use crate::alphabet::{Declaration, Param, ParameterKind};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::tree::{Arg, Call, Name, Number};

/// Returns an example value for a parameter; `None` if the value is a name that only the user can know.
pub(in crate::plan) fn example(param: &Param) -> Option<String> {
    let value = match param.kind {
        ParameterKind::Length => "1m".to_owned(),
        ParameterKind::Speed => "20cm/s".to_owned(),
        ParameterKind::Angle => "90deg".to_owned(),
        ParameterKind::AngularRate | ParameterKind::Number | ParameterKind::Integer | ParameterKind::Sonar => {
            "0".to_owned()
        }
        ParameterKind::Time => "5s".to_owned(),
        ParameterKind::Voltage => "12V".to_owned(),
        ParameterKind::Frequency => "10Hz".to_owned(),
        ParameterKind::Count => "1".to_owned(),
        ParameterKind::Bits(length) => format!("1{}", "0".repeat((length as usize).saturating_sub(1))),
        ParameterKind::Robot | ParameterKind::Module | ParameterKind::File => return None,
    };
    Some(value)
}

/// Returns the number of the sonar whose range the name denotes, as in the paper's `align r_7 r_9`; `None` if the name
/// does not denote a range.
pub(super) fn sonar<'s>(name: &Name<'s>) -> Option<Number<'s>> {
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

/// Reports two arguments that are in the wrong order, as shown by their units.
pub(super) fn swapped(call: &Call, found: &[Diagnostic], fits: impl Fn(&Call) -> bool) -> Option<Diagnostic> {
    let [first, second] = call.args else { return None };
    if found.len() != 2 || found.iter().any(|found| found.code != Code::E0303) {
        return None;
    }
    let args = [*second, *first];
    let swapped = Call { args: &args, ..*call };
    let span = first.span().to(second.span());
    let message = format!("the arguments of `{}` are in the other order", call.name);
    let arguments = written(&swapped).split_once(' ')?.1.to_owned();
    fits(&swapped).then(|| Diagnostic::new(Code::E0303, message, span, "swap these").fix("write {}", span, arguments))
}
