//! Writes the message about a call with too many or too few arguments.

use mdle_runtime::SONARS;

use super::examples::{bits_apart, example};
use super::{signature, written};
use crate::alphabet::{Declaration, DeclarationKind, Param, ParameterKind, Unit};
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::moves;
use crate::syntax::tree::{Arg, Call, Number};

/// Reports that `call` has the wrong number of arguments; `declaration` needs at least `needed` arguments.
pub(super) fn wrong_count(call: &Call, declaration: &Declaration, needed: usize) -> Diagnostic {
    let most = declaration.params.len();
    let takes = match (needed, most) {
        (_, 0) => "no arguments".to_owned(),
        (1, 1) => "one argument".to_owned(),
        (least, most) if least == most => format!("{most} arguments"),
        (least, most) => format!("{least} to {most} arguments"),
    };
    let found = match call.args.len() {
        0 => "found none".to_owned(),
        count => format!("found {count}"),
    };
    let span = match call.args.get(most) {
        Some(first_too_many) => first_too_many.span(),
        None => call.span,
    };
    let report = |here: String| {
        let message = format!("`{}` takes {takes}, {found}", declaration.name);
        Diagnostic::new(Code::E0301, message, span, here).help(format!("write it as `{}`", signature(declaration)))
    };
    if let Some(pattern) = bits_apart(call, declaration) {
        return report("bits are written together".into()).fix("write {}", call.span, pattern);
    }
    if let [Arg::Name(side), amount @ ..] = call.args
        && let Some(law) = moves::meant(&Call { name: side.node, args: amount, ..*call })
        && declaration.kind == DeclarationKind::Control
        && matches!(declaration.params.first(), Some(Param { kind: ParameterKind::Angle, .. }))
    {
        let message = format!("`{}` takes {takes}, and `{}` is not an argument", declaration.name, side.node);
        let found = Diagnostic::new(Code::E0301, message, side.span, "write a number with a sign");
        return found.fix(law.words, call.span, law.call);
    }
    if call.args.len() > most {
        let report = report("one too many".into());
        return match (call.args, declaration.params.as_slice()) {
            ([Arg::Number(time)], []) if declaration.kind == DeclarationKind::Control && is_time(time) => {
                let time = format!("{}{}", time.digits(), time.unit().unwrap_or_default());
                report.help(format!("a time is waited for: `(Atom (wait {time}) {})`", call.name))
            }
            ([Arg::Name(robot), Arg::Number(number)], [Param { kind: ParameterKind::Robot, .. }]) => {
                let name = format!("{} {}{}", call.name, robot.node, number.digits());
                report.fix("a name has no space: {}", call.span, name)
            }
            _ => report,
        };
    }
    let missing = declaration.params.get(call.args.len()..needed).unwrap_or_default();
    let names: Vec<_> = missing.iter().map(|param| format!("`{}`", param.name)).collect();
    let report = report(format!("{} {} missing", names.join(" and "), if names.len() == 1 { "is" } else { "are" }));
    match completed(call, declaration) {
        Some(completed) => report.fix("for instance {}", call.span, completed),
        None => report,
    }
}

/// Returns the text of a call with an example for each argument that it lacks; `None` if only the user can know one.
pub(in crate::plan) fn completed(call: &Call, declaration: &Declaration) -> Option<String> {
    let params = &declaration.params;
    let needed = params.iter().filter(|param| param.default.is_none()).count();
    let Some(missing) = params.get(call.args.len()..needed).filter(|missing| !missing.is_empty()) else {
        return Some(written(call));
    };
    if params.iter().all(|param| param.kind == ParameterKind::Sonar) {
        // Two sonars that look at one wall are two apart, as in the paper's `align 7 9`.
        let sonars = (first_sonar(call)..).step_by(2).take(params.len()).map(|sonar| format!(" {}", sonar % SONARS));
        return Some(format!("{}{}", call.name, sonars.collect::<String>()));
    }
    let examples: Vec<_> = missing.iter().map(example).collect::<Option<_>>()?;
    Some(format!("{} {}", written(call), examples.join(" ")))
}

/// Returns the number of the sonar that a call names first, or of one to the left of the robot.
fn first_sonar(call: &Call) -> usize {
    let first = match call.args {
        [Arg::Number(first), ..] => first.digits().parse().ok(),
        _ => None,
    };
    first.filter(|sonar| *sonar < SONARS).unwrap_or(3)
}

/// Returns `true` if a number has a unit of time.
fn is_time(number: &Number) -> bool {
    number.unit().and_then(Unit::from_name).is_some_and(|unit| unit.kind == ParameterKind::Time)
}
