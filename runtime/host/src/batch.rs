//! The runs to be made of one plan.

use std::fmt;
use std::num::{NonZeroU64, NonZeroUsize};

/// Runs to be made of one plan.
pub struct Batch<R> {
    /// The seed of the first run; each run's is one more than that of the run before.
    pub first: u64,
    /// Number of runs.
    pub runs: NonZeroU64,
    /// Number of runs that are made at the same time.
    pub jobs: NonZeroUsize,
    /// `true` if the summary is to be JSON.
    pub json: bool,
    /// Makes the robot of a seed, or returns why that failed.
    pub robot: Box<dyn Fn(u64) -> Result<R, String> + Send + Sync>,
    /// Returns the options that repeat the run of a seed by itself.
    pub alone: Box<dyn Fn(u64) -> Vec<String> + Send + Sync>,
}

impl<R> fmt::Debug for Batch<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, runs, jobs, json, .. } = self;
        write!(f, "Batch {{ first: {first}, runs: {runs}, jobs: {jobs}, json: {json} }}")
    }
}
