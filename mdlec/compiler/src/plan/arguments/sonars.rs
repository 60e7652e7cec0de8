//! Writes messages about arguments that are not sonars where a sonar is expected.

use mdle_runtime::{Radians, SONARS, SonarId};

use crate::alphabet::{Declaration, ParameterKind, Unit};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::tree::{Arg, Call, Number};

/// Help text with the directions of the sonars.
pub(super) const DIRECTIONS: &str = "sonar 0 looks ahead, 4 left, 8 back, 12 right";

/// Maximum angle between a direction and the axis of the sonar that is meant by it.
const EXACT: Radians = Radians::from_degrees(0.2);

/// Returns help with the two sonars on either side of each direction, for a law that compares two sonars.
pub(in crate::plan) fn walls(law: &str) -> String {
    format!("for a wall on the left `{law} 3 5`, on the right `{law} 11 13`, ahead `{law} 15 1`, behind `{law} 7 9`")
}

/// Returns `diagnostic`, which is about an argument that is not a sonar, with help about the sonar that is meant.
pub(super) fn looks(diagnostic: Diagnostic, arg: &Arg) -> Diagnostic {
    let name = match arg {
        Arg::Name(name) => name.node,
        Arg::Number(_) | Arg::Infinity(_) | Arg::String(_) | Arg::Module(_) => "",
    };
    let sonar = match name {
        "front" | "ahead" | "forward" => "0",
        "left" => "4",
        "back" | "behind" | "rear" => "8",
        "right" => "12",
        _ => return diagnostic.help(DIRECTIONS),
    };
    let words = format!("for the sonar that looks {} write {{}}", if sonar == "0" { "ahead" } else { name });
    diagnostic.fix(&words, arg.span(), sonar)
}

/// Appends help to a message about a number with a unit where a sonar is expected. If the number is the direction of a
/// sonar, the help names this sonar.
pub(super) fn faces(report: Diagnostic, number: &Number) -> Diagnostic {
    let unit = number.unit().and_then(Unit::from_name).filter(|unit| unit.kind == ParameterKind::Angle);
    let Some((unit, Ok(value))) = unit.map(|unit| (unit, number.digits().parse::<f64>())) else {
        return report.help("write it without a unit");
    };
    let faces = |sonar: &SonarId| Radians(unit.to_si(value) - sonar.bearing().0).wrapped().0.abs() <= EXACT.0;
    match (0..SONARS as u8).map(SonarId::new).find(faces) {
        Some(sonar) => report.fix("the sonar in this direction is {}", number.span, sonar.number().to_string()),
        None => report.help(DIRECTIONS),
    }
}

/// Reports a call that needs two sonars and has two names, as in `align left right`.
pub(super) fn two_names(call: &Call, declaration: &Declaration, found: &[Diagnostic]) -> Option<Diagnostic> {
    let [Arg::Name(first), Arg::Name(second)] = call.args else { return None };
    let are_sonars = declaration.params.iter().all(|param| param.kind == ParameterKind::Sonar);
    if found.len() != 2 || !are_sonars || found.iter().any(|found| found.code != Code::E0302) {
        return None;
    }
    let message = format!("expected two sonars, 0 to 15, found the names `{}` and `{}`", first.node, second.node);
    let diagnostic = Diagnostic::new(Code::E0302, message, first.span.to(second.span), "names, not sonars");
    Some(diagnostic.help(walls(call.name)))
}
