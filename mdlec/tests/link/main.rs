//! Executables from emitted Rust, and the cache that they are built in.
//!
//! All tests share a cache that outlives them: only the first run compiles the runtime.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "a test may, and files are what this is about")]

mod damaged;
mod executables;
mod robot;
