//! The language server of MDLe, for every editor that supports the Language Server Protocol 3.17; `mdlec lsp` runs it
//! on standard input and output.
//!
//! `mdle-language-service` implements the features, and its results contain byte ranges. `requests` and `convert`
//! translate between the features and the protocol, which counts positions in UTF-16 units.

mod answers;
mod check;
mod commands;
mod convert;
mod documents;
mod guard;
mod params;
mod publishing;
mod refactoring;
mod requests;
mod server;
mod synchronization;
mod uri;

use std::io;

pub use server::serve_on;

/// Reason why the server ends although the client has not requested it.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The client violated the protocol.
    #[error(
        "the client does not speak the Language Server Protocol: {0}\nhelp: an editor starts `mdlec lsp`, as docs/src/editors.md shows"
    )]
    Protocol(String),
    /// The client closed the connection without `shutdown` and `exit`.
    #[error("the client is gone: it closed the connection without `exit`")]
    Vanished,
}

/// Serves one client on standard input and output until the client ends the server.
///
/// # Errors
/// Fails if the client violates the protocol or closes the connection too early.
pub fn serve() -> Result<(), ServeError> {
    let (connection, threads) = lsp_server::Connection::stdio();
    let served = serve_on(&connection);
    // The threads end when there is nothing left to send. A reading thread may still wait for a client that is silent.
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
