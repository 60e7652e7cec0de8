//! Errors that prevent a scenario from running.

use super::file::ScenarioError;
use crate::failure::Failure;

/// Error of a scenario: either in its own file, or in a plan whose error has been reported.
pub(super) enum SetupError {
    File(ScenarioError),
    Plan(Failure),
}

impl From<ScenarioError> for SetupError {
    fn from(error: ScenarioError) -> Self {
        Self::File(error)
    }
}

impl<F: Into<Failure>> From<F> for SetupError {
    fn from(failure: F) -> Self {
        Self::Plan(failure.into())
    }
}
