//! Warnings about refused connections, states and letters. The same warning is repeated only at intervals.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Time after a warning during which the same warning is not repeated.
const QUIET: Duration = Duration::from_secs(10);
/// Maximum number of warnings that are kept.
const KNOWN: usize = 64;

/// Recent warnings, by their text.
#[derive(Debug, Default)]
pub(super) struct Refusals(BTreeMap<String, RefusalCount>);

#[derive(Debug)]
struct RefusalCount {
    /// Time at which the warning was given.
    at: Instant,
    /// Number of times that the cause has recurred since the warning.
    count: u32,
}

impl Refusals {
    /// Returns the warning that `what` is refused at time `now`. Returns `None` if the same warning was given a short
    /// time ago, or if there are too many different warnings.
    pub(super) fn warning(&mut self, what: &str, reason: &str, now: Instant) -> Option<String> {
        let warning = format!("warning: state link: {what} is refused: {reason}");
        if let Some(known) = self.0.get_mut(&warning) {
            known.count = known.count.saturating_add(1);
            if now.saturating_duration_since(known.at) < QUIET {
                return None;
            }
            let (seconds, count) = (now.saturating_duration_since(known.at).as_secs(), known.count);
            *known = RefusalCount { at: now, count: 0 };
            return Some(format!("{warning} ({count} times in {seconds} s)"));
        }
        if self.0.len() >= KNOWN {
            self.0.retain(|_, known| now.saturating_duration_since(known.at) < QUIET);
        }
        if self.0.len() >= KNOWN {
            return None;
        }
        self.0.insert(warning.clone(), RefusalCount { at: now, count: 0 });
        Some(warning)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_is_repeated_with_its_number_after_a_while() {
        let (mut refusals, begun) = (Refusals::default(), Instant::now());
        let mut warning =
            |what: &str, seconds| refusals.warning(what, "it sends no states", begun + Duration::from_secs(seconds));
        let text = |what| Some(format!("warning: state link: {what} is refused: it sends no states"));
        assert_eq!((warning("10.0.0.1", 0), warning("10.0.0.2", 0)), (text("10.0.0.1"), text("10.0.0.2")));
        assert_eq!([1, 2, 9].map(|seconds| warning("10.0.0.1", seconds)), [const { None }; 3]);
        assert_eq!(warning("10.0.0.1", 11), text("10.0.0.1").map(|warning| warning + " (4 times in 11 s)"));
        assert_eq!(warning("10.0.0.1", 12), None);
    }

    #[test]
    fn only_so_many_warnings_are_given_in_a_while() {
        let (mut refusals, begun) = (Refusals::default(), Instant::now());
        let mut given =
            |at| (0..1000).filter(|port| refusals.warning(&port.to_string(), "it is full", at).is_some()).count();
        assert_eq!([given(begun), given(begun), given(begun + QUIET)], [KNOWN, 0, KNOWN]);
    }
}
