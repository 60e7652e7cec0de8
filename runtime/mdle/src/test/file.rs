//! A test file: its keys and values, as written (docs/src/testing.md).

use std::ops::Range;
use std::path::{Path, PathBuf};

use mdle_compiler::alphabet::did_you_mean;
use mdle_quantity::{TomlKeys, TomlMistake};
use mdle_runtime::Printable;
use serde::{Deserialize, Serialize};
use toml::Spanned;

/// Suffix of the name of a test file.
pub(super) const ENDING: &str = ".test.toml";
/// Description of a number without a sign, for messages.
const COUNT: &str = "a whole number from 0 on";
/// Maximum size of a test file, in bytes.
const LARGEST: u64 = 4_000_000;

/// Keys of a test file, by the kind of their values.
const KEYS: TomlKeys = TomlKeys { numbers: &["t", "way", "heading"], lists: &[], flags: &[], tables: &["test"] };

/// A value with its place in the file.
pub(super) type At<T> = Spanned<T>;

/// A test file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct TestFile {
    /// Path of the plan's file, relative to the folder of the test file; by default, the plan beside the test file.
    pub(super) plan: Option<At<PathBuf>>,
    /// Name of the plan, for a file with several plans.
    pub(super) name: Option<At<String>>,
    /// Name or folder of the target.
    pub(super) target: Option<At<String>>,
    /// The tests.
    #[serde(default)]
    pub(super) test: Vec<TestText>,
}

/// A test as written.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct TestText {
    pub(super) name: At<String>,
    /// The turns of a script; a test without a script runs in the simulator.
    pub(super) script: Option<At<Vec<At<ScriptTurn>>>>,
    pub(super) world: Option<At<String>>,
    pub(super) start: Option<At<String>>,
    pub(super) start_noise: Option<At<String>>,
    pub(super) body: Option<At<String>>,
    pub(super) without: Option<At<String>>,
    pub(super) goal: Option<At<String>>,
    pub(super) battery: Option<At<u64>>,
    pub(super) period: Option<At<String>>,
    pub(super) paths: Option<At<String>>,
    pub(super) timeout: Option<At<String>>,
    pub(super) seed: Option<At<u64>>,
    pub(super) seeds: Option<At<u64>>,
    #[serde(default)]
    pub(super) faults: Vec<FaultText>,
    #[serde(default)]
    pub(super) expect: ExpectText,
}

/// A turn of a script, with the same keys as a line of `mdlec trace --script`.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ScriptTurn {
    t: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    way: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    heading: Option<f64>,
    #[serde(default)]
    fired: Vec<String>,
    #[serde(default)]
    completed: Vec<String>,
}

/// A fault of the simulated robot.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FaultText {
    /// Name of the fault.
    pub(super) fault: At<String>,
    /// Time of the run at which the fault begins.
    pub(super) from: Option<At<String>>,
    /// Time of the run at which the fault ends.
    pub(super) until: Option<At<String>>,
    pub(super) sonar: Option<At<u8>>,
    pub(super) range: Option<At<String>>,
    pub(super) percent: Option<At<u8>>,
}

/// The expectations of a test.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct ExpectText {
    /// All atoms that must begin, in order; no other atom may begin.
    pub(super) atoms: Option<At<Vec<At<String>>>>,
    /// Atoms that must begin in this order; other atoms may begin between them.
    pub(super) order: Option<At<Vec<At<String>>>>,
    #[serde(default)]
    pub(super) transitions: Vec<At<TransitionText>>,
    #[serde(default)]
    pub(super) never: Vec<At<String>>,
    pub(super) end: Option<At<String>>,
    pub(super) pose: Option<At<String>>,
    pub(super) most_turns: Option<At<u64>>,
    pub(super) most_transitions: Option<At<u64>>,
    pub(super) most_time: Option<At<String>>,
}

/// An expected transition.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct TransitionText {
    pub(super) from: Option<At<String>>,
    pub(super) to: Option<At<String>>,
    pub(super) by: Option<At<String>>,
    /// Time of the run before which the transition does not count.
    pub(super) after: Option<At<String>>,
    /// Time of the run by which the transition must be made.
    pub(super) within: Option<At<String>>,
}

impl ExpectText {
    /// Returns `true` if there are no expectations.
    pub(super) fn is_empty(&self) -> bool {
        let Self { atoms, order, transitions, never, end, pose, most_turns, most_transitions, most_time } = self;
        let order = order.as_ref().is_none_or(|order| order.get_ref().is_empty());
        let texts = [end, pose, most_time].iter().all(|text| text.is_none());
        let most = [most_turns, most_transitions].iter().all(|most| most.is_none());
        atoms.is_none() && order && texts && most && transitions.is_empty() && never.is_empty()
    }
}

impl TestText {
    /// Returns the options of the simulator that the test gives, each with the place of its value.
    pub(super) fn options(&self) -> Vec<(&'static str, String, Range<usize>)> {
        let texts = [
            ("world", &self.world),
            ("start", &self.start),
            ("start-noise", &self.start_noise),
            ("body", &self.body),
            ("without", &self.without),
            ("goal", &self.goal),
            ("period", &self.period),
            ("paths", &self.paths),
            ("timeout", &self.timeout),
        ];
        let texts = texts
            .into_iter()
            .filter_map(|(name, text)| text.as_ref().map(|text| (name, text.get_ref().clone(), text.span())));
        let battery = self.battery.as_ref().map(|charge| ("battery", charge.get_ref().to_string(), charge.span()));
        texts.chain(battery).collect()
    }
}

/// An error in a test file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct TestFileError {
    /// Byte range in the file; `None` for the whole file.
    pub(super) place: Option<Range<usize>>,
    /// Description of the error.
    pub(super) message: String,
    /// Text to type instead; empty if there is none.
    pub(super) help: String,
}

impl TestFileError {
    /// Returns an error at a place of the file.
    pub(super) fn at(place: Range<usize>, message: impl Into<String>) -> Self {
        Self { place: Some(place), message: message.into(), help: String::new() }
    }

    /// Sets the help text of the error.
    pub(super) fn help(self, help: impl Into<String>) -> Self {
        Self { help: help.into(), ..self }
    }
}

/// Reads the text of a test file.
///
/// # Errors
/// Fails with a message, but without a place, if the file cannot be read.
pub(super) fn text(path: &Path) -> Result<String, TestFileError> {
    let unread = |error: std::io::Error| TestFileError {
        place: None,
        message: format!("{} cannot be read: {error}", path.display()),
        help: String::new(),
    };
    mdle_host::read_text(path, LARGEST).map_err(unread)
}

/// Reads a test file.
///
/// # Errors
/// Fails if the text is not TOML, has unknown keys or values of the wrong type, or two tests of the same name.
pub(super) fn read(text: &str) -> Result<TestFile, TestFileError> {
    let file: TestFile = toml::from_str(text).map_err(|error| refused(&error, text))?;
    for (number, test) in file.test.iter().enumerate() {
        let name = test.name.get_ref();
        if name.trim().is_empty() {
            return Err(TestFileError::at(test.name.span(), "a test needs a name"));
        }
        if file.test[..number].iter().any(|before| before.name.get_ref() == name) {
            let message = format!("there is another test with the name `{}`", Printable(name));
            return Err(TestFileError::at(test.name.span(), message).help("give each test of a file a name of its own"));
        }
    }
    if file.test.is_empty() {
        let message = "the file has no test".to_owned();
        let help = "write `[[test]]`, then `name = \"…\"` and what the test expects, as in `expect.end = \"bumper\"`";
        return Err(TestFileError { place: None, message, help: help.to_owned() });
    }
    Ok(file)
}

/// Returns the error for text that the TOML parser refuses. For an unknown key, the error proposes the most similar
/// name.
fn refused(error: &toml::de::Error, text: &str) -> TestFileError {
    let place = error.span();
    let mistake = place.clone().and_then(|place| KEYS.mistake(text, place.start, error.message()));
    if let Some(TomlMistake { message, help }) = mistake {
        return TestFileError { place, message, help };
    }
    let words = [("a sequence", "a list"), ("map", "a table"), ("u64", COUNT), ("u8", COUNT)];
    let message = error.message().replace('\n', "; ");
    let message = words.iter().fold(message, |message, (type_name, word)| match message.starts_with("invalid ") {
        true => message.replace(type_name, word),
        false => message,
    });
    let Some((unknown, known)) = message.strip_prefix("unknown field `").and_then(|rest| rest.split_once('`')) else {
        let has_no_value = message.starts_with("key with no value");
        let help = if has_no_value { "write `= ` and a value, as in `expect.never = [\"bumper\"]`" } else { "" };
        return TestFileError { place, message, help: help.to_owned() };
    };
    let known: Vec<&str> = known.split('`').skip(1).step_by(2).collect();
    let message = format!("there is no key `{}`{}", Printable(unknown), did_you_mean(unknown, &known));
    TestFileError { place, message, help: format!("the keys are {}", known.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        let TestFileError { place, message, help } = read(text).unwrap_err();
        format!("{:?} {message} | {help}", place.map(|place| &text[place]))
    }

    #[test]
    fn a_file_has_tests_with_names_of_their_own() {
        let file = read("[[test]]\nname = \"a\"\nexpect.end = \"bumper\"\n[[test]]\nname = \"b\"\n").unwrap();
        assert_eq!(file.test.len(), 2);
        assert!(file.test[0].expect.end.is_some() && file.test[1].expect.end.is_none());
        insta::assert_snapshot!(
            [
                "",
                "[[test]]\nname = \"a\"\n[[test]]\nname = \"a\"\n",
                "[[test]]\nname = \" \"\n",
                "[[test]]\nworld = \"room\"\n",
            ]
            .map(message)
            .join("\n")
        );
    }

    #[test]
    fn unknown_keys_have_a_near_name() {
        insta::assert_snapshot!(
            [
                "plann = \"a.mdle\"\n",
                "[[test]]\nname = \"a\"\nwrold = \"room\"\n",
                "[[test]]\nname = \"a\"\nexpect.nevr = []\n",
                "[[test]]\nname = \"a\"\nscript = [{ t = 0, fire = [\"bumper\"] }]\n",
                "[[test]]\nname = \"a\"\nexpect.most-turns = \"many\"\n",
                "[[test]]\nname = \"a\"\nfaults = [{ fault = \"bumper\", form = \"2s\" }]\n",
                "[test]\nname = \"a\"\n",
                "[[test]\n",
            ]
            .map(message)
            .join("\n")
        );
    }
}
