//! The protocol, as a client in the same process speaks it with the server. Answers are read as the types of
//! `lsp-types`, which know the protocol independently of the server.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod client;
mod diagnostics;
mod features;
mod life_cycle;
mod names;
mod synchronization;
