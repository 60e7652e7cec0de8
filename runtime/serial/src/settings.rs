//! Values of a robot's configuration from a TOML file or the defaults, with the origin of each value.

use std::fmt;
use std::path::Path;

use mdle_host::read_piped_text;
use mdle_runtime::capability::Steering;
use serde::de::DeserializeOwned;

use crate::key::{Key, Setting};

/// Maximum size of a configuration file, in bytes.
const LARGEST: u64 = 1_000_000;

/// A key with its value, and the origin of the value.
#[derive(Debug, Clone, PartialEq)]
struct Entry {
    key: Key,
    value: String,
    from: String,
}

/// Values of the configuration in use, with the name of the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    file: Option<String>,
    entries: Vec<Entry>,
}

impl Settings {
    /// Reads the configuration file, if there is one. `F` is a type whose fields are options; a missing value is
    /// `None`.
    ///
    /// # Errors
    /// Fails if the file cannot be read, is not TOML, or has an unknown key or an invalid value. The sentence gives the
    /// place and reason.
    pub fn read<F: DeserializeOwned + Default>(file: Option<&Path>) -> Result<(F, Self), String> {
        let Some(path) = file else { return Ok((F::default(), Self::default())) };
        let name = path.display().to_string();
        let text = read_piped_text(path, LARGEST).map_err(|error| format!("{name}: {error}"))?;
        let values = toml::from_str(&text).map_err(|error| format!("{name}: {}", error.to_string().trim_end()))?;
        Ok((values, Self { file: Some(name), entries: Vec::new() }))
    }

    /// Returns the value of `key` in the file, or the default.
    ///
    /// # Errors
    /// Returns a sentence with the file's name and the reason if the key cannot have this value.
    pub fn value<T: Setting>(
        &mut self,
        key: Key,
        written: Option<T::Written>,
        default: T::Written,
    ) -> Result<T, String> {
        let written = self.chosen(key, written, default);
        T::of(&key, written).map_err(|why| self.blamed(&why))
    }

    /// Returns the device on the command line; if there is none, the device in the file, or else the first serial port.
    pub fn device(&mut self, given: Option<&str>, written: Option<String>) -> String {
        let key = Key::of("device", "", "the serial port, or tcp:ADDRESS:PORT");
        match given {
            Some(device) => self.noted(key, device.to_owned(), "--device".to_owned()),
            None => self.chosen(key, written, "/dev/ttyS0".to_owned()),
        }
    }

    /// Returns the steering gains: `rotate`, `align` and `avoid` of the file, and the default for each missing gain.
    /// With a gain below 0.1 a robot hardly turns; with a gain above 10 it oscillates.
    ///
    /// # Errors
    /// Returns a sentence about a gain that is too small or too large.
    pub fn steering(&mut self, [rotate, align, avoid]: [Option<f64>; 3]) -> Result<Steering, String> {
        let usual = Steering::USUAL;
        let gain = |name, help| Key { range: Some((0.1, 10.0)), ..Key::of(name, "rad/s", help) };
        Ok(Steering {
            rotate: self.value(
                gain("rotate_gain", "for each radian, of rotate, turn and path"),
                rotate,
                usual.rotate,
            )?,
            align: self.value(gain("align_gain", "for each metre, of align"), align, usual.align)?,
            avoid: self.value(gain("avoid_gain", "for each radian, of goAvoid"), avoid, usual.avoid)?,
        })
    }

    /// Returns the message `why` about a value, with the file's name if there is a file.
    #[must_use]
    pub fn blamed(&self, why: &str) -> String {
        self.file.as_ref().map_or_else(|| why.to_owned(), |file| format!("{file}: {why}"))
    }

    /// Returns the value in the file or the default, and records it for `--print-config`.
    fn chosen<W: fmt::Debug>(&mut self, key: Key, written: Option<W>, default: W) -> W {
        let file = self.file.as_deref().filter(|_| written.is_some());
        let from = file.unwrap_or("default").to_owned();
        self.noted(key, written.unwrap_or(default), from)
    }

    /// Records `value` with its origin for `--print-config`, and returns it.
    fn noted<W: fmt::Debug>(&mut self, key: Key, value: W, from: String) -> W {
        self.entries.push(Entry { key, value: format!("{value:?}"), from });
        value
    }
}

/// Prints TOML that `--config` can read, with the meaning and the origin of each value.
impl fmt::Display for Settings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Entry { key, value, from } in &self.entries {
            let line = format!("{} = {value}", key.in_a_file());
            writeln!(f, "{line:34} # {} ({from})", key.about())?;
        }
        Ok(())
    }
}
