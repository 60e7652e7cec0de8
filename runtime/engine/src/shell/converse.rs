//! The front end of the shell: reads commands, sends requests to the hub, and prints the answers.

use std::io::Write;
use std::time::Duration;

use mdle_runtime::PrintableLines;

use super::command::{COMMANDS, ShellCommand, command};
use super::{Lines, Typed};
use crate::tree::{Access, Answer, Change, Hub, Node, Operation, Request, Role, ValueKind};

/// Maximum time for which a user at a terminal waits for a module that is being created.
const PATIENCE: Duration = Duration::from_secs(1);

/// Settings of a session's conversation.
#[derive(Debug, Clone)]
pub struct Conversation {
    /// Name of the command file, for messages about its lines; `None` at a terminal.
    pub file: Option<String>,
    /// Role of the user.
    pub role: Role,
    /// `true` if the first error ends the session.
    pub stops_at_errors: bool,
    /// `true` if each command is printed before its answer.
    pub echoes: bool,
}

/// Carries out commands until there are no more, the session ends, or an error ends it; then also ends the run. Returns
/// `true` if every command was carried out. Also returns `true` if the run never begins, because the reason is reported
/// elsewhere.
pub fn converse(
    hub: &Hub,
    conversation: &Conversation,
    lines: &mut dyn Lines,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> bool {
    if !hub.has_begun() {
        return true;
    }
    let mut here = "/".to_owned();
    let mut is_well = true;
    loop {
        let (number, line) = match lines.next(&here) {
            Typed::End => break,
            Typed::Line(number, line) => (number, Ok(line)),
            Typed::Unusable(number, sentence) => (number, Err(sentence)),
        };
        if let (Ok(line), true) = (&line, conversation.echoes) {
            let _ = writeln!(out, "> {}", PrintableLines(line));
        }
        let command = line.and_then(|line| command(&line, &here));
        if command == Ok(ShellCommand::Quit) {
            break;
        }
        let mut asker = Asker { hub, conversation, out };
        let answer = match command {
            Ok(command) => asker.carried_out(command, &mut here),
            Err(sentence) => Answer::Refused(sentence),
        };
        asker.report();
        // At a terminal, no further command is read; a file continues, because `get` is also answered after the run.
        let is_last = answer == Answer::Ended && conversation.file.is_none();
        let sentence = match answer {
            Answer::Entries(entries) => Ok(entries.join("\n")),
            Answer::Value(text) | Answer::Done(text) => Ok(text),
            Answer::Refused(sentence) => Err(sentence),
            Answer::Ended => Err("the run has ended".to_owned()),
        };
        let is_done = sentence.is_ok();
        match sentence {
            Ok(text) if text.is_empty() => {}
            Ok(text) => drop(writeln!(out, "{}", PrintableLines(text))),
            Err(sentence) => {
                is_well = false;
                let place = conversation.file.as_ref().map(|file| format!("{file}:{number}: ")).unwrap_or_default();
                let _ = writeln!(err, "error: {place}{}", PrintableLines(&sentence));
            }
        }
        let _ = out.flush();
        if is_last || !is_done && conversation.stops_at_errors {
            break;
        }
    }
    // The end of the session ends the run, even if the user's role may not.
    let quit = Operation::Change(Change::Call(Vec::new()));
    let _ = hub.ask(Request { path: "/engine/quit".to_owned(), operation: quit, role: Role::Admin });
    is_well
}

/// The part of a conversation that makes requests.
struct Asker<'a> {
    hub: &'a Hub,
    conversation: &'a Conversation,
    out: &'a mut dyn Write,
}

impl Asker<'_> {
    /// Sends a request to the hub, and prints reports while it waits for the answer.
    fn ask(&mut self, path: &str, operation: Operation) -> Answer {
        let request = Request { path: path.to_owned(), operation, role: self.conversation.role };
        // Creating a module may take long: a user at a terminal can type the next command in the meantime.
        let is_made = path.starts_with("/lib/") && self.conversation.file.is_none();
        let patience = if is_made { PATIENCE } else { Duration::MAX };
        self.hub.wait(request, patience, &mut || self.report())
    }

    /// Prints reports of watched attributes. At a terminal, another thread prints them, even while a line is being
    /// typed.
    fn report(&mut self) {
        if self.conversation.file.is_some() {
            while let Some(report) = self.hub.report(Duration::ZERO) {
                let _ = writeln!(self.out, "{}", PrintableLines(&report));
            }
            let _ = self.out.flush();
        }
    }

    /// Returns the error message about a plan that is not stored.
    fn no_plan(&mut self, name: &str) -> String {
        let stored = match self.ask("/plans", Operation::List) {
            Answer::Entries(names) => names,
            Answer::Value(_) | Answer::Done(_) | Answer::Refused(_) | Answer::Ended => Vec::new(),
        };
        let stored: Vec<_> = stored.iter().map(|name| name.trim_end_matches('/')).collect();
        let near = mdle_compiler::alphabet::did_you_mean(name, &stored);
        let others = if stored.is_empty() { "there is none".to_owned() } else { stored.join(", ") };
        format!("no plan `{name}` is stored{near}; the stored plans: {others}")
    }

    /// Carries out a command.
    fn carried_out(&mut self, command: ShellCommand, here: &mut String) -> Answer {
        match command {
            ShellCommand::Nothing | ShellCommand::Quit => Answer::Done(String::new()),
            ShellCommand::Ask(path, operation) => self.ask(&path, operation),
            ShellCommand::Here => Answer::Done(here.clone()),
            ShellCommand::Help(None) => Answer::Done(COMMANDS.map(summary).join("\n")),
            ShellCommand::Explain(command) => Answer::Done(summary(command)),
            ShellCommand::Swap(name, moment) => {
                let path = format!("/plans/{name}/run");
                let answer = self.ask(&path, Operation::Change(Change::Call(moment)));
                let is_unknown = matches!(answer, Answer::Refused(_)) && self.hub.node(&path).is_none();
                if is_unknown { Answer::Refused(self.no_plan(&name)) } else { answer }
            }
            ShellCommand::Help(Some(path)) => match (self.ask(&path, Operation::List), self.hub.node(&path)) {
                (Answer::Ended, _) => Answer::Ended,
                (_, Some(node)) => Answer::Done(described(&path, &node)),
                (answer, None) => answer,
            },
            ShellCommand::Enter(path) => {
                let answer = self.ask(&path, Operation::List);
                match answer {
                    Answer::Entries(_) => {
                        *here = path;
                        Answer::Done(String::new())
                    }
                    Answer::Refused(_) if self.hub.node(&path).is_some() => {
                        Answer::Refused(format!("`{path}` is no folder"))
                    }
                    other @ (Answer::Value(_) | Answer::Done(_) | Answer::Refused(_) | Answer::Ended) => other,
                }
            }
        }
    }
}

/// Returns a line that describes a command.
fn summary((name, arguments, does): (&str, &str, &str)) -> String {
    format!("{:28} {does}", format!("{name} {arguments}"))
}

/// Returns a line that describes a node.
fn described(path: &str, node: &Node) -> String {
    let kind = match node.kind {
        ValueKind::Flag => "true or false".to_owned(),
        ValueKind::Integer => "a whole number".to_owned(),
        ValueKind::Number => "a number".to_owned(),
        ValueKind::Pose => "two lengths and an angle".to_owned(),
        ValueKind::Numbers => "numbers".to_owned(),
        ValueKind::Bytes => "bytes, as hexadecimal digits".to_owned(),
        ValueKind::Quantity(_, unit) => format!("in {unit}"),
        ValueKind::Text => "text".to_owned(),
    };
    let role = node.role.name();
    let access = match node.access {
        Access::Read => format!("{kind}, read-only"),
        Access::Write => format!("{kind}, set by the role {role}"),
        Access::Call => format!("called by the role {role}"),
    };
    format!("{path}: {} ({access})", node.doc)
}
