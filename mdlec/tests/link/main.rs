//! Tests of executables that are built from emitted Rust, and of the cache in which they are built.
//!
//! All tests share a cache that is kept between runs of the tests, so that only the first run compiles the runtime.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "a test may, and files are what this is about")]

mod damaged;
mod executables;
mod robot;
