//! The paper's theory of plans: Theorem 1 in both directions, and the equations of transition matrices.
//!
//! No stage of the compiler needs it, only commands that print it. It does no I/O.

pub mod equations;
#[cfg(test)]
mod samples;
pub mod theorem;
