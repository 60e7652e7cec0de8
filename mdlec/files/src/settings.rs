//! Reads an `mdle.toml`, which contains the target, the world and the options of runs for the plans in its folder
//! (docs/src/reference/interfaces.md, 1.4).

mod text;

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

use mdle_compiler::builtin;

use crate::read::{self, Unread};
use crate::{InputError, Target, target};
use text::{Setting, SettingsText};

/// Name of the settings file.
const NAME: &str = "mdle.toml";
/// Maximum size of the settings file, in bytes.
const LARGEST: u64 = 1_000_000;

/// The settings of the plans in a folder; empty if the folder has no `mdle.toml`.
#[derive(Debug, Default)]
pub struct Settings {
    /// Path of the file; `None` if there is none.
    file: Option<PathBuf>,
    text: SettingsText,
}

/// The worlds and the options of a target, as far as they are known before a run.
#[derive(Debug, Default)]
pub struct KnownSettings {
    /// Names of the worlds; empty if they are not known.
    pub worlds: Vec<&'static str>,
    /// Options of the target, each with the placeholder of its value (empty for an option without a value);
    /// `None` if they are not known.
    pub options: Option<Vec<(&'static str, &'static str)>>,
}

/// A child process that an `mdle.toml` names as a module.
#[derive(Debug)]
pub struct NamedProcess<'s> {
    /// Place of the entry, such as `plans/mdle.toml:3`.
    pub place: String,
    /// Name of the module.
    pub name: &'s str,
    /// Command line of the process.
    pub command: &'s str,
}

/// The safety file that an `mdle.toml` names.
#[derive(Debug)]
pub struct SafetyEntry {
    /// Place of the entry, such as `plans/mdle.toml:3`.
    pub place: String,
    /// Path of the safety file.
    pub file: PathBuf,
}

/// An option that a run gets from an `mdle.toml`.
#[derive(Debug)]
pub struct RunOption {
    /// Place of the option, such as `plans/mdle.toml:3`.
    place: String,
    /// Arguments for the executable.
    pub arguments: Vec<OsString>,
}

/// Returns the path of the `mdle.toml` beside the plan in the file `plan`. Returns `None` for a plan on standard input.
#[must_use]
pub fn file_beside(plan: &Path) -> Option<PathBuf> {
    (plan != Path::new("-")).then(|| plan.with_file_name(NAME))
}

impl Settings {
    /// Reads the `mdle.toml` beside the plan in the file `plan`.
    ///
    /// # Errors
    /// Fails if the file cannot be read or has errors.
    pub fn beside(plan: &Path) -> Result<Self, InputError> {
        let Some(file) = file_beside(plan) else { return Ok(Self::default()) };
        let bytes = match read::file(&file, LARGEST) {
            Ok(bytes) => bytes,
            // `NotADirectory` means that the plan's folder is a file; the error for the plan reports this.
            Err(Unread::System(error))
                if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) =>
            {
                return Ok(Self::default());
            }
            Err(why) => return Err(InputError::Unusable(why.of(file.display()))),
        };
        let text = String::from_utf8(crate::without_mark(bytes))
            .map_err(|_| InputError::Unusable(format!("`{}` is not UTF-8 text", file.display())))?;
        let text = text::read(&text)
            .map_err(|error| InputError::Unusable(format!("{}:{}: {}", file.display(), error.line, error.message)))?;
        Ok(Self { file: Some(file), text })
    }

    /// Returns the target that the command line names with `option`, or else the target of the file. If neither is
    /// given, returns a robot that has every capability.
    ///
    /// # Errors
    /// Fails if there is no such target, or if its alphabet cannot be read or has errors.
    pub fn target(&self, option: Option<&str>) -> Result<Target, InputError> {
        let mut target = match (option, &self.text.target) {
            (Some(_), _) | (None, None) => target(option),
            (None, Some(own)) => {
                let named = |error| InputError::NamedAt { place: self.place(own.line), error: Box::new(error) };
                target(Some(&self.target_name(&own.value))).map_err(named)
            }
        }?;
        target.settings = self.file.clone();
        Ok(target)
    }

    /// Returns the name of the target that the command line gives with `option`, or else the name in the file. Returns
    /// `None` if neither is given.
    #[must_use]
    pub fn name_of_target(&self, option: Option<&str>) -> Option<String> {
        let own = || self.text.target.as_ref().map(|own| self.target_name(&own.value));
        option.map(str::to_owned).or_else(own)
    }

    /// Returns `true` if the command line or the file names a target.
    #[must_use]
    pub fn names_target(&self, option: Option<&str>) -> bool {
        option.is_some() || self.text.target.is_some()
    }

    /// Returns the child processes that a run of `mdle` loads as modules.
    pub fn modules(&self) -> impl Iterator<Item = NamedProcess<'_>> {
        self.text.modules.iter().map(|(name, command)| NamedProcess {
            place: self.place(command.line),
            name,
            command: &command.value,
        })
    }

    /// Returns the file of the safety rules that a run of `mdle` applies to the inputs before they reach the robot.
    #[must_use]
    pub fn safety(&self) -> Option<SafetyEntry> {
        let own = self.text.safety.as_ref()?;
        Some(SafetyEntry { place: self.place(own.line), file: self.in_folder(&own.value) })
    }

    /// Returns the options of the file for a run, except those that are also in `given`, the arguments of the command
    /// line. The options apply to the target of the file: if the command line names a different target with `target`,
    /// no options are returned. `known` returns the known worlds and options of a target; the run itself checks
    /// everything else.
    ///
    /// # Errors
    /// Fails if there is no such world or option.
    pub fn run_options(
        &self,
        target: Option<&str>,
        given: &[String],
        known: impl Fn(&str) -> KnownSettings,
    ) -> Result<Vec<RunOption>, InputError> {
        let own = self.text.target.as_ref().map(|own| &*own.value);
        if let (Some(target), Some(own)) = (target, own)
            && target != own
            && target != self.target_name(own)
        {
            return Ok(Vec::new());
        }
        let is_given = |name: &str| {
            let names = given.iter().filter_map(|argument| argument.strip_prefix("--"));
            names.map(|argument| argument.split_once('=').map_or(argument, |(name, _)| name)).any(|given| given == name)
        };
        let world = self.text.world.as_ref().filter(|_| !is_given("world"));
        let KnownSettings { worlds, options } = target.or(own).map(known).unwrap_or_default();
        let world = world.map(|world| self.world(world, &worlds));
        let others = self.text.options.iter().filter(|option| !is_given(&option.name)).map(|option| {
            let place = self.place(option.line);
            if let Some(known) = &options {
                option.must_be_among(known).map_err(|message| InputError::Unusable(format!("{place}: {message}")))?;
            }
            let arguments = option.arguments.iter().map(OsString::from).collect();
            Ok(RunOption { place, arguments })
        });
        world.into_iter().chain(others).collect()
    }

    /// Returns the option `--world`: its value is a file of that name in the folder of the `mdle.toml`, or else a world
    /// that the target knows.
    fn world(&self, world: &Setting, worlds: &[&str]) -> Result<RunOption, InputError> {
        let (place, file) = (self.place(world.line), self.in_folder(&world.value));
        if !file.is_file() && world.value.contains(['.', '/']) {
            return Err(InputError::Unusable(format!("{place}: there is no file `{}`", file.display())));
        }
        if !file.is_file() && !worlds.is_empty() && !worlds.contains(&&*world.value) {
            let (name, worlds) = (&world.value, worlds.join(", "));
            let message = format!("{place}: there is no such world or file: `{name}`; the worlds are {worlds}");
            return Err(InputError::Unusable(message));
        }
        let mut argument = OsString::from("--world=");
        argument.push(if file.is_file() { file.as_os_str() } else { world.value.as_ref() });
        Ok(RunOption { place, arguments: vec![argument] })
    }

    /// Returns the name or folder of the target, as `--target` takes it. A relative folder is relative to the
    /// folder of the file.
    fn target_name(&self, value: &str) -> String {
        let is_robot = builtin::alphabets().iter().any(|alphabet| alphabet.target && alphabet.name == value);
        let folder = self.in_folder(value);
        if !is_robot && (folder.is_dir() || value.contains('/')) {
            folder.display().to_string()
        } else {
            value.to_owned()
        }
    }

    /// Returns the path `value`, which is relative to the folder of the file.
    fn in_folder(&self, value: &str) -> PathBuf {
        self.file.as_deref().and_then(Path::parent).unwrap_or(Path::new("")).join(value)
    }

    /// Returns the place of a line, for messages.
    fn place(&self, line: usize) -> String {
        format!("{}:{line}", self.file.as_deref().unwrap_or(Path::new(NAME)).display())
    }
}

impl RunOption {
    /// Returns the error for an option that a program refused with this text on standard error.
    #[must_use]
    pub fn refused(&self, text: &str) -> InputError {
        let is_about_option = |line: &&str| !line.starts_with("Usage:") && !line.starts_with("For more information");
        let lines = text.lines().take_while(is_about_option).filter(|line| !line.trim().is_empty());
        let lines: Vec<_> = lines.map(|line| line.strip_prefix("error: ").unwrap_or(line)).collect();
        InputError::Unusable(format!("{}: {}", self.place, lines.join("\n")))
    }
}
