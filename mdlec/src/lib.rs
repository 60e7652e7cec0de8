//! The command line of mdlec. It prints the results of the stages of [`mdle_compiler`], and builds executables from the
//! Rust code that the compiler generates.

#[allow(clippy::disallowed_methods, reason = "the command line reads and writes files")]
pub mod cli;
pub mod link;
