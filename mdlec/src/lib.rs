//! The command line of mdlec, which prints the results of the stages of [`mdle_compiler`], and builds
//! executables from emitted Rust code.

#[allow(clippy::disallowed_methods, reason = "the command line reads and writes files")]
pub mod cli;
pub mod link;
