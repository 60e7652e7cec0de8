//! Tests Theorem 1 in both directions: against brute force, as the inverse of Algorithm 1, and through the real binary.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod augmented;
mod brute_force;
mod command;
mod definition;
mod loops;
mod machines;
mod printed;
mod round_trip;
