//! The configuration of a robot, declared as one table. From each line of the table,
//! [`configuration!`](crate::configuration!) generates a field, the code that reads and checks its value, and its line
//! in the output of `--print-config`.

use std::fmt;
use std::path::Path;

use crate::settings::Settings;

/// Configuration of a robot: the values that differ between robots of the same kind.
pub trait Configuration: Sized {
    /// Reads the values in the configuration file. `device` replaces the device in the file. All other values are
    /// defaults.
    ///
    /// # Errors
    /// Fails if the file cannot be read, is not TOML, or has an unknown key or an invalid value. The message contains
    /// the place in the file and the reason.
    fn read(file: Option<&Path>, device: Option<&str>) -> Result<(Self, Settings), String>;
}

/// A configuration, and the source of each of its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Configured<C> {
    /// Values of the configuration.
    pub config: C,
    settings: Settings,
}

impl<C: Configuration> Configured<C> {
    /// Reads the configuration as [`Configuration::read`] does.
    ///
    /// # Errors
    /// Fails if [`Configuration::read`] fails.
    pub fn read(file: Option<&Path>, device: Option<&str>) -> Result<Self, String> {
        C::read(file, device).map(|(config, settings)| Self { config, settings })
    }
}

/// Prints the configuration as TOML that the option `--config` can read.
impl<C> fmt::Display for Configured<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.settings.fmt(f)
    }
}

/// Declares a configuration, with one line for each key: `name: type = default, in range, "unit" "help", confidence;`.
///
/// Every configuration begins with a `device`, and ends with the gains that laws use to steer. The type must have a
/// function `check`, which reports values that are valid individually but not in combination.
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
            /// Serial port of the robot, or `tcp:ADDRESS:PORT`.
            pub device: String,
            $($(#[$field_meta])* pub $key: $type,)*
            /// Gains that laws use to steer.
            pub steering: $crate::Steering,
        }

        impl $crate::Configuration for $config {
            fn read(
                file: Option<&::std::path::Path>,
                device: Option<&str>,
            ) -> Result<(Self, $crate::Settings), String> {
                let mut settings = $crate::Settings::read(file)?;
                let config = Self {
                    device: settings.device(device)?,
                    $($key: settings.value(
                        $crate::Key {
                            name: stringify!($key),
                            unit: $unit,
                            help: $help,
                            is_verified: $crate::configuration!(@is_verified $($confidence)?),
                            range: $crate::configuration!(@range $($least, $most)?),
                        },
                        $default,
                    )?,)*
                    steering: settings.steering()?,
                };
                settings.check()?;
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
