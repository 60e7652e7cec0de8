//! A resolved plan in the paper's formal notation (Definitions 1 and 2): `((u1, ξ1)(u2, ξ2), ξ, T)^n`.
//!
//! It is MDLe again: the outermost scope keeps its braces and its name, for a file is made of those.

use super::angle::frame_text;
use super::{Atom, Interrupt, Mark, Node, Plan, Scope};

/// The longest line, where there is a choice.
const WIDTH: usize = 100;

impl Plan {
    /// The text in formal notation. Labels of plans that are used more than once come as often.
    #[must_use]
    pub fn formal(&self) -> String {
        let (name, text) = (self.root.name.as_str(), self.root.interrupt.text.as_str());
        let condition = if text == "null" { String::new() } else { format!(" ({text})") };
        let body = self.sequence(&self.root.body).into_iter().map(|line| format!("  {line}\n"));
        format!("{{ {name}{condition}\n{}}}\n", body.collect::<String>())
    }

    /// The lines of a sequence.
    fn sequence(&self, body: &[Node]) -> Vec<String> {
        body.iter().flat_map(|node| self.node(node)).collect()
    }

    fn node(&self, node: &Node) -> Vec<String> {
        let (mut lines, marks) = match node {
            Node::Atom(atom) => (vec![self.atom(atom)], &atom.marks),
            Node::Scope(scope) => (self.scope(scope), &scope.marks),
            Node::Loop(repeated) => {
                let times = repeated.times.map_or_else(|| "inf".to_owned(), |times| times.to_string());
                let is_whole =
                    matches!(repeated.body.as_slice(), [Node::Scope(Scope { marks, .. })] if marks.is_empty());
                let body = self.sequence(&repeated.body);
                let body = if is_whole { body } else { around(body, "(", ")") };
                (ended(body, &format!("^{times}")), &repeated.marks)
            }
        };
        for (place, Mark { label, .. }) in marks.iter().enumerate() {
            // What ends with it is around it.
            lines = if place == 0 {
                begun(lines, &format!("{label}: "))
            } else {
                around(lines, &format!("{label}: ("), ")")
            };
        }
        lines
    }

    fn atom(&self, atom: &Atom) -> String {
        let text = &self.quark(atom.law).text;
        let law = match text.split_once(' ') {
            Some((name, arguments)) => format!("{name}({arguments})"),
            None => text.clone(),
        };
        format!("{}({law}, {})", frame_text(atom.frame), interrupt(&atom.interrupt))
    }

    fn scope(&self, scope: &Scope) -> Vec<String> {
        around(self.sequence(&scope.body), "(", &format!(", {})", interrupt(&scope.interrupt)))
    }
}

/// `ξ`, or `ξ, T` where a timer is its last operand.
fn interrupt(interrupt: &Interrupt) -> String {
    let text = interrupt.text.as_str();
    let (condition, time) = match text.strip_prefix("wait ") {
        Some(time) => ("null", time),
        None => match text.rsplit_once(" OR wait ") {
            Some((condition, time)) => (condition, time),
            None => return text.to_owned(),
        },
    };
    // Behind the time something else may follow, and a parenthesis may be open.
    match time.parse::<f64>() {
        Ok(_) if time.starts_with(|digit: char| digit.is_ascii_digit()) => format!("{condition}, {time}s"),
        _ => text.to_owned(),
    }
}

/// Lines between brackets: one line if there is room for that.
fn around(lines: Vec<String>, open: &str, close: &str) -> Vec<String> {
    let length: usize = lines.iter().map(|line| line.chars().count()).sum();
    if length + open.len() + close.len() <= WIDTH && lines.iter().all(|line| !line.starts_with(' ')) {
        return vec![format!("{open}{}{close}", lines.concat())];
    }
    let inside = lines.into_iter().map(|line| format!("  {line}"));
    [open.to_owned()].into_iter().chain(inside).chain([close.to_owned()]).collect()
}

/// Lines with this in front.
fn begun(mut lines: Vec<String>, start: &str) -> Vec<String> {
    if let Some(first) = lines.first_mut() {
        first.insert_str(0, start);
    }
    lines
}

/// Lines with this behind.
fn ended(mut lines: Vec<String>, end: &str) -> Vec<String> {
    if let Some(last) = lines.last_mut() {
        last.push_str(end);
    }
    lines
}
