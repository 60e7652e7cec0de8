//! Variables on which the value of a condition depends.

use crate::plan::{QuarkId, RecordId};

/// A variable that is true or false in a turn, independent of the conditions that read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Variable {
    /// An interrupt quark with the same value in all scopes.
    Quark(QuarkId),
    /// An interrupt quark that has its own memory in the scope of this bracket.
    Own(u32, QuarkId),
    /// A timer: this number of nanoseconds has passed since the scope of this bracket was entered.
    Timer(u32, u64),
    /// A timer in a scope that has ended: this number of nanoseconds has passed since the scope of this bracket was
    /// entered.
    Past(u32, u64),
    /// A path: the robot has driven this number of nanometres since the scope of this bracket was entered.
    Way(u32, u64),
    /// A path in a scope that has ended: the robot has driven this number of nanometres since the scope of this bracket
    /// was entered.
    PastWay(u32, u64),
    /// A memory of the interrupt of a bracket. Contains the numbers of the bracket and of the memory.
    Memory(u32, u32),
    /// A fact that `after` tests. Contains the record, and the number of the fact in the record.
    Fact(RecordId, u32),
    /// A fact that `after` tests, with the value that it had before an element ended.
    PastFact(RecordId, u32),
}
