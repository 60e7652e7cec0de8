//! Writes a plan in the language of mermaid, as a `stateDiagram-v2` in which scopes and loops are composite states.
//!
//! In mermaid, no transition leads from inside a composite state to the outside. Therefore, the end of an element is
//! drawn in steps: the last element leads to the end of the enclosing element, and the enclosing element leads on.

use mdle_runtime::{Printable, is_printable};

use super::can_be_shown;
use super::exits::{WaysOut, ends};
use super::measure::wrapped;
use super::texts::{exponent, labels, law, passes, until};
use crate::diagnostic::Diagnostic;
use crate::fsm::{Element, ElementKind, Exit, Machine, Visit};

/// Maximum number of characters of a condition or a law. Longer texts are cut, because mermaid does not break the lines
/// of labels.
const LETTERS: usize = 60;

/// Returns the plan as a state diagram.
///
/// # Errors
/// Fails with E0502 for a plan of more than 1,000 atoms, or of more than 1,000 scopes and loops together.
pub fn mermaid(machine: &Machine) -> Result<String, Diagnostic> {
    can_be_shown(machine)?;
    let mut diagram = Diagram { ends: ends(machine), depth: 1, text: "stateDiagram-v2\n".into() };
    diagram.line("[*] --> b0");
    for visit in machine.walk() {
        match visit {
            Visit::Enter(element) => diagram.enter(element),
            Visit::Leave(element) => diagram.leave(element),
        }
    }
    Ok(diagram.text)
}

struct Diagram {
    ends: Vec<WaysOut>,
    depth: usize,
    text: String,
}

impl Diagram {
    fn line(&mut self, text: &str) {
        let indent = 4 * self.depth.min(20);
        self.text += &format!("{:indent$}{text}\n", "");
    }

    /// Writes the state of an element. For a scope or a loop, stops at the beginning of the states inside it.
    fn enter(&mut self, element: Element<'_>) {
        let (labels, number) = (labels(element), element.number());
        let title = match element.kind() {
            ElementKind::Atom(atom) => {
                let title = format!("{}: {labels}{}", atom.state(), law(atom));
                return self.line(&format!("state \"{}\" as b{number}", shown(&title)));
            }
            ElementKind::Scope => {
                let name = if element.name().is_empty() { "( )" } else { element.name() };
                format!("{labels}{name}")
            }
            ElementKind::Loop { times } => format!("{labels}{} ({})", exponent(times), passes(times)),
        };
        self.line(&format!("state \"{}\" as b{number} {{", shown(&title)));
        self.depth += 1;
        self.line(&format!("[*] --> b{}", number + 1));
    }

    /// Writes the transitions that leave an element: one for when its condition fires, and one for when the last
    /// element inside it ends.
    fn leave(&mut self, element: Element<'_>) {
        if element.atom().is_none() {
            self.depth -= 1;
            self.line("}");
        }
        let to = match element.exit() {
            Exit::Next(next) => format!("b{}", next.number()),
            Exit::Last(_) | Exit::Over => "[*]".to_owned(),
        };
        let (number, until) = (element.number(), until(element));
        let at_its_end = self.ends[element.index()].at_its_end;
        if until.ends() {
            self.line(&format!("b{number} --> {to} : {}", shown(&until.text())));
        }
        match element.kind() {
            ElementKind::Atom(_) => {}
            ElementKind::Scope => {
                if at_its_end {
                    self.line(&format!("b{number} --> {to} : at its end"));
                }
            }
            ElementKind::Loop { times: None } => self.line(&format!("b{number} --> b{number} : next pass")),
            ElementKind::Loop { times: Some(times) } => {
                if times > 1 {
                    self.line(&format!("b{number} --> b{number} : next pass of {times}"));
                }
                if at_its_end {
                    self.line(&format!("b{number} --> {to} : after the last pass"));
                }
            }
        }
    }
}

/// Returns a text on one line; characters with a meaning in mermaid are replaced by their codes.
fn shown(text: &str) -> String {
    let mut shown = String::new();
    for letter in wrapped(text, LETTERS, 1).concat().chars() {
        match letter {
            '"' | '#' | ';' | ':' | '<' | '>' | '&' | '{' | '}' | '%' | '`' | '\\' => {
                shown += &format!("#{};", letter as u32)
            }
            letter if !is_printable(letter) => shown += &Printable(letter).to_string(),
            letter => shown.push(letter),
        }
    }
    shown
}
