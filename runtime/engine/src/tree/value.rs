//! Values of attributes as they are shown and typed; quantities have the units of the plan language.

use std::fmt::{self, Write as _};
use std::sync::Arc;
use std::time::Duration;

use mdle_quantity::Quantity;

use super::ValueKind;

/// A value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A value of [`ValueKind::Flag`].
    Flag(bool),
    /// A value of [`ValueKind::Integer`].
    Integer(i64),
    /// A value of [`ValueKind::Number`].
    Number(f64),
    /// A value of [`ValueKind::Quantity`], in the unit of the kind.
    Quantity(f64, &'static str),
    /// A value of [`ValueKind::Text`].
    Text(Arc<str>),
    /// A value of [`ValueKind::Pose`]: two lengths in metres and an angle in degrees.
    Pose([f64; 3]),
    /// A value of [`ValueKind::Numbers`].
    Numbers(Arc<[f64]>),
    /// A value of [`ValueKind::Bytes`].
    Bytes(Arc<[u8]>),
}

impl Value {
    /// Returns text as a value.
    #[must_use]
    pub fn text(text: &str) -> Self {
        Self::Text(text.into())
    }

    /// Returns a time as a value in milliseconds.
    #[must_use]
    pub fn milliseconds(time: Duration) -> Self {
        Self::Quantity(time.as_secs_f64() * 1e3, "ms")
    }

    /// Returns a count as a value.
    #[must_use]
    pub fn count(count: u64) -> Self {
        Self::Integer(i64::try_from(count).unwrap_or(i64::MAX))
    }
}

impl fmt::Display for Value {
    /// Writes the value as users can type it; numbers with units are rounded to a millionth.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Integer(number) => write!(f, "{number}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Quantity(number, unit) => write!(f, "{}", Rounded(*number, unit)),
            Self::Text(text) => f.write_str(text),
            Self::Pose([x, y, theta]) => {
                write!(f, "{} {} {}", Rounded(*x, "m"), Rounded(*y, "m"), Rounded(*theta, "deg"))
            }
            Self::Numbers(numbers) => separated(f, numbers.iter()),
            Self::Bytes(bytes) => bytes.iter().try_for_each(|byte| write!(f, "{byte:02x}")),
        }
    }
}

/// A number with its unit, rounded to a millionth; infinity is shown as `none`.
struct Rounded(f64, &'static str);

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(number, unit) = self;
        if number.is_infinite() {
            return f.write_str("none");
        }
        let text = format!("{number:.6}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        write!(f, "{}{unit}", if text == "-0" { "0" } else { text })
    }
}

fn separated<T: fmt::Display>(f: &mut fmt::Formatter<'_>, parts: impl Iterator<Item = T>) -> fmt::Result {
    for (place, part) in parts.enumerate() {
        if place > 0 {
            f.write_char(' ')?;
        }
        write!(f, "{part}")?;
    }
    Ok(())
}

/// Reads a value of this kind.
///
/// # Errors
/// Fails with a sentence that explains what to type instead.
pub fn read(text: &str, kind: ValueKind) -> Result<Value, String> {
    match kind {
        ValueKind::Flag => match text {
            "true" => Ok(Value::Flag(true)),
            "false" => Ok(Value::Flag(false)),
            _ => Err(format!("expected true or false, found `{text}`")),
        },
        ValueKind::Integer => {
            let digits = text.strip_prefix('-').unwrap_or(text);
            let number = text.parse().ok().filter(|_| digits.bytes().all(|byte| byte.is_ascii_digit()));
            number.map(Value::Integer).ok_or_else(|| format!("expected a whole number, found `{text}`"))
        }
        ValueKind::Number => {
            number(text).map(Value::Number).ok_or_else(|| format!("expected a number, found `{text}`"))
        }
        ValueKind::Quantity(quantity, unit) => {
            quantity_of(text, quantity, unit).map(|number| Value::Quantity(number, unit))
        }
        ValueKind::Text => Ok(Value::text(text)),
        ValueKind::Pose => {
            let [x, y, theta] = text.split_whitespace().collect::<Vec<_>>()[..] else {
                return Err(format!("expected two lengths and an angle, such as `1m 0.5m 90deg`; found `{text}`"));
            };
            let length = |text| quantity_of(text, Quantity::Length, "m");
            Ok(Value::Pose([length(x)?, length(y)?, quantity_of(theta, Quantity::Angle, "deg")?]))
        }
        ValueKind::Numbers => {
            let numbers: Option<Vec<f64>> = text.split_whitespace().map(number).collect();
            let numbers = numbers.ok_or_else(|| format!("expected numbers between spaces, found `{text}`"))?;
            Ok(Value::Numbers(numbers.into()))
        }
        ValueKind::Bytes => {
            let pairs = text.as_bytes().chunks(2);
            let byte = |pair: &[u8]| match pair {
                [first, second] if first.is_ascii_hexdigit() && second.is_ascii_hexdigit() => {
                    u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()
                }
                [..] => None,
            };
            let bytes: Option<Vec<u8>> = pairs.map(byte).collect();
            let bytes = bytes.ok_or_else(|| format!("expected two hexadecimal digits a byte, found `{text}`"))?;
            Ok(Value::Bytes(bytes.into()))
        }
    }
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Reads a number with a unit of this quantity, and converts it to `unit`.
fn quantity_of(text: &str, quantity: Quantity, unit: &str) -> Result<f64, String> {
    if let Some(number) = number(text) {
        if quantity == Quantity::Time && number < 0.0 {
            return Err(format!("expected a time of at least 0{unit}, found `{text}`"));
        }
        let smaller = Quantity::of_unit(&format!("c{unit}")).filter(|(other, ..)| *other == quantity);
        let smaller = smaller.map_or_else(String::new, |_| format!("`{text}c{unit}` or "));
        return Err(format!("`{text}` has no unit: write {smaller}`{text}{unit}`"));
    }
    let read = quantity.read(text, unit);
    // A number without a unit was refused above.
    let number = read.map_err(|refusal| refusal.replace(&format!(", or a number in {unit}"), ""))?;
    let (_, factor, divisor) = Quantity::of_unit(unit).unwrap_or((quantity, 1.0, 1.0));
    Ok(number * divisor / factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_shown_as_it_may_be_typed() {
        let shown = |number, unit| Value::Quantity(number, unit).to_string();
        assert_eq!(shown(0.4, "m/s"), "0.4m/s");
        assert_eq!(shown(-0.000_000_1, "m"), "0m");
        assert_eq!(shown(1e3 / 3.0, "deg"), "333.333333deg");
        assert_eq!(shown(100.0, "s"), "100s");
        let speed = ValueKind::Quantity(Quantity::Speed, "m/s");
        assert_eq!(read("40cm/s", speed), Ok(Value::Quantity(0.4, "m/s")));
        assert_eq!(
            (read("true", ValueKind::Flag), read("7", ValueKind::Integer)),
            (Ok(Value::Flag(true)), Ok(Value::Integer(7)))
        );
        let length = ValueKind::Quantity(Quantity::Length, "cm");
        assert_eq!(read("1.5m", length), Ok(Value::Quantity(150.0, "cm")));
        let typed = [
            ("-7", ValueKind::Integer),
            ("0.1", ValueKind::Number),
            ("1m -0.5m 90deg", ValueKind::Pose),
            ("1 -2.5 1000", ValueKind::Numbers),
            ("00ff7a", ValueKind::Bytes),
            ("", ValueKind::Numbers),
        ];
        for (text, kind) in typed {
            assert_eq!(read(text, kind).map(|value| value.to_string()), Ok(text.to_owned()));
        }
    }

    #[test]
    fn a_wrong_value_is_refused_with_what_to_type() {
        let speed = ValueKind::Quantity(Quantity::Speed, "m/s");
        let refused = [
            ("40", speed),
            ("1.2ft", speed),
            ("40knots", speed),
            ("fast", speed),
            ("NaN", speed),
            ("", speed),
            ("-1", ValueKind::Quantity(Quantity::Time, "s")),
            ("-1", ValueKind::Quantity(Quantity::Length, "m")),
            ("yes", ValueKind::Flag),
            ("+1", ValueKind::Integer),
            ("1.5", ValueKind::Integer),
            ("99999999999999999999", ValueKind::Integer),
            ("inf", ValueKind::Number),
            ("1m 2m", ValueKind::Pose),
            ("1m 2m 3", ValueKind::Pose),
            ("1 x", ValueKind::Numbers),
            ("0", ValueKind::Bytes),
            ("+1é", ValueKind::Bytes),
        ];
        insta::assert_snapshot!(refused.map(|(text, kind)| read(text, kind).unwrap_err()).join("\n"), @"
        `40` has no unit: write `40cm/s` or `40m/s`
        `1.2ft` is a length: expected a speed in m/s, cm/s, mm/s, in/s
        there is no unit `knots`: expected a speed in m/s, cm/s, mm/s, in/s
        `fast` is not a number with a unit: expected a speed, such as `5m/s`
        `NaN` is not a number with a unit: expected a speed, such as `5m/s`
        `` is not a number with a unit: expected a speed, such as `5m/s`
        expected a time of at least 0s, found `-1`
        `-1` has no unit: write `-1cm` or `-1m`
        expected true or false, found `yes`
        expected a whole number, found `+1`
        expected a whole number, found `1.5`
        expected a whole number, found `99999999999999999999`
        expected a number, found `inf`
        expected two lengths and an angle, such as `1m 0.5m 90deg`; found `1m 2m`
        `3` has no unit: write `3deg`
        expected numbers between spaces, found `1 x`
        expected two hexadecimal digits a byte, found `0`
        expected two hexadecimal digits a byte, found `+1é`
        ");
    }
}
