//! The language: the meaning of plans, each rule by its smallest plan, and texts of every notation.

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
