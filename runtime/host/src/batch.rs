//! Several runs of one plan, as the options request them.

use std::fmt;
use std::num::{NonZeroU64, NonZeroUsize};

/// Several runs of one plan, with different seeds.
pub struct Batch<R> {
    /// Seed of the first run. The seed of each other run is the previous run's seed plus 1.
    pub first: u64,
    /// Number of runs.
    pub runs: NonZeroU64,
    /// Number of simultaneous runs.
    pub jobs: NonZeroUsize,
    /// `true` if the summary is written as JSON.
    pub json: bool,
    /// Function that creates the robot for a seed; the error is the reason why the robot could not be created.
    pub robot: Box<dyn Fn(u64) -> Result<R, String> + Send + Sync>,
    /// Function that returns the options that repeat the run with a given seed alone.
    pub alone: Box<dyn Fn(u64) -> Vec<String> + Send + Sync>,
}

impl<R> fmt::Debug for Batch<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, runs, jobs, json, .. } = self;
        write!(f, "Batch {{ first: {first}, runs: {runs}, jobs: {jobs}, json: {json} }}")
    }
}
