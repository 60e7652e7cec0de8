//! Values of a robot's configuration, which come from a TOML file or are defaults, with the source of each value.

use std::fmt;
use std::path::Path;

use mdle_host::read_piped_text;
use mdle_quantity::did_you_mean;
use mdle_runtime::capability::Steering;
use toml::Table;

use crate::key::{Key, Setting};
use crate::shown::{shortened, shown, syntax_error};

/// Maximum size of a configuration file, in bytes.
const LARGEST: u64 = 1_000_000;

/// A key with its value and the source of the value.
#[derive(Debug, Clone, PartialEq)]
struct SettingEntry {
    key: Key,
    value: String,
    from: String,
}

/// Values of the configuration that are in use, and the name of the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    file: Option<String>,
    /// Values of the file whose keys have not been read yet.
    written: Table,
    entries: Vec<SettingEntry>,
}

impl Settings {
    /// Reads the configuration file; without a file, there are no values.
    ///
    /// # Errors
    /// Fails if the file cannot be read or is not TOML. The message contains the place in the file and the reason.
    pub fn read(file: Option<&Path>) -> Result<Self, String> {
        let Some(path) = file else { return Ok(Self::default()) };
        let name = path.display().to_string();
        let text = read_piped_text(path, LARGEST).map_err(|error| format!("{name}: {error}"))?;
        let written = toml::from_str(&text).map_err(|error| format!("{name}: {}", syntax_error(&text, &error)))?;
        Ok(Self { file: Some(name), written, entries: Vec::new() })
    }

    /// Checks that every key of the file has been read; any other key is unknown.
    ///
    /// # Errors
    /// Returns a message with the file's name, the unknown key and the most similar key if a key has not been read.
    pub fn check(&self) -> Result<(), String> {
        let Some(unknown) = self.written.keys().next() else { return Ok(()) };
        let known: Vec<_> = self.entries.iter().map(|entry| entry.key.in_a_file()).collect();
        let known: Vec<_> = known.iter().map(String::as_str).collect();
        let near = did_you_mean(unknown, &known);
        let unknown = shortened(unknown);
        let keys = known.join(", ");
        Err(self.blamed(&format!("there is no key `{unknown}`{near}\nhelp: the keys are {keys}")))
    }

    /// Returns `true` if the file contains the key with this name and the key has not been read yet.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.written.contains_key(name)
    }

    /// Reads the value of `key` from the file; if the file does not contain the key, returns the default.
    ///
    /// # Errors
    /// Returns a message with the file's name and the reason if the key cannot have this value.
    pub fn value<T: Setting>(&mut self, key: Key, default: T::Written) -> Result<T, String> {
        let written = self.taken::<T>(&key)?;
        let written = self.chosen(key, written, default);
        T::of(&key, written).map_err(|why| self.blamed(&why))
    }

    /// Returns the device that the command line names; if it names none, the device in the file; and if the file has
    /// none, the first serial port.
    ///
    /// # Errors
    /// Returns a message with the file's name if the device in the file is not a text.
    pub fn device(&mut self, given: Option<&str>) -> Result<String, String> {
        let key = Key::of("device", "", "the serial port, or tcp:ADDRESS:PORT");
        let written = self.taken::<String>(&key)?;
        Ok(match given {
            Some(device) => self.noted(key, device.to_owned(), "--device".to_owned()),
            None => self.chosen(key, written, "/dev/ttyS0".to_owned()),
        })
    }

    /// Removes and returns the value of `key` in the file; `None` if the file does not contain the key.
    fn taken<T: Setting>(&mut self, key: &Key) -> Result<Option<T::Written>, String> {
        let Some(value) = self.written.remove(&key.in_a_file()) else { return Ok(None) };
        let shown = shown(&value);
        value.try_into().map(Some).map_err(|_| {
            let (name, expected) = (key.in_a_file(), T::expected(key));
            self.blamed(&format!("`{name}` is {shown}, and has to be {expected}"))
        })
    }

    /// Reads the steering gains `rotate`, `align` and `avoid` from the file; missing gains have their defaults. With a
    /// gain below 0.1, a robot hardly turns; with a gain above 10, it oscillates.
    ///
    /// # Errors
    /// Returns a message about a gain that is too small or too large.
    pub fn steering(&mut self) -> Result<Steering, String> {
        let usual = Steering::USUAL;
        let gain = |name, help| Key { range: Some((0.1, 10.0)), ..Key::of(name, "rad/s", help) };
        Ok(Steering {
            rotate: self.value(gain("rotate_gain", "for each radian, of rotate, turn and path"), usual.rotate)?,
            align: self.value(gain("align_gain", "for each metre, of align"), usual.align)?,
            avoid: self.value(gain("avoid_gain", "for each radian, of goAvoid"), usual.avoid)?,
        })
    }

    /// Returns the message `why` about a value, together with the file's name if there is a file.
    #[must_use]
    pub fn blamed(&self, why: &str) -> String {
        self.file.as_ref().map_or_else(|| why.to_owned(), |file| format!("{file}: {why}"))
    }

    /// Returns the value in the file; without such a value, the default. Records the value for `--print-config`.
    fn chosen<W: fmt::Debug>(&mut self, key: Key, written: Option<W>, default: W) -> W {
        let file = self.file.as_deref().filter(|_| written.is_some());
        let from = file.unwrap_or("default").to_owned();
        self.noted(key, written.unwrap_or(default), from)
    }

    /// Returns `value`, after recording it with its source for `--print-config`.
    fn noted<W: fmt::Debug>(&mut self, key: Key, value: W, from: String) -> W {
        self.entries.push(SettingEntry { key, value: format!("{value:?}"), from });
        value
    }
}

/// Prints TOML that the option `--config` can read, with the meaning and the source of each value.
impl fmt::Display for Settings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for SettingEntry { key, value, from } in &self.entries {
            let line = format!("{} = {value}", key.in_a_file());
            writeln!(f, "{line:34} # {} ({from})", key.about())?;
        }
        Ok(())
    }
}
