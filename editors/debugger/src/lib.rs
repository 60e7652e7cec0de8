//! The debugger of MDLe, for every editor that supports the Debug Adapter Protocol; `mdlec dap` runs it on standard
//! input and output.
//!
//! A plan runs on a script of interrupts, as in `mdlec trace`. Runs are deterministic, so a step back restarts from a
//! copy of an earlier state and runs forward again (`run.rs`).

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

/// Reason why the debugger ends although the client has not requested it.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The client violated the protocol.
    #[error(
        "the client does not speak the Debug Adapter Protocol: {0}\nhelp: an editor starts `mdlec dap`, as docs/src/editors.md shows"
    )]
    Protocol(String),
    /// The client closed the connection without `disconnect`.
    #[error("the client is gone: it closed the connection without `disconnect`")]
    Vanished,
}

/// Serves one client on standard input and output until the client ends the session.
///
/// # Errors
/// Fails if the client violates the protocol or closes the connection too early.
pub fn serve() -> Result<(), ServeError> {
    serve_on(io::stdin(), &mut io::stdout())
}

/// Serves one client until the client ends the session.
///
/// # Errors
/// Fails if the client violates the protocol or closes the connection too early.
pub fn serve_on(input: impl Read + Send + 'static, output: &mut dyn Write) -> Result<(), ServeError> {
    serve::serve(&mut Client::new(BufReader::new(input), output))
}
