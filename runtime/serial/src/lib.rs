//! Shared code of robots on a serial line: the line, the options of their executables, their configuration and its
//! origin, the time of their outputs, and the check that they move as commanded.
#![forbid(unsafe_code)]

mod capacity;
mod clock;
mod configuration;
mod key;
mod line;
mod moment;
mod obedience;
pub mod options;
mod settings;
mod shown;
mod target;

pub use capacity::{carries, time_of};
pub use clock::{Clock, Times};
pub use configuration::{Configuration, Configured};
pub use key::{Key, Setting, one_of, quoted, within};
pub use line::{Line, LineFault};
pub use mdle_runtime::capability::Steering;
pub use moment::Moment;
pub use obedience::Obedience;
pub use settings::Settings;
pub use shown::shortened;
pub use target::{SerialRobot, SerialTarget};
