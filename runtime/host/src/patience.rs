//! The time that a writer waits for its reader: without limit before the run, not at all while a robot drives, and for
//! a limited time afterwards.

use std::sync::Arc;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::stop_request::StopRequest;

/// The time that a reader which takes nothing is waited for once the run is to end.
pub(crate) const AT_THE_END: Duration = Duration::from_secs(2);

/// The phase of a run, as far as it decides how long writers wait.
#[derive(Debug, Clone)]
pub(crate) struct Patience {
    request: StopRequest,
    /// `true` once a robot in real time has been driven.
    is_real: Arc<AtomicBool>,
    stopped: Arc<OnceLock<Stopped>>,
}

/// Result of the attempt to stop the robot.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stopped {
    /// Time at which the attempt to stop ended.
    pub(crate) at: Instant,
    /// The exit status as far as it was known then; `None` if only a signal ends the run.
    pub(crate) status: Option<u8>,
}

impl Patience {
    /// The patience of a run that has not begun, and that `request` ends.
    pub(crate) fn new(request: StopRequest) -> Self {
        Self { request, is_real: Arc::default(), stopped: Arc::default() }
    }

    /// Ends all waits for readers from now on.
    pub(crate) fn robot_drives(&self) {
        self.is_real.store(true, Ordering::SeqCst);
    }

    /// Lets writers wait for readers again, but for a limited time.
    pub(crate) fn stop_was_tried(&self, status: Option<u8>) {
        let _ = self.stopped.set(Stopped { at: Instant::now(), status });
    }

    /// Returns the attempt to stop the robot, if it has been made.
    pub(crate) fn stopped(&self) -> Option<Stopped> {
        self.stopped.get().copied()
    }

    /// Returns the maximum wait for a reader that takes nothing; `None` for no limit.
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
