//! What the value of a condition depends on, and which of these can be true at once: timers run from entries that lie one
//! behind the other, and a signal has one value.

use std::collections::BTreeMap;

use super::choices::Choices;
use super::tables::Table;
use crate::alphabet::{Kind, family_to_si};
use crate::plan::{Compared, Comparison, Operator, Quark, QuarkId, RecordId, Value};

/// Something that is true or not in a turn, as far as conditions say no more of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Variable {
    /// An interrupt quark that is the same function wherever it stands.
    Quark(QuarkId),
    /// One with a memory of its own, in the scope of this bracket.
    Own(u32, QuarkId),
    /// So many nanoseconds have passed since the scope of this bracket was entered.
    Timer(u32, u64),
    /// The same of a scope that has ended.
    Past(u32, u64),
    /// A memory of the interrupt of this bracket.
    Memory(u32, u32),
    /// What `after` asks.
    Fact(RecordId, u32),
    /// What it asked before an element ended.
    PastFact(RecordId, u32),
}

/// Interrupt quarks that speak of the same thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Family {
    /// Patterns of obstacles, of which one matches at most.
    Patterns,
    /// Comparisons of this signal with a value.
    Signal(QuarkId),
}

/// The family of a quark; none if nothing is known of it.
pub(super) fn family(quark: &Quark) -> Option<Family> {
    match &quark.comparison {
        // An angle comes round to where it was.
        Some(comparison) => threshold(comparison).map(|_| Family::Signal(comparison.signal)),
        None => (pattern(quark).is_some()).then_some(Family::Patterns),
    }
}

/// The bits that all have to match.
fn pattern(quark: &Quark) -> Option<&[bool]> {
    match quark.args.as_slice() {
        [Value::Bits(bits)] if quark.name == "atIsection" => Some(bits),
        _ => None,
    }
}

/// The value that a signal is compared with, and the tolerance, in SI units; nothing for an angle.
fn threshold(comparison: &Comparison) -> Option<(f64, f64)> {
    let si = |value: &Value| match value {
        Value::Quantity { kind: Kind::Angle, .. } => None,
        Value::Quantity { exact, family, .. } => Some(exact.to_f64() * family_to_si(family)),
        Value::Infinity(_) | Value::Bits(_) | Value::Integer(_) | Value::Sonar(_) | Value::Name(..) => None,
    };
    match &comparison.with {
        Compared::Value(value) => Some((si(value)?, si(&comparison.tolerance)?)),
        Compared::Signal(_) => None,
    }
}

/// Where the values of these variables can be so at once: `entered` says when a scope was entered at the earliest, and the
/// brackets of timers hold one another, a smaller number the larger.
pub(super) fn possible(choices: &Choices, quarks: &[Quark], entered: &impl Fn(u32) -> u64) -> Table {
    let mut possible = choices.constant(true);
    let mut timers: Vec<(u32, u64, &Table)> = Vec::new();
    let mut families: BTreeMap<Family, Vec<(&Quark, &Table)>> = BTreeMap::new();
    for (variable, column) in choices.columns() {
        match variable {
            Variable::Timer(bracket, nanos) => {
                timers.push((*bracket, entered(*bracket).saturating_add(*nanos), column))
            }
            Variable::Quark(id) => {
                let Some(quark) = quarks.get(id.0 as usize) else { continue };
                if let Some(family) = family(quark) {
                    families.entry(family).or_default().push((quark, column));
                }
            }
            Variable::Own(..) | Variable::Past(..) | Variable::Memory(..) => {}
            Variable::Fact(..) | Variable::PastFact(..) => {}
        }
    }
    for (inner, at, over) in &timers {
        for (outer, until, column) in &timers {
            // The outer one has run for longer.
            if !std::ptr::eq(*over, *column) && outer <= inner && until <= at {
                possible = possible.and(&(*over).clone().not().or(column));
            }
        }
    }
    for members in families.values().filter(|members| members.len() > 1) {
        let mut some = choices.constant(false);
        for fired in at_once(members.iter().map(|(quark, _)| *quark)) {
            let mut one = choices.constant(true);
            for ((_, column), fired) in members.iter().zip(fired) {
                one = if fired { one.and(column) } else { one.and(&(*column).clone().not()) };
            }
            some = some.or(&one);
        }
        possible = possible.and(&some);
    }
    possible
}

/// What the quarks of one family can say at once.
fn at_once<'q>(quarks: impl Iterator<Item = &'q Quark>) -> Vec<Vec<bool>> {
    let quarks: Vec<&Quark> = quarks.collect();
    let mut all = vec![vec![false; quarks.len()]];
    // A signal that is no number makes every comparison false; no pattern need match.
    for value in values(&quarks) {
        all.push(quarks.iter().map(|quark| holds(quark, value)).collect());
    }
    for one in &quarks {
        if let Some(bits) = pattern(one) {
            all.push(quarks.iter().map(|other| pattern(other) == Some(bits)).collect());
        }
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// Values of a signal among which is one for everything that comparisons can say of it: all ends, and one between any two.
fn values(quarks: &[&Quark]) -> Vec<f64> {
    let compared = quarks.iter().filter_map(|quark| threshold(quark.comparison.as_ref()?));
    let ends = compared.flat_map(|(value, tolerance)| [value - tolerance, value, value + tolerance]);
    let mut ends: Vec<f64> = ends.flat_map(|end| [end.next_down(), end, end.next_up()]).collect();
    ends.sort_by(f64::total_cmp);
    let between: Vec<f64> = ends.iter().zip(ends.iter().skip(1)).map(|(low, high)| low + (high - low) / 2.0).collect();
    ends.extend(between);
    if !ends.is_empty() {
        ends.extend([f64::NEG_INFINITY, f64::INFINITY]);
    }
    ends
}

/// Whether a comparison holds of a value.
fn holds(quark: &Quark, signal: f64) -> bool {
    let Some(comparison) = &quark.comparison else { return false };
    let Some((value, tolerance)) = threshold(comparison) else { return false };
    match comparison.operator {
        Operator::Equal => (signal - value).abs() <= tolerance,
        Operator::Less => signal < value,
        Operator::LessOrEqual => signal <= value,
        Operator::Greater => signal > value,
        Operator::GreaterOrEqual => signal >= value,
    }
}
