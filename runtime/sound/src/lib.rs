//! Sound for robots with two microphones on a hard spherical head (paper, section III-G): what they hear in a room, and
//! the bearing of a source by the delay between them (paper, equation 7).
//!
//! Nothing here does I/O or depends on the machine: no wall clock, no platform trigonometry, no instructions chosen at
//! run time. The same calls return the same bits everywhere.
#![forbid(unsafe_code)]

mod ears;
mod estimator;
mod gate;
mod head;
mod histogram;
mod localizer;
mod room;
mod source;

pub use ears::{EarPose, Ears};
pub use estimator::{Estimate, Estimator};
pub use gate::RatioGate;
pub use head::SphericalHead;
pub use histogram::Histogram;
pub use localizer::Localizer;
pub use room::SoundRoom;
pub use source::{SoundKind, SoundSource};

/// Sampling rate of each ear, in samples per second.
pub const RATE: u32 = 44_100;
/// Number of samples of each ear from which a bearing is estimated: a turn of 100 ms.
pub const WINDOW: usize = 4_410;
/// Speed of sound, in m/s.
pub const SPEED: f64 = 343.0;
/// Default radius of the head, in metres.
pub const RADIUS: f64 = 0.0875;
