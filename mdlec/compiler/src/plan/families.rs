//! Determines families of interrupts whose values depend on each other. A signal has only one value, and an interrupt
//! that the alphabet declares as `exclusive` fires for at most one value of its arguments.

use super::{Compared, Comparison, Operator, Quark, QuarkId, Value};
use crate::alphabet::{ParameterKind, family_to_si};

/// A family of interrupt quarks that depend on the same quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Family<'q> {
    /// Uses of an exclusive interrupt. Contains the interrupt's name, and the index of its declaration among the
    /// declarations with this name.
    Exclusive(&'q str, usize),
    /// Comparisons of this signal with a value.
    Signal(QuarkId),
}

/// Returns the family of a quark; `None` if the quark does not depend on other quarks.
pub(crate) fn family(quark: &Quark) -> Option<Family<'_>> {
    match &quark.comparison {
        // Angles wrap around, so comparisons of angles have no family.
        Some(comparison) => threshold(comparison).map(|_| Family::Signal(comparison.signal)),
        None => quark.exclusive.then_some(Family::Exclusive(&quark.name, quark.overload)),
    }
}

/// Returns the value with which a signal is compared, and the tolerance, both in SI units. Returns `None` for an angle,
/// and for a comparison with another signal.
fn threshold(comparison: &Comparison) -> Option<(f64, f64)> {
    let si = |value: &Value| match value {
        Value::Quantity { kind: ParameterKind::Angle, .. } => None,
        Value::Quantity { exact, family, .. } => Some(exact.to_f64() * family_to_si(family)),
        Value::Infinity(_) | Value::Bits(_) | Value::Integer(_) | Value::Sonar(_) | Value::Name(..) => None,
    };
    match &comparison.with {
        Compared::Value(value) => Some((si(value)?, si(&comparison.tolerance)?)),
        Compared::Signal(_) => None,
    }
}

/// Assumption of an analysis about the value of a signal in a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Readings {
    /// The signal has a number or no value. Without a value, every comparison is false.
    Any,
    /// The signal has a number, as most users expect.
    Numbers,
}

/// Returns the combinations of values that the quarks of one family can have in one turn. Each combination is a list in
/// the order of the quarks.
pub(crate) fn at_once<'q>(quarks: impl Iterator<Item = &'q Quark>, readings: Readings) -> Vec<Vec<bool>> {
    let quarks: Vec<&Quark> = quarks.collect();
    let are_numbers = readings == Readings::Numbers && !quarks.iter().any(|quark| quark.exclusive);
    // It is possible that no exclusive interrupt fires.
    let mut all = if are_numbers { Vec::new() } else { vec![vec![false; quarks.len()]] };
    for value in values(&quarks) {
        all.push(quarks.iter().map(|quark| holds(quark, value)).collect());
    }
    for one in quarks.iter().filter(|quark| quark.exclusive) {
        all.push(quarks.iter().map(|other| other.args == one.args).collect());
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// Returns values of a signal that cover all results of the comparisons: all limits, and one value between each two
/// neighbouring limits.
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

/// Returns `true` if a comparison is true for this value of its signal.
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
