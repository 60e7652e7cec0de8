//! Formats values and lines of a configuration file for messages. The result uses plain words, and its length is
//! limited.

use toml::Value;

/// Maximum number of characters of a text in a message.
const LETTERS: usize = 60;
/// Size from which a number is written with an exponent. The same applies to numbers closer to zero than the inverse of
/// this size.
const LARGE: f64 = 1e15;

/// Returns `text`, truncated to the maximum length in a message.
#[must_use]
pub fn shortened(text: &str) -> String {
    match text.char_indices().nth(LETTERS) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// Formats a number for a message.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    let is_plain = !value.is_finite() || size == 0.0 || (LARGE.recip()..=LARGE).contains(&size);
    if is_plain { value.to_string() } else { format!("{value:e}") }
}

/// Formats a value of a file for a message.
pub(crate) fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => shortened(&format!("{text:?}")),
        Value::Integer(value) => value.to_string(),
        // A float keeps its decimal point, even if its value is whole.
        Value::Float(value) if value.fract() == 0.0 && value.abs() <= LARGE => format!("{value:.1}"),
        Value::Float(value) => number(*value),
        Value::Boolean(value) => value.to_string(),
        Value::Datetime(_) => "a date or time".to_owned(),
        Value::Array(values) => {
            let values: Vec<_> = values.iter().map(shown).collect();
            shortened(&format!("[{}]", values.join(", ")))
        }
        Value::Table(values) => {
            let values: Vec<_> = values.iter().map(|(key, value)| format!("{key} = {}", shown(value))).collect();
            shortened(&format!("{{ {} }}", values.join(", ")))
        }
    }
}

/// Returns the message about a text that is not TOML. It contains the line number, the error, and the beginning of the
/// line.
pub(crate) fn syntax_error(text: &str, error: &toml::de::Error) -> String {
    let too_large = ["number overflowed", "value was too large", "value was too small", "as i128", "as u128"];
    let reason = match error.message() {
        reason if too_large.iter().any(|words| reason.contains(words)) => "the number is too large",
        "" => "this is not TOML",
        reason => reason,
    };
    let mut reason = reason.replace('\n', "; ");
    let Some(before) = error.span().and_then(|span| text.get(..span.start)) else { return reason };
    let (number, begin) = (before.matches('\n').count() + 1, before.rfind('\n').map_or(0, |end| end + 1));
    let line = text.get(begin..).and_then(|rest| rest.lines().next()).unwrap_or_default();
    if reason == "duplicate key"
        && let Some(first) = before.lines().position(|earlier| key_of(earlier) == key_of(line))
    {
        reason = format!("this key is already in line {}, where it can be changed", first + 1);
    }
    format!("line {number}: {reason}: `{}`", shortened(line.trim()))
}

/// Returns the key in a line of TOML; `None` if the line has no key.
fn key_of(line: &str) -> Option<&str> {
    line.split_once('=').map(|(key, _)| key.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_line_of_a_key_names_the_first() {
        let text = "# odom\nodom = \"odom\" # topic (default)\nscan = \"scan\"\nodom = \"/odom\"\n";
        let error = toml::from_str::<toml::Table>(text).unwrap_err();
        let expected = "line 4: this key is already in line 2, where it can be changed: `odom = \"/odom\"`";
        assert_eq!(syntax_error(text, &error), expected);
    }

    #[test]
    fn numbers_that_no_type_holds_are_too_large() {
        for text in ["a = 9999999999999999999", "a = -9999999999999999999", "a = 99999999999999999999"] {
            let error = toml::from_str::<toml::Table>(text).unwrap_err();
            assert_eq!(syntax_error(text, &error), format!("line 1: the number is too large: `{text}`"));
        }
    }

    #[test]
    fn messages_stay_short() {
        let long = "9".repeat(300);
        for text in
            [format!("speed = {long}"), format!("speed = {long}.0"), format!("a = \"{long}"), format!("{long} {long}")]
        {
            let error = toml::from_str::<toml::Table>(&format!("\n{text}"));
            let shown = match error {
                Ok(table) => shown(&table["speed"]),
                Err(error) => syntax_error(&format!("\n{text}"), &error),
            };
            assert!(shown.len() < 150 && (shown == "1e300" || shown.starts_with("line 2: ")), "{shown}");
        }
        let integer = format!("speed = {long}");
        let error = toml::from_str::<toml::Table>(&integer).unwrap_err();
        assert!(syntax_error(&integer, &error).starts_with("line 1: the number is too large: `speed = 999"), "{error}");
    }

    #[test]
    fn numbers_are_plain_or_have_an_exponent() {
        let numbers = [0.0, -0.5, 1e15, 1.5e300, -2e-300, f64::INFINITY, f64::NAN].map(number);
        assert_eq!(numbers, ["0", "-0.5", "1000000000000000", "1.5e300", "-2e-300", "inf", "NaN"]);
    }

    #[test]
    fn values_are_shown_as_in_the_file() {
        let text = "a = [1, 2.5, true]\nb = { c = \"größe\" }\nd = 1979-05-27";
        let table: toml::Table = toml::from_str(text).unwrap();
        let all: Vec<_> = table.values().map(shown).collect();
        assert_eq!(all, ["[1, 2.5, true]", "{ c = \"größe\" }", "a date or time"]);
    }
}
