//! Formats times and lengths for people.

use std::fmt;

use mdle_runtime::Nanos;

/// Formats nanoseconds as seconds, or nanometres as metres, rounded to a thousandth and with at least one decimal
/// place.
#[must_use]
pub fn rounded(nanos: u64) -> String {
    let thousandths = nanos / 1_000_000 + u64::from(nanos % 1_000_000 >= 500_000);
    let text = format!("{}.{:03}", thousandths / 1000, thousandths % 1000);
    let short = text.trim_end_matches('0');
    if short.ends_with('.') { format!("{short}0") } else { short.to_owned() }
}

/// A time that is displayed in seconds, rounded to the millisecond.
pub struct Clocked(
    /// The time.
    pub Nanos,
);

impl fmt::Display for Clocked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} s", rounded(self.0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_rounded_to_milliseconds() {
        let shown = |nanos| Clocked(Nanos(nanos)).to_string();
        assert_eq!(shown(0), "0.0 s");
        assert_eq!(shown(12_300_000_000), "12.3 s");
        assert_eq!(shown(62_500_000), "0.063 s");
        assert_eq!(shown(100_000_000_000), "100.0 s");
        assert_eq!(shown(999_499_999), "0.999 s");
        assert_eq!(shown(999_500_000), "1.0 s");
        assert_eq!(shown(u64::MAX), "18446744073.71 s");
    }
}
