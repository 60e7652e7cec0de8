//! Workloads of the benchmarks, and code that compares results. `benches/` contains one file for each subject.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

pub mod front_end;
pub mod plan_text;
