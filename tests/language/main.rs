//! Tests of the language: each rule for the meaning of plans with a minimal plan, and texts in every notation.

mod assert_trace;
mod corpus;
mod degeneracy;
mod fmt;
mod helps;
mod loops;
mod memory;
mod motion;
mod notation;
mod paper;
mod parameters;
mod signals;
mod turns;
