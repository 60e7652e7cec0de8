//! Time stamps of ROS messages outside of a simulation, which contain the system's time.

use std::time::{SystemTime, UNIX_EPOCH};

/// Returns the time since the epoch, in nanoseconds, for the headers of messages.
#[must_use]
pub(crate) fn ros_now() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since.as_nanos()).unwrap_or(i64::MAX)
}
