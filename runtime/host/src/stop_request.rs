//! The request to end a run. Code that connects to a robot checks it.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Maximum wait between two checks of the request.
const SLICE: Duration = Duration::from_millis(20);

/// A request to end a run; a signal makes it. The default value is a request that is never made.
#[derive(Debug, Clone, Default)]
pub struct StopRequest(Arc<AtomicUsize>);

impl StopRequest {
    /// Returns the request that a signal makes by storing its number in `caught`.
    pub(crate) fn of(caught: &Arc<AtomicUsize>) -> Self {
        Self(Arc::clone(caught))
    }

    /// Returns a request that has already been made.
    #[must_use]
    pub fn at_once() -> Self {
        Self(Arc::new(AtomicUsize::new(1)))
    }

    /// Returns `true` once the request has been made.
    #[must_use]
    pub fn is_made(&self) -> bool {
        self.0.load(Ordering::SeqCst) != 0
    }

    /// Waits for `time`, or until the request has been made.
    pub fn wait(&self, time: Duration) {
        let start = Instant::now();
        while !self.is_made() {
            let left = time.saturating_sub(start.elapsed());
            if left.is_zero() {
                return;
            }
            std::thread::sleep(left.min(SLICE));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_ends_a_wait() {
        StopRequest::at_once().wait(Duration::MAX);
        assert!(StopRequest::at_once().is_made() && !StopRequest::default().is_made());
        let start = Instant::now();
        StopRequest::default().wait(Duration::from_millis(50));
        assert!(start.elapsed() >= Duration::from_millis(50));
    }
}
