//! Values of attributes, as they are shown and typed: quantities have the units of plans.

use std::fmt;

use mdle_quantity::Quantity;

use super::Kind;

/// A value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Of [`Kind::Flag`].
    Flag(bool),
    /// Of [`Kind::Integer`].
    Integer(u64),
    /// Of [`Kind::Quantity`], in the unit of the kind.
    Quantity(f64, &'static str),
    /// Of [`Kind::Text`].
    Text(String),
}

impl fmt::Display for Value {
    /// Writes the value as it may be typed: quantities to a millionth.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Integer(number) => write!(f, "{number}"),
            Self::Quantity(number, _) if number.is_infinite() => write!(f, "none"),
            Self::Quantity(number, unit) => {
                let text = format!("{number:.6}");
                let text = text.trim_end_matches('0').trim_end_matches('.');
                write!(f, "{}{unit}", if text == "-0" { "0" } else { text })
            }
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// Reads a value of this kind.
///
/// # Errors
/// A sentence with what to type instead.
pub fn read(text: &str, kind: Kind) -> Result<Value, String> {
    match kind {
        Kind::Flag => match text {
            "true" => Ok(Value::Flag(true)),
            "false" => Ok(Value::Flag(false)),
            _ => Err(format!("expected true or false, found `{text}`")),
        },
        Kind::Integer => {
            let number = text.parse().ok().filter(|_| text.bytes().all(|byte| byte.is_ascii_digit()));
            number.map(Value::Integer).ok_or_else(|| format!("expected a whole number, found `{text}`"))
        }
        Kind::Quantity(quantity, unit) => quantity_of(text, quantity, unit),
        Kind::Text => Ok(Value::Text(text.to_owned())),
    }
}

fn quantity_of(text: &str, quantity: Quantity, unit: &'static str) -> Result<Value, String> {
    if text.parse::<f64>().is_ok_and(f64::is_finite) {
        return Err(format!("`{text}` has no unit: write `{text}{unit}`"));
    }
    let read = quantity.read(text, unit);
    // A number alone has been refused.
    let number = read.map_err(|refusal| refusal.replace(&format!(", or a number in {unit}"), ""))?;
    Ok(Value::Quantity(number, unit))
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
        let speed = Kind::Quantity(Quantity::Speed, "m/s");
        assert_eq!(read("40cm/s", speed), Ok(Value::Quantity(0.4, "m/s")));
        assert_eq!(
            (read("true", Kind::Flag), read("7", Kind::Integer)),
            (Ok(Value::Flag(true)), Ok(Value::Integer(7)))
        );
    }

    #[test]
    fn a_wrong_value_is_refused_with_what_to_type() {
        let speed = Kind::Quantity(Quantity::Speed, "m/s");
        let refused = [
            ("40", speed),
            ("1.2ft", speed),
            ("40knots", speed),
            ("fast", speed),
            ("NaN", speed),
            ("", speed),
            ("yes", Kind::Flag),
            ("-1", Kind::Integer),
            ("+1", Kind::Integer),
            ("1.5", Kind::Integer),
            ("99999999999999999999", Kind::Integer),
        ];
        insta::assert_snapshot!(refused.map(|(text, kind)| read(text, kind).unwrap_err()).join("\n"), @"
        `40` has no unit: write `40m/s`
        `1.2ft` is a length: expected a speed in m/s, cm/s, mm/s, in/s
        there is no unit `knots`: expected a speed in m/s, cm/s, mm/s, in/s
        `fast` is not a number with a unit: expected a speed, such as `5m/s`
        `NaN` is not a number with a unit: expected a speed, such as `5m/s`
        `` is not a number with a unit: expected a speed, such as `5m/s`
        expected true or false, found `yes`
        expected a whole number, found `-1`
        expected a whole number, found `+1`
        expected a whole number, found `1.5`
        expected a whole number, found `99999999999999999999`
        ");
    }
}
