//! The command line by which a program that runs a plan was called: the words of the program's name, and the options.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use mdle_record::SafetyTexts;

/// Words of the command line by which a program that runs a plan was called.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Call {
    /// Words before the options, which begin with the program's own name, such as `./dock` or `mdle run dock.mdle
    /// --target sim`. Usage and summaries show these words.
    pub words: Vec<OsString>,
    /// Options after these words.
    pub options: Vec<OsString>,
    /// Files that the program has read for the plan; no option may name such a file for writing.
    pub read: Vec<PathBuf>,
    /// Data of the plan that a record contains.
    pub recorded: RecordedPlan,
    /// Name of a path that the run itself records; the path's file need not exist when the run starts.
    pub later_path: Option<String>,
    /// Long options that the program has parsed itself, with their dashes. One of them is proposed for an unknown
    /// option that resembles it.
    pub own_options: Vec<String>,
}

/// Data about a plan that a record contains. Parts that the program does not know are empty.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RecordedPlan {
    /// Name and text of each file of the plan, the plan's own file first; empty for an executable, which has no texts.
    pub files: Vec<(String, String)>,
    /// Description of the influences on the inputs other than the plan and the robot's outputs, such as safety rules;
    /// empty if there are none.
    pub beside: String,
    /// Safety rules of the run; `None` if it has no safety rules.
    pub safety: Option<SafetyTexts>,
    /// Words that influence the run but are not part of the command line, such as the target and the modules from a
    /// settings file.
    pub settings: Vec<String>,
}

impl Call {
    /// Returns the call of an executable with these arguments, which begin with the executable's name.
    pub(crate) fn of_executable(arguments: impl IntoIterator<Item = OsString>) -> Self {
        let mut arguments = arguments.into_iter();
        let words = arguments.next().into_iter().collect();
        Self {
            words,
            options: arguments.collect(),
            read: Vec::new(),
            recorded: RecordedPlan::default(),
            later_path: None,
            own_options: Vec::new(),
        }
    }

    /// Returns the words with which the usage line begins; `None` if the call consists of the program's name and
    /// options only.
    pub(crate) fn several_words(&self) -> Option<String> {
        let (program, others) = self.words.split_first().filter(|(_, others)| !others.is_empty())?;
        let name = Path::new(program).file_name().unwrap_or(program);
        Some([&[name.to_owned()], others].concat().join(" ".as_ref()).to_string_lossy().into_owned())
    }

    /// Returns the name of the program and the options, in the form that a command-line parser expects.
    pub(crate) fn arguments(&self) -> impl Iterator<Item = &OsString> {
        self.words.iter().take(1).chain(&self.options)
    }

    /// Returns the words in the form in which a user types them in a shell. If the program was called without a name,
    /// returns the name `plan` of the plan.
    pub(crate) fn command(&self, plan: &str) -> String {
        let words: Vec<String> = self.words.iter().map(|word| quoted(&word.to_string_lossy())).collect();
        if words.is_empty() { quoted(plan) } else { words.join(" ") }
    }

    /// Returns the command that repeats the run: the words of the call and the options that determine the run, quoted
    /// for a shell.
    pub(crate) fn repeating(&self, plan: &str) -> String {
        let settings = self.recorded.settings.iter().map(OsString::from);
        let words = settings.chain(determining(&self.options)).map(|word| quoted(&word.to_string_lossy()));
        [self.command(plan)].into_iter().chain(words).collect::<Vec<_>>().join(" ")
    }
}

/// Options that take a value and do not influence a run: they name files that the run writes, or processors.
const BESIDE: [&str; 8] =
    ["--log", "--plot", "--record", "--trail", "--trips", "--record-path", "--recorded-paths", "--threads"];

/// Returns the options that influence a run, without the options for its log, its pictures and its tables.
pub fn determining(options: &[OsString]) -> impl Iterator<Item = OsString> {
    let mut was_beside = false;
    let others = options.iter().filter(move |option| {
        let option = option.to_string_lossy();
        let is_beside = !was_beside && BESIDE.contains(&&*option);
        let is_value = std::mem::replace(&mut was_beside, is_beside);
        let is_assigned = option.split_once('=').is_some_and(|(name, _)| BESIDE.contains(&name));
        !(is_beside || is_value || is_assigned || ["--log-best-effort", "--watch"].contains(&&*option))
    });
    others.cloned()
}

/// Returns a word in the form in which a user types it in a shell, with quotes if necessary.
#[must_use]
pub fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./,=:+@%".contains(letter);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_repeated_without_the_files_that_it_writes() {
        let options = "--log --log --seed 7 --log=x --log-best-effort --logs --plot a.svg --trail=t.csv --threads 2";
        let options = options.split(' ').map(OsString::from);
        let settings = vec!["--module".to_owned(), "a=b c".to_owned()];
        let call = Call {
            words: ["mdle", "run", "a b"].map(OsString::from).into(),
            options: options.collect(),
            read: Vec::new(),
            recorded: RecordedPlan { settings, ..RecordedPlan::default() },
            later_path: None,
            own_options: Vec::new(),
        };
        assert_eq!(call.repeating("P"), "mdle run 'a b' --module 'a=b c' --seed 7 --logs");
    }

    #[test]
    fn a_call_is_shown_as_a_shell_takes_it() {
        let call = |words: &[&str]| Call {
            words: words.iter().map(Into::into).collect(),
            options: Vec::new(),
            read: Vec::new(),
            recorded: RecordedPlan::default(),
            later_path: None,
            own_options: Vec::new(),
        };
        assert_eq!(call(&["./it's"]).command("P"), r"'./it'\''s'");
        assert_eq!(call(&["mdle", "run", "a b.mdle"]).command("P"), "mdle run 'a b.mdle'");
        assert_eq!(call(&[]).command("P"), "P");
        assert_eq!(
            (call(&["./p"]).several_words(), call(&["bin/a", "b"]).several_words()),
            (None, Some("a b".to_owned()))
        );
    }
}
