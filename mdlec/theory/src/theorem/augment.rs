//! Converts any machine to a plan that uses `after` (paper, below Theorem 1: "auxiliary variables"). The plan is an
//! endless loop over all states, in which the condition of each state tests which element ended last.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::names::{in_a_comment, texts};
use super::{COMPLETED, Machine, State};
use mdle_compiler::syntax::operands;

/// Returns a plan that is equivalent to a machine of any shape. If several interrupts lead from a state, the first of
/// them in the file takes precedence.
///
/// The plan has a start state that ends at once. The machine's states follow in the order of the file. In each turn the
/// plan is in the same state as the machine, until a turn in which the machine would enter a state twice.
#[must_use]
pub fn augment(machine: &Machine) -> String {
    let (texts, mut names) = texts(machine);
    let (main, start) = (names.name("Augmented"), names.name("start"));
    let labels: Vec<_> = machine.atoms().map(|_| names.name("L")).collect();
    let mut ways = vec![Vec::new(); machine.states().len()];
    let first = machine.start().unwrap_or(State(0));
    ways[first.0 as usize].push(format!("after {start}"));
    let mut own = Vec::with_capacity(labels.len());
    for (state, label) in machine.atoms().zip(&labels) {
        let exits = Exits::of(machine, state, &texts.conditions);
        for (to, way) in exits.ways(label) {
            ways[to.0 as usize].push(way);
        }
        own.push(exits.condition());
    }
    let mut text = String::new();
    for (name, means) in &texts.renamed {
        let _ = writeln!(text, "// {name}: {}", in_a_comment(means));
    }
    let over = ways.pop().unwrap_or_default();
    let over = if over.is_empty() { "null".to_owned() } else { over.join(" OR ") };
    let _ = writeln!(text, "{{ {main} ({over})\n  {start}: (Atom (wait 0) stop)\n  (");
    for (state, (label, own)) in machine.atoms().zip(labels.iter().zip(&own)) {
        let ways = &ways[state.0 as usize];
        let guard = if ways.is_empty() { "NOT null".to_owned() } else { format!("NOT ({})", ways.join(" OR ")) };
        let law = &texts.laws[state.0 as usize];
        let (number, name) = (state.0 + 2, in_a_comment(machine.name(state)));
        let scope = names.name("Is");
        let _ = writeln!(
            text,
            "    {{ {scope} ({guard})\n      {label}: (Atom ({own}) {law})    // {number}: {name}\n    }}"
        );
    }
    let _ = writeln!(
        text,
        "  )^inf\n}}    // {}: {}",
        machine.states().len() + 1,
        in_a_comment(machine.name(machine.end()))
    );
    text
}

/// Transitions from a state.
struct Exits<'t> {
    /// Operands of the conditions of the state's interrupts, in the order of the file and without duplicates, each with
    /// the destination of its interrupt.
    operands: Vec<(&'t str, State)>,
    /// Destination after the state's law completes.
    completed: Option<State>,
}

impl<'t> Exits<'t> {
    fn of(machine: &Machine, state: State, conditions: &'t [String]) -> Self {
        let mut exits = Self { operands: Vec::new(), completed: None };
        let mut seen = BTreeSet::new();
        for exit in machine.exits(state) {
            if machine.interrupt(exit.interrupt).name == COMPLETED {
                exits.completed = Some(exit.to);
                continue;
            }
            let condition = &conditions[exit.interrupt.0 as usize];
            let operands = operands(condition).unwrap_or_else(|| vec![condition]);
            // An operand `null` never fires, and a repeated operand never decides, since the first one takes
            // precedence.
            let new = operands.into_iter().filter(|operand| *operand != "null" && seen.insert(*operand));
            exits.operands.extend(new.map(|operand| (operand, exit.to)));
        }
        exits
    }

    /// Returns the text of the interrupt of the state's atom.
    fn condition(&self) -> String {
        let operands: Vec<_> = self.operands.iter().map(|(operand, _)| *operand).collect();
        if operands.is_empty() { "null".to_owned() } else { operands.join(" OR ") }
    }

    /// Returns each destination of the state, with a condition that holds if the state was left for this destination.
    /// `label` is the label of the state's atom.
    fn ways(&self, label: &str) -> Vec<(State, String)> {
        let after = |operand: &str| match is_a_name(operand) {
            true => format!("after {label} {operand}"),
            false => format!("after {label} ({operand})"),
        };
        let mut ways: Vec<_> = self.operands.iter().map(|(operand, to)| (*to, after(operand))).collect();
        if let Some(to) = self.completed {
            let others: Vec<_> = self.operands.iter().map(|(operand, _)| after(operand)).collect();
            let none_other = format!(" AND NOT ({})", others.join(" OR "));
            let none_other = if others.is_empty() { "" } else { &none_other };
            ways.push((to, format!("after {label}{none_other}")));
        }
        ways
    }
}

fn is_a_name(operand: &str) -> bool {
    operand.chars().all(|letter| letter.is_alphanumeric() || letter == '_')
}
