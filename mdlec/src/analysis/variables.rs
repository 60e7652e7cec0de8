//! What the value of a condition depends on, and which of these can be true at once: timers run from entries that lie one
//! behind the other, and a signal has one value.

use std::collections::BTreeMap;

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
pub(super) fn possible(variables: &[Variable], quarks: &[Quark], entered: &impl Fn(u32) -> u64) -> Table {
    let count = variables.len();
    let mut possible = Table::constant(count, true);
    let column = |index| Table::variable(count, index);
    let timers: Vec<_> = variables.iter().enumerate().filter_map(|(index, variable)| timer(index, variable)).collect();
    for (index, inner, nanos) in &timers {
        for (other, outer, until) in &timers {
            let is_past = entered(*outer).saturating_add(*until) <= entered(*inner).saturating_add(*nanos);
            if other != index && outer <= inner && is_past {
                possible = possible.and(&column(*index).not().or(&column(*other)));
            }
        }
    }
    let mut families: BTreeMap<Family, Vec<(usize, &Quark)>> = BTreeMap::new();
    for (index, variable) in variables.iter().enumerate() {
        let Variable::Quark(id) = variable else { continue };
        let Some(quark) = quarks.get(id.0 as usize) else { continue };
        if let Some(family) = family(quark) {
            families.entry(family).or_default().push((index, quark));
        }
    }
    for members in families.values().filter(|members| members.len() > 1) {
        let mut some = Table::constant(count, false);
        for fired in at_once(members.iter().map(|(_, quark)| *quark)) {
            let mut one = Table::constant(count, true);
            for ((index, _), fired) in members.iter().zip(fired) {
                one = one.and(&if fired { column(*index) } else { column(*index).not() });
            }
            some = some.or(&one);
        }
        possible = possible.and(&some);
    }
    possible
}

fn timer(index: usize, variable: &Variable) -> Option<(usize, u32, u64)> {
    match variable {
        Variable::Timer(bracket, nanos) => Some((index, *bracket, *nanos)),
        Variable::Quark(_) | Variable::Own(..) | Variable::Past(..) | Variable::Memory(..) => None,
        Variable::Fact(..) | Variable::PastFact(..) => None,
    }
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
