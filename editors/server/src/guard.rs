//! Converts a panic in a task to an error, so that the server continues.

use std::panic::{AssertUnwindSafe, catch_unwind};

use lsp_server::ErrorCode;

use crate::params::RequestError;

/// Runs `work`; returns an internal error if it panics.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, RequestError>) -> Result<T, RequestError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|cause| {
        let text = cause.downcast_ref::<&str>().copied().map(str::to_owned);
        let text = text.or_else(|| cause.downcast_ref::<String>().cloned()).unwrap_or_default();
        Err(RequestError { code: ErrorCode::InternalError, message: format!("a bug in mdlec: {text}") })
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

    use super::*;

    #[test]
    fn a_panic_is_an_error_of_its_request_alone() {
        let refused = guarded(|| -> Result<(), RequestError> { panic!("at {}", 7) }).unwrap_err();
        assert!(matches!(refused.code, ErrorCode::InternalError));
        assert_eq!(refused.message, "a bug in mdlec: at 7");
        assert_eq!(guarded(|| Ok(1)).ok(), Some(1));
    }
}
