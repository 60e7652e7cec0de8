//! The language server of MDLe, for every editor that speaks the Language Server Protocol 3.17; `mdlec lsp` runs it on
//! standard input and output.
//!
//! A feature is a function from a [`View`](view::View), a checked document, to an answer in places of bytes, and knows
//! nothing of the protocol. `requests` and `convert` translate between both, with positions in UTF-16.

mod answers;
mod brackets;
mod check;
mod commands;
pub mod completion;
pub mod context;
mod convert;
pub mod diagnostics;
mod documents;
pub mod fixes;
pub mod formatting;
mod guard;
pub mod hints;
pub mod hover;
pub mod lenses;
pub mod lines;
pub mod mentions;
pub mod outline;
mod params;
mod publishing;
mod refactoring;
pub mod rename;
mod requests;
mod server;
mod synchronization;
pub mod tokens;
mod uri;
pub mod view;
mod words;

use std::io;

pub use server::serve_on;

/// Reason why the server ends before its client asked for it.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The client broke the protocol.
    #[error(
        "the client does not speak the Language Server Protocol: {0}\nhelp: an editor starts `mdlec lsp`, as docs/src/editors.md shows"
    )]
    Protocol(String),
    /// The client closed the connection without `shutdown` and `exit`.
    #[error("the client is gone: it closed the connection without `exit`")]
    Vanished,
}

/// Serves one client on standard input and output, until the client ends it.
///
/// # Errors
/// The client broke the protocol or vanished.
pub fn serve() -> Result<(), ServeError> {
    let (connection, threads) = lsp_server::Connection::stdio();
    let served = serve_on(&connection);
    // The threads end when nothing is left to be sent. A reader may wait for a client that sends nothing more.
    drop(connection);
    match served {
        Ok(()) => Ok(()),
        Err(ServeError::Vanished) => Err(match threads.join() {
            Err(error) if error.kind() == io::ErrorKind::InvalidData => ServeError::Protocol(error.to_string()),
            Ok(()) | Err(_) => ServeError::Vanished,
        }),
        Err(error @ ServeError::Protocol(_)) => Err(error),
    }
}
