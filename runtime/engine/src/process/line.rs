//! Converts values to and from the JSON lines of a child process.

use mdle_compiler::alphabet::Unit;
use mdle_runtime::{Meters, MetersPerSecond, Nanos, Pose, Radians, RadiansPerSecond, Volts};
use serde_json::{Map, Value as Json, json};

use super::shown;
use crate::attribute::{AttributeKind, Value};

/// Kinds without units, each with its word in a declaration.
const WORDS: [(&str, AttributeKind); 6] = [
    ("flag", AttributeKind::Flag),
    ("integer", AttributeKind::Integer),
    ("number", AttributeKind::Number),
    ("pose", AttributeKind::Pose),
    ("text", AttributeKind::Text),
    ("numbers", AttributeKind::Numbers),
];

/// Kinds with units. In a declaration, the unit is the word for the kind.
const QUANTITIES: [AttributeKind; 6] = [
    AttributeKind::Length,
    AttributeKind::Speed,
    AttributeKind::Angle,
    AttributeKind::AngularRate,
    AttributeKind::Voltage,
    AttributeKind::Time,
];

/// Kind of an attribute's values, and the unit in which lines contain these values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LineForm {
    pub(super) kind: AttributeKind,
    pub(super) unit: Option<Unit>,
}

impl LineForm {
    /// Returns the form for this word: a unit, or the name of a kind without units; `None` for any other word.
    pub(super) fn from_word(word: &str) -> Option<Self> {
        if let Some((_, kind)) = WORDS.into_iter().find(|(name, _)| *name == word) {
            return Some(Self { kind, unit: None });
        }
        let unit = Unit::from_name(word)?;
        let kind = QUANTITIES.into_iter().find(|kind| kind.quantity() == Some(unit.kind))?;
        Some(Self { kind, unit: Some(unit) })
    }

    /// Returns the words of all forms, separated by commas.
    pub(super) fn words() -> String {
        let units = Unit::ALL.iter().map(|unit| unit.name).filter(|name| Self::from_word(name).is_some());
        let words: Vec<_> = units.chain(WORDS.map(|(word, _)| word)).collect();
        words.join(", ")
    }

    /// Converts `json`, a value from a line, to a value of this form.
    ///
    /// # Errors
    /// Fails with a description of the expected value.
    pub(super) fn read(self, json: &Json) -> Result<Value, String> {
        let Self { kind, unit } = self;
        let numbers = |count: usize| {
            let numbers: Option<Vec<_>> = json.as_array()?.iter().map(number).collect();
            numbers.filter(|numbers| count == 0 || numbers.len() == count)
        };
        let number = || number(json).map(|number| unit.map_or(number, |unit| unit.to_si(number)));
        let value = match kind {
            AttributeKind::Flag => json.as_bool().map(Value::Flag),
            AttributeKind::Integer => json.as_i64().map(Value::Integer),
            AttributeKind::Number => number().map(Value::Number),
            AttributeKind::Length => number().map(|number| Value::Length(Meters(number))),
            AttributeKind::Speed => number().map(|number| Value::Speed(MetersPerSecond(number))),
            AttributeKind::Angle => number().map(|number| Value::Angle(Radians(number))),
            AttributeKind::AngularRate => number().map(|number| Value::AngularRate(RadiansPerSecond(number))),
            AttributeKind::Voltage => number().map(|number| Value::Voltage(Volts(number))),
            AttributeKind::Time => number().and_then(nanos).map(Value::Time),
            AttributeKind::Pose => numbers(3).and_then(|numbers| pose(&numbers)).map(Value::Pose),
            AttributeKind::Text => json.as_str().map(|text| Value::Text(text.into())),
            AttributeKind::Numbers => numbers(0).map(|numbers| Value::Numbers(numbers.into())),
            AttributeKind::Bytes => None,
        };
        value.ok_or_else(|| self.expected())
    }

    /// Returns a description of the value that a line must contain.
    fn expected(self) -> String {
        match (self.kind, self.unit) {
            (AttributeKind::Flag, _) => "true or false".to_owned(),
            (AttributeKind::Integer, _) => "a whole number".to_owned(),
            (AttributeKind::Pose, _) => "three numbers, `[x, y, theta]` in m and rad".to_owned(),
            (AttributeKind::Text, _) => "a text".to_owned(),
            (AttributeKind::Numbers, _) => "a list of numbers".to_owned(),
            (AttributeKind::Time, Some(unit)) => format!("a time in {} of at least 0", unit.name),
            (_, Some(unit)) => format!("a number, in {}", unit.name),
            (_, None) => "a number".to_owned(),
        }
    }

    /// Converts a value to this form for a line; a number that is not finite becomes `null`.
    pub(super) fn write(self, value: &Value) -> Json {
        match value {
            Value::Flag(flag) => json!(flag),
            Value::Integer(number) => json!(number),
            Value::Pose(Pose { x, y, theta }) => json!([x.0, y.0, theta.0]),
            Value::Text(text) => json!(**text),
            Value::Numbers(numbers) => json!(**numbers),
            Value::Bytes(bytes) => json!(**bytes),
            Value::Number(_)
            | Value::Length(_)
            | Value::Speed(_)
            | Value::Angle(_)
            | Value::AngularRate(_)
            | Value::Voltage(_)
            | Value::Time(_) => {
                let number = value.number().unwrap_or(f64::NAN);
                json!(self.unit.map_or(number, |unit| number / unit.to_si(1.0)))
            }
        }
    }
}

/// Reads a number from a line; `None` if the value is not a number. Infinite numbers and NaN are strings in `json`,
/// because JSON cannot represent them as numbers.
fn number(json: &Json) -> Option<f64> {
    match json.as_str() {
        Some("NaN") => Some(f64::NAN),
        Some("Infinity") => Some(f64::INFINITY),
        Some("-Infinity") => Some(f64::NEG_INFINITY),
        Some(_) => None,
        None => json.as_f64(),
    }
}

/// Converts seconds to a time; `None` if they are negative, not finite or too large.
pub(super) fn nanos(seconds: f64) -> Option<Nanos> {
    let time = std::time::Duration::try_from_secs_f64(seconds).ok()?;
    u64::try_from(time.as_nanos()).ok().map(Nanos)
}

fn pose(numbers: &[f64]) -> Option<Pose> {
    let [x, y, theta] = numbers else { return None };
    Some(Pose { x: Meters(*x), y: Meters(*y), theta: Radians(*theta) })
}

/// Parses a line that contains a JSON object. Also accepts `NaN` and `Infinity`, which Python prints although they are
/// not JSON.
///
/// # Errors
/// Fails with a sentence if the line is not a JSON object.
pub(super) fn object(line: &[u8]) -> Result<Map<String, Json>, String> {
    let refused = |reason: String| {
        format!(
            "its process printed {}, which is no object of JSON: {reason}\nhelp: print messages to standard error, as \
             standard output is for answers",
            shown(line)
        )
    };
    let text = std::str::from_utf8(line).map_err(|_| refused("it is not UTF-8 text".to_owned()))?;
    if text.trim().is_empty() {
        return Err(refused("it is empty".to_owned()));
    }
    let read = serde_json::from_str(text);
    let read = read.or_else(|error| serde_json::from_str(&quoted(text)).map_err(|_| error));
    match read {
        Ok(Json::Object(object)) => Ok(object),
        Ok(_) => Err(refused("it is not in braces".to_owned())),
        Err(error) => {
            let reason = error.to_string();
            Err(refused(reason.replace(" at line 1 column", " at column")))
        }
    }
}

/// Puts quotes around `NaN` and infinite numbers, except inside strings.
fn quoted(text: &str) -> String {
    const WORDS: [&str; 3] = ["-Infinity", "Infinity", "NaN"];
    let (mut result, mut rest, mut is_text) = (String::new(), text, false);
    while let Some(next) = rest.chars().next() {
        let word = WORDS.into_iter().find(|word| !is_text && rest.starts_with(word));
        let length = match word {
            Some(word) => {
                result += &format!("\"{word}\"");
                word.len()
            }
            None => {
                is_text ^= next == '"';
                let escaped = rest.chars().nth(1).filter(|_| is_text && next == '\\');
                let length = next.len_utf8() + escaped.map_or(0, char::len_utf8);
                result.push_str(rest.get(..length).unwrap_or_default());
                length
            }
        };
        rest = rest.get(length..).unwrap_or_default();
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_comes_back_as_it_was() {
        let values = [
            ("flag", Value::Flag(true)),
            ("integer", Value::Integer(-7)),
            ("number", Value::Number(0.1)),
            ("cm", Value::Length(Meters(0.25))),
            ("mm/s", Value::Speed(MetersPerSecond(-0.5))),
            ("rad", Value::Angle(Radians(1.25))),
            ("rad/s", Value::AngularRate(RadiansPerSecond(2.0))),
            ("V", Value::Voltage(Volts(12.0))),
            ("ms", Value::Time(Nanos(1_500_000))),
            ("pose", Value::Pose(Pose { x: Meters(1.0), y: Meters(-2.0), theta: Radians(0.5) })),
            ("text", Value::Text("NaN \"".into())),
            ("numbers", Value::Numbers([1.0, 2.5].into())),
        ];
        for (word, value) in values {
            let form = LineForm::from_word(word).unwrap();
            assert_eq!(form.read(&form.write(&value)), Ok(value), "{word}");
        }
        assert_eq!(LineForm::from_word("Hz"), None);
        assert_eq!(
            LineForm::from_word("deg").unwrap().read(&json!(180)),
            Ok(Value::Angle(Radians(std::f64::consts::PI)))
        );
    }

    #[test]
    fn numbers_that_python_prints_are_read() {
        let line = br#"{"a": NaN, "b": [-Infinity, Infinity], "NaN": "\" NaN"}"#;
        let object = object(line).unwrap();
        assert!(LineForm::from_word("m").unwrap().read(&object["a"]).unwrap().has_nan());
        let numbers = LineForm::from_word("numbers").unwrap().read(&object["b"]);
        assert_eq!(numbers, Ok(Value::Numbers([f64::NEG_INFINITY, f64::INFINITY].into())));
        assert_eq!(object["NaN"], json!("\" NaN"));
        assert_eq!(LineForm::from_word("m").unwrap().write(&Value::Length(Meters(f64::INFINITY))), Json::Null);
    }
}
