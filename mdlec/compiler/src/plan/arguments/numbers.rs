//! Converts numbers in arguments, checks their units and ranges, and reports errors in them.

use super::examples::example;
use super::ranges::{allowed, meant_in_range};
use super::sonars::{DIRECTIONS, faces};
use super::{Fitted, Fitting, Value};
use crate::alphabet::{Origin, Param, ParameterKind, Unit};
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::Decimal;
use crate::syntax::BITS;
use crate::syntax::tree::Number;

/// Largest whole number up to which `f64` represents every whole number exactly.
const WHOLE: i64 = 1 << 53;

impl Fitting<'_> {
    pub(super) fn quantity(&self, number: &Number, param: &Param, bare: Option<Unit>) -> Fitted {
        let Some(decimal) = Decimal::parse(number.digits()) else { return Err(not_a_number(number).into()) };
        let Some(default) = param.unit else {
            return match number.unit() {
                Some(_) => Err(self.wrong_unit(number, param).into()),
                None => {
                    self.in_range(number, param, decimal.to_f64())?;
                    let words = decimal.to_string();
                    Ok((Value::Quantity { kind: param.kind, exact: decimal, family: "" }, words))
                }
            };
        };
        let unit = match number.unit() {
            None => bare.unwrap_or(default),
            Some(name) => match Unit::from_name(name) {
                Some(unit) if unit.kind == param.kind => unit,
                Some(_) | None => return Err(self.wrong_unit(number, param).into()),
            },
        };
        let exact = decimal.scaled(unit.factor, unit.exponent);
        let in_default = if unit == default { decimal.to_f64() } else { converted(&exact, unit, default) };
        self.in_range(number, param, in_default)?;
        let words = if unit == default { decimal.to_string() } else { in_default.to_string() };
        Ok((Value::Quantity { kind: param.kind, exact, family: unit.family }, words))
    }

    pub(super) fn whole(&self, number: &Number, param: &Param) -> Fitted {
        if number.unit().is_some() {
            return Err(self.wrong_unit(number, param).into());
        }
        let Some(decimal) = Decimal::parse(number.digits()).filter(Decimal::is_whole) else {
            return Err(not_whole(number, param).into());
        };
        let text = decimal.to_string();
        self.in_range(number, param, decimal.to_f64())?;
        let is_sonar = param.kind == ParameterKind::Sonar;
        let allowed = if is_sonar {
            0..=15
        } else if param.kind == ParameterKind::Count {
            1..=WHOLE
        } else {
            -WHOLE..=WHOLE
        };
        let Some(whole) = text.parse::<i64>().ok().filter(|whole| allowed.contains(whole)) else {
            let message = format!("expected {}, found `{}`", param.kind.words(), number.digits());
            let report = Diagnostic::new(Code::E0304, message, number.span, "out of range");
            return Err(if is_sonar { report.help(DIRECTIONS) } else { report }.into());
        };
        let value = match (param.kind, u8::try_from(whole)) {
            (ParameterKind::Sonar, Ok(sonar)) => Value::Sonar(sonar),
            _ => Value::Integer(whole),
        };
        Ok((value, text))
    }

    /// Returns `value`, which is in the parameter's unit, if it is finite and in the parameter's range.
    fn in_range(&self, number: &Number, param: &Param, value: f64) -> Result<f64, Box<Diagnostic>> {
        let unit = param.unit.map(|unit| format!(" {}", unit.name)).unwrap_or_default();
        if !value.is_finite() {
            let message = format!("`{}` is too large a number", number.digits());
            return Err(Diagnostic::new(Code::E0304, message, number.span, "no robot can do that").into());
        }
        if param.except == Some(value) {
            return Err(self.excluded(number, param, value).into());
        }
        let Some((least, most)) = param.range.filter(|(least, most)| value < *least || value > *most) else {
            return Ok(value);
        };
        let quark = &self.declaration.name;
        let here = match number.unit() {
            None if number.digits().parse() == Ok(value) => format!("`{}` is {}{unit}", param.name, number.digits()),
            None | Some(_) => format!("`{}` is {value}{unit}", param.name),
        };
        if self.declaration.origin == Origin::Target {
            let message = format!("`{}` cannot do this: `{quark}` takes {}", self.robot, allowed(param, least, most));
            let report = Diagnostic::new(Code::E0402, message, number.span, here);
            return Err(meant_in_range(report, number, param, self.declaration).into());
        }
        let message = format!("`{quark}` takes {}", allowed(param, least, most));
        let report =
            meant_in_range(Diagnostic::new(Code::E0304, message, number.span, here), number, param, self.declaration);
        Err(too_long(report, number, param, quark).into())
    }

    /// Reports a number that is the only value excluded from the parameter's range.
    fn excluded(&self, number: &Number, param: &Param, value: f64) -> Diagnostic {
        let unit = param.unit.map(|unit| unit.name).unwrap_or_default();
        let (quark, name) = (&self.declaration.name, &param.name);
        let message = format!("`{quark}` takes any `{name}` but {value}");
        let here = format!("`{name}` is {value} {unit}");
        let report = Diagnostic::new(Code::E0304, message, number.span, here.trim_end().to_owned());
        let other = example(param).unwrap_or_else(|| format!("1{unit}"));
        report.help(format!("write another {}, such as `{quark} {other}`", param.kind.words().replace("a ", "")))
    }

    fn wrong_unit(&self, number: &Number, param: &Param) -> Diagnostic {
        let found = number.unit().unwrap_or_default();
        let what = Unit::from_name(found).map_or_else(|| format!("`{found}`"), |unit| unit.kind.words());
        let message = format!("expected {}, found {what}", param.kind.words());
        let here = format!("`{}` of `{}` is {}", param.name, self.declaration.name, param.kind.words());
        let units: Vec<_> = Unit::ALL.iter().filter(|unit| unit.kind == param.kind).map(|unit| unit.name).collect();
        let report = Diagnostic::new(Code::E0303, message, number.span, here);
        let report = match (param.kind, found) {
            (ParameterKind::Time, "m") => {
                report.fix("for minutes write {}", number.span, format!("{}min", number.digits()))
            }
            _ => report,
        };
        match units.split_last() {
            Some((last, [])) => report.help(format!("its unit is {last}")),
            Some((last, others)) => report.help(format!("its unit is {} or {last}", others.join(", "))),
            None if param.kind == ParameterKind::Sonar => faces(report, number),
            None => report.help("write it without a unit"),
        }
    }
}

/// Reports a number with digits after its dot where a whole number is expected.
fn not_whole(number: &Number, param: &Param) -> Diagnostic {
    let message = format!("expected {}, found `{}`", param.kind.words(), number.digits());
    let report = Diagnostic::new(Code::E0302, message, number.span, "not a whole number");
    if param.kind == ParameterKind::Sonar { report.help(DIRECTIONS) } else { report }
}

fn not_a_number(number: &Number) -> Diagnostic {
    Diagnostic::new(
        Code::E0304,
        format!("`{}` is too large or too small a number", number.digits()),
        number.span,
        "here",
    )
}

pub(super) fn bits(number: &Number, length: u32) -> Fitted {
    let digits = number.digits().as_bytes();
    let all_bits = digits.iter().all(|digit| matches!(digit, b'0' | b'1'));
    if number.unit().is_some() || !all_bits || digits.len() != length as usize {
        let message = format!("expected {length} digits 0 or 1, found `{}`", number.digits());
        let here = match digits.iter().find(|digit| !matches!(digit, b'0' | b'1')) {
            Some(digit) => format!("`{}` is not a bit", char::from(*digit)),
            None if number.unit().is_some() => "bits have no unit".into(),
            None if digits.len() == 1 => "this is 1 digit".into(),
            None => format!("these are {} digits", digits.len()),
        };
        let report = Diagnostic::new(Code::E0302, message, number.span, here);
        return Err(report.help(BITS).into());
    }
    let bits = digits.iter().map(|digit| *digit == b'1').collect();
    Ok((Value::Bits(bits), number.digits().to_owned()))
}

/// Converts an exact value from the unit `from` to the unit `to`, and returns the nearest `f64`.
fn converted(exact: &Decimal, from: Unit, to: Unit) -> f64 {
    if from.family != to.family {
        return exact.to_f64() * from.family_to_si() / to.family_to_si() / f64::from(to.factor);
    }
    exact.scaled(1, -to.exponent).to_f64() / f64::from(to.factor)
}

/// Appends help to a message about a time that is too long: the text that waits for ever, or an example of a time.
fn too_long(report: Diagnostic, number: &Number, param: &Param, quark: &str) -> Diagnostic {
    if param.kind != ParameterKind::Time || number.digits().starts_with('-') {
        return report;
    }
    match example(param) {
        _ if quark == "wait" => report.fix("to wait for ever write {}", number.span, "inf"),
        Some(example) => report.fix("for instance {}", number.span, example),
        None => report,
    }
}
