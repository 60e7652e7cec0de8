//! Determines which combinations of values of variables are possible in the same turn. Timers start in a known order,
//! when their scopes are entered, and a signal has only one value.

use std::collections::BTreeMap;

use super::choices::Choices;
use super::tables::TruthTable;
use super::variables::Variable;
use crate::plan::Quark;
use crate::plan::families::{Family, Readings, at_once, family};

/// Returns the table of the possible choices, in which all variables can have their values in the same turn. `entered`
/// returns the earliest time at which a scope is entered. The brackets of timers are nested; an outer bracket has a
/// smaller number.
pub(super) fn possible(
    choices: &Choices,
    quarks: &[Quark],
    readings: Readings,
    entered: &impl Fn(u32) -> u64,
) -> TruthTable {
    let mut possible = choices.constant(true);
    let mut timers: Vec<(u32, u64, &TruthTable)> = Vec::new();
    let mut ways: Vec<(u32, u64, &TruthTable)> = Vec::new();
    let mut families: BTreeMap<Family<'_>, Vec<(&Quark, &TruthTable)>> = BTreeMap::new();
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
            Variable::Way(bracket, nanometers) => ways.push((*bracket, *nanometers, column)),
            Variable::Own(..) | Variable::Past(..) | Variable::PastWay(..) | Variable::Memory(..) => {}
            Variable::Fact(..) | Variable::PastFact(..) => {}
        }
    }
    for counted in [timers, ways] {
        for (inner, at, over) in &counted {
            for (outer, until, column) in &counted {
                // The outer timer or path began earlier, so it is at least as long.
                if !std::ptr::eq(*over, *column) && outer <= inner && until <= at {
                    possible = possible.and(&(*over).clone().not().or(column));
                }
            }
        }
    }
    for members in families.values().filter(|members| members.len() > 1) {
        let mut some = choices.constant(false);
        for fired in at_once(members.iter().map(|(quark, _)| *quark), readings) {
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
