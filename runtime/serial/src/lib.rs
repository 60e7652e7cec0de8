//! What robots on a serial line share, whatever their languages: the line, the options of their executables, their
//! configuration and where it came from, and the time of their outputs.
#![forbid(unsafe_code)]

mod capacity;
mod clock;
mod line;
pub mod options;
mod settings;

pub use capacity::{carries, time_of};
pub use clock::{Clock, Times};
pub use line::{Line, LineFault};
pub use settings::{Settings, can_steer, within};
