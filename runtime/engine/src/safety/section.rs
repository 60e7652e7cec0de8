//! The tables of a safety file: keys with their values and lines.

use std::borrow::Cow;
use std::ops::Range;
use std::time::Duration;

use mdle_compiler::alphabet::did_you_mean;
use mdle_quantity::Quantity;
use mdle_runtime::Printable;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::RulesError;

/// A key in the representation of the TOML parser.
pub(super) type TomlKey<'i> = Spanned<Cow<'i, str>>;
/// A value in the representation of the TOML parser.
pub(super) type TomlValue<'i> = Spanned<DeValue<'i>>;

/// A table of a safety file.
#[derive(Clone, Copy)]
pub(super) struct Section<'t, 'i> {
    text: &'t str,
    /// Name of the table, as in `[limits]`; empty for the whole file.
    pub(super) name: &'t str,
    table: &'t DeTable<'i>,
    /// Byte offset of the table in the file.
    place: usize,
}

impl<'t, 'i> Section<'t, 'i> {
    /// Returns the section of the whole file.
    pub(super) fn of_file(text: &'t str, table: &'t DeTable<'i>) -> Self {
        Self { text, name: "", table, place: 0 }
    }

    /// Returns the section if every key is one of `keys`; fails otherwise.
    pub(super) fn only(self, keys: &[&str]) -> Result<Self, RulesError> {
        for (key, _) in self.entries() {
            let name = key.get_ref();
            if !keys.contains(&&**name) {
                let near = did_you_mean(name, keys);
                let of = if self.name.is_empty() { String::new() } else { format!(" of `{}`", self.name) };
                let message =
                    format!("there is no key `{}`{near}\nhelp: the keys{of} are {}", Printable(name), keys.join(", "));
                return Err(self.error(key, message));
            }
        }
        Ok(self)
    }

    /// Returns the entries sorted by line.
    pub(super) fn entries(self) -> impl Iterator<Item = (&'t TomlKey<'i>, &'t TomlValue<'i>)> {
        let mut entries: Vec<_> = self.table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        entries.into_iter()
    }

    /// Returns the value of a key; `None` if the table does not have the key.
    pub(super) fn get(self, key: &str) -> Option<&'t TomlValue<'i>> {
        self.table.get(key)
    }

    /// Returns the value of a required key; `example` is shown in the error message.
    pub(super) fn needed(self, key: &str, example: &str) -> Result<&'t TomlValue<'i>, RulesError> {
        let missing = || RulesError {
            line: line(self.text, self.place),
            message: format!("`{}` needs `{key}`, as in `{key} = {example}`", self.name),
        };
        self.get(key).ok_or_else(missing)
    }

    /// Returns the value of the key `name`, which must be a table.
    pub(super) fn table(self, name: &'t str, value: &'t TomlValue<'i>) -> Result<Section<'t, 'i>, RulesError> {
        let found = value.get_ref();
        let within = if self.name.is_empty() { String::new() } else { format!("{}.", self.name) };
        let message =
            || format!("`{0}` has to be a table, as in `[{within}{0}]`; found: {1}", Printable(name), kind(found));
        let table = found.as_table().ok_or_else(|| self.error(value, message()))?;
        Ok(Section { name, table, place: value.span().start, ..self })
    }

    /// Returns a value that must be text; `example` is shown in the error message.
    pub(super) fn text(self, key: &str, value: &'t TomlValue<'i>, example: &str) -> Result<&'t str, RulesError> {
        let found = value.get_ref();
        let message = || format!("`{key}` has to be text, as in `{key} = {example}`; found: {}", kind(found));
        found.as_str().ok_or_else(|| self.error(value, message()))
    }

    /// Returns a quantity in the unit of [`Quantity`]. It must be above 0, or at least 0 if `may_be_none` is `true`.
    pub(super) fn quantity(
        self,
        key: &str,
        value: &'t TomlValue<'i>,
        (quantity, unit): (Quantity, &str),
        may_be_none: bool,
    ) -> Result<f64, RulesError> {
        let found = value.get_ref();
        let example = format!("`{key} = \"2{unit}\"`");
        let Some(text) = found.as_str() else {
            let message = format!("`{key}` has to be text with a unit, as in {example}; found: {}", kind(found));
            return Err(self.error(value, message));
        };
        let message = |message: String| self.error(value, format!("`{key}`: {message}"));
        if text.ends_with(|letter: char| letter.is_ascii_digit() || letter == '.') && text.parse::<f64>().is_ok() {
            return Err(message(format!("`{text}` has no unit, as in {example}")));
        }
        let compact: String = text.split_whitespace().collect();
        if compact != text && quantity.read(&compact, unit).is_ok() {
            return Err(message(format!("a unit touches its number: write `{compact}`")));
        }
        let read = quantity.read(text, unit);
        // A number without a unit was refused above.
        let read = read.map_err(|refusal| message(refusal.replace(&format!(", or a number in {unit}"), "")))?;
        match read {
            read if read > 0.0 || may_be_none && read == 0.0 => Ok(read),
            _ => Err(self.error(
                value,
                format!("`{key}` has to be {} 0; found: {text}", if may_be_none { "at least" } else { "above" }),
            )),
        }
    }

    /// Returns a time, which must be above 0.
    pub(super) fn time(self, key: &str, value: &'t TomlValue<'i>) -> Result<Duration, RulesError> {
        let seconds = self.quantity(key, value, (Quantity::Time, "s"), false)?;
        let time = Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero());
        time.ok_or_else(|| self.error(value, format!("`{key}` has to be a time from 1ns to 100 years")))
    }

    /// Returns an integer, which must be at least 1.
    pub(super) fn count(self, key: &str, value: &'t TomlValue<'i>) -> Result<u64, RulesError> {
        let found = value.get_ref();
        let number = found.as_integer().and_then(|number| u64::from_str_radix(number.as_str(), number.radix()).ok());
        number.filter(|number| *number > 0).ok_or_else(|| {
            self.error(
                value,
                format!("`{key}` has to be a whole number from 1, as in `{key} = 3`; found: {}", shown(found)),
            )
        })
    }

    /// Returns an error at a place in the file.
    pub(super) fn error<T>(self, place: &Spanned<T>, message: String) -> RulesError {
        RulesError { line: line(self.text, place.span().start), message }
    }

    /// Returns the line of a value, counted from 1, and the byte range of its text. If the text contains escape
    /// sequences, this is the range of the whole value.
    pub(super) fn place(self, span: &Range<usize>, text: &str) -> (usize, Range<usize>) {
        let start = self.text.get(span.clone()).and_then(|value| value.find(text)).map(|before| span.start + before);
        let bytes = start.map_or_else(|| span.clone(), |start| start..start + text.len());
        (line(self.text, bytes.start), bytes)
    }
}

/// Returns the line number of a byte offset, counted from 1.
pub(super) fn line(text: &str, place: usize) -> usize {
    text.bytes().take(place).filter(|byte| *byte == b'\n').count() + 1
}

/// Returns the name of a value's type, for messages.
pub(super) fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// Returns a number in the form in which the file contains it; for any other value, returns its type.
fn shown(value: &DeValue<'_>) -> String {
    match value {
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.to_string(),
        DeValue::String(_) | DeValue::Boolean(_) | DeValue::Datetime(_) | DeValue::Array(_) | DeValue::Table(_) => {
            kind(value).to_owned()
        }
    }
}
