//! Explains the operands of a condition in a turn: their values, the deciding operands, and the values that operands
//! would need to fire.

use std::iter::Peekable;
use std::slice::Iter;

use mdle_compiler::fsm::{Element, Machine};
use mdle_compiler::plan::{Compared, Condition, QuarkId, Value};
use mdle_host::operand_words;
use mdle_runtime::{Examined, Measured, Nanos, OperandWords, SONARS, Words};

use super::lack::{TurnFacts, held, lack};
use super::part_text::PartText;
use crate::examined::ScopeMoment;

/// Age from which the last ping of a sonar is treated as stale.
const STALE: Nanos = Nanos(1_000_000_000);

/// An operand of a condition in a turn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeasuredOperand {
    /// The operand as written in the plan.
    pub(crate) written: String,
    /// The operand with its measured values.
    pub(crate) words: String,
    /// `true` if the operand has fired.
    pub(crate) fired: bool,
    /// `true` if the condition ended a scope, and would not have fired if this operand alone had been false.
    pub(crate) decided: bool,
    /// `true` if the condition has not fired, and would have fired if this operand alone had fired.
    pub(crate) suffices: bool,
    /// Values from which the operand was evaluated.
    pub(crate) measured: Measured,
    /// Time or value that the operand still needs to fire, or reason why it has not fired; empty if there is neither.
    pub(crate) lack: String,
    /// Remarks about stale data; empty if there are none.
    pub(crate) stale: Vec<String>,
    /// Parts of the operand, if it is a NOT or RISING of several conditions; empty otherwise.
    pub(crate) inside: Vec<MeasuredOperand>,
}

/// Facts about a turn that operands need in addition to their own values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OperandFacts {
    /// Time since the last ping of each sonar; `None` before the first ping.
    pub(crate) ages: [Option<Nanos>; SONARS],
    /// Time for which the law of the previous turn has made no progress; `None` if that law has no goal.
    pub(crate) stalled: Option<Nanos>,
    /// `true` if the atom was entered in this turn, so that the law of the previous turn belongs to another atom.
    pub(crate) is_new: bool,
}

/// The condition of a scope in a turn.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Examination {
    /// `true` if the condition has fired.
    pub(crate) fired: bool,
    /// Parts of the condition that AND and OR join, in the order of the text.
    pub(crate) operands: Vec<MeasuredOperand>,
    /// Text of the operands that have not fired, joined as in the condition; empty if the condition has fired or has
    /// only one operand.
    pub(crate) missing: String,
}

/// Explains the condition of a scope of a machine.
pub(crate) fn examination(
    machine: &Machine,
    element: Element<'_>,
    scope: &ScopeMoment,
    facts: &OperandFacts,
    words: &dyn Words,
) -> Examination {
    let condition = element.condition();
    let mut parts = scope.parts.iter().peekable();
    let node = ConditionPart::of(condition, &mut parts, &mut 0);
    let (Some(node), false) = (node, *condition == Condition::Null) else { return Examination::default() };
    let source: Vec<_> = words.operands_of(element.number()).collect();
    let explaining = Explaining { machine, scope, facts };
    let mut joined = Vec::new();
    node.joined(&mut joined);
    let operands = joined.iter().map(|part| {
        let turns = node.value(None) != node.value(part.number);
        let words = part.number.and_then(|number| source.get(number as usize));
        explaining.operand(part, words, turns, false)
    });
    let operands: Vec<_> = operands.collect();
    let fired = node.part.fired;
    let name = |number: u32| source.get(number as usize).map_or("", |words| words.written);
    let missing = if fired || operands.len() < 2 { String::new() } else { node.missing(&name, Join::None) };
    Examination { fired, operands, missing }
}

/// A part of a condition, with its value in the turn.
struct ConditionPart<'c> {
    condition: &'c Condition,
    part: Examined,
    /// Index among the parts that AND and OR join, counted separately inside each NOT and RISING; `None` for AND and
    /// OR.
    number: Option<u32>,
    parts: Vec<ConditionPart<'c>>,
}

/// An operator that joins operands in a text.
#[derive(Clone, Copy, PartialEq)]
enum Join {
    None,
    And,
    Or,
}

impl<'c> ConditionPart<'c> {
    /// Pairs a condition with its examined parts, which must be in the same order.
    fn of(condition: &'c Condition, parts: &mut Peekable<Iter<'_, Examined>>, next: &mut u32) -> Option<Self> {
        let part = *parts.next()?;
        let is_joining = condition.lasting().is_none() && matches!(condition, Condition::Or(_) | Condition::And(_));
        let number = (!is_joining).then_some(*next);
        let inside = if condition.lasting().is_some() { &[] } else { condition.children() };
        let mut apart = 0;
        if !is_joining {
            *next = next.saturating_add(1);
        }
        let next = if is_joining { next } else { &mut apart };
        let inside = inside.iter().map(|condition| ConditionPart::of(condition, parts, next)).collect::<Option<_>>()?;
        Some(Self { condition, part, number, parts: inside })
    }

    /// Collects the parts that AND and OR join.
    fn joined<'n>(&'n self, to: &mut Vec<&'n Self>) {
        if self.number.is_some() {
            to.push(self);
        } else {
            self.parts.iter().for_each(|part| part.joined(to));
        }
    }

    /// Returns the value that the condition would have if the operand `other` were inverted; if `other` is `None`,
    /// returns the actual value.
    fn value(&self, other: Option<u32>) -> bool {
        match self.condition {
            _ if self.number.is_some() => self.part.fired != (self.number == other),
            Condition::And(_) => self.parts.iter().all(|part| part.value(other)),
            Condition::Or(_) => self.parts.iter().any(|part| part.value(other)),
            Condition::Null
            | Condition::Quark(_)
            | Condition::Wait { .. }
            | Condition::Elapsed { .. }
            | Condition::Driven { .. }
            | Condition::Not(_)
            | Condition::Rising { .. }
            | Condition::After(_) => self.part.fired,
        }
    }

    /// Returns the texts of the parts that have not fired, joined by `and` and `or`.
    fn missing<'w>(&self, name: &impl Fn(u32) -> &'w str, around: Join) -> String {
        if let Some(number) = self.number {
            return name(number).to_owned();
        }
        let join = if matches!(self.condition, Condition::And(_)) { Join::And } else { Join::Or };
        let missing: Vec<_> = self.parts.iter().filter(|part| !part.part.fired).collect();
        let inner = if missing.len() > 1 { join } else { around };
        let texts: Vec<_> = missing.iter().map(|part| part.missing(name, inner)).collect();
        let text = texts.join(if join == Join::And { " and " } else { " or " });
        if missing.len() > 1 && around != Join::None && around != join { format!("({text})") } else { text }
    }
}

/// Explains operands of one scope.
struct Explaining<'e> {
    machine: &'e Machine,
    scope: &'e ScopeMoment,
    facts: &'e OperandFacts,
}

impl Explaining<'_> {
    /// Explains an operand. `turns` is `true` if the condition would be inverted by inverting this operand alone.
    /// `must_end` is `true` if the operand is a part of a NOT that has not fired.
    fn operand(
        &self,
        node: &ConditionPart<'_>,
        words: Option<&OperandWords<'_>>,
        turns: bool,
        must_end: bool,
    ) -> MeasuredOperand {
        let Examined { fired, measured } = node.part;
        let is_about_another = matches!(node.condition, Condition::Not(_) | Condition::Rising { .. });
        let inner = node.parts.first().filter(|_| is_about_another);
        let text = PartText::of(node.condition, self.machine);
        let text = text.words();
        let words = words.unwrap_or(&text);
        let written = words.written.to_owned();
        // The values shown are those of the comparison inside NOT and RISING.
        let holds = inner.map_or(fired, |inner| innermost(inner).part.fired);
        let shown = operand_words(words, measured, holds);
        // The values are shown for each part if NOT or RISING contains several parts joined by AND or OR.
        let joined = inner.map_or(&[][..], |inner| if inner.number.is_none() { &inner.parts } else { &[] });
        let is_negated = matches!(node.condition, Condition::Not(_));
        let must_end_inside = if is_negated { !fired } else { must_end };
        let inside = joined.iter().map(|part| self.operand(part, None, false, must_end_inside)).collect();
        let unit = words.values.first().map(|value| (value.unit, value.scale));
        let values = TurnFacts {
            since: self.scope.since,
            way: self.scope.way,
            stalled: self.facts.stalled,
            is_new: self.facts.is_new,
            unit,
            is_range: self.sonars(node.condition).0,
        };
        let inner = inner.map(|inner| (inner.condition, inner.part));
        let lack = match must_end && fired && !is_negated {
            true => still(node.condition, &held(node.condition, node.part, &values)),
            false => lack(node.condition, node.part, inner, &values),
        };
        let stale = self.stale(node.condition);
        let (decided, suffices) = (turns && fired, turns && !fired);
        MeasuredOperand { written, words: shown, fired, decided, suffices, measured, lack, stale, inside }
    }

    /// Returns remarks about the sonars that a condition reads and that have not sent a ping for a long time.
    fn stale(&self, condition: &Condition) -> Vec<String> {
        let remark = |sonar: usize| match self.facts.ages.get(sonar)? {
            None => Some(format!("sonar {sonar} has not pinged yet")),
            Some(age) if *age >= STALE => {
                Some(format!("stale: sonar {sonar} pinged {} s ago", mdle_host::rounded(age.0)))
            }
            Some(_) => None,
        };
        self.sonars(condition).1.into_iter().filter_map(remark).collect()
    }

    /// Returns `true` if the first signal of a condition is a range, and the list of sonars that the condition reads.
    fn sonars(&self, condition: &Condition) -> (bool, Vec<usize>) {
        let (mut is_range, mut sonars) = (false, Vec::new());
        condition.each_quark(&mut |id| {
            let quark = self.machine.quark(id);
            let Some(comparison) = &quark.comparison else { return self.read_by(id, &mut sonars) };
            is_range |= self.machine.quark(comparison.signal).name == "r";
            self.read_by(comparison.signal, &mut sonars);
            match comparison.with {
                Compared::Signal(other) => self.read_by(other, &mut sonars),
                Compared::Value(_) => {}
            }
        });
        (is_range, sonars)
    }

    fn read_by(&self, id: QuarkId, sonars: &mut Vec<usize>) {
        for argument in &self.machine.quark(id).args {
            match argument {
                Value::Sonar(sonar) if !sonars.contains(&usize::from(*sonar)) => sonars.push(usize::from(*sonar)),
                Value::Sonar(_)
                | Value::Quantity { .. }
                | Value::Infinity(_)
                | Value::Bits(_)
                | Value::Integer(_)
                | Value::Name(..) => {}
            }
        }
    }
}

/// Returns a description of an operand that has fired, although the condition requires that it has not fired.
fn still(condition: &Condition, held: &str) -> String {
    let is_whole = held.is_empty() || matches!(condition, Condition::Wait { .. });
    if is_whole { held.to_owned() } else { format!("holds {held}") }
}

/// Returns the condition inside all enclosing NOT and RISING.
fn innermost<'n, 'c>(node: &'n ConditionPart<'c>) -> &'n ConditionPart<'c> {
    match (node.condition, node.parts.first()) {
        (Condition::Not(_) | Condition::Rising { .. }, Some(inner)) => innermost(inner),
        _ => node,
    }
}
