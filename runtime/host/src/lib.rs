//! What the executable of a plan needs around its turns: arguments, clock, signals, safe stop, run log.

mod target;

pub use clap;
pub use target::{Hosted, Pace, Refusal, Target, Time};
