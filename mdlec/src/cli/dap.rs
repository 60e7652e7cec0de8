//! `mdlec dap`: debugs plans for an editor, through the Debug Adapter Protocol on standard input and output.

use mdle_debugger::ServeError;

use super::CommandFailure;

/// Serves an editor until it ends the session. The exit status is 1 if the client closes the connection too early, and
/// 2 if it violates the protocol.
pub(super) fn dap() -> Result<(), CommandFailure> {
    mdle_debugger::serve().map_err(|error| match error {
        ServeError::Vanished => CommandFailure::of(1, error.to_string()),
        ServeError::Protocol(_) => CommandFailure::usage(error.to_string()),
    })
}
