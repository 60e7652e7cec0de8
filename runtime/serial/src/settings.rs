//! A robot's configuration: a TOML file, the defaults, and where each value came from.

use std::fmt::{self, Write as _};
use std::path::Path;

use mdle_host::read_text;
use mdle_runtime::capability::Steering;
use serde::de::DeserializeOwned;

/// The largest configuration that is read, in bytes.
const LARGEST: u64 = 1_000_000;

/// A value with a few words on it, and where it came from.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Entry {
    name: &'static str,
    value: String,
    about: &'static str,
    from: String,
}

/// Takes down each value as it is chosen.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Settings {
    file: Option<String>,
    entries: Vec<Entry>,
}

impl Settings {
    /// What the file says, if there is one; a type whose fields are options can say that there is nothing.
    ///
    /// # Errors
    /// The file cannot be read, is no TOML, or has a key or a value that it cannot have: where and why.
    pub fn read<F: DeserializeOwned + Default>(file: Option<&Path>) -> Result<(F, Self), String> {
        let Some(path) = file else { return Ok((F::default(), Self::default())) };
        let name = path.display().to_string();
        let text = read_text(path, LARGEST).map_err(|error| format!("{name}: {error}"))?;
        let said = toml::from_str(&text).map_err(|error| format!("{name}: {}", error.to_string().trim_end()))?;
        Ok((said, Self { file: Some(name), entries: Vec::new() }))
    }

    /// What the file says of this value, or the default.
    pub fn value<T: fmt::Debug>(&mut self, name: &'static str, said: Option<T>, default: T, about: &'static str) -> T {
        match (said, &self.file) {
            (Some(value), Some(file)) => {
                let from = file.clone();
                self.noted(name, value, about, &from)
            }
            (Some(value), None) => self.noted(name, value, about, "default"),
            (None, _) => self.noted(name, default, about, "default"),
        }
    }

    /// The device: what the command line says, else the file, else the first serial port.
    pub fn device(&mut self, given: Option<&str>, said: Option<String>) -> String {
        let about = "the serial port, or tcp:ADDRESS:PORT";
        match given {
            Some(device) => self.noted("device", device.to_owned(), about, "--device"),
            None => self.value("device", said, "/dev/ttyS0".to_owned(), about),
        }
    }

    /// How hard laws steer: what the file says of it, for the rest what is usual.
    pub fn steering(&mut self, rotate: Option<f64>, align: Option<f64>, avoid: Option<f64>) -> Steering {
        let usual = Steering::USUAL;
        Steering {
            rotate: self.value("rotate-gain", rotate, usual.rotate, "rad/s for each radian, of rotate, turn and path"),
            align: self.value("align-gain", align, usual.align, "rad/s for each metre, of align"),
            avoid: self.value("avoid-gain", avoid, usual.avoid, "rad/s for each radian, of goAvoid"),
        }
    }

    /// What is wrong with a value, with the file's name if there is one.
    #[must_use]
    pub fn blamed(&self, why: &str) -> String {
        self.file.as_ref().map_or_else(|| why.to_owned(), |file| format!("{file}: {why}"))
    }

    fn noted<T: fmt::Debug>(&mut self, name: &'static str, value: T, about: &'static str, from: &str) -> T {
        self.entries.push(Entry { name, value: format!("{value:?}"), about, from: from.to_owned() });
        value
    }
}

/// As TOML that can be given back with `--config`, with what each value means and where it came from.
impl fmt::Display for Settings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Entry { name, value, about, from } in &self.entries {
            let mut line = String::new();
            write!(line, "{name} = {value}")?;
            writeln!(f, "{line:34} # {about} ({from})")?;
        }
        Ok(())
    }
}

/// Whether laws that steer so hard can hold a robot: one that steers less hardly turns, one that steers more swings.
///
/// # Errors
/// The sentence that says which cannot.
pub fn can_steer(steering: &Steering) -> Result<(), String> {
    within("rotate-gain", steering.rotate, 0.1, 10.0)?;
    within("align-gain", steering.align, 0.1, 10.0)?;
    within("avoid-gain", steering.avoid, 0.1, 10.0)
}

/// Whether a value is from `least` to `most`.
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
