//! Code that robots on a serial line share: the line, the options of executables, the configuration and the source of
//! its values, the time of outputs, and the check that a robot moves as commanded.
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
