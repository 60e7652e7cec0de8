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

/// Number of consecutive turns longer than the period after which a run ends, because the robot receives its commands
/// too late.
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
}

/// Number of turns in each class.
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
        Self { period, late: Counts::default(), took: Counts::default(), overruns: 0, in_a_row: 0 }
    }

    /// Records the start of a turn, `late` nanoseconds after its scheduled time.
    pub(crate) fn begins(&mut self, late: u64) {
        self.late.add(late);
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
    fn ten_long_turns_in_a_row_are_too_many() {
        let mut timing = Timing::new(1_000);
        let long = |timing: &mut Timing| (1..=10).map(|_| timing.took(1_001)).position(|turn| turn.is_err());
        (0..9).for_each(|_| assert_eq!(timing.took(1_001), Ok(())));
        assert_eq!(timing.took(1_000), Ok(()));
        assert_eq!(long(&mut timing), Some(9));
    }
}
