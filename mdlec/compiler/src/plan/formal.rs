//! Prints a resolved plan in the paper's formal notation (Definitions 1 and 2): `((u1, ξ1)(u2, ξ2), ξ, T)^n`.
//!
//! The output is valid MDLe. The outermost scope keeps its braces and its name, because a file consists of such plans.

use std::collections::{BTreeMap, BTreeSet};

use super::angle::{HERE, frame_text};
use super::{Atom, Interrupt, Mark, Node, Plan, Scope};

/// Maximum length of a line; longer lines are broken where possible.
const WIDTH: usize = 100;

impl Plan {
    /// Returns the plan in formal notation. A used plan with labels that `after` reads becomes a separate plan, because
    /// `after` can read only the labels of its own plan.
    #[must_use]
    pub fn formal(&self) -> String {
        let quarks = self.quarks.iter().map(|quark| quark.name.clone());
        let taken = quarks.chain([self.root.name.clone()]).collect();
        let mut writer = FormalWriter { plan: self, taken, numbers: BTreeMap::new(), definitions: Vec::new() };
        writer.definition(self.root.name.clone(), &self.root);
        writer.definitions.concat()
    }
}

struct FormalWriter<'p> {
    plan: &'p Plan,
    /// Names that are not available for further plans in the output.
    taken: BTreeSet<String>,
    /// For each base name, the last number that was appended to it to form a plan name.
    numbers: BTreeMap<String, usize>,
    /// Texts of the plans; the main plan comes first.
    definitions: Vec<String>,
}

impl<'p> FormalWriter<'p> {
    /// Writes a plan with the name `name`.
    fn definition(&mut self, name: String, scope: &'p Scope) {
        let number = self.definitions.len();
        self.definitions.push(String::new());
        let body = self.sequence(&scope.body).into_iter().map(|line| format!("  {line}\n")).collect::<String>();
        let text = in_parentheses(&scope.interrupt);
        // After the plan's name, a string of plans used by name could be read as the plan's condition.
        let uses_others = self.definitions.len() > number + 1;
        let condition = if text == "null" && !uses_others { String::new() } else { format!(" ({text})") };
        self.definitions[number] = format!("{{ {name}{condition}\n{body}}}\n");
    }

    /// Returns the lines of a sequence.
    fn sequence(&mut self, body: &'p [Node]) -> Vec<String> {
        body.iter().flat_map(|node| self.node(node)).collect()
    }

    fn node(&mut self, node: &'p Node) -> Vec<String> {
        let (mut lines, marks) = match node {
            Node::Atom(atom) => (vec![self.atom(atom)], &atom.marks),
            Node::Scope(scope) => (self.scope(scope), &scope.marks),
            Node::Loop(repeated) => {
                let times = repeated.times.map_or_else(|| "inf".to_owned(), |times| times.to_string());
                let is_whole = matches!(repeated.body.as_slice(), [Node::Scope(scope)] if scope.marks.is_empty() && scope.record.is_none());
                let body = self.sequence(&repeated.body);
                let body = if is_whole { body } else { around(body, "(", ")") };
                (ended(body, &format!("^{times}")), &repeated.marks)
            }
        };
        for (place, Mark { label, .. }) in marks.iter().enumerate() {
            // The elements that end with the node enclose it.
            lines = if place == 0 {
                begun(lines, &format!("{label}: "))
            } else {
                around(lines, &format!("{label}: ("), ")")
            };
        }
        lines
    }

    fn atom(&self, atom: &Atom) -> String {
        let text = &self.plan.quark(atom.law).text;
        let law = match text.split_once(' ') {
            Some((name, arguments)) => format!("{name}({arguments})"),
            None => text.clone(),
        };
        let frame = if atom.here { HERE.to_owned() } else { frame_text(atom.frame) };
        format!("{frame}({law}, {})", interrupt(&atom.interrupt))
    }

    fn scope(&mut self, scope: &'p Scope) -> Vec<String> {
        let here = if scope.here { HERE } else { "" };
        if scope.record.is_some() {
            let name = self.distinct(&scope.name);
            self.definition(name.clone(), scope);
            return vec![format!("{here}{name}")];
        }
        around(self.sequence(&scope.body), &format!("{here}("), &format!(", {})", interrupt(&scope.interrupt)))
    }

    /// Returns a name that neither a quark nor a plan in the output has: either `name`, or `name` with a number.
    fn distinct(&mut self, name: &str) -> String {
        let number = self.numbers.entry(name.to_owned()).or_insert(1);
        let mut distinct = name.to_owned();
        while !self.taken.insert(distinct.clone()) {
            *number += 1;
            distinct = format!("{name}_{number}");
        }
        distinct
    }
}

/// Returns `ξ`, or `ξ, T` if the last operand is a timer.
fn interrupt(interrupt: &Interrupt) -> String {
    let text = in_parentheses(interrupt);
    let (condition, time) = match text.strip_prefix("wait ") {
        Some(time) => ("null", time),
        None => match text.rsplit_once(" OR wait ") {
            // `ξ, T` means one OR of all operands of ξ and the time, or only the time if ξ is null.
            Some((condition, time)) if interrupt.nested.is_none() && condition != "null" => (condition, time),
            Some(_) | None => return text.to_owned(),
        },
    };
    // The text after `wait` may be more than a time, for example `5 AND bumper` or `5)`.
    match time.parse::<f64>() {
        Ok(_) if time.starts_with(|digit: char| digit.is_ascii_digit()) => format!("{condition}, {time}s"),
        _ => text.to_owned(),
    }
}

/// Returns the text of the condition. Nested ORs appear in it as they were written, because `after` refers to the
/// operands of the outermost OR.
fn in_parentheses(interrupt: &Interrupt) -> &str {
    interrupt.nested.as_deref().unwrap_or(&interrupt.text)
}

/// Encloses lines in brackets. If there is room, the result is a single line.
fn around(lines: Vec<String>, open: &str, close: &str) -> Vec<String> {
    let length: usize = lines.iter().map(|line| line.chars().count()).sum();
    if length + open.len() + close.len() <= WIDTH && lines.iter().all(|line| !line.starts_with(' ')) {
        return vec![format!("{open}{}{close}", joined(&lines))];
    }
    let inside = lines.into_iter().map(|line| format!("  {line}"));
    [open.to_owned()].into_iter().chain(inside).chain([close.to_owned()]).collect()
}

/// Joins elements. Inserts a space where two elements would otherwise be read as one, because a parenthesis directly
/// after a name contains its arguments.
fn joined(elements: &[String]) -> String {
    let is_of_a_name = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || !letter.is_ascii();
    let mut joined = String::new();
    for element in elements {
        let is_count = joined.rsplit_once('^').is_some_and(|(_, count)| count == "inf" || count.parse::<u64>().is_ok());
        let begins_with_name = element.starts_with(is_of_a_name);
        if joined.ends_with(is_of_a_name) && (begins_with_name || !is_count) {
            joined.push(' ');
        }
        joined += element;
    }
    joined
}

/// Prepends `start` to the first line.
fn begun(mut lines: Vec<String>, start: &str) -> Vec<String> {
    if let Some(first) = lines.first_mut() {
        first.insert_str(0, start);
    }
    lines
}

/// Appends `end` to the last line.
fn ended(mut lines: Vec<String>, end: &str) -> Vec<String> {
    if let Some(last) = lines.last_mut() {
        last.push_str(end);
    }
    lines
}
