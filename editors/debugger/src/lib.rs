//! The debugger of MDLe, for every editor that speaks the Debug Adapter Protocol; `mdlec dap` runs it on standard input
//! and output.
//!
//! A plan runs on a script of interrupts, as `mdlec trace` runs it. Runs are deterministic, so a run goes back by going
//! forward again from a copy of an earlier state (`run.rs`).

mod breakpoints;
mod client;
mod launch;
mod motion;
mod places;
mod requests;
mod run;
mod serve;
mod session;
mod stack;
mod variables;
mod why;

use std::io::{self, BufReader, Read, Write};

use client::Client;

/// Reason why the debugger ends before its client asked for it.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The client broke the protocol.
    #[error(
        "the client does not speak the Debug Adapter Protocol: {0}\nhelp: an editor starts `mdlec dap`, as docs/src/editors.md shows"
    )]
    Protocol(String),
    /// The client closed the connection without `disconnect`.
    #[error("the client is gone: it closed the connection without `disconnect`")]
    Vanished,
}

/// Serves one client on standard input and output, until the client ends the session.
///
/// # Errors
/// The client broke the protocol or vanished.
pub fn serve() -> Result<(), ServeError> {
    serve_on(io::stdin(), &mut io::stdout())
}

/// Serves one client, until it ends the session.
///
/// # Errors
/// The client broke the protocol or vanished.
pub fn serve_on(input: impl Read + Send + 'static, output: &mut dyn Write) -> Result<(), ServeError> {
    serve::serve(&mut Client::new(BufReader::new(input), output))
}
