//! `mdle replay --step`: steps through the turns of a record, forwards and backwards.

use std::fmt::Write as _;
use std::io::{self, BufRead, Write};

use mdle_compiler::alphabet::did_you_mean;
use mdle_host::Clocked;
use mdle_record::{Message, MessageKind, Overruled};
use mdle_runtime::{Nanos, Printable};

use crate::failure::{self, Failure};
use crate::record::OVER;
use crate::replayer::{RecordedRun, ReplayStop, ReplayedTurn};
use crate::run_time::run_time;

/// The commands, with their descriptions.
const COMMANDS: [(&str, &str); 6] = [
    ("step [N]", "make the next turn, or N turns; an empty line does the same"),
    ("back [N]", "go back by a turn, or by N turns"),
    ("next", "make turns up to the next one with a transition"),
    ("to TIME", "go to the last turn at or before a time of the run"),
    ("help", "print the commands"),
    ("quit", "end"),
];

/// The outcome of stepping through a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Steps {
    /// `true` if a turn differs from the record, or the record was changed.
    pub(crate) differs: bool,
    /// `true` if a command was refused.
    pub(crate) is_refused: bool,
}

/// A turn that has been replayed.
#[derive(Debug)]
struct SteppedTurn {
    t: Nanos,
    has_transition: bool,
    text: String,
}

/// The turns of a record up to the last replayed turn.
struct ReplayedTurns<'r> {
    replay: &'r mut dyn RecordedRun,
    until: Option<Nanos>,
    made: Vec<SteppedTurn>,
    /// Number of turns up to and including the turn that is shown.
    place: usize,
    /// Reason why there are no more turns; `None` until the end of the record is reached.
    end: Option<String>,
    differs: bool,
    /// Number of the plan that made the last turn; `None` before the first turn.
    plan: Option<u64>,
}

/// Steps through a record as the lines of `commands` request, and prints the turns on standard output. `is_typed` is
/// `true` if a person types the commands.
///
/// # Errors
/// Fails if a plan that replaced another plan during the run cannot be compiled, or if standard output cannot be
/// written.
pub(crate) fn step(
    replay: &mut dyn RecordedRun,
    until: Option<Nanos>,
    commands: impl BufRead,
    is_typed: bool,
) -> Result<Steps, Failure> {
    let (mut lines, mut out) = (commands.lines(), io::stdout().lock());
    let mut turns = ReplayedTurns { replay, until, made: Vec::new(), place: 0, end: None, differs: false, plan: None };
    let (mut answer, mut is_refused) = (turns.forward(1)?, false);
    loop {
        let prompt = if is_typed { "> " } else { "" };
        write!(out, "{answer}{prompt}").and_then(|()| out.flush()).map_err(|error| failure::unprinted(&error))?;
        let Some(Ok(line)) = lines.next() else { break };
        answer = match turns.command(line.trim()) {
            Ok(Some(text)) => text,
            Ok(None) => break,
            Err(RefusedCommand::Sentence(sentence)) => {
                is_refused |= !is_typed;
                // Errors are printed between the answers, as in the shell, because their order matters.
                let _ = writeln!(io::stderr(), "error: {sentence}");
                String::new()
            }
            Err(RefusedCommand::Failure(failure)) => return Err(failure),
        };
    }
    Ok(Steps { differs: turns.differs, is_refused })
}

/// Reason why a command was not carried out.
enum RefusedCommand {
    /// The command is invalid; contains the error message.
    Sentence(String),
    /// A plan cannot be compiled.
    Failure(Failure),
}

impl From<Failure> for RefusedCommand {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

impl ReplayedTurns<'_> {
    /// Carries out a command. Returns the answer; `None` if the command ends the session.
    fn command(&mut self, line: &str) -> Result<Option<String>, RefusedCommand> {
        let (word, argument) = line.split_once(' ').map_or((line, ""), |(word, argument)| (word, argument.trim()));
        if ["next", "help", "quit"].contains(&word) && !argument.is_empty() {
            return Err(RefusedCommand::Sentence(format!("`{word}` takes no arguments")));
        }
        match word {
            "" | "step" => Ok(Some(self.forward(count(word, argument)?)?)),
            "back" => Ok(Some(self.back(count(word, argument)?))),
            "next" => Ok(Some(self.next()?)),
            "to" => {
                let found =
                    if argument.is_empty() { String::new() } else { format!("; found `{}`", Printable(argument)) };
                let refused = |_| RefusedCommand::Sentence(format!("`to` takes a time, as in `to 5s`{found}"));
                let time = run_time(argument).map_err(refused)?;
                Ok(Some(self.to(time)?))
            }
            "help" => Ok(Some(COMMANDS.iter().fold(String::new(), |mut text, (command, what)| {
                let _ = writeln!(text, "{command:<9} {what}");
                text
            }))),
            "quit" => Ok(None),
            _ => {
                let names: Vec<_> = COMMANDS.iter().filter_map(|(command, _)| command.split(' ').next()).collect();
                let near = did_you_mean(word, &names);
                let near = if near.is_empty() { ": `help` lists them".to_owned() } else { near };
                Err(RefusedCommand::Sentence(format!("there is no command `{}`{near}", Printable(word))))
            }
        }
    }

    /// Goes forward by `count` turns, and returns the text to print.
    fn forward(&mut self, count: usize) -> Result<String, Failure> {
        let wanted = self.place.saturating_add(count);
        while self.made.len() < wanted && self.make()? {}
        self.show(wanted)
    }

    /// Goes back by `count` turns, and returns the text to print.
    fn back(&mut self, count: usize) -> String {
        match self.place.checked_sub(count).filter(|place| *place > 0) {
            Some(place) => {
                self.place = place;
                self.text()
            }
            None => {
                self.place = self.made.len().min(1);
                format!("this is the first turn\n{}", self.text())
            }
        }
    }

    /// Goes to the next turn with a transition, and returns the text to print.
    fn next(&mut self) -> Result<String, Failure> {
        let mut place = self.place;
        loop {
            if self.made.len() <= place && !self.make()? {
                return self.show(place.saturating_add(1));
            }
            place += 1;
            if self.made.get(place - 1).is_some_and(|turn| turn.has_transition) {
                return self.show(place);
            }
        }
    }

    /// Goes to the last turn at or before the time `time`, and returns the text to print.
    fn to(&mut self, time: Nanos) -> Result<String, Failure> {
        while self.made.last().is_none_or(|last| last.t <= time) && self.make()? {}
        let place = self.made.iter().take_while(|turn| turn.t <= time).count();
        self.show(place.max(1))
    }

    /// Returns the text of the turn at this position; if there is no such turn, of the last turn.
    fn show(&mut self, place: usize) -> Result<String, Failure> {
        self.place = place.min(self.made.len());
        let end = self.end.as_ref().filter(|_| place > self.made.len());
        Ok(end.map_or_else(String::new, |end| format!("{end}\n")) + &self.text())
    }

    fn text(&self) -> String {
        let shown = self.place.checked_sub(1).and_then(|place| self.made.get(place));
        shown.map_or_else(String::new, |turn| turn.text.clone())
    }

    /// Replays the next turn. Returns `false` if there is no further turn.
    fn make(&mut self) -> Result<bool, Failure> {
        if self.end.is_some() {
            return Ok(false);
        }
        let end = match self.replay.turn() {
            Some(Ok(turn)) if self.until.is_none_or(|until| turn.recorded.t <= until) => {
                self.differs |= !turn.parts.is_empty();
                let plan = turn.recorded.plan;
                let is_other = self.plan.replace(plan).is_some_and(|before| before != plan);
                let has_transition = is_other || !turn.laws.is_empty() || !turn.recorded.steps.is_empty();
                let t = turn.recorded.t;
                self.made.push(SteppedTurn { t, has_transition, text: text(&turn) });
                return Ok(true);
            }
            Some(Err(ReplayStop::Failed(failure))) => return Err(failure),
            Some(Err(ReplayStop::Unread(error))) => {
                self.differs = true;
                format!("no turn follows: {error}")
            }
            Some(Ok(_)) => "no turn follows up to that time".to_owned(),
            None if self.replay.is_whole() => "no turn follows: the record ends here".to_owned(),
            None => "no turn follows: the record has no end".to_owned(),
        };
        self.end = Some(end);
        Ok(false)
    }
}

/// Parses a number of turns.
fn count(word: &str, argument: &str) -> Result<usize, RefusedCommand> {
    if argument.is_empty() {
        return Ok(1);
    }
    let count = argument.parse().ok().filter(|count| *count > 0);
    count.ok_or_else(|| {
        RefusedCommand::Sentence(format!("`{word}` takes a number of turns from 1; found `{}`", Printable(argument)))
    })
}

/// Returns the text of a turn: its cause, its transitions, its input, and its differences from the record.
fn text(ReplayedTurn { recorded, messages, parts, laws, law, .. }: &ReplayedTurn) -> String {
    let mut text = format!("turn {} at {}  {}\n", recorded.number, Clocked(recorded.t), Printable(law));
    if law.is_empty() {
        text = text.trim_end().to_owned() + "\n";
    }
    let mut line = |line: &str| _ = writeln!(text, "  {}", Printable(line));
    for (kind, words) in messages.iter().filter_map(words) {
        line(&format!("{kind}{words}"));
    }
    if messages.iter().all(|message| message.kind != MessageKind::Transition) {
        laws.iter().for_each(|law| line(law));
    }
    if let Some(Overruled { asked, rule }) = &recorded.overruled {
        line(&format!("asked for {} m/s, {} rad/s; {rule} changed it", asked.v.0, asked.omega.0));
    }
    line(&format!("sent {} m/s, {} rad/s", recorded.sent.v.0, recorded.sent.omega.0));
    for part in parts {
        line(&format!("differs: {}: recorded {}, replayed {}", part.name, part.recorded, part.replayed));
    }
    text
}

/// Returns the text of a message in the record, in two parts; `None` if the message cannot be parsed.
fn words(message: &Message) -> Option<(String, String)> {
    let json: serde_json::Value = serde_json::from_str(&message.json).ok()?;
    let field = |name: &str| json.get(name).and_then(serde_json::Value::as_str);
    Some(match message.kind {
        MessageKind::Transition => {
            (field("law").unwrap_or(OVER).to_owned(), format!("  <- {}", field("cause").unwrap_or_default()))
        }
        MessageKind::Event => {
            let text = field("text").filter(|text| !text.is_empty()).unwrap_or("the plan goes on");
            (format!("{}: ", field("kind")?), text.to_owned())
        }
    })
}
