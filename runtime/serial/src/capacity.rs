//! Capacity of a line in a turn.

use std::time::Duration;

/// Bits of a byte on the line: eight, a start and a stop.
const BITS: f64 = 10.0;

/// Returns the time that `bytes` bytes take on a line of `speed` bits per second.
#[must_use]
pub fn time_of(bytes: usize, speed: u32) -> Duration {
    Duration::from_secs_f64(bytes as f64 * BITS / f64::from(speed.max(1)))
}

/// Checks that turns of this period are long enough for their transmission, which takes `takes`.
///
/// # Errors
/// Fails with a sentence for the operator if they are too short.
pub fn carries(period: Duration, takes: Duration) -> Result<(), String> {
    if takes <= period {
        return Ok(());
    }
    let least = (takes.as_secs_f64() * 1e3).ceil() / 1e3;
    Err(format!(
        "a --period of {} s is too short for this robot's line, on which each turn takes {takes:.1?}: \
         choose {least} s or longer",
        period.as_secs_f64()
    ))
}
