//! Compares a text with an operand of the plan. Differences in spaces, units and the form of numbers are ignored.

use mdle_runtime::OperandWords;

use crate::Quantity;

/// Maximum relative difference of two numbers that are treated as equal: converting units may change the last digits.
const TOLERANCE: f64 = 1e-9;

/// A word or a number of a condition.
#[derive(Debug, PartialEq)]
enum OperandToken<'a> {
    /// A name, an operator, a quoted text, or a number whose leading zeros are significant.
    Word(&'a str),
    /// A number, converted to the base unit of its quantity; a number without a unit is unchanged.
    Number(Option<Quantity>, f64),
}

/// Returns `true` if `text` means the operand. The text may have the operand's canonical form or the form in the plan's
/// text, and may differ from these forms in units and spaces.
#[must_use]
pub fn is_operand(text: &str, operand: &OperandWords<'_>) -> bool {
    let unit = operand.values.first().map_or("", |signal| signal.unit);
    let asked = tokens(text, unit);
    [operand.text, operand.written].into_iter().any(|known| {
        let known = tokens(known, unit);
        asked.len() == known.len() && asked.iter().zip(&known).all(|(asked, known)| asked.is(known))
    })
}

/// Returns `true` if the two texts are equal except for spaces and the form of numbers.
#[must_use]
pub fn is_condition(text: &str, condition: &str) -> bool {
    is_operand(text, &OperandWords { text: condition, written: condition, ..NO_OPERAND })
}

const NO_OPERAND: OperandWords<'static> =
    OperandWords { text: "", written: "", at: mdle_runtime::SourceLine { file: 0, line: 0 }, values: &[] };

impl OperandToken<'_> {
    fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Number(kind, one), Self::Number(other_kind, other)) => {
                kind == other_kind && (one - other).abs() <= TOLERANCE * one.abs().max(other.abs())
            }
            (Self::Word(_) | Self::Number(..), _) => self == other,
        }
    }
}

/// Returns the words and numbers of a condition. A number that is written without a unit gets the unit `unit`.
fn tokens<'a>(text: &'a str, unit: &str) -> Vec<OperandToken<'a>> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let is_time = matches!(tokens.last(), Some(OperandToken::Word("wait")));
        let (token, length) = if first.is_ascii_digit() || first == '.' {
            number(rest, if is_time { "s" } else { unit })
        } else {
            let length = word_length(rest, first);
            (OperandToken::Word(rest.get(..length).unwrap_or(rest)), length)
        };
        tokens.push(token);
        rest = rest.get(length..).unwrap_or("").trim_start();
    }
    tokens
}

/// Returns the length in bytes of the name, the quoted text or the operator at the start of `rest`.
fn word_length(rest: &str, first: char) -> usize {
    let length_of = |is_part: fn(char) -> bool| rest.find(|letter| !is_part(letter)).unwrap_or(rest.len());
    match first {
        '"' => rest.get(1..).and_then(|inside| inside.find('"')).map_or(rest.len(), |end| end + 2),
        '<' | '>' | '=' | '!' => length_of(|letter| matches!(letter, '<' | '>' | '=' | '!')),
        _ if first.is_alphanumeric() || first == '_' => length_of(|letter| letter.is_alphanumeric() || letter == '_'),
        _ => first.len_utf8(),
    }
}

/// Returns the number at the start of `rest`, and its length in bytes. A number that is written without a unit gets the
/// unit `bare`.
fn number<'a>(rest: &'a str, bare: &str) -> (OperandToken<'a>, usize) {
    let is_part = |letter: char| letter.is_ascii_digit() || letter == '.';
    let mantissa = rest.find(|letter| !is_part(letter)).unwrap_or(rest.len());
    let after = rest.get(mantissa..).unwrap_or("");
    let sign = after.get(1..).map_or(0, |power| usize::from(power.starts_with(['-', '+'])));
    let power = after.get(1 + sign..).unwrap_or("");
    let power = power.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(power.len());
    let end = if after.starts_with(['e', 'E']) && power > 0 { mantissa + 1 + sign + power } else { mantissa };
    let digits = rest.get(..end).unwrap_or(rest);
    let letters = rest.get(end..).unwrap_or("");
    let length = letters.find(|letter: char| !letter.is_ascii_alphabetic() && letter != '/').unwrap_or(letters.len());
    let written = letters.get(..length).unwrap_or("");
    // A bit pattern, as in `atIsection 0100`.
    let is_pattern = length == 0 && digits.len() > 1 && digits.starts_with('0') && !digits.contains('.');
    match digits.parse::<f64>() {
        Ok(value) if !is_pattern => {
            let (kind, value) = match Quantity::of_unit(if written.is_empty() { bare } else { written }) {
                Some((kind, factor, divisor)) => (Some(kind), value * factor / divisor),
                None => (None, value),
            };
            (OperandToken::Number(kind, value), end + length)
        }
        Ok(_) | Err(_) => (OperandToken::Word(digits), end),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mdle_runtime::ValueWords;

    const METRES: &[ValueWords<'_>] = &[ValueWords { after: 2, unit: "m", scale: 1.0 }];

    fn is(text: &str, canonical: &str, written: &str, values: &[ValueWords<'_>]) -> bool {
        is_operand(text, &OperandWords { text: canonical, written, values, ..NO_OPERAND })
    }

    #[test]
    fn spaces_units_and_zeros_make_no_difference() {
        for text in ["r0 < 60cm", "r0<0.6", "r0 < 0.60", "r0<600mm", " r0  <.6 ", "r0 < 6e-1m", "r0 < 60.0cm"] {
            assert!(is(text, "r0 < 0.6", "r0 < 60cm", METRES), "{text}");
        }
        for text in ["r0 < 60", "r0 <= 0.6", "r0 > 0.6", "r0 < 0.6s", "r1 < 0.6", "NOT r0 < 0.6", "r0 <", "0.6", ""] {
            assert!(!is(text, "r0 < 0.6", "r0 < 60cm", METRES), "{text}");
        }
        let speed = [ValueWords { after: 1, unit: "cm/s", scale: 0.01 }];
        assert!(["v < 80", "v<0.8m/s", "v < 80cm/s"].iter().all(|text| is(text, "v < 80", "v < 80", &speed)));
    }

    #[test]
    fn times_of_wait_are_in_seconds() {
        for text in ["wait 600", "wait 10min", "wait 600s", "wait 6e2"] {
            assert!(is(text, "wait 600", "wait 10min", &[]) && is(text, "wait 600", "wait 600", &[]), "{text}");
        }
        assert!(!is("wait 10", "wait 600", "wait 10min", &[]) && !is("wait 600m", "wait 600", "wait 10min", &[]));
    }

    #[test]
    fn patterns_and_texts_are_compared_as_written() {
        assert!(is("atIsection  0100", "atIsection 0100", "atIsection 0100", &[]));
        assert!(!is("atIsection 100", "atIsection 0100", "atIsection 0100", &[]));
        assert!(is("heard \"go  on\"", "heard \"go  on\"", "heard \"go  on\"", &[]));
        assert!(!is("heard \"go on\"", "heard \"go  on\"", "heard \"go  on\"", &[]));
        assert!(is("NOT(bumper)", "NOT (bumper)", "NOT (bumper)", &[]));
        assert!(is_condition("r3<r5", "r3 < r5") && !is_condition("r5 < r3", "r3 < r5"));
    }
}
