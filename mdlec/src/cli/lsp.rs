//! `mdlec lsp`: provides language features to an editor, through the Language Server Protocol on standard input and
//! output.

use mdle_language_server::ServeError;

use super::CommandFailure;

/// Serves an editor until it ends the server. The exit status is 1 if the client closes the connection too early, and 2
/// if it violates the protocol.
pub(super) fn lsp() -> Result<(), CommandFailure> {
    mdle_language_server::serve().map_err(|error| match error {
        ServeError::Vanished => CommandFailure::of(1, error.to_string()),
        ServeError::Protocol(_) => CommandFailure::usage(error.to_string()),
    })
}
