//! Implements the theory of plans in the paper: Theorem 1 in both directions, and the equations of transition matrices.
//!
//! Only the commands that print its results use this crate; no stage of the compiler does. It does no I/O.

pub mod equations;
#[cfg(test)]
mod samples;
pub mod theorem;
