//! A Super Scout that is not there: its language on a pseudo-terminal, its body in a simulated world.
#![forbid(unsafe_code)]

pub mod scout;
pub mod wire;
