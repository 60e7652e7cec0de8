//! What robots on a serial line share, whatever their languages: the line, the options of their executables, their
//! configuration and where it came from, the time of their outputs, and whether they move as they are told.
#![forbid(unsafe_code)]

mod capacity;
mod clock;
mod line;
mod moment;
mod obedience;
pub mod options;
mod settings;

pub use capacity::{carries, time_of};
pub use clock::{Clock, Times};
pub use line::{Line, LineFault};
pub use moment::Moment;
pub use obedience::Obedience;
pub use settings::{Settings, can_steer, within};
