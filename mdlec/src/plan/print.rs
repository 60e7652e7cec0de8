//! Prints a resolved plan as MDLe text: plans by name copied in, every argument in its default unit.

use std::fmt;

use super::angle::{HERE, frame_text};
use super::{Atom, Interrupt, Node, Plan, Scope};

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.printed(false))
    }
}

impl Plan {
    /// Returns the text with each atom's number after it: for a plan with expanded loops, the states of its machine.
    #[must_use]
    pub fn numbered(&self) -> String {
        self.printed(true)
    }

    fn printed(&self, numbered: bool) -> String {
        let mut printer = Printer { plan: self, text: String::new(), depth: 0, numbered, atoms: 0 };
        printer.scope(&self.root);
        printer.text
    }
}

struct Printer<'p> {
    plan: &'p Plan,
    text: String,
    depth: usize,
    numbered: bool,
    /// Number of atoms printed so far.
    atoms: u64,
}

impl Printer<'_> {
    fn line(&mut self, text: &str) {
        self.text += &format!("{:indent$}{text}\n", "", indent = 2 * self.depth);
    }

    fn scope(&mut self, scope: &Scope) {
        let name = if scope.name.is_empty() { "_" } else { scope.name.as_str() };
        let condition = condition(&scope.interrupt);
        let condition = if condition == "null" { String::new() } else { format!(" ({condition})") };
        let here = if scope.here { HERE } else { "" };
        self.line(&format!("{here}{{ {name}{condition}"));
        self.inside(&scope.body);
        self.line("}");
    }

    fn inside(&mut self, body: &[Node]) {
        self.depth += 1;
        for node in body {
            match node {
                Node::Atom(atom) => self.atom(atom),
                Node::Scope(scope) => self.scope(scope),
                Node::Loop(repeated) => {
                    let times = repeated.times.map_or_else(|| "inf".to_owned(), |times| times.to_string());
                    self.line(&format!("ExecPlan {times} {{"));
                    self.inside(&repeated.body);
                    self.line("}");
                }
            }
        }
        self.depth -= 1;
    }

    fn atom(&mut self, atom: &Atom) {
        self.atoms += 1;
        let frame = if atom.here { HERE.to_owned() } else { frame_text(atom.frame) };
        let number = if self.numbered { format!("  // a{}", self.atoms) } else { String::new() };
        let law = &self.plan.quark(atom.law).text;
        self.line(&format!("{frame}(Atom ({}) {law}){number}", condition(&atom.interrupt)));
    }
}

fn condition(interrupt: &Interrupt) -> &str {
    if interrupt.removed { "null" } else { &interrupt.text }
}
