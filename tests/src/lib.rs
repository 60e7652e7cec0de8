//! Shared code of the tests: random plans and scripts, the steps from a text to machines, robots' lines, and the files
//! of the repository.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test tool fails by panicking")]
#![allow(clippy::print_stdout, reason = "a test tells what it has measured")]

pub mod any_bytes;
pub mod any_file;
pub mod any_text;
pub mod book;
pub mod chance;
pub mod citations;
pub mod driving_plan;
pub mod ecmascript;
pub mod elf;
pub mod emission;
pub mod executable;
pub mod explore;
pub mod golden;
pub mod grammar;
pub mod graphs;
pub mod outputs;
pub mod outside;
pub mod pipeline;
pub mod productions;
pub mod pursuit;
pub mod random_condition;
pub mod random_plan;
pub mod random_script;
pub mod repository;
pub mod run_output;
pub mod scxml;
pub mod signals;
pub mod texts;
pub mod ways;
pub mod xml;
