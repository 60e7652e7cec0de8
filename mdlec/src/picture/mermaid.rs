//! A plan for mermaid: a `stateDiagram-v2` with scopes and loops as composite states.
//!
//! In mermaid nothing leads from inside a composite state to the outside, so an end is told one step at a time: what ends
//! last leads to the end of what is around it, and that leads on.

use mdle_runtime::{Printable, is_printable};

use super::can_be_shown;
use super::exits::ends;
use super::measure::wrapped;
use super::texts::{Texts, What, exponent, passes};
use crate::diagnostic::Diagnostic;
use crate::fsm::Machine;
use crate::plan::frame_text;

/// How many letters of a condition or a law are shown: mermaid does not break the lines of labels.
const LETTERS: usize = 60;

/// The plan as a state diagram.
///
/// # Errors
/// E0502 for a plan of more than 1,000 atoms, or of as many scopes and loops.
pub fn mermaid(lowered: &Machine) -> Result<String, Diagnostic> {
    can_be_shown(lowered)?;
    let texts = Texts(lowered);
    let mut diagram = Diagram {
        texts,
        next: followers(lowered),
        at_its_end: ends(texts).at_its_end,
        text: "stateDiagram-v2\n".into(),
    };
    diagram.line(1, "[*] --> b0");
    let mut open: Vec<usize> = Vec::new();
    for (number, bracket) in lowered.brackets.iter().enumerate() {
        diagram.close(&mut open, |holder| holder != bracket.parent as usize);
        diagram.bracket(number, open.len() + 1);
        if !matches!(texts.what(number), What::Atom(..)) {
            open.push(number);
        }
    }
    diagram.close(&mut open, |_| true);
    Ok(diagram.text)
}

/// What follows each bracket in the one around it.
fn followers(lowered: &Machine) -> Vec<Option<usize>> {
    let mut next = vec![None; lowered.brackets.len()];
    let mut latest: Vec<Option<usize>> = vec![None; lowered.brackets.len()];
    for (number, bracket) in lowered.brackets.iter().enumerate().skip(1) {
        if let Some(before) = latest[bracket.parent as usize].replace(number) {
            next[before] = Some(number);
        }
    }
    next
}

struct Diagram<'l> {
    texts: Texts<'l>,
    /// What follows each bracket.
    next: Vec<Option<usize>>,
    at_its_end: Vec<bool>,
    text: String,
}

impl Diagram<'_> {
    fn line(&mut self, depth: usize, text: &str) {
        let indent = 4 * depth.min(20);
        self.text += &format!("{:indent$}{text}\n", "");
    }

    /// A bracket, if it holds others up to where these begin.
    fn bracket(&mut self, number: usize, depth: usize) {
        let labels = self.texts.labels(number);
        match self.texts.what(number) {
            What::Atom(atom, _, law) => {
                let frame = frame_text(law.frame);
                let title = format!("{}: {labels}{frame}{}", self.texts.state(atom), self.texts.law(law));
                self.line(depth, &format!("state \"{}\" as b{number}", shown(&title)));
                self.leads_on(number, depth);
            }
            What::Scope(scope) => {
                let name = if scope.name.is_empty() { "( )" } else { &scope.name };
                self.open(number, depth, &format!("{labels}{name}"));
            }
            What::Loop(times) => {
                self.open(number, depth, &format!("{labels}{} ({})", exponent(times), passes(times)));
            }
        }
    }

    fn open(&mut self, number: usize, depth: usize, title: &str) {
        self.line(depth, &format!("state \"{}\" as b{number} {{", shown(title)));
        self.line(depth + 1, &format!("[*] --> b{}", number + 1));
    }

    /// Ends composite states, the innermost first, as long as they are to end.
    fn close(&mut self, open: &mut Vec<usize>, ends: impl Fn(usize) -> bool) {
        while let Some(number) = open.pop_if(|number| ends(*number)) {
            let depth = open.len() + 1;
            self.line(depth, "}");
            self.leads_on(number, depth);
        }
    }

    /// Where a bracket leads: by its own condition, and when what it holds is at its end.
    fn leads_on(&mut self, number: usize, depth: usize) {
        let to = self.next[number].map_or("[*]".to_owned(), |next| format!("b{next}"));
        let until = self.texts.until(number);
        if until.ends() {
            self.line(depth, &format!("b{number} --> {to} : {}", shown(&until.text())));
        }
        match self.texts.what(number) {
            What::Atom(..) => {}
            What::Scope(_) => {
                if self.at_its_end[number] {
                    self.line(depth, &format!("b{number} --> {to} : at its end"));
                }
            }
            What::Loop(None) => self.line(depth, &format!("b{number} --> b{number} : next pass")),
            What::Loop(Some(times)) => {
                if times > 1 {
                    self.line(depth, &format!("b{number} --> b{number} : next pass of {times}"));
                }
                if self.at_its_end[number] {
                    self.line(depth, &format!("b{number} --> {to} : after the last pass"));
                }
            }
        }
    }
}

/// A text on one line, what mermaid reads otherwise as the numbers of its letters.
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
