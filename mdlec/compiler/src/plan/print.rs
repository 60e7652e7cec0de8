//! Prints a resolved plan as MDLe text. Plans used by name are copied in, and all arguments are in their default units.

use std::fmt;

use super::angle::{HERE, frame_text};
use super::{Atom, Interrupt, Plan, PlanPart, Scope, Visit};

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.printed(false))
    }
}

impl Plan {
    /// Returns the text of the plan, with the number of each atom after the atom. If the loops of the plan are
    /// expanded, the numbers are the numbers of the machine's states.
    #[must_use]
    pub fn numbered(&self) -> String {
        self.printed(true)
    }

    fn printed(&self, numbered: bool) -> String {
        let mut printer = Printer { plan: self, text: String::new(), depth: 0, numbered, atoms: 0 };
        for visit in self.walk() {
            match visit {
                Visit::Enter(PlanPart::Atom(atom)) => printer.atom(atom),
                Visit::Enter(PlanPart::Scope(scope)) => printer.open(&scope_head(scope)),
                Visit::Enter(PlanPart::Loop(repeated)) => {
                    let times = repeated.times.map_or_else(|| "inf".to_owned(), |times| times.to_string());
                    printer.open(&format!("ExecPlan {times} {{"));
                }
                Visit::Leave(PlanPart::Atom(_)) => {}
                Visit::Leave(PlanPart::Scope(_) | PlanPart::Loop(_)) => {
                    printer.depth -= 1;
                    printer.line("}");
                }
            }
        }
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

    /// Writes a line that opens a scope or a loop.
    fn open(&mut self, head: &str) {
        self.line(head);
        self.depth += 1;
    }

    fn atom(&mut self, atom: &Atom) {
        self.atoms += 1;
        let frame = if atom.here { HERE.to_owned() } else { frame_text(atom.frame) };
        let number = if self.numbered { format!("  // a{}", self.atoms) } else { String::new() };
        let law = &self.plan.quark(atom.law).text;
        self.line(&format!("{frame}(Atom ({}) {law}){number}", condition(&atom.interrupt)));
    }
}

/// Writes the head of a scope: `{ Leg (bumper)`.
fn scope_head(scope: &Scope) -> String {
    let name = if scope.name.is_empty() { "_" } else { scope.name.as_str() };
    let condition = condition(&scope.interrupt);
    let condition = if condition == "null" { String::new() } else { format!(" ({condition})") };
    let here = if scope.here { HERE } else { "" };
    format!("{here}{{ {name}{condition}")
}

fn condition(interrupt: &Interrupt) -> &str {
    if interrupt.removed { "null" } else { &interrupt.text }
}
