//! The paper's theory of plans: Theorem 1 in both directions, and the equations of transition matrices.
//!
//! No stage of the compiler uses this crate, only the commands that print its results. It does no I/O.

pub mod equations;
#[cfg(test)]
mod samples;
pub mod theorem;
