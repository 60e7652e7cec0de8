//! Variables on which the value of a condition depends.

use crate::plan::{QuarkId, RecordId};

/// A variable that is true or false in a turn, independent of the conditions that read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Variable {
    /// An interrupt quark that is the same function in every place.
    Quark(QuarkId),
    /// An interrupt quark with a memory of its own, in the scope of this bracket.
    Own(u32, QuarkId),
    /// This number of nanoseconds has passed since the scope of this bracket was entered.
    Timer(u32, u64),
    /// This time has passed since a scope was entered that has ended.
    Past(u32, u64),
    /// This number of nanometres has been driven since the scope of this bracket was entered.
    Way(u32, u64),
    /// This length has been driven since a scope was entered that has ended.
    PastWay(u32, u64),
    /// A memory of the interrupt of a bracket: number of the bracket, then number of the memory.
    Memory(u32, u32),
    /// A fact that `after` asks for.
    Fact(RecordId, u32),
    /// A fact that `after` asks for, as it was before an element ended.
    PastFact(RecordId, u32),
}
