//! Defines the reasons why a plan or a target cannot be read, with messages that tell the user what to type.

use std::fmt;

use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::builtin;
use mdle_compiler::diagnostic::{Diagnostic, Sources};

/// Reason why a plan or a target cannot be read.
#[derive(Debug)]
pub enum InputError {
    /// A file cannot be read, or a folder is not a target; contains the error message.
    Unusable(String),
    /// No target is selected, although Rust code can be written only for a target.
    NoTarget,
    /// There is no target of this name.
    UnknownTarget(String),
    /// A file, such as an `mdle.toml`, names a target or a plan that cannot be read.
    NamedAt {
        /// Line of the file, as in `plans/mdle.toml:3`.
        place: String,
        /// Reason why the target or the plan cannot be read.
        error: Box<InputError>,
    },
    /// A file has errors.
    Faulty(FaultyFile),
    /// The file has no plan of the requested name.
    UnknownPlan {
        /// Name of the file.
        file: String,
        /// Name of the requested plan.
        name: String,
        /// Names of the file's plans.
        plans: Vec<String>,
    },
    /// The file contains the plan of a group, and no robot of the group was selected.
    Group {
        /// Name of the file.
        file: String,
        /// Names of the plans of the robots.
        plans: Vec<String>,
    },
    /// No plan was selected, and the file does not contain exactly one plan that no other plan uses.
    NotOnePlan {
        /// Name of the file.
        file: String,
        /// Names of the plans that no other plan uses.
        plans: Vec<String>,
    },
}

/// A file with errors, as diagnostics.
#[derive(Debug)]
pub struct FaultyFile {
    /// Files to which the diagnostics refer.
    pub sources: Sources,
    /// Errors of the file, and possibly warnings.
    pub diagnostics: Vec<Diagnostic>,
    /// Name of the target if the file is an alphabet; otherwise `None`.
    pub target: Option<String>,
}

/// The syntax in which a user names targets and plans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spelling {
    /// Options of a command line: `--target sim`.
    CommandLine,
    /// Calls in a build script: `.target("sim")`.
    BuildScript,
    /// Entries of a TOML file: `target = "sim"`.
    Entry,
    /// Entries of a test file. In these entries, `plan` names a file and `name` names a plan.
    TestEntry,
}

impl Spelling {
    /// Returns the text that sets the option `name` to `value`.
    fn option(self, name: &str, value: &str) -> String {
        match self {
            Self::CommandLine => format!("--{name} {value}"),
            Self::BuildScript => format!(".{name}({value:?})"),
            Self::TestEntry if name == "plan" => format!("name = {value:?}"),
            Self::Entry | Self::TestEntry => format!("{name} = {value:?}"),
        }
    }

    /// Returns the text by which a user selects the plan `name` of a file, for messages.
    fn plan(self, name: &str) -> String {
        let place = match self {
            Self::TestEntry => " before the first test",
            Self::CommandLine | Self::BuildScript | Self::Entry => "",
        };
        format!("`{}`{place}", self.option("plan", name))
    }
}

impl InputError {
    /// Returns the file with errors if this is the reason; otherwise `None`. The file may also be one that another
    /// file, such as an `mdle.toml`, names.
    #[must_use]
    pub fn faulty_file(self) -> Option<FaultyFile> {
        match self {
            Self::Faulty(file) => Some(file),
            Self::NamedAt { error, .. } => error.faulty_file(),
            Self::Unusable(_)
            | Self::NoTarget
            | Self::UnknownTarget(_)
            | Self::UnknownPlan { .. }
            | Self::Group { .. }
            | Self::NotOnePlan { .. } => None,
        }
    }

    /// Returns the message, with options in the user's syntax. The message does not include the diagnostics of
    /// [`InputError::Faulty`]. It is empty for a plan file with errors; for an alphabet with errors, it names the
    /// target.
    #[must_use]
    pub fn message(&self, spelling: Spelling) -> String {
        match self {
            Self::Unusable(sentence) => sentence.clone(),
            Self::NoTarget => {
                let option = spelling.option("target", "sim");
                format!("for which robot? Name it, as in `{option}`; `mdlec targets` lists them")
            }
            Self::UnknownTarget(name) => unknown_target(name, spelling),
            Self::NamedAt { place, error } => match error.message(spelling) {
                message if message.is_empty() => message,
                message => format!("{place}: {message}"),
            },
            Self::Faulty(FaultyFile { target: Some(name), .. }) => {
                format!("the alphabet of target `{name}` has errors")
            }
            Self::Faulty(FaultyFile { target: None, .. }) => String::new(),
            Self::UnknownPlan { file, name, plans } => {
                let known: Vec<_> = plans.iter().map(String::as_str).collect();
                let near = did_you_mean(name, &known);
                format!("`{file}` has no plan `{name}`{near}\nhelp: its plans are {}", plans.join(", "))
            }
            Self::Group { file, plans } => format!(
                "`{file}` is the plan of a group, and has one for each robot: {}\nhelp: name one of them, as in {}; \
                 `mdle run SCENARIO.toml` runs all of them, simulated",
                plans.join(", "),
                spelling.plan(plans.first().map_or("NAME", String::as_str)),
            ),
            Self::NotOnePlan { file, plans } => match plans.first() {
                None => format!(
                    "every plan of `{file}` is used by another or takes parameters\nhelp: name one of them, as in {}, \
                     or write a plan that uses it",
                    spelling.plan("NAME"),
                ),
                Some(first) => format!(
                    "`{file}` contains several plans that no other plan uses: {}\nhelp: name one of them, as in {}",
                    plans.join(", "),
                    spelling.plan(first),
                ),
            },
        }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message(Spelling::CommandLine))
    }
}

impl std::error::Error for InputError {}

fn unknown_target(name: &str, spelling: Spelling) -> String {
    let known: Vec<_> = builtin::alphabets().iter().filter(|found| found.target).map(|found| found.name).collect();
    if name.contains('/') {
        return format!("there is no folder `{name}`\nhelp: the built-in targets are {}", known.join(", "));
    }
    format!(
        "there is no target `{name}`{}\nhelp: the targets are {}; a target of your own is named by its folder, as in \
         `{}`",
        did_you_mean(name, &known),
        known.join(", "),
        spelling.option("target", "../rover")
    )
}
