//! The functions by which a target lets its runs be observed, and started over.

use std::fmt;
use std::time::Duration;

use clap::ArgMatches;

use crate::{Batch, Observer, Refusal};

/// The part of a target whose robot has an observer.
pub struct Observation<R> {
    /// Returns the observer.
    pub observer: fn(&mut R) -> &mut dyn Observer,
    /// `true` if the robot itself shows and draws its run as `--watch`, `--plot`, `--record` and `--trail` ask, as a
    /// simulator does, which knows the world; it leaves the screen when it is stopped. Otherwise the host does, by
    /// odometry.
    pub draws: bool,
    /// Returns the runs to be made instead of one, if these options ask for several: only robots that can be started
    /// over have such options. No run has begun yet.
    pub batch: fn(&ArgMatches, Duration) -> SeveralRuns<R>,
}

/// Runs to be made instead of one, if several were asked for; a bad option or a fault otherwise.
pub type SeveralRuns<R> = Result<Option<Batch<R>>, Refusal>;

impl<R> Observation<R> {
    /// An observer that draws nothing, of one run at a time.
    pub const fn by(observer: fn(&mut R) -> &mut dyn Observer) -> Self {
        Self { observer, draws: false, batch: |_, _| Ok(None) }
    }
}

impl<R> fmt::Debug for Observation<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Observation").finish_non_exhaustive()
    }
}
