//! The contents of a scenario file: its keys and values, as written (docs/src/many_robots.md).

use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use mdle_compiler::alphabet::did_you_mean;
use mdle_host::Quantity;
use mdle_quantity::{TomlKeys, TomlMistake};
use mdle_runtime::Printable;
use mdle_sim::Body;
use serde::Deserialize;
use toml::Spanned;

use crate::robot_name::{FORM, is_robot_name};

/// Maximum size of a scenario file, in bytes.
pub(super) const LARGEST: u64 = 4_000_000;

/// Keys of a scenario file, by the kind of their values.
const KEYS: TomlKeys =
    TomlKeys { numbers: &["loss", "duplication"], lists: &[], flags: &[], tables: &["robot", "sent-plan"] };

/// A value with its place in the file.
pub(super) type At<T> = Spanned<T>;

/// A scenario file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct ScenarioText {
    pub(super) world: Option<At<String>>,
    pub(super) seed: Option<At<u64>>,
    pub(super) timeout: Option<At<String>>,
    pub(super) period: Option<At<String>>,
    #[serde(default)]
    pub(super) link: LinkText,
    /// The robots of the scenario, in the order in which they move.
    #[serde(default)]
    pub(super) robot: Vec<RobotText>,
    /// Plans that robots send each other.
    #[serde(default)]
    pub(super) sent_plan: Vec<SentPlanText>,
    /// A crowd, which takes the place of robots with names; `None` if the scenario has no crowd.
    pub(super) crowd: Option<CrowdText>,
}

/// A crowd, as written.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct CrowdText {
    /// Number of robots.
    pub(super) robots: At<u64>,
    /// Path of the plan that each robot runs, relative to the folder of the scenario.
    pub(super) file: At<PathBuf>,
    /// Name of the plan to run, for a file with several plans.
    pub(super) plan: Option<At<String>>,
    pub(super) body: Option<At<String>>,
    /// Distance between two robots at the start, as written.
    pub(super) spacing: Option<At<String>>,
}

/// The link between the robots, as written.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct LinkText {
    /// Transmission time of a state, as written. This is a time, or a minimum and a maximum with `..` between them.
    pub(super) latency: Option<At<String>>,
    /// Probability that a state is lost.
    pub(super) loss: Option<At<f64>>,
    /// Probability that a state arrives twice.
    pub(super) duplication: Option<At<f64>>,
}

/// A robot, as written.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct RobotText {
    pub(super) name: At<String>,
    /// Path of the plan's file, relative to the folder of the scenario.
    pub(super) file: At<PathBuf>,
    /// Name of the plan to run, for a file with several plans.
    pub(super) plan: Option<At<String>>,
    pub(super) start: At<String>,
    pub(super) start_noise: Option<At<String>>,
    pub(super) body: Option<At<String>>,
    pub(super) seed: Option<At<u64>>,
    /// Folder of the paths that the plan replays, relative to the folder of the scenario.
    pub(super) paths: Option<At<PathBuf>>,
    /// Name of the path that the run replaces with the way back after each `path` and `Follow`.
    pub(super) records: Option<At<String>>,
    /// Time at which the robot's program is killed.
    pub(super) killed: Option<At<String>>,
    /// Radius of the robot's head, which has two ears. With ears, the module `heading` publishes the bearing of a
    /// sound.
    pub(super) ears: Option<At<String>>,
    /// Names of the modules whose attributes the robot shares with the other robots.
    #[serde(default)]
    pub(super) shares: Vec<String>,
    /// Names of the robots whose plans the robot accepts.
    #[serde(default)]
    pub(super) plans_from: Vec<At<String>>,
}

/// A plan that one robot sends to another, as written in the scenario file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct SentPlanText {
    /// Time at which the plan is sent, as written.
    pub(super) at: At<String>,
    pub(super) from: At<String>,
    pub(super) to: At<String>,
    /// Path of the plan's file, relative to the folder of the scenario.
    pub(super) file: At<PathBuf>,
    /// Moment at which the plan takes over, as written.
    pub(super) when: Option<At<String>>,
}

/// An error in a scenario file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ScenarioError {
    /// Byte range of the error in the file; `None` if the error concerns the whole file.
    pub(super) place: Option<Range<usize>>,
    /// Description of the error.
    pub(super) message: String,
    /// Text that the user can type instead; empty if there is no such text.
    pub(super) help: String,
}

impl ScenarioError {
    /// Creates an error at a place of the file.
    pub(super) fn at(place: Range<usize>, message: impl Into<String>) -> Self {
        Self { place: Some(place), message: message.into(), help: String::new() }
    }

    /// Creates an error about the whole file.
    pub(super) fn whole(message: impl Into<String>) -> Self {
        Self { place: None, message: message.into(), help: String::new() }
    }

    /// Sets the help text of the error.
    pub(super) fn help(self, help: impl Into<String>) -> Self {
        Self { help: help.into(), ..self }
    }
}

/// Reads a time between the limits `least` and `most`, in seconds.
pub(super) fn duration(text: &At<String>, least: f64, most: f64) -> Result<Duration, ScenarioError> {
    let [least, most] = [least, most].map(Duration::from_secs_f64);
    let read = Quantity::duration(text.get_ref(), "s", least, most);
    read.map_err(|sentence| ScenarioError::at(text.span(), sentence))
}

/// Returns the body with the name `text`; the ideal body if `text` is `None`.
pub(super) fn body(text: Option<&At<String>>) -> Result<Body, ScenarioError> {
    let Some(text) = text else { return Ok(Body::Ideal) };
    let body = [Body::Ideal, Body::Scout, Body::Atrv].into_iter().find(|body| body.to_string() == *text.get_ref());
    body.ok_or_else(|| ScenarioError::at(text.span(), "expected `ideal`, `scout` or `atrv`"))
}

/// Reads a scenario file.
///
/// # Errors
/// Fails if the text is not TOML, if it contains unknown keys or values of the wrong type, or if it has no robot or two
/// robots with the same name.
pub(super) fn read(text: &str) -> Result<ScenarioText, ScenarioError> {
    let file: ScenarioText = toml::from_str(text).map_err(|error| refused(&error, text))?;
    for (number, robot) in file.robot.iter().enumerate() {
        let (name, place) = (robot.name.get_ref(), robot.name.span());
        if !is_robot_name(name) {
            let message = format!("`{}` is no name of a robot", Printable(name));
            return Err(ScenarioError::at(place, message).help(FORM));
        }
        if file.robot.iter().take(number).any(|before| before.name.get_ref() == name) {
            let message = format!("there is another robot with the name `{name}`");
            return Err(ScenarioError::at(place, message).help("give each robot a name of its own"));
        }
    }
    if let (Some(crowd), Some(robot)) = (&file.crowd, file.robot.first()) {
        let message = format!("`{}` has a name, and the robots of a crowd have none", robot.name.get_ref());
        let help = format!("leave `[[robot]]` or `[crowd]` with its {} robots out", crowd.robots.get_ref());
        return Err(ScenarioError::at(robot.name.span(), message).help(help));
    }
    if let (Some(_), Some((place, what))) = (&file.crowd, between_robots(&file)) {
        let message = format!("a crowd has no {what}: its robots have no names");
        return Err(ScenarioError::at(place, message).help("leave it out, or write `[[robot]]` for each robot"));
    }
    if file.robot.is_empty() && file.crowd.is_none() {
        let help = "write `[[robot]]`, then `name = \"…\"`, `file = \"….mdle\"` and `start = \"x, y, degrees\"`";
        let message = "the scenario has no robot".to_owned();
        return Err(ScenarioError { place: None, message, help: help.to_owned() });
    }
    Ok(file)
}

/// Returns the place and the description of the first value that is about robots that hear each other; `None` if the
/// file has no such value.
fn between_robots(file: &ScenarioText) -> Option<(Range<usize>, &'static str)> {
    let LinkText { latency, loss, duplication } = &file.link;
    let numbers = [loss, duplication].into_iter().flatten().map(At::span);
    let link = latency.iter().map(At::span).chain(numbers).map(|place| (place, "link"));
    link.chain(file.sent_plan.iter().map(|plan| (plan.at.span(), "plans that robots send"))).next()
}

/// Returns the error for a number in the place of a text, as in `spacing = 0.3`; `None` for any other error.
fn unquoted(place: Option<Range<usize>>, message: &str, text: &str) -> Option<ScenarioError> {
    let number = ["floating point", "integer"].iter().find_map(|kind| {
        message.strip_prefix(&format!("invalid type: {kind} `"))?.strip_suffix("`, expected a string")
    })?;
    let line = text.get(..place.as_ref()?.start)?.lines().last().unwrap_or_default();
    let unit = match line.split('=').next().unwrap_or_default().trim() {
        "timeout" | "period" | "latency" | "killed" | "at" => Some("s"),
        "spacing" | "ears" => Some("m"),
        _ => None,
    };
    let help = unit.map(|unit| format!("write `\"{number}{unit}\"`")).unwrap_or_default();
    Some(ScenarioError { place, message: format!("expected a text in quotes, found the number {number}"), help })
}

/// Returns the error for a text that the TOML parser refuses. For an unknown key, the error proposes the most similar
/// name.
fn refused(error: &toml::de::Error, text: &str) -> ScenarioError {
    let place = error.span();
    let mistake = place.clone().and_then(|place| KEYS.mistake(text, place.start, error.message()));
    if let Some(TomlMistake { message, help }) = mistake {
        return ScenarioError { place, message, help };
    }
    let message = error.message().replace('\n', "; ").replace("expected u64", "expected a whole number");
    let message = message.replace("missing field", "there has to be a key");
    if let Some(error) = unquoted(place.clone(), &message, text) {
        return error;
    }
    let Some((unknown, known)) = message.strip_prefix("unknown field `").and_then(|rest| rest.split_once('`')) else {
        return ScenarioError { place, message, help: String::new() };
    };
    let known: Vec<&str> = known.split('`').skip(1).step_by(2).collect();
    let message = format!("there is no key `{}`{}", Printable(unknown), did_you_mean(unknown, &known));
    ScenarioError { place, message, help: format!("the keys are {}", known.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        let ScenarioError { place, message, help } = read(text).unwrap_err();
        format!("{:?} {message} | {help}", place.map(|place| &text[place]))
    }

    #[test]
    fn a_wrong_file_is_refused_with_place_and_cure() {
        let robot = |name: &str| format!("[[robot]]\nname = \"{name}\"\nfile = \"a.mdle\"\nstart = \"0,0,0\"\n");
        insta::assert_snapshot!(
            [
                String::new(),
                robot("a") + &robot("b") + &robot("a"),
                robot("a b"),
                robot("a") + "strat = \"0,0,0\"\n",
                "wrold = \"room\"\n".to_owned() + &robot("a"),
                "[link]\nlos = 0.1\n".to_owned() + &robot("a"),
                "[link]\nloss = 0,1\n".to_owned() + &robot("a"),
                robot("a").replace("[[robot]]", "[robot]"),
                robot("a") + "seed = 1\nseed = 2\n",
                "[[robot]]\nname = \"a\"\nfile = \"a.mdle\"\n".to_owned(),
                "seed = \"many\"\n".to_owned() + &robot("a"),
                "timeout = 20\n".to_owned() + &robot("a"),
                robot("a") + "body = 3\n",
                "[crowd]\nrobots = 9\nfile = \"a.mdle\"\nspacing = 0.3\n".to_owned(),
                "[link]\nloss = 0.1\n[crowd]\nrobots = 9\nfile = \"a.mdle\"\n".to_owned(),
                "[crowd]\nrobots = 9\nfile = \"a.mdle\"\n[[sent-plan]]\nat = \"1s\"\nfrom = \"a\"\nto = \"b\"\nfile = \"b.mdle\"\n"
                    .to_owned(),
            ]
            .map(|text| message(&text))
            .join("\n")
        );
    }
}
