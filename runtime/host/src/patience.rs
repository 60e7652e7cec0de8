//! Determines how long a writer waits for its reader. A writer does not wait while a robot in real time is being
//! driven, waits for a limited time once the run is ending, and waits without limit before the robot is driven.

use std::sync::Arc;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::stop_request::StopRequest;

/// Maximum time, once the run is ending, to wait for a reader that accepts nothing.
pub(crate) const AT_THE_END: Duration = Duration::from_secs(2);

/// Phase of a run, which determines how long writers wait for their readers.
#[derive(Debug, Clone)]
pub(crate) struct Patience {
    request: StopRequest,
    /// `true` once a robot in real time is being driven.
    is_real: Arc<AtomicBool>,
    stopped: Arc<OnceLock<Stopped>>,
}

/// Result of an attempt to stop the robot.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stopped {
    /// Time at which the attempt to stop ended.
    pub(crate) at: Instant,
    /// Exit status at that time; `None` if only a signal can end the run.
    pub(crate) status: Option<u8>,
}

impl Patience {
    /// Creates the phase before a run. Once `request` is made, the run is ending.
    pub(crate) fn new(request: StopRequest) -> Self {
        Self { request, is_real: Arc::default(), stopped: Arc::default() }
    }

    /// Ends all waits for readers, because the robot is being driven from now on.
    pub(crate) fn robot_drives(&self) {
        self.is_real.store(true, Ordering::SeqCst);
    }

    /// Lets writers wait for readers again, for a limited time, because the stop of the robot has been attempted.
    pub(crate) fn stop_was_tried(&self, status: Option<u8>) {
        let _ = self.stopped.set(Stopped { at: Instant::now(), status });
    }

    /// Returns the result of the attempt to stop the robot; `None` before such an attempt.
    pub(crate) fn stopped(&self) -> Option<Stopped> {
        self.stopped.get().copied()
    }

    /// Returns the maximum wait for a reader that accepts nothing; `None` for no limit.
    pub(crate) fn limit(&self) -> Option<Duration> {
        let is_real = self.is_real.load(Ordering::SeqCst);
        if is_real && self.stopped().is_none() {
            Some(Duration::ZERO)
        } else if is_real || self.request.is_made() {
            Some(AT_THE_END)
        } else {
            None
        }
    }
}
