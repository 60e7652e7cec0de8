//! A resolved plan as MDLe text: plans by name copied in, every argument in its default unit.

use std::fmt::{self, Write};

use super::{Atom, Interrupt, Node, Plan, Scope};

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Printer { plan: self, f, depth: 0, numbered: false, state: 0 }.scope(&self.root, "")
    }
}

impl Plan {
    /// The text with each atom's number behind it: for a plan whose loops are expanded, the states of its machine.
    ///
    /// # Errors
    /// When `out` cannot be written to.
    pub fn print_numbered(&self, out: &mut dyn Write) -> fmt::Result {
        Printer { plan: self, f: out, depth: 0, numbered: true, state: 0 }.scope(&self.root, "")
    }
}

struct Printer<'p, 'f> {
    plan: &'p Plan,
    f: &'f mut dyn Write,
    depth: usize,
    numbered: bool,
    /// The atoms printed so far.
    state: u64,
}

impl Printer<'_, '_> {
    fn line(&mut self, text: &str) -> fmt::Result {
        writeln!(self.f, "{:indent$}{text}", "", indent = 2 * self.depth)
    }

    fn scope(&mut self, scope: &Scope, frame: &str) -> fmt::Result {
        let name = if scope.name.is_empty() { "_" } else { scope.name.as_str() };
        let condition = condition(&scope.interrupt);
        let condition = if condition == "null" { String::new() } else { format!(" ({condition})") };
        self.line(&format!("{frame}{{ {name}{condition}"))?;
        self.inside(&scope.body)?;
        self.line("}")
    }

    fn inside(&mut self, body: &[Node]) -> fmt::Result {
        self.depth += 1;
        for node in body {
            match node {
                Node::Atom(atom) => self.atom(atom)?,
                Node::Scope(scope) => self.scope(scope, "")?,
                Node::Loop(repeated) => {
                    let times = repeated.times.map_or_else(|| "inf".to_owned(), |times| times.to_string());
                    self.line(&format!("ExecPlan {times} {{"))?;
                    self.inside(&repeated.body)?;
                    self.line("}")?;
                }
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn atom(&mut self, atom: &Atom) -> fmt::Result {
        self.state += 1;
        let frame = if atom.frame == 0.0 { String::new() } else { format!("FRAME {}deg ", atom.frame.to_degrees()) };
        let number = if self.numbered { format!("  // a{}", self.state) } else { String::new() };
        let law = &self.plan.quark(atom.law).text;
        self.line(&format!("{frame}(Atom ({}) {law}){number}", condition(&atom.interrupt)))
    }
}

fn condition(interrupt: &Interrupt) -> &str {
    if interrupt.removed { "null" } else { &interrupt.text }
}
