//! Histograms of the lateness and the duration of a robot's turns; recording a turn does not allocate memory.

use std::fmt;
use std::time::Duration;

/// Upper bounds, in nanoseconds, of all histogram classes but the last.
const BOUNDS: [u64; 19] = {
    let mut bounds = [0; 19];
    let (mut class, mut decade) = (0, 10_000);
    while class < bounds.len() {
        bounds[class] = decade * [1, 2, 5][class % 3];
        if class % 3 == 2 {
            decade *= 10;
        }
        class += 1;
    }
    bounds
};

/// Number of consecutive turns, each longer than the period, after which a run ends because the robot receives its
/// commands too late.
const LIMIT: u32 = 10;

/// Lateness and duration of a run's turns.
#[derive(Debug)]
pub(crate) struct Timing {
    /// Period of a turn, in nanoseconds.
    period: u64,
    late: Counts,
    took: Counts,
    overruns: u64,
    in_a_row: u32,
    /// Number of turns that were not made because the previous turn ended too late.
    missed: u64,
}

/// Lateness of the turns of a run on a real robot. The lateness of a turn is the time from its scheduled start to its
/// actual start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lateness {
    /// Lateness that half of the turns do not exceed, rounded up to 1, 2 or 5 times a power of ten.
    pub p50: Duration,
    /// Lateness that 99 of 100 turns do not exceed, rounded up to 1, 2 or 5 times a power of ten.
    pub p99: Duration,
    /// Maximum lateness.
    pub max: Duration,
    /// Number of turns that were not made because the previous turn ended too late.
    pub missed: u64,
}

/// Number of turns in each class of a histogram.
#[derive(Debug, Default)]
struct Counts {
    classes: [u64; BOUNDS.len() + 1],
    /// Maximum value, in nanoseconds.
    most: u64,
}

impl Timing {
    /// Returns `true` if a turn has been counted.
    pub(crate) fn has_turns(&self) -> bool {
        self.took.most > 0
    }

    /// Returns empty statistics for turns with a period in nanoseconds.
    pub(crate) fn new(period: u64) -> Self {
        Self { period, late: Counts::default(), took: Counts::default(), overruns: 0, in_a_row: 0, missed: 0 }
    }

    /// Records the start of a turn, `late` nanoseconds after its scheduled time.
    pub(crate) fn begins(&mut self, late: u64) {
        self.late.add(late);
    }

    /// Records turns that are not made because the previous turn ended too late.
    pub(crate) fn misses(&mut self, turns: u64) {
        self.missed = self.missed.saturating_add(turns);
    }

    /// Returns the lateness of all turns.
    pub(crate) fn lateness(&self) -> Lateness {
        let Self { late, missed, .. } = self;
        let [p50, p99] = [50, 99].map(|percent| Duration::from_nanos(late.within(percent)));
        Lateness { p50, p99, max: Duration::from_nanos(late.most), missed: *missed }
    }

    /// Records a turn that took `nanos` nanoseconds.
    ///
    /// # Errors
    /// Returns a message for the operator if this turn and the turns before it were too long.
    pub(crate) fn took(&mut self, nanos: u64) -> Result<(), String> {
        self.took.add(nanos);
        if nanos <= self.period {
            self.in_a_row = 0;
            return Ok(());
        }
        self.overruns = self.overruns.saturating_add(1);
        self.in_a_row = self.in_a_row.saturating_add(1);
        if self.in_a_row < LIMIT {
            return Ok(());
        }
        let [period, last] = [self.period, nanos].map(Duration::from_nanos);
        Err(format!(
            "{LIMIT} turns in a row took longer than the period of {period:?}, the last {last:.1?}: choose a longer \
             --period, or have nothing else run on this computer"
        ))
    }
}

impl Counts {
    fn add(&mut self, nanos: u64) {
        let class = BOUNDS.partition_point(|bound| *bound < nanos);
        if let Some(count) = self.classes.get_mut(class) {
            *count = count.saturating_add(1);
        }
        self.most = self.most.max(nanos);
    }

    /// Returns a bound, in nanoseconds, that this percentage of the values does not exceed. The result is the upper
    /// bound of a class, or the maximum value if that is lower.
    fn within(&self, percent: u128) -> u64 {
        let total: u128 = self.classes.iter().map(|count| u128::from(*count)).sum();
        let mut so_far = 0;
        let class = self.classes.iter().position(|count| {
            so_far += u128::from(*count) * 100;
            so_far >= total * percent
        });
        class.and_then(|class| BOUNDS.get(class)).map_or(self.most, |bound| self.most.min(*bound))
    }
}

impl fmt::Display for Timing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [late, took] = [&self.late, &self.took];
        let turns: u64 = took.classes.iter().sum();
        let period = Duration::from_nanos(self.period);
        writeln!(f, "{turns} {} of {period:?}, {} longer", if turns == 1 { "turn" } else { "turns" }, self.overruns)?;
        write!(f, "{:>10}{:>10}{:>10}", "up to", "late", "took")?;
        let bounds =
            BOUNDS.iter().map(|bound| format!("{:?}", Duration::from_nanos(*bound))).chain(["more".to_owned()]);
        let counts = late.classes.iter().zip(&took.classes);
        for (bound, (late, took)) in bounds.zip(counts).filter(|(_, (late, took))| **late > 0 || **took > 0) {
            write!(f, "\n{bound:>10}{late:>10}{took:>10}")?;
        }
        let [late, took] = [late, took].map(|counts| format!("{:.1?}", Duration::from_nanos(counts.most)));
        write!(f, "\n{:>10}{late:>10}{took:>10}", "most")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_printed_as_a_table() {
        let mut timing = Timing::new(100_000_000);
        for (late, took) in [(0, 10_000), (10_001, 100_000_000), (75_000, 100_000_001), (20_000_000_000, 30_000_000)] {
            timing.begins(late);
            assert_eq!(timing.took(took), Ok(()));
        }
        insta::assert_snapshot!(timing);
    }

    #[test]
    fn lateness_is_rounded_up_to_the_bound_of_a_class() {
        let mut timing = Timing::new(100_000_000);
        assert_eq!(
            timing.lateness(),
            Lateness { p50: Duration::ZERO, p99: Duration::ZERO, max: Duration::ZERO, missed: 0 }
        );
        (0..98).for_each(|turn| timing.begins(if turn < 50 { 15_000 } else { 30_000 }));
        timing.begins(150_000);
        timing.begins(20_000_000_000);
        timing.misses(199);
        let [p50, p99] = [20, 200].map(Duration::from_micros);
        assert_eq!(timing.lateness(), Lateness { p50, p99, max: Duration::from_secs(20), missed: 199 });
        timing.begins(30_000_000_000);
        assert_eq!(timing.lateness().p99, Duration::from_secs(30), "beyond the last bound");
    }

    #[test]
    fn ten_long_turns_in_a_row_are_too_many() {
        let mut timing = Timing::new(1_000);
        let long = |timing: &mut Timing| (1..=10).map(|_| timing.took(1_001)).position(|turn| turn.is_err());
        (0..9).for_each(|_| assert_eq!(timing.took(1_001), Ok(())));
        assert_eq!(timing.took(1_000), Ok(()));
        assert_eq!(long(&mut timing), Some(9));
    }
}
