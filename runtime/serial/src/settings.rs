//! A robot's configuration: a TOML file, the defaults, and the origin of each value.

use std::fmt;
use std::path::Path;

use mdle_host::read_text;
use mdle_runtime::capability::Steering;
use serde::de::DeserializeOwned;

use crate::key::{Key, Setting};

/// Maximum size of a configuration that is read, in bytes.
const LARGEST: u64 = 1_000_000;

/// A key with its value, and where that came from.
#[derive(Debug, Clone, PartialEq)]
struct Entry {
    key: Key,
    value: String,
    from: String,
}

/// The values that were chosen, with the name of the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    file: Option<String>,
    entries: Vec<Entry>,
}

impl Settings {
    /// Reads the file, if there is one; a value that the file lacks is `None` in a type whose fields are options.
    ///
    /// # Errors
    /// The file cannot be read, is no TOML, or has a key or a value that it cannot have: where and why.
    pub fn read<F: DeserializeOwned + Default>(file: Option<&Path>) -> Result<(F, Self), String> {
        let Some(path) = file else { return Ok((F::default(), Self::default())) };
        let name = path.display().to_string();
        let text = read_text(path, LARGEST).map_err(|error| format!("{name}: {error}"))?;
        let values = toml::from_str(&text).map_err(|error| format!("{name}: {}", error.to_string().trim_end()))?;
        Ok((values, Self { file: Some(name), entries: Vec::new() }))
    }

    /// Returns the value that the file has for this key, or the default.
    ///
    /// # Errors
    /// The sentence that says why the key cannot have this value, after the file's name if there is one.
    pub fn value<T: Setting>(
        &mut self,
        key: Key,
        written: Option<T::Written>,
        default: T::Written,
    ) -> Result<T, String> {
        let written = self.chosen(key, written, default);
        T::of(&key, written).map_err(|why| self.blamed(&why))
    }

    /// Returns the device: the one of the command line, else of the file, else the first serial port.
    pub fn device(&mut self, given: Option<&str>, written: Option<String>) -> String {
        let key = Key::of("device", "", "the serial port, or tcp:ADDRESS:PORT");
        match given {
            Some(device) => self.noted(key, device.to_owned(), "--device".to_owned()),
            None => self.chosen(key, written, "/dev/ttyS0".to_owned()),
        }
    }

    /// Returns how hard laws steer: `rotate`, `align` and `avoid` of the file, for the rest the usual gains. With less
    /// than a tenth a robot hardly turns, with more than ten it swings.
    ///
    /// # Errors
    /// The sentence that says which gain is too small or too great.
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

    /// Returns the message about a value, with the file's name if there is one.
    #[must_use]
    pub fn blamed(&self, why: &str) -> String {
        self.file.as_ref().map_or_else(|| why.to_owned(), |file| format!("{file}: {why}"))
    }

    /// Returns the value of the file, or else the default, and records it for `--print-config`.
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

/// Prints TOML that can be given back with `--config`, with the meaning and the origin of each value.
impl fmt::Display for Settings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Entry { key, value, from } in &self.entries {
            let line = format!("{} = {value}", key.in_a_file());
            writeln!(f, "{line:34} # {} ({from})", key.about())?;
        }
        Ok(())
    }
}
