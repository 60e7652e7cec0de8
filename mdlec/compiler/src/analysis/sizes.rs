//! Computes the size of the emitted machine, in bytes: the size of the state that it keeps between turns, and of its
//! tables.

use std::collections::BTreeSet;

use mdle_runtime::fsm::{Atom, Bracket};
use mdle_runtime::{Frame, Nanos, Stamp, Stamps};
use serde::Serialize;

use crate::fsm::{Element, Machine};
use crate::rust::Shape;

/// Size of a reference to a text on a 64-bit computer, in bytes: address and length.
const PLACE: usize = 16;

/// Sizes of the parts of the emitted machine on a 64-bit computer, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct MachineSizes {
    /// Form of the emitted plan: `code` or `rows`.
    pub form: &'static str,
    /// Size of the state that the machine keeps between turns: position in the plan, times of entry, and frame. The
    /// running law is not included.
    pub state: u64,
    /// Size of the memories of RISING and `after`.
    pub memories: u64,
    /// Size of the tables of brackets and atoms.
    pub machine: u64,
    /// Size of the texts that the machine shows: one reference for each use of a text, and the bytes of each different
    /// text once.
    pub texts: u64,
}

/// Returns the sizes of the parts of the emitted machine.
pub(super) fn bytes(machine: &Machine) -> MachineSizes {
    let number = |count: usize| u64::try_from(count).unwrap_or(u64::MAX);
    // The atom's number in a cursor takes eight bytes, because numbers of eight bytes follow it.
    let entries = match machine.sizes().stamps {
        true => size_of::<Stamps<[Stamp; 0]>>() + machine.sizes().levels * size_of::<Stamp>(),
        false => machine.sizes().levels * size_of::<Nanos>(),
    };
    let cursor = size_of::<u64>() + entries + machine.sizes().slots * size_of::<u64>();
    let tables = machine.tables();
    let tables = size_of_val(tables.brackets) + size_of_val(tables.atoms);
    debug_assert!(align_of::<Bracket>() == 8 && align_of::<Atom>() == 8);
    MachineSizes {
        form: match Shape::of(machine) {
            Shape::Code => "code",
            Shape::Rows => "rows",
        },
        state: number(cursor + size_of::<Frame>()),
        memories: number(machine.depth() * machine.sizes().memories),
        machine: number(tables),
        texts: number(texts(machine)),
    }
}

fn texts(machine: &Machine) -> usize {
    let laws = machine.atoms().map(|atom| atom.law().text.as_str());
    let conditions = machine.elements().map(Element::condition_text);
    let names = machine.elements().map(Element::name);
    let (mut places, mut different) = (0, BTreeSet::new());
    for text in laws.chain(conditions).chain(names) {
        places += PLACE;
        different.insert(text);
    }
    places + different.iter().map(|text| text.len()).sum::<usize>()
}
