//! Keys of a configuration, and the types of their values.

use std::fmt;

use mdle_quantity::did_you_mean;
use serde::de::DeserializeOwned;

use crate::shown::{number, shortened};

/// A key of a configuration, as its table declares it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Name of the field.
    pub name: &'static str,
    /// Unit of the value; empty if the value has no unit.
    pub unit: &'static str,
    /// Short description of the value. It is printed after the unit.
    pub help: &'static str,
    /// `true` if the default has been compared with a real robot.
    pub is_verified: bool,
    /// Minimum and maximum of a number; `None` if the value has no range.
    pub range: Option<(f64, f64)>,
}

impl Key {
    /// Creates a key without a range, whose default is verified.
    pub(crate) const fn of(name: &'static str, unit: &'static str, help: &'static str) -> Self {
        Self { name, unit, help, is_verified: true, range: None }
    }

    /// Returns `true` if the key has no range, or if its range contains `value`.
    fn has(&self, value: f64) -> bool {
        self.range.is_none_or(|(least, most)| (least..=most).contains(&value))
    }

    /// Returns the name that the key has in a configuration file.
    #[must_use]
    pub fn in_a_file(&self) -> String {
        self.name.replace('_', "-")
    }

    /// Returns the description of the value, as `--print-config` shows it.
    pub(crate) fn about(&self) -> String {
        let words: Vec<_> = [self.unit, self.help].into_iter().filter(|words| !words.is_empty()).collect();
        format!("{}{}", words.join(" "), if self.is_verified { "" } else { "; unverified" })
    }
}

/// Type of a configuration value, with the conversion from the form that a file contains.
pub trait Setting: Sized {
    /// Type of the value in a file, and of its default.
    type Written: DeserializeOwned + fmt::Debug;

    /// Returns a description of the value that `key` must have in a file, as the end of a sentence.
    fn expected(key: &Key) -> String;

    /// Converts a value in the form that a file contains to this type.
    ///
    /// # Errors
    /// Returns a message with the reason if `key` cannot have this value.
    fn of(key: &Key, written: Self::Written) -> Result<Self, String>;
}

/// Returns a description of the expected value, as the end of a sentence. `what` is the kind of the value; the range
/// and the unit are those of `key`.
fn ranged(what: &str, key: &Key) -> String {
    let range = key.range.map(|(least, most)| format!(" from {least} to {most}")).unwrap_or_default();
    let unit = if key.unit.is_empty() { String::new() } else { format!(" {}", key.unit) };
    let of_unit = if range.is_empty() && !unit.is_empty() { " in" } else { "" };
    format!("{what}{range}{of_unit}{unit}")
}

macro_rules! written_as_it_is {
    ($($type:ty, $value:ident, $number:expr, |$key:ident| $expected:expr;)*) => {
        $(impl Setting for $type {
            type Written = Self;

            fn expected($key: &Key) -> String {
                $expected
            }

            fn of(key: &Key, $value: Self) -> Result<Self, String> {
                let as_number: Option<f64> = $number;
                match as_number.filter(|found| !found.is_finite() || !key.has(*found)) {
                    Some(wrong) => {
                        let (name, wrong) = (key.in_a_file(), number(wrong));
                        Err(format!("`{name}` is {wrong}, and has to be {}", Self::expected(key)))
                    }
                    None => Ok($value),
                }
            }
        })*
    };
}

written_as_it_is! {
    f64, value, Some(value), |key| ranged("a number", key);
    u8, value, Some(f64::from(value)), |key| ranged("a whole number", key);
    u32, value, Some(f64::from(value)), |key| ranged("a whole number", key);
    u64, value, Some(value as f64), |key| ranged("a whole number", key);
    bool, value, None, |_key| "true or false".to_owned();
    String, value, None, |_key| "a text in quotes".to_owned();
    Vec<u8>, value, None, |_key| "a list of whole numbers from 0 to 255".to_owned();
}

/// Returns the value in `choices` whose name is `written`.
///
/// # Errors
/// Returns a message with all names, and the most similar one, if no value has this name.
pub fn one_of<T: Copy>(key: &Key, written: &str, choices: &[(&str, T)]) -> Result<T, String> {
    choices.iter().find(|(name, _)| *name == written).map(|(_, choice)| *choice).ok_or_else(|| {
        let names: Vec<_> = choices.iter().map(|(name, _)| *name).collect();
        let (written, near) = (shortened(&format!("{written:?}")), did_you_mean(written, &names));
        format!("`{}` is {written}, and has to be {}{near}", key.in_a_file(), quoted(&names))
    })
}

/// Returns a list of the allowed words, in quotes.
#[must_use]
pub fn quoted(words: &[&str]) -> String {
    let words: Vec<_> = words.iter().map(|word| format!("{word:?}")).collect();
    words.join(" or ")
}

/// Checks that `value` is at least `least` and at most `most`.
///
/// # Errors
/// Returns a message if the value is out of range.
pub fn within(name: &str, value: f64, least: f64, most: f64) -> Result<(), String> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(format!("`{name}` is {}, and has to be from {least} to {most}", number(value)))
    }
}
