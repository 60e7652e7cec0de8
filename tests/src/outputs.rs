//! Converts scripts to outputs of the target `scripted`, one for each turn.

use std::collections::BTreeSet;

use mdle_compiler::trace::{Reports, Script};
use mdle_runtime::Nanos;
use mdle_scripted::{INTERRUPTS, LAWS, Output};

use crate::signals::values;

/// Returns the times and outputs of a script's turns.
#[must_use]
pub fn outputs(script: &Script) -> Vec<(Nanos, Output)> {
    let turns = script.turns().iter();
    turns
        .map(|reports| {
            let (fired, completed) = (bits(INTERRUPTS, &reports.fired), bits(LAWS, &reports.completed));
            let Reports { way, heading, .. } = *reports;
            let output = Output { fired, completed, signals: values(&reports.fired), way, heading };
            (reports.t, output)
        })
        .collect()
}

/// Returns a number whose bit `i` is 1 if `message` contains the text with index `i`.
fn bits(texts: &[&str], message: &BTreeSet<String>) -> u64 {
    let bits = texts.iter().zip(0..).filter(|(text, _)| message.contains(**text));
    bits.fold(0, |number, (_, bit)| number | 1 << bit)
}
