//! Runtime of every plan: the state machine of Algorithm 1, the traits of a kinetic state machine, quarks, units and
//! time.
//!
//! A robot implements [`Robot`], [`Output`] and the traits of [`capability`]. A quark implements [`Interrupt`], or
//! [`Control`], [`Law`] and [`Completes`]. Generated code and its callers use [`fsm`], [`Cursor`], [`Plan`] and
//! [`Machine`]; [`trace`] formats the turns of a machine. Programs that show text to people use [`Printable`].
//!
//! This crate runs in a robot's control loop: it does not allocate, has no unsafe code and cannot panic.
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::indexing_slicing, clippy::arithmetic_side_effects)]
#![cfg_attr(test, allow(clippy::indexing_slicing, clippy::arithmetic_side_effects, reason = "a test may panic"))]

#[cfg(test)]
extern crate std;

mod alphabet;
pub mod capability;
mod compass;
mod condition;
mod cursor;
mod entries;
mod follows;
pub mod fsm;
mod links;
mod machine;
mod measured;
mod memory;
mod operands;
mod operator;
mod paths;
mod plan;
mod pose;
mod printable;
mod published;
mod quark;
mod robot;
mod rows;
mod sensed;
mod shape;
mod signal;
mod slots;
mod sonar;
mod source;
mod table;
#[cfg(test)]
mod tests;
mod text_list;
mod time;
pub mod trace;
mod units;
mod way;

pub use alphabet::{Alphabet, Argument, Limit};
pub use compass::Compass;
pub use condition::Condition;
pub use cursor::Cursor;
pub use entries::{Entries, Here, Stamp, Stamps};
pub use follows::Follows;
pub use fsm::Fsm;
pub use links::{Links, Meeting, PEERS, Peer, PeerState, STALE};
pub use machine::{Machine, TRANSITIONS_PER_TURN, Transition, Turn, Watch};
pub use measured::Measured;
pub use memory::{Fact, MarkRow, Memories, Memory};
pub use operands::Conditions;
pub use operator::Operator;
pub use paths::{PathStore, Setpoint, StoredPath};
pub use plan::{Cause, Ending, Plan};
pub use pose::{Frame, Pose, Twist};
pub use printable::{Printable, PrintableLines, is_printable};
pub use published::{ModuleRead, PUBLISHED, Published, PublishedNumber};
pub use quark::{Begin, Completes, Control, Interrupt, Law};
pub use robot::{Output, Robot};
pub use rows::{Examined, InRows};
pub use sensed::{Sensed, Supply};
pub use shape::Shape;
pub use signal::{Comparison, NoSignal, Operand, Signal};
pub use slots::Slots;
pub use sonar::{Mount, PINGS_KEPT, Ping, Pings, SONARS, SonarId};
pub use source::{BracketWords, OperandWords, Source, SourceLine, ValueWords, Words};
pub use table::{Guard, LawRow, Rows, Table, Texts};
pub use text_list::TextList;
pub use time::Nanos;
pub use units::{Bits, Meters, MetersPerSecond, Radians, RadiansPerSecond, Volts};
pub use way::Nanometers;
