//! Writes messages about numbers that are out of range: the text of limits, and the number that the user probably
//! meant.

use crate::alphabet::{Declaration, Param, Unit};
use crate::diagnostic::Diagnostic;
use crate::syntax::tree::Number;

/// Returns the text of a limit of a range. A large limit is written as `1e10`.
pub(super) fn limit(value: f64) -> String {
    if value.abs() >= 1e7 { format!("{value:e}") } else { value.to_string() }
}

/// Returns the text of a parameter's name and range. A range whose lower limit is excluded begins above this limit.
pub(super) fn allowed(param: &Param, least: f64, most: f64) -> String {
    let unit = param.unit.map(|unit| format!(" {}", unit.name)).unwrap_or_default();
    let (name, least_text, most) = (&param.name, limit(least), limit(most));
    match param.except == Some(least) {
        true => format!("`{name}` of more than {least_text} and at most {most}{unit}"),
        false => format!("`{name}` from {least_text} to {most}{unit}"),
    }
}

/// Appends help to a message about a number that is out of range, if the number would be in range in degrees instead of
/// radians, or without its sign. A range without its sign would lead in the opposite direction, so the help for a range
/// that belongs to a bearing also changes the bearing.
pub(super) fn meant_in_range(
    report: Diagnostic,
    number: &Number,
    param: &Param,
    declaration: &Declaration,
) -> Diagnostic {
    let (digits, own) = (number.digits(), number.unit().or(param.unit.map(|unit| unit.name)).unwrap_or_default());
    let fits = |digits: &str, unit: &str| {
        let (Some((least, most)), Ok(value)) = (param.range, digits.parse::<f64>()) else { return false };
        let value = match (Unit::from_name(unit), param.unit) {
            (Some(unit), Some(own)) => unit.to_si(value) / own.to_si(1.0),
            _ => value,
        };
        least <= value && value <= most
    };
    if number.unit().is_none() && own == "rad/s" && fits(digits, "deg/s") {
        return report.fix("for degrees per second write {}", number.span, format!("{digits}deg/s"));
    }
    match digits.strip_prefix('-').filter(|positive| fits(positive, own)) {
        Some(positive) => {
            let positive = format!("{positive}{}", number.unit().unwrap_or_default());
            if param.name == "range" && declaration.params.iter().any(|other| other.name == "bearing") {
                return report
                    .help(format!("for the opposite direction add 180 to the bearing, and write `{positive}`"));
            }
            report.fix("write it without the sign: {}", number.span, positive)
        }
        None => report,
    }
}
