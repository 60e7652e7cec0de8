//! The configuration of a robot as one table: [`configuration!`](crate::configuration!) makes of each line a field, its
//! reader, its check and its line of `--print-config`.

use std::fmt;
use std::path::Path;

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
