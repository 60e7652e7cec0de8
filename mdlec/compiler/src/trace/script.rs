//! Reads scripts (docs/src/reference/interfaces.md, 3). A script contains, turn by turn, the reports of interrupts and
//! laws as JSON lines.
//!
//! Once a script has been read, its times are in nanoseconds since the first turn, and its path lengths are in
//! nanometres; neither ever decreases.

use std::collections::BTreeSet;
use std::fmt;

use mdle_runtime::{Frame, Nanometers, Nanos, Radians};
use serde::Deserialize;

use crate::alphabet::{Alphabet, Decimal};
use crate::plan::{Plan, Words};

/// A script that has been read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Script {
    turns: Vec<Reports>,
    /// Line number of each turn, counted from 1.
    lines: Vec<usize>,
}

/// Reports of one turn: the output `y` of the scripted robot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reports {
    /// Time since the first turn.
    pub t: Nanos,
    /// Reading of the odometer: the length of the driven path so far.
    pub way: Nanometers,
    /// Heading by odometry.
    pub heading: Radians,
    /// Quark texts of the interrupts that have fired.
    pub fired: BTreeSet<String>,
    /// Quark texts of the laws that have completed.
    pub completed: BTreeSet<String>,
}

/// Data about the time at which a scope was entered. All machines except `counted` store it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct EntryTime {
    t: Nanos,
    way: Nanometers,
    heading: Radians,
}

impl EntryTime {
    /// Returns `true` if at least `nanos` nanoseconds have passed since the scope was entered.
    pub(super) fn waited(self, nanos: u64, now: &Reports) -> bool {
        self.since(now) >= Nanos(nanos)
    }

    /// Returns `true` if the robot has driven at least `nanometers` nanometres since the scope was entered.
    pub(super) fn driven(self, nanometers: u64, now: &Reports) -> bool {
        self.way_since(now) >= Nanometers(nanometers)
    }

    /// Returns the time since the scope was entered.
    pub(super) fn since(self, now: &Reports) -> Nanos {
        now.t.since(self.t)
    }

    /// Returns the length of the path that was driven since the scope was entered.
    pub(super) fn way_since(self, now: &Reports) -> Nanometers {
        now.way.since(self.way)
    }

    /// Returns the frame of the heading at which the scope was entered, turned counter-clockwise by `turned` radians.
    pub(super) fn frame(self, turned: f64) -> Frame {
        Frame(self.heading).turned(Radians(turned))
    }
}

impl Reports {
    /// Returns the data for a scope that is entered in this turn.
    pub(super) fn moment(&self) -> EntryTime {
        EntryTime { t: self.t, way: self.way, heading: self.heading }
    }
}

/// An error in a script.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScriptError {
    /// Line number, counted from 1.
    pub line: usize,
    /// Description of the error.
    pub message: String,
}

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for ScriptError {}

/// A line of a script as written. A missing list is empty.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScriptLine {
    t: f64,
    /// Reading of the odometer, in metres.
    #[serde(default)]
    way: f64,
    /// Heading by odometry, in degrees.
    #[serde(default)]
    heading: f64,
    #[serde(default)]
    fired: BTreeSet<String>,
    #[serde(default)]
    completed: BTreeSet<String>,
}

impl Script {
    /// Reads a script, which contains one object per line; empty lines are ignored.
    ///
    /// # Errors
    /// Fails at the first line that is not a valid object, or whose time or path length is less than in the previous
    /// line.
    pub fn read(text: &str) -> Result<Self, ScriptError> {
        let (mut turns, mut lines): (Vec<Reports>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut start = None;
        for (line, content) in (1..).zip(text.lines()).filter(|(_, content)| !content.trim().is_empty()) {
            let refused = |message| ScriptError { line, message };
            let written = written(content).map_err(refused)?;
            let at = nanos(written.t).ok_or_else(|| refused(format!("{} is no time in seconds", written.t)))?;
            let start = *start.get_or_insert(at);
            let back = || refused(format!("the time {} is before the time of the previous line", written.t));
            let t = Nanos(at.checked_sub(start).ok_or_else(back)?);
            if turns.last().is_some_and(|before| t < before.t) {
                return Err(back());
            }
            let way = nanos(written.way).map(Nanometers);
            let way = way.ok_or_else(|| refused(format!("{} is no way in metres", written.way)))?;
            if turns.last().is_some_and(|before| way < before.way) {
                let absent = "; a line without `way` counts as 0";
                let absent = if written.way == 0.0 { absent } else { "" };
                let message = format!("the way {} is less than the way of the previous line{absent}", written.way);
                return Err(refused(message));
            }
            let heading = Radians::from_degrees(written.heading);
            turns.push(Reports { t, way, heading, fired: written.fired, completed: written.completed });
            lines.push(line);
        }
        Ok(Self { turns, lines })
    }

    /// Returns the script with each interrupt replaced by the interrupts that `words` returns for it.
    #[must_use]
    pub fn renamed(mut self, words: impl Fn(&str) -> Vec<String>) -> Self {
        for reports in &mut self.turns {
            let fired = std::mem::take(&mut reports.fired);
            reports.fired = fired.iter().flat_map(|text| words(text)).collect();
        }
        self
    }

    /// Replaces each name in the script with the text of the same quark in `plan`: `r0<60cm` becomes `r0 < 0.6`.
    ///
    /// # Errors
    /// Fails at the first name that is neither an interrupt in the plan nor a law in the plan that can complete.
    pub fn in_words_of(mut self, plan: &Plan, alphabet: &Alphabet) -> Result<Self, ScriptError> {
        let words = Words::new(plan, alphabet);
        for (reports, line) in self.turns.iter_mut().zip(&self.lines) {
            let refused = |message| ScriptError { line: *line, message };
            let fired = std::mem::take(&mut reports.fired).into_iter();
            reports.fired = fired.map(|text| words.interrupt(text)).collect::<Result<_, _>>().map_err(refused)?;
            let completed = std::mem::take(&mut reports.completed).into_iter();
            reports.completed = completed.map(|text| words.law(text)).collect::<Result<_, _>>().map_err(refused)?;
        }
        Ok(self)
    }

    /// Returns the turns of the script, in order; the first is at time 0.
    #[must_use]
    pub fn turns(&self) -> &[Reports] {
        &self.turns
    }
}

/// Converts seconds or metres to billionths; `None` if the number is negative or too large. Converts the shortest
/// decimal form of the number, which is the number as written, so that rounding occurs only once.
fn nanos(seconds: f64) -> Option<u64> {
    Decimal::parse(&seconds.to_string())?.to_nanos()
}

/// Parses a line.
fn written(line: &str) -> Result<ScriptLine, String> {
    let expected = r#"expected one object per line, as in {"t": 0.0, "fired": ["bumper"]}"#;
    // Without this check, a JSON list of values would be accepted as an object with these values.
    match line.trim_start().chars().next() {
        Some('{') => {}
        Some('[') => return Err(format!("a script is no JSON list: {expected}")),
        Some(_) | None => return Err(expected.to_owned()),
    }
    serde_json::from_str(line).map_err(|error| {
        let reason = reason(&error);
        // Messages about unknown keys already list the valid keys.
        if reason.contains(" field `") { reason } else { format!("{reason}; {expected}") }
    })
}

/// Returns the message of the JSON parser with the column only. The line in the message would always be 1, because each
/// line is parsed by itself.
fn reason(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let message = message.split_once(" at line ").map_or(&*message, |(message, _)| message);
    let message =
        message.replace("expected f64", "expected a number").replace("expected a sequence", "expected a list");
    format!("{message} (column {})", error.column())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(text: &str) -> Vec<u64> {
        Script::read(text).unwrap().turns().iter().map(|reports| reports.t.0).collect()
    }

    fn refused(text: &str) -> String {
        Script::read(text).unwrap_err().to_string()
    }

    #[test]
    fn times_count_from_the_first_line_in_nanoseconds() {
        assert_eq!(times("{\"t\": 5}\n\n{\"t\": 5.1}\n{\"t\": 5.1000000014}\r\n"), [0, 100_000_000, 100_000_001]);
        assert_eq!(times("{\"t\":1700000000.1}\n{\"t\":1700000000.3}"), [0, 200_000_000]);
        assert_eq!(times("{\"t\":1e-9}\n{\"t\":2.5e-9}"), [0, 2]);
        assert_eq!(times(" \n"), [0_u64; 0]);
    }

    #[test]
    fn reports_are_read_as_quark_texts() {
        let script =
            Script::read(r#"{"t":0.0,"fired":["atIsection 0100","bumper"],"completed":["rotate 90"]}"#).unwrap();
        assert_eq!(script.turns()[0].fired, BTreeSet::from(["atIsection 0100".into(), "bumper".into()]));
        assert_eq!(script.turns()[0].completed, BTreeSet::from(["rotate 90".into()]));
    }

    #[test]
    fn a_time_that_goes_back_is_refused_with_its_line() {
        assert_eq!(refused("{\"t\":1}\n\n{\"t\":0.9}"), "line 3: the time 0.9 is before the time of the previous line");
        assert_eq!(
            refused("{\"t\":1}\n{\"t\":3}\n{\"t\":2}"),
            "line 3: the time 2 is before the time of the previous line"
        );
    }

    #[test]
    fn ways_and_headings_are_read_and_0_where_they_are_left_out() {
        let script =
            Script::read("{\"t\":0}\n{\"t\":1,\"way\":0.3,\"heading\":-90}\n{\"t\":2,\"way\":1.0000000014}").unwrap();
        let ways: Vec<_> = script.turns().iter().map(|reports| reports.way.0).collect();
        assert_eq!(ways, [0, 300_000_000, 1_000_000_001]);
        let headings: Vec<_> = script.turns().iter().map(|reports| reports.heading.degrees()).collect();
        assert_eq!(headings, [0.0, -90.0, 0.0]);
    }

    #[test]
    fn a_way_that_gets_shorter_is_refused_with_its_line() {
        assert_eq!(
            refused("{\"t\":0,\"way\":2}\n{\"t\":1,\"way\":1.5}"),
            "line 2: the way 1.5 is less than the way of the previous line"
        );
        assert_eq!(
            refused("{\"t\":0,\"way\":2}\n{\"t\":1}"),
            "line 2: the way 0 is less than the way of the previous line; a line without `way` counts as 0"
        );
        assert_eq!(refused("{\"t\":0,\"way\":-1}"), "line 1: -1 is no way in metres");
    }

    #[test]
    fn what_is_no_object_is_refused_with_an_example() {
        let expected = r#"expected one object per line, as in {"t": 0.0, "fired": ["bumper"]}"#;
        for list in ["[", "[]", " [{\"t\": 0}, {\"t\": 1}]", "[0, 0, 0, [], []]"] {
            assert_eq!(refused(list), format!("line 1: a script is no JSON list: {expected}"));
        }
        for plain in ["0.5 bumper", "bumper", "\"bumper\"", "7", "\u{feff}{\"t\":0}"] {
            assert_eq!(refused(&format!("{{\"t\": 0}}\n{plain}")), format!("line 2: {expected}"));
        }
        let of_type = |text: &str, found: &str, column: usize| {
            assert_eq!(refused(text), format!("line 1: invalid type: {found} (column {column}); {expected}"));
        };
        of_type(r#"{"t": "0s"}"#, r#"string "0s", expected a number"#, 10);
        of_type(r#"{"t": 0, "fired": "bumper"}"#, r#"string "bumper", expected a list"#, 26);
        of_type(r#"{"t": 0, "fired": [1]}"#, "integer `1`, expected a string", 20);
        assert_eq!(refused("{"), format!("line 1: EOF while parsing an object (column 1); {expected}"));
        assert_eq!(refused("{\"t\": 0},"), format!("line 1: trailing characters (column 9); {expected}"));
    }

    #[test]
    fn what_is_no_line_of_a_script_is_refused() {
        assert_eq!(refused("{\"t\":-1}"), "line 1: -1 is no time in seconds");
        assert_eq!(refused("{\"t\":1e300}").split_at(8).0, "line 1: ");
        assert_eq!(
            refused("{\"t\":0,\"fire\":[]}"),
            "line 1: unknown field `fire`, expected one of `t`, `way`, `heading`, `fired`, `completed` (column 13)"
        );
        for text in ["[]", "{}", "{\"t\":0", "{\"t\":\"0\"}", "{\"t\":0,\"t\":1}", "{\"t\":1e999}", "\u{feff}{\"t\":0}"]
        {
            assert!(refused(text).starts_with("line 1: "), "{text}");
        }
    }
}
