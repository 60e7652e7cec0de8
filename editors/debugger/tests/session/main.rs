//! Tests the debugger's answers to a client's requests.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod breakpoints;
mod client;
mod life_cycle;
mod steps;
mod values;
