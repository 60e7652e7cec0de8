//! Computes whether a serial line can transmit the data of a turn.

use std::time::Duration;

/// Number of bits of a byte on the line: a start bit, eight data bits and a stop bit.
const BITS: f64 = 10.0;

/// Returns the time that `bytes` bytes need on a line with `speed` bits per second.
#[must_use]
pub fn time_of(bytes: usize, speed: u32) -> Duration {
    Duration::from_secs_f64(bytes as f64 * BITS / f64::from(speed.max(1)))
}

/// Checks that a turn of length `period` is long enough for its transmission, which takes the time `takes`.
///
/// # Errors
/// Returns a message for the operator if the period is too short.
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
