//! Writes a plan as a state machine in W3C SCXML that behaves like the plan.
//!
//! In SCXML, transitions of inner states take precedence; in MDLe, transitions of outer scopes do. Therefore, there are
//! no nested states. Each atom of the expanded plan is a state, and has the transitions of all its enclosing scopes in
//! document order, the outermost first. In place of entering nested states, assignments reset the variables of the
//! scopes that restart.
//!
//! An event `turn` carries the content of a script's line (`t`, `way`, `fired`, `completed`). After it, transitions
//! without an event are taken as long as such a transition is enabled, but at most [`TRANSITIONS_PER_TURN`]. The
//! variable `law` contains the law that is applied.

use std::collections::BTreeMap;

use mdle_runtime::{TRANSITIONS_PER_TURN, is_printable};

use super::xml::escaped;
use crate::diagnostic::{Code, Diagnostic};
use crate::fsm::{Matrices, Transition, matrices};
use crate::plan::{Condition, Mark, Nondegenerate, Plan, Quark, RecordId};

/// Maximum length of the SCXML text, in bytes.
const LONGEST: usize = 64 << 20;
/// Initial value of the variable `n`, which counts the transitions of a turn.
const BEFORE: u32 = TRANSITIONS_PER_TURN + 1;

/// Returns the plan as a state machine in SCXML.
///
/// # Errors
/// Fails with E0501 and E0502, as in [`fsm::expand`](crate::fsm::expand); E0502 for a machine of more than 64 MB.
pub fn scxml(plan: &Nondegenerate) -> Result<String, Diagnostic> {
    let made = matrices(plan)?;
    let mut listing = vec![Vec::new(); made.laws.len() + 1];
    for (number, transition) in made.transitions.iter().enumerate() {
        transition.matrix.columns().for_each(|column| listing[column].push(number));
    }
    let plan = plan.plan();
    let records = made.transitions.iter().filter_map(|transition| transition.record);
    let facts = records.map(|record| (record.id, record.facts)).collect();
    let drives = made.transitions.iter().any(|transition| transition.interrupt.condition.drives());
    let mut machine = ScxmlWriter { plan, made: &made, drives, listing, facts, text: String::new() };
    machine.head();
    for (state, law) in made.laws.iter().enumerate() {
        machine.state(state, plan.quark(*law));
        if machine.text.len() > LONGEST {
            let states = made.laws.len() + 1;
            let message = format!("as SCXML the {states} states of this plan take more than {} MB", LONGEST >> 20);
            let help = "a state has the conditions of all scopes around it: let the outer ones be shorter, or use `--emit fsm`";
            return Err(Diagnostic::new(Code::E0502, message, plan.root.span, "this plan").help(help));
        }
    }
    machine.foot();
    Ok(machine.text)
}

struct ScxmlWriter<'m, 'p> {
    plan: &'p Plan,
    made: &'m Matrices<'p>,
    /// `true` if the plan reads the length of the driven path. This is computed once, because the states may have many
    /// conditions.
    drives: bool,
    /// For each state, the interrupts of its enclosing scopes; the outermost comes first.
    listing: Vec<Vec<usize>>,
    /// Number of facts of each record.
    facts: BTreeMap<RecordId, u32>,
    text: String,
}

impl<'p> ScxmlWriter<'_, 'p> {
    fn line(&mut self, depth: usize, text: &str) {
        let indent = 2 * depth;
        self.text += &format!("{:indent$}{text}\n", "");
    }

    fn assign(&mut self, depth: usize, location: &str, value: &str) {
        self.line(depth, &format!("<assign location=\"{location}\" expr=\"{}\"/>", escaped(value)));
    }

    fn data(&mut self, id: &str, value: &str) {
        self.line(2, &format!("<data id=\"{id}\" expr=\"{value}\"/>"));
    }

    fn transition(&self, number: usize) -> &Transition<'p> {
        &self.made.transitions[number]
    }

    fn head(&mut self) {
        let name = escaped(&self.plan.root.name);
        self.line(0, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
        let space = "xmlns=\"http://www.w3.org/2005/07/scxml\" version=\"1.0\" datamodel=\"ecmascript\"";
        self.line(0, &format!("<scxml {space} name=\"{name}\" initial=\"a1\">"));
        self.line(1, "<datamodel>");
        let data = [("n", BEFORE.to_string().as_str()), ("start", "0"), ("t", "0"), ("fired", "[]")].map(owned);
        if self.drives {
            ["origin", "way"].iter().for_each(|id| self.data(id, "0"));
        }
        let others = [("completed", "[]"), ("law", "null"), ("cause", "-1")].map(owned);
        data.into_iter().chain(others).for_each(|(id, value)| self.data(&id, &value));
        for number in 0..self.made.transitions.len() {
            let interrupt = self.transition(number).interrupt;
            if interrupt.condition.waits() {
                self.data(&entered(number), "0");
            }
            if interrupt.condition.drives() {
                self.data(&begun(number), "0");
            }
            (0..interrupt.memories).for_each(|memory| self.data(&risen(number, memory), "false"));
        }
        for (record, facts) in self.facts.clone() {
            (0..facts).for_each(|number| self.data(&fact(record, number), "false"));
        }
        self.line(1, "</datamodel>");
    }

    fn foot(&mut self) {
        self.line(1, "<final id=\"end\">");
        self.line(2, "<onentry>");
        self.assign(3, "law", "null");
        self.line(2, "</onentry>");
        self.line(1, "</final>");
        self.line(0, "</scxml>");
    }

    fn state(&mut self, state: usize, law: &Quark) {
        self.line(1, &format!("<state id=\"{}\">", self.name(state)));
        self.line(2, "<onentry>");
        self.assign(3, "law", &text(law));
        self.line(2, "</onentry>");
        self.turn(state, law);
        let mut any = Vec::new();
        for number in self.listing[state].clone() {
            let condition = &self.transition(number).interrupt.condition;
            if *condition != Condition::Null {
                let fired = self.expression(condition, number);
                self.leave(number, &fired, true);
                any.push(fired);
            }
        }
        if let Some(own) = self.listing[state].last().copied().filter(|_| law.completes) {
            let done = format!("completed.indexOf({}) >= 0", text(law));
            self.leave(own, &done, false);
            any.push(done);
        }
        if !any.is_empty() {
            // At the limit of transitions, the turn ends without a law, and the next turn continues the search.
            let cut = format!("n == {TRANSITIONS_PER_TURN} && law !== null && ({})", any.join(" || "));
            self.line(2, &format!("<transition cond=\"{}\">", escaped(&cut)));
            self.assign(3, "law", "null");
            self.line(2, "</transition>");
        }
        self.line(1, "</state>");
    }

    /// Writes the beginning of a turn: sets the memories from the values at the end of the previous turn, and reads new
    /// values.
    fn turn(&mut self, state: usize, law: &Quark) {
        self.line(2, "<transition event=\"turn\">");
        for number in self.listing[state].clone() {
            let mut set = Vec::new();
            self.transition(number).interrupt.condition.each_rising(&mut |memory, operand| {
                set.push((risen(number, memory), self.expression(operand, number)));
            });
            for (memory, operand) in set {
                self.line(3, &format!("<if cond=\"{}\">", escaped(&format!("n < {BEFORE} && !({operand})"))));
                self.assign(4, &memory, "true");
                self.line(3, "</if>");
            }
        }
        self.line(3, &format!("<if cond=\"n == {BEFORE}\">"));
        self.assign(4, "start", "_event.data.t");
        if self.drives {
            self.assign(4, "origin", "_event.data.way || 0");
        }
        self.line(3, "</if>");
        self.assign(3, "t", "_event.data.t - start");
        if self.drives {
            self.assign(3, "way", "(_event.data.way || 0) - origin");
        }
        self.assign(3, "fired", "_event.data.fired || []");
        self.assign(3, "completed", "_event.data.completed || []");
        self.assign(3, "n", "0");
        self.assign(3, "law", &text(law));
        self.line(2, "</transition>");
    }

    /// Writes the transition of an interrupt under the condition `when`. `by_condition` is `false` if the completion of
    /// the law causes the transition.
    fn leave(&mut self, number: usize, when: &str, by_condition: bool) {
        let made = self.made;
        let transition = &made.transitions[number];
        let target = transition.matrix.row();
        let condition = format!("n < {TRANSITIONS_PER_TURN} && {when}");
        self.line(2, &format!("<transition cond=\"{}\" target=\"{}\">", escaped(&condition), self.name(target)));
        self.record(transition, number, by_condition);
        self.assign(3, "n", "n + 1");
        let begins = self.listing[target].iter().copied().filter(|begun| *begun >= transition.afresh);
        for begun in begins.collect::<Vec<_>>() {
            let Transition { interrupt, record, .. } = &made.transitions[begun];
            if interrupt.condition.waits() {
                self.assign(3, &entered(begun), "t");
            }
            if interrupt.condition.drives() {
                self.assign(3, &self::begun(begun), "way");
            }
            (0..interrupt.memories).for_each(|memory| self.assign(3, &risen(begun, memory), "false"));
            if let Some(kept) = record {
                (0..kept.facts).for_each(|number| self.assign(3, &fact(kept.id, number), "false"));
            }
        }
        self.line(2, "</transition>");
    }

    /// Writes assignments to the facts that `after` tests and that change when the transition ends elements.
    fn record(&mut self, transition: &Transition<'p>, number: usize, by_condition: bool) {
        let own = transition.marks.iter().map(|mark| (mark, by_condition));
        let ended: Vec<(&Mark, bool)> = own.chain(transition.ends_with.iter().map(|mark| (*mark, false))).collect();
        let asks =
            ended.iter().any(|(mark, has_cause)| *has_cause && mark.facts.iter().any(|fact| fact.operand.is_some()));
        if asks {
            let operands = transition.interrupt.condition.operands();
            let causes = (0..).zip(operands).map(|(place, operand)| {
                let fired = self.expression(operand, number);
                format!("{fired} ? {place} : ")
            });
            let cause = causes.collect::<String>() + "-1";
            self.assign(3, "cause", &cause);
        }
        for (mark, _) in &ended {
            let facts = self.facts.get(&mark.record).copied().unwrap_or(0);
            (0..facts).for_each(|number| self.assign(3, &fact(mark.record, number), "false"));
        }
        for (mark, has_cause) in ended {
            for asked in &mark.facts {
                let name = fact(mark.record, asked.number);
                match asked.operand {
                    None => self.assign(3, &name, "true"),
                    Some(operand) if has_cause => {
                        self.line(3, &format!("<if cond=\"cause == {operand}\">"));
                        self.assign(4, &name, "true");
                        self.line(3, "</if>");
                    }
                    Some(_) => {}
                }
            }
        }
    }

    /// Returns the ECMAScript expression for a condition of this interrupt. The expression is true if the condition has
    /// fired.
    fn expression(&self, condition: &Condition, number: usize) -> String {
        let joined = |operands: &[Condition], sign: &str| {
            let operands: Vec<_> = operands.iter().map(|operand| self.expression(operand, number)).collect();
            format!("({})", operands.join(sign))
        };
        let waited = |nanos: &u64| format!("Math.round((t - {}) * 1000000000) >= {nanos}", entered(number));
        let driven = |nanometers: &u64| format!("Math.round((way - {}) * 1000000000) >= {nanometers}", begun(number));
        match condition {
            Condition::Null => "false".into(),
            Condition::Quark(id) => format!("fired.indexOf({}) >= 0", text(self.plan.quark(*id))),
            Condition::Wait { nanos, .. } => waited(nanos),
            Condition::Elapsed { from, until: None, .. } => waited(from),
            Condition::Elapsed { from, until: Some(until), .. } => {
                format!("({} && !({}))", waited(from), waited(until))
            }
            Condition::Driven { from, until: None, .. } => driven(from),
            Condition::Driven { from, until: Some(until), .. } => {
                format!("({} && !({}))", driven(from), driven(until))
            }
            Condition::Or(operands) => joined(operands, " || "),
            Condition::And(operands) => joined(operands, " && "),
            Condition::Not(operand) => format!("!({})", self.expression(operand, number)),
            Condition::Rising { memory, operand } => {
                format!("({} && {})", risen(number, *memory), self.expression(operand, number))
            }
            Condition::After(after) => fact(after.record, after.fact),
        }
    }

    fn name(&self, state: usize) -> String {
        if state == self.made.laws.len() { "end".into() } else { format!("a{}", state + 1) }
    }
}

fn owned((id, value): (&str, &str)) -> (String, String) {
    (id.to_owned(), value.to_owned())
}

/// Returns the name of the variable for the time at which the scope of an interrupt was entered.
fn entered(number: usize) -> String {
    format!("entered{}", number + 1)
}

/// Returns the name of the variable for the odometer reading at which the scope of an interrupt was entered.
fn begun(number: usize) -> String {
    format!("begun{}", number + 1)
}

/// Returns the name of the variable for a memory of RISING.
fn risen(number: usize, memory: u32) -> String {
    format!("risen{}_{memory}", number + 1)
}

/// Returns the name of the variable for a fact of a record.
fn fact(record: RecordId, number: u32) -> String {
    format!("fact{}_{number}", record.0)
}

/// Returns a quark's text as an ECMAScript string; every JSON string is also a valid ECMAScript string.
fn text(quark: &Quark) -> String {
    // Serializing a string cannot fail.
    let text = serde_json::to_string(&quark.text).unwrap_or_default();
    let escape = |letter: char| -> String {
        letter.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")).collect()
    };
    text.chars().map(|letter| if is_printable(letter) { letter.to_string() } else { escape(letter) }).collect()
}
