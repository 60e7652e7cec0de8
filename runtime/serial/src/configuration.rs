//! The configuration of a robot as one table: [`configuration!`](crate::configuration!) makes of each line a field, its
//! reader, its check and its line of `--print-config`.

use std::fmt;
use std::path::Path;

use serde::de::DeserializeOwned;

use crate::settings::Settings;

/// The values by which robots of one kind differ.
pub trait Configuration: Sized {
    /// Returns the values of the file, if there is one, and `device`, if it was given; for the rest the defaults.
    ///
    /// # Errors
    /// The file cannot be read, is no TOML, has a key that there is not, or a value that makes no sense: where and why.
    fn read(file: Option<&Path>, device: Option<&str>) -> Result<(Self, Settings), String>;
}

/// A configuration, and where each of its values came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Configured<C> {
    /// The values.
    pub config: C,
    settings: Settings,
}

impl<C: Configuration> Configured<C> {
    /// Reads the configuration, as [`Configuration::read`] does.
    ///
    /// # Errors
    /// Those of [`Configuration::read`].
    pub fn read(file: Option<&Path>, device: Option<&str>) -> Result<Self, String> {
        C::read(file, device).map(|(config, settings)| Self { config, settings })
    }
}

/// Returns the configuration as TOML, which `--config` reads.
impl<C> fmt::Display for Configured<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.settings.fmt(f)
    }
}

/// A key of a configuration, as its table declares it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// The name of the field.
    pub name: &'static str,
    /// The unit; empty for a value without one.
    pub unit: &'static str,
    /// A few words on the value, after the unit.
    pub help: &'static str,
    /// `false` if nobody has compared the default with a real robot.
    pub is_verified: bool,
    /// Minimum and maximum of a number.
    pub range: Option<(f64, f64)>,
}

impl Key {
    /// A key without a range, whose default is verified.
    pub(crate) const fn of(name: &'static str, unit: &'static str, help: &'static str) -> Self {
        Self { name, unit, help, is_verified: true, range: None }
    }

    /// Returns the name in a file.
    pub(crate) fn in_a_file(&self) -> String {
        self.name.replace('_', "-")
    }

    /// Returns the words on the value that `--print-config` shows.
    pub(crate) fn about(&self) -> String {
        let words: Vec<_> = [self.unit, self.help].into_iter().filter(|words| !words.is_empty()).collect();
        format!("{}{}", words.join(" "), if self.is_verified { "" } else { "; unverified" })
    }
}

/// The type of a value.
pub trait Setting: Sized {
    /// Type of the value in a file, and of its default.
    type Written: DeserializeOwned + fmt::Debug;

    /// Returns the value.
    ///
    /// # Errors
    /// The sentence that says why `key` cannot have it.
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

/// Returns the one of `choices` that has this name.
///
/// # Errors
/// The sentence that says which there are.
pub fn one_of<T: Copy>(key: &Key, written: &str, choices: &[(&str, T)]) -> Result<T, String> {
    choices.iter().find(|(name, _)| *name == written).map(|(_, choice)| *choice).ok_or_else(|| {
        let names: Vec<_> = choices.iter().map(|(name, _)| format!("{name:?}")).collect();
        format!("`{}` is {written:?}, and has to be {}", key.in_a_file(), names.join(" or "))
    })
}

/// Checks that a value is from `least` to `most`.
///
/// # Errors
/// The sentence that says that it is not.
pub fn within(name: &str, value: f64, least: f64, most: f64) -> Result<(), String> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(format!("`{name}` is {value}, and has to be from {least} to {most}"))
    }
}

/// Declares a configuration, a line for each of its keys: `name: type = default, in range, "unit" "help", confidence;`.
///
/// Every configuration has a `device` in front, and how hard laws steer at the end. The type has a function `check`,
/// which says what is wrong with values that are good each by itself.
#[macro_export]
macro_rules! configuration {
    (
        $(#[$meta:meta])*
        $config:ident;
        $(
            $(#[$field_meta:meta])*
            $key:ident: $type:ty = $default:expr, $(in $least:literal..=$most:literal,)? $unit:literal $help:literal
                $(, $confidence:ident)?;
        )*
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq)]
        pub struct $config {
            /// The serial port, or `tcp:ADDRESS:PORT`.
            pub device: String,
            $($(#[$field_meta])* pub $key: $type,)*
            /// The gains with which laws steer.
            pub steering: $crate::Steering,
        }

        impl $crate::Configuration for $config {
            fn read(
                file: Option<&::std::path::Path>,
                device: Option<&str>,
            ) -> Result<(Self, $crate::Settings), String> {
                /// The configuration file; a key that is missing keeps its value.
                #[derive(Default, $crate::serde::Deserialize)]
                #[serde(crate = "mdle_serial::serde", deny_unknown_fields, rename_all = "kebab-case")]
                struct File {
                    device: Option<String>,
                    $($key: Option<<$type as $crate::Setting>::Written>,)*
                    rotate_gain: Option<f64>,
                    align_gain: Option<f64>,
                    avoid_gain: Option<f64>,
                }
                let (file, mut settings) = $crate::Settings::read::<File>(file)?;
                let config = Self {
                    device: settings.device(device, file.device),
                    $($key: settings.value(
                        $crate::Key {
                            name: stringify!($key),
                            unit: $unit,
                            help: $help,
                            is_verified: $crate::configuration!(@is_verified $($confidence)?),
                            range: $crate::configuration!(@range $($least, $most)?),
                        },
                        file.$key,
                        $default,
                    )?,)*
                    steering: settings.steering([file.rotate_gain, file.align_gain, file.avoid_gain])?,
                };
                config.check().map_err(|why| settings.blamed(&why))?;
                Ok((config, settings))
            }
        }
    };
    (@is_verified) => { true };
    (@is_verified unverified) => { false };
    (@range) => { None };
    (@range $least:literal, $most:literal) => { Some(($least as f64, $most as f64)) };
}
