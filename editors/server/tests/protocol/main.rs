//! Tests the server with a client in the same process. Answers are parsed with `lsp-types`, which implements the
//! protocol independently of the server.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod client;
mod diagnostics;
mod features;
mod life_cycle;
mod names;
mod synchronization;
