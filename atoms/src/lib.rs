//! Contains the quarks of the paper (section IV-A), for any robot whose output has the capabilities that they need.
//!
//! Each quark is a type that contains the arguments of the quark, in the order of `alphabet.mdle`, and requires the
//! capabilities that the alphabet names for the quark. `wait` is not a type of this crate, since the machine handles
//! time.
//!
//! The crate does not allocate, has no unsafe code and cannot panic. It uses the trigonometric functions of `libm`, so
//! that the results of a law are the same, bit for bit, on every machine.
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::indexing_slicing)]

mod advance;
mod align;
pub mod alphabet;
mod approach;
mod askew;
mod at_isection;
mod beside;
mod between;
mod bumper;
mod crossing;
mod directions;
mod follow;
mod gains;
mod go;
mod go_avoid;
mod heading;
mod lead;
mod map;
mod memory;
mod missed;
mod modules;
mod narrow;
mod passers;
mod path;
mod power;
mod rotate;
mod signals;
mod slot;
mod stop;
mod stuck;
mod swept;
mod sync;
mod tangent;
mod too_near;
#[cfg(test)]
mod trial;
mod turn;
mod wave;
mod way;
mod winding;

pub use advance::{Advance, Advancing};
pub use align::{Align, Aligning};
pub use at_isection::AtIsection;
pub use bumper::Bumper;
pub use follow::{Follow, Pursuing};
pub use go::Go;
pub use go_avoid::{GoAvoid, GoingRound};
pub use lead::{Lead, Leading};
pub use modules::{Age2, Bearing, Following, GoAvoid2, Range};
pub use path::{Path, Replaying};
pub use power::{Battery, Charger, LowBattery};
pub use rotate::{Rotate, Rotating};
pub use signals::{Age, Omega, R, Theta, V, X, Y};
pub use slot::{Keeping, Slot};
pub use stop::Stop;
pub use stuck::Stuck;
pub use sync::{Past, Rendezvous, Sync};
pub use turn::{Turn, Turning};
