//! Reads times of a run from arguments.

use mdle_host::Quantity;
use mdle_runtime::Nanos;

use crate::failure::Failure;

/// Reads a time of a run.
///
/// # Errors
/// Fails if the text is not a time, or is a negative time.
pub(crate) fn run_time(text: &str) -> Result<Nanos, Failure> {
    let seconds = Quantity::Time.read(text, "s").map_err(Failure::Usage)?;
    if seconds < 0.0 {
        let help = "a time of the run is 0 or more, as in `12.3` or `2min`";
        return Err(Failure::Usage(format!("`{text}` is before the start of the run\nhelp: {help}")));
    }
    // The conversion to an integer saturates.
    Ok(Nanos(libm::round(seconds * 1e9) as u64))
}
