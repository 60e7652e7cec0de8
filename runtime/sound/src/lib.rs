//! Sound for robots with two microphones on a hard spherical head (paper, section III-G): computes the signals that the
//! microphones receive in a room, and estimates the bearing of a source from the delay between them (paper, equation
//! 7).
//!
//! The crate does no I/O, and does not depend on the machine: it uses no wall clock, no trigonometric functions of the
//! platform, and no instructions that are selected at run time. The same calls return the same bits everywhere.
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
