//! The command line of mdlec, and what writes executables: it prints what the stages of [`mdle_compiler`] make, and
//! links emitted Rust.

#[allow(clippy::disallowed_methods, reason = "the command line reads and writes files")]
pub mod cli;
pub mod link;
