//! Workloads of the benchmarks, and the code beside which they are measured; `benches/` holds one file for each
//! subject.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a benchmark fails by panicking")]

pub mod front_end;
pub mod plan_text;
