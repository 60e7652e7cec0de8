//! Functions of a target with which its runs are observed and started over.

use std::fmt;
use std::time::Duration;

use clap::ArgMatches;

use crate::{Batch, Observer, Refusal};

/// Functions of a target whose robot has an observer.
pub struct Observation<R> {
    /// Function that returns the robot's observer.
    pub observer: fn(&mut R) -> &mut dyn Observer,
    /// `true` if the robot itself handles `--watch`, `--plot`, `--record` and `--trail`, as a simulator does because it
    /// knows the world. Such a robot also restores the screen when it is stopped. If `false`, the host handles these
    /// options with the robot's odometry.
    pub draws: bool,
    /// Function that returns the runs of a batch, if the options request more than one run. Only robots that can be
    /// started over have such options. No run has begun when the function is called.
    pub batch: fn(&ArgMatches, Duration) -> SeveralRuns<R>,
}

/// The runs of a batch, if the options request more than one run; the error is the reason why they cannot be made.
pub type SeveralRuns<R> = Result<Option<Batch<R>>, Refusal>;

impl<R> Observation<R> {
    /// Creates an observation with this observer. The host draws the views, and the robot makes a single run.
    pub const fn by(observer: fn(&mut R) -> &mut dyn Observer) -> Self {
        Self { observer, draws: false, batch: |_, _| Ok(None) }
    }
}

impl<R> fmt::Debug for Observation<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Observation").finish_non_exhaustive()
    }
}
