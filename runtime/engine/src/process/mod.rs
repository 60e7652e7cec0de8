//! `/lib/process`: a child process, written in any language, as a background module. It exchanges lines of JSON on its
//! standard input and output (docs/src/own_module.md).
//!
//! The child's first line declares its attributes. At each turn break for which it waits, the child gets a line with
//! the values that it reads. It answers with a line of values, which are published at the next turn break.

mod child;
mod declaration;
mod line;

use std::time::Duration;

use mdle_host::StopRequest;
use mdle_runtime::Printable;

use crate::attribute::is_name;
use crate::module::{Background, Candidate, Declare, Exchange, Fault, Refusal};
use child::{Child, LONGEST_FAREWELL, Silence};
use declaration::Declaration;

/// Maximum time from the start of a child to its declaration.
const DECLARATION: Duration = Duration::from_secs(10);
/// Maximum time between sending a line to the child and reading the child's answer.
const ANSWER: Duration = Duration::from_secs(10);
/// Maximum number of characters of a child's line that a message shows.
const SHOWN: usize = 60;

/// A background module whose values a child process computes.
struct Process {
    child: Child,
    declaration: Declaration,
}

impl<Y> Candidate<Y> {
    /// Starts a child process with the command line `command`, which `/bin/sh` interprets, and returns a background
    /// module with this name for it. The child ends when the module ends. It has ten seconds to send its declaration.
    ///
    /// # Errors
    /// Fails if the name is invalid, if the child cannot be started, if its first line is not a declaration, or if
    /// `request` is made before the declaration.
    pub fn process(name: &str, command: &str, request: &StopRequest) -> Result<Self, Refusal> {
        if !is_name(name) {
            return Err(Refusal::BadName(name.to_owned()));
        }
        let refused = |sentence: String| Refusal::Process(name.to_owned(), sentence);
        let mut child =
            Child::start(command).map_err(|error| refused(format!("its process does not start: {error}")))?;
        let line = child.line(DECLARATION, || request.is_made()).map_err(|silence| match silence {
            Silence::Over => Refusal::Ended,
            Silence::Late => refused(format!(
                "its process has declared no attributes within {} s\nhelp: its first line declares them, and is flushed, as in \
                 `print('{{\"publishes\": {{\"range\": \"m\"}}}}', flush=True)`",
                DECLARATION.as_secs()
            )),
            Silence::Fault(sentence) => refused(sentence),
        })?;
        let declaration = Declaration::read(&line).map_err(refused)?;
        Self::background(name, |declare: &mut Declare| {
            declaration.declare(declare);
            declare.begins_at_once();
            declare.farewell(LONGEST_FAREWELL);
            Process { child, declaration }
        })
    }
}

impl Background for Process {
    fn run(self: Box<Self>, mut exchange: Exchange) -> Result<(), Fault> {
        let Self { mut child, declaration } = *self;
        let end = converse(&mut child, &declaration, &mut exchange);
        if end.is_err() {
            // The turn break must not wait for a child that violates the protocol to end by itself.
            child.kill();
        }
        end
    }
}

/// Passes lines between a child and the turn breaks until the module has to end.
///
/// # Errors
/// Fails if the child violates the protocol.
fn converse(child: &mut Child, declaration: &Declaration, exchange: &mut Exchange) -> Result<(), Fault> {
    let mut values = Vec::new();
    // The first turn break supplies the first values for the child.
    while exchange.exchange(|offer| values.drain(..).for_each(|(place, value)| offer.put(place, value))).is_ok() {
        let (now, readings) = exchange.readings();
        let question = declaration.question(now, readings);
        let answer = match child.ask(question.as_bytes(), ANSWER, || exchange.is_stopped()) {
            Ok(answer) => answer,
            Err(Silence::Over) => return Ok(()),
            Err(Silence::Late) => {
                return Err(Fault(format!("its process has not answered within {} s", ANSWER.as_secs())));
            }
            Err(Silence::Fault(sentence)) => return Err(Fault(sentence)),
        };
        values = declaration.answer(&answer).map_err(Fault)?;
    }
    Ok(())
}

/// Returns a child's line in the form in which messages show it.
fn shown(line: &[u8]) -> String {
    let text = String::from_utf8_lossy(line);
    let mut start: String = text.chars().take(SHOWN).collect();
    if start.len() < text.len() {
        start.push('…');
    }
    format!("`{}`", Printable(start))
}
