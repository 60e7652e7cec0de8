//! An ATRV-mini that is not there: its language on a pseudo-terminal, its body in a simulated world.
#![forbid(unsafe_code)]

pub mod atrv;
pub mod wire;
