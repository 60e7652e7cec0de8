//! A key of a configuration, and the types of its value.

use std::fmt;

use serde::de::DeserializeOwned;

/// A key of a configuration, as its table declares it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Name of the field.
    pub name: &'static str,
    /// Unit of the value; empty if the value has no unit.
    pub unit: &'static str,
    /// Short description of the value, which follows the unit.
    pub help: &'static str,
    /// `true` if the default has been compared with a real robot.
    pub is_verified: bool,
    /// Minimum and maximum of a number.
    pub range: Option<(f64, f64)>,
}

impl Key {
    /// Returns a key without a range, whose default is verified.
    pub(crate) const fn of(name: &'static str, unit: &'static str, help: &'static str) -> Self {
        Self { name, unit, help, is_verified: true, range: None }
    }

    /// Returns the name of the key in a configuration file.
    pub(crate) fn in_a_file(&self) -> String {
        self.name.replace('_', "-")
    }

    /// Returns the description of the value that `--print-config` shows.
    pub(crate) fn about(&self) -> String {
        let words: Vec<_> = [self.unit, self.help].into_iter().filter(|words| !words.is_empty()).collect();
        format!("{}{}", words.join(" "), if self.is_verified { "" } else { "; unverified" })
    }
}

/// The type of a value.
pub trait Setting: Sized {
    /// Type of the value in a file, and of its default.
    type Written: DeserializeOwned + fmt::Debug;

    /// Converts a written value to a value of this type.
    ///
    /// # Errors
    /// Returns a sentence with the reason if `key` cannot have this value.
    fn of(key: &Key, written: Self::Written) -> Result<Self, String>;
}

macro_rules! written_as_it_is {
    ($($type:ty, $value:ident, $number:expr;)*) => {
        $(impl Setting for $type {
            type Written = Self;

            fn of(key: &Key, $value: Self) -> Result<Self, String> {
                if let (Some((least, most)), Some(number)) = (key.range, $number) {
                    within(&key.in_a_file(), number, least, most)?;
                }
                Ok($value)
            }
        })*
    };
}

written_as_it_is! {
    f64, value, Some(value);
    u8, value, Some(f64::from(value));
    u32, value, Some(f64::from(value));
    u64, value, Some(value as f64);
    bool, value, None::<f64>;
    String, value, None::<f64>;
    Vec<u8>, value, None::<f64>;
}

/// Returns the value in `choices` whose name is `written`.
///
/// # Errors
/// Returns a sentence with all names if no choice has this name.
pub fn one_of<T: Copy>(key: &Key, written: &str, choices: &[(&str, T)]) -> Result<T, String> {
    choices.iter().find(|(name, _)| *name == written).map(|(_, choice)| *choice).ok_or_else(|| {
        let names: Vec<_> = choices.iter().map(|(name, _)| format!("{name:?}")).collect();
        format!("`{}` is {written:?}, and has to be {}", key.in_a_file(), names.join(" or "))
    })
}

/// Checks that `value` is between `least` and `most`, ends included.
///
/// # Errors
/// Returns a sentence if the value is out of range.
pub fn within(name: &str, value: f64, least: f64, most: f64) -> Result<(), String> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(format!("`{name}` is {value}, and has to be from {least} to {most}"))
    }
}
