//! Code that all robot emulators share: pseudo-terminals, the advance of time, and the main program.
#![forbid(unsafe_code)]

mod driven;
#[cfg(feature = "trial")]
mod effects;
mod fault;
mod faulty;
mod options;
mod orders;
mod port;
mod presence;
mod program;
mod serve;
mod several;
mod staged;
#[cfg(feature = "trial")]
mod trial;

pub use driven::{Driven, driven};
#[cfg(feature = "trial")]
pub use effects::{Effect, Speed, untrue_effects};
pub use fault::{Ailment, Fault, ScheduledFault};
pub use faulty::Faulty;
pub use options::EmulatorOptions;
pub use orders::{MotionOrder, OrderLog};
pub use port::Port;
pub use program::program;
pub use serve::{Embodied, Emulated, Pace, STEP, serve};
pub use several::{Seat, Several};
pub use staged::Staged;
#[cfg(feature = "trial")]
pub use trial::{OnItsLine, Trial, WheelMotion, memory_asked_for};
