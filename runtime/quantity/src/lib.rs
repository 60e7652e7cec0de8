//! Reads and formats quantities for people. Reads the values of options, which are a number alone or a number with a
//! unit as in a plan. Formats measured values in the words of a plan. Also suggests known names that are similar to an
//! unknown name, and explains mistakes in TOML files.

mod measured;
mod near;
mod rounded;
mod toml_keys;

use std::time::Duration;

pub use measured::{cause_text, file_line, operand_words};
pub use near::{did_you_mean, nearest};
pub use rounded::{Clocked, rounded};
pub use toml_keys::{TomlKeys, TomlMistake};

/// A kind of quantity that an option can have as its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A time, in seconds.
    Time,
    /// A length, in metres.
    Length,
    /// An angle, in degrees.
    Angle,
    /// A speed, in metres per second.
    Speed,
    /// A turn rate, in degrees per second.
    TurnRate,
    /// An acceleration, in metres per second squared.
    Acceleration,
    /// A voltage, in volts.
    Voltage,
    /// A frequency, in hertz.
    Frequency,
}

/// A unit: its name, and the factor and the divisor that convert a number with this unit to the unit of its
/// [`Quantity`].
type Unit = (&'static str, f64, f64);

impl Quantity {
    const ALL: [Self; 8] = [
        Self::Time,
        Self::Length,
        Self::Angle,
        Self::Speed,
        Self::TurnRate,
        Self::Acceleration,
        Self::Voltage,
        Self::Frequency,
    ];

    /// Reads a finite number followed by a unit, such as `3s`; `bare` is the unit of a number alone. The result is in
    /// the unit of the variant.
    ///
    /// # Errors
    /// Fails if the text is not a number with a unit of this kind; the message contains the correction.
    pub fn read(self, text: &str, bare: &str) -> Result<f64, String> {
        let is_unit = |letter: char| !letter.is_ascii() || letter.is_ascii_alphabetic() && !matches!(letter, 'e' | 'E');
        let (digits, unit) = text.split_at(text.find(is_unit).unwrap_or(text.len()));
        let number = digits.parse().ok().filter(|number: &f64| number.is_finite());
        let number = number.ok_or_else(|| self.no_number(text, bare))?;
        let name = if unit.is_empty() { bare } else { unit };
        let (_, factor, divisor) =
            self.units().iter().find(|known| known.0 == name).ok_or_else(|| self.no_unit(text, digits, unit, bare))?;
        Ok(number * factor / divisor)
    }

    /// Reads a time as [`Quantity::read`] does.
    ///
    /// # Errors
    /// Fails if the text is not a time from `least` to `most`; the message contains the correction.
    pub fn duration(text: &str, bare: &str, least: Duration, most: Duration) -> Result<Duration, String> {
        let read = Duration::try_from_secs_f64(Self::Time.read(text, bare)?).ok();
        read.filter(|duration| (least..=most).contains(duration))
            .ok_or_else(|| format!("expected a time from {least:?} to {most:?}"))
    }

    /// Returns the quantity that has this unit, and the factor and the divisor that convert a number with this unit;
    /// `None` if there is no such unit.
    #[must_use]
    pub fn of_unit(name: &str) -> Option<(Self, f64, f64)> {
        Self::ALL.into_iter().find_map(|kind| {
            let unit = kind.units().iter().find(|unit| unit.0 == name);
            unit.map(|(_, factor, divisor)| (kind, *factor, *divisor))
        })
    }

    fn units(self) -> &'static [Unit] {
        match self {
            Self::Time => &[("s", 1.0, 1.0), ("ms", 1.0, 1000.0), ("min", 60.0, 1.0), ("h", 3600.0, 1.0)],
            Self::Length => &[
                ("m", 1.0, 1.0),
                ("cm", 1.0, 100.0),
                ("mm", 1.0, 1000.0),
                ("in", 254.0, 10_000.0),
                ("ft", 3048.0, 10_000.0),
            ],
            Self::Angle => &[("deg", 1.0, 1.0), ("rad", 180.0, std::f64::consts::PI)],
            Self::Speed => &[("m/s", 1.0, 1.0), ("cm/s", 1.0, 100.0), ("mm/s", 1.0, 1000.0), ("in/s", 254.0, 10_000.0)],
            Self::TurnRate => &[("deg/s", 1.0, 1.0), ("rad/s", 180.0, std::f64::consts::PI)],
            Self::Acceleration => &[("m/s2", 1.0, 1.0), ("cm/s2", 1.0, 100.0), ("mm/s2", 1.0, 1000.0)],
            Self::Voltage => &[("V", 1.0, 1.0)],
            Self::Frequency => &[("Hz", 1.0, 1.0)],
        }
    }

    /// Returns the name of the quantity with its article, such as "a time".
    fn words(self) -> &'static str {
        match self {
            Self::Time => "a time",
            Self::Length => "a length",
            Self::Angle => "an angle",
            Self::Speed => "a speed",
            Self::TurnRate => "a turn rate",
            Self::Acceleration => "an acceleration",
            Self::Voltage => "a voltage",
            Self::Frequency => "a frequency",
        }
    }

    fn no_number(self, text: &str, bare: &str) -> String {
        format!("`{text}` is not a number with a unit: expected {}, such as `5{bare}`", self.words())
    }

    fn no_unit(self, text: &str, digits: &str, unit: &str, bare: &str) -> String {
        let units = self.units().iter().map(|unit| unit.0).collect::<Vec<_>>().join(", ");
        let expected = format!("expected {} in {units}, or a number in {bare}", self.words());
        match Self::ALL.into_iter().find(|kind| kind.units().iter().any(|known| known.0 == unit)) {
            // Minutes are often written with this unit.
            Some(Self::Length) if self == Self::Time && unit == "m" => {
                format!("`{text}` is a length: {expected}; did you mean `{digits}min`?")
            }
            Some(other) => format!("`{text}` is {}: {expected}", other.words()),
            None => format!("there is no unit `{unit}`: {expected}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(text: &str) -> Result<Duration, String> {
        Quantity::duration(text, "s", Duration::from_nanos(1), Duration::from_secs(100_000))
    }

    #[test]
    fn a_number_alone_is_in_the_unit_of_the_option() {
        assert_eq!(time("0.3"), Ok(Duration::from_nanos(300_000_000)));
        assert_eq!(time("86400.1"), Ok(Duration::from_millis(86_400_100)));
        assert_eq!(Quantity::Time.read("250", "ms"), Ok(0.25));
        assert_eq!(Quantity::Angle.read("90", "deg"), Ok(90.0));
        assert_eq!(Quantity::Length.read("-1e-1", "m"), Ok(-0.1));
    }

    #[test]
    fn a_unit_touches_its_number() {
        for (text, nanos) in
            [("3s", 3e9), ("100ms", 1e8), ("33.333333ms", 33_333_333.0), ("1.5min", 9e10), ("2h", 7.2e12)]
        {
            assert_eq!(time(text), Ok(Duration::from_nanos(nanos as u64)), "{text}");
        }
        let length = |text| Quantity::Length.read(text, "m");
        assert_eq!(["20cm", "5mm", "10in", "1ft", "-2m"].map(length), [0.2, 0.005, 0.254, 0.3048, -2.0].map(Ok));
        assert_eq!(Quantity::Acceleration.read("-50cm/s2", "m/s2"), Ok(-0.5));
        assert_eq!(Quantity::Angle.read("1.5rad", "deg"), Ok(1.5 * 180.0 / std::f64::consts::PI));
    }

    #[test]
    fn what_is_no_quantity_is_refused_with_what_is_meant() {
        let texts = ["", "fast", "NaN", "inf", "1e999", "3 s", "3m", "3sec", "90°", "1s1", "0", "-1s", "30h", "٣s"];
        let refused = texts.map(|text| time(text).expect_err(text));
        insta::assert_snapshot!(refused.join("\n"), @"
        `` is not a number with a unit: expected a time, such as `5s`
        `fast` is not a number with a unit: expected a time, such as `5s`
        `NaN` is not a number with a unit: expected a time, such as `5s`
        `inf` is not a number with a unit: expected a time, such as `5s`
        `1e999` is not a number with a unit: expected a time, such as `5s`
        `3 s` is not a number with a unit: expected a time, such as `5s`
        `3m` is a length: expected a time in s, ms, min, h, or a number in s; did you mean `3min`?
        there is no unit `sec`: expected a time in s, ms, min, h, or a number in s
        there is no unit `°`: expected a time in s, ms, min, h, or a number in s
        there is no unit `s1`: expected a time in s, ms, min, h, or a number in s
        expected a time from 1ns to 100000s
        expected a time from 1ns to 100000s
        expected a time from 1ns to 100000s
        `٣s` is not a number with a unit: expected a time, such as `5s`
        ");
        let refused = [(Quantity::Length, "3kg", "m"), (Quantity::Angle, "3m", "deg"), (Quantity::Time, "x", "ms")]
            .map(|(kind, text, bare)| kind.read(text, bare).expect_err(text));
        insta::assert_snapshot!(refused.join("\n"), @"
        there is no unit `kg`: expected a length in m, cm, mm, in, ft, or a number in m
        `3m` is a length: expected an angle in deg, rad, or a number in deg
        `x` is not a number with a unit: expected a time, such as `5ms`
        ");
    }
}
