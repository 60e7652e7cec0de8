//! `mdle.toml`: target, world and options of runs of the plans in its folder (docs/src/reference/interfaces.md, 1.4).

mod text;

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::Failure;
use crate::link;
use mdle_compiler::builtin;
use mdle_files::Target;
use mdle_files::read::{self, Unread};
use text::{Setting, SettingsText};

/// Name of the settings file.
const NAME: &str = "mdle.toml";
/// Maximum size of the settings file, in bytes.
const LARGEST: u64 = 1_000_000;

/// The settings of the plans in a folder; empty if the folder has no `mdle.toml`.
#[derive(Debug, Default)]
pub(super) struct Settings {
    /// Path of the file, if there is one.
    file: Option<PathBuf>,
    text: SettingsText,
}

/// An option that a run gets from an `mdle.toml`.
#[derive(Debug)]
pub(super) struct RunOption {
    /// Place of the option, as in `plans/mdle.toml:3`.
    place: String,
    /// Arguments of the executable.
    pub(super) arguments: Vec<OsString>,
}

/// Returns the path of the `mdle.toml` beside the plan in the file `plan`. A plan on standard input has none.
pub(super) fn file_beside(plan: &Path) -> Option<PathBuf> {
    (plan != Path::new("-")).then(|| plan.with_file_name(NAME))
}

/// Returns the target of the `mdle.toml` beside the plan in the file `plan`, after a check of what a run would take
/// from the file.
pub(super) fn checked_target(plan: &Path) -> Result<Target, Failure> {
    let settings = Settings::beside(plan)?;
    let target = settings.target(None)?;
    settings.run_options(None, &[]).map(|_| target)
}

/// Returns the target for the plan in the file `plan`: the one that the command line names with `option`, or else that
/// of the `mdle.toml` beside the plan.
pub(super) fn target(plan: &Path, option: Option<&str>) -> Result<Target, Failure> {
    Settings::beside(plan)?.target(option)
}

impl Settings {
    /// Reads the `mdle.toml` beside the plan in the file `plan`.
    pub(super) fn beside(plan: &Path) -> Result<Self, Failure> {
        let Some(file) = file_beside(plan) else { return Ok(Self::default()) };
        let bytes = match read::file(&file, LARGEST) {
            Ok(bytes) => bytes,
            // The second if the folder is none, which is said of the plan.
            Err(Unread::System(error))
                if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) =>
            {
                return Ok(Self::default());
            }
            Err(why) => return Err(Failure::usage(why.of(file.display()))),
        };
        let text = String::from_utf8(mdle_files::without_mark(bytes))
            .map_err(|_| Failure::usage(format!("`{}` is not UTF-8 text", file.display())))?;
        let text = text::read(&text)
            .map_err(|error| Failure::usage(format!("{}:{}: {}", file.display(), error.line, error.message)))?;
        Ok(Self { file: Some(file), text })
    }

    /// Returns the target that the command line names with `option`, or else that of the file; without either, a robot
    /// that has every capability.
    pub(super) fn target(&self, option: Option<&str>) -> Result<Target, Failure> {
        let mut target = match (option, &self.text.target) {
            (Some(_), _) | (None, None) => mdle_files::target(option).map_err(Failure::from),
            (None, Some(own)) => {
                let named = |message| format!("{}: {message}", self.place(own.line));
                let target = mdle_files::target(Some(&self.target_name(&own.value))).map_err(Failure::from);
                target.map_err(|failure| Failure { message: failure.message.map(named), ..failure })
            }
        }?;
        target.settings = self.file.clone();
        Ok(target)
    }

    /// Returns `true` if the command line or the file names a target.
    pub(super) fn names_target(&self, option: Option<&str>) -> bool {
        option.is_some() || self.text.target.is_some()
    }

    /// Returns the options of the file for a run, except those that are also in `given`, the arguments of the command
    /// line. The options are for the target of the file: if the command line names another one with `target`, there are
    /// none.
    pub(super) fn run_options(&self, target: Option<&str>, given: &[String]) -> Result<Vec<RunOption>, Failure> {
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
        let world = world.map(|world| self.world(world, target.or(own)));
        let known = target.or(own).and_then(link::options);
        let others = self.text.options.iter().filter(|option| !is_given(&option.name)).map(|option| {
            let place = self.place(option.line);
            if let Some(known) = &known {
                option.must_be_among(known).map_err(|message| Failure::usage(format!("{place}: {message}")))?;
            }
            let arguments = option.arguments.iter().map(OsString::from).collect();
            Ok(RunOption { place, arguments })
        });
        world.into_iter().chain(others).collect()
    }

    /// The option `--world`: a file of that name in the folder of the `mdle.toml`, or else a world that the target
    /// knows.
    fn world(&self, world: &Setting, robot: Option<&str>) -> Result<RunOption, Failure> {
        let (place, file) = (self.place(world.line), self.in_folder(&world.value));
        if !file.is_file() && world.value.contains(['.', '/']) {
            return Err(Failure::usage(format!("{place}: there is no file `{}`", file.display())));
        }
        let worlds: Vec<_> = robot.into_iter().flat_map(link::worlds).collect();
        if !file.is_file() && !worlds.is_empty() && !worlds.contains(&&*world.value) {
            let (name, worlds) = (&world.value, worlds.join(", "));
            let message = format!("{place}: there is no such world or file: `{name}`; the worlds are {worlds}");
            return Err(Failure::usage(message));
        }
        let mut argument = OsString::from("--world=");
        argument.push(if file.is_file() { file.as_os_str() } else { world.value.as_ref() });
        Ok(RunOption { place, arguments: vec![argument] })
    }

    /// Name or folder of the target, as `--target` takes it: a relative folder is relative to the folder of the file.
    fn target_name(&self, value: &str) -> String {
        let is_robot = builtin::alphabets().iter().any(|alphabet| alphabet.target && alphabet.name == value);
        let folder = self.in_folder(value);
        if !is_robot && (folder.is_dir() || value.contains('/')) {
            folder.display().to_string()
        } else {
            value.to_owned()
        }
    }

    /// The path `value`, which is relative to the folder of the file.
    fn in_folder(&self, value: &str) -> PathBuf {
        self.file.as_deref().and_then(Path::parent).unwrap_or(Path::new("")).join(value)
    }

    /// The place of a line, for messages.
    fn place(&self, line: usize) -> String {
        format!("{}:{line}", self.file.as_deref().unwrap_or(Path::new(NAME)).display())
    }
}

impl RunOption {
    /// Fails if the executable `program` does not have the option, or not with this value.
    ///
    /// An executable judges its arguments one by one, and does nothing else before it answers `--version`.
    pub(super) fn must_fit(&self, program: &Path) -> Result<(), Failure> {
        let answer = Command::new(program).args(&self.arguments).arg("--version").stdin(Stdio::null()).output();
        // A program that cannot be run cannot become this process either, which says why.
        let Some(refusal) = answer.ok().filter(|answer| answer.status.code() == Some(2)) else { return Ok(()) };
        let text = String::from_utf8_lossy(&refusal.stderr).into_owned();
        let is_about_option = |line: &&str| !line.starts_with("Usage:") && !line.starts_with("For more information");
        let lines = text.lines().take_while(is_about_option).filter(|line| !line.trim().is_empty());
        let lines: Vec<_> = lines.map(|line| line.strip_prefix("error: ").unwrap_or(line)).collect();
        Err(Failure::usage(format!("{}: {}", self.place, lines.join("\n"))))
    }
}
