//! The line on standard error that shows the progress of a fast run. It appears only on a terminal, and is erased at
//! the end.

use std::fmt;
use std::io::Write;
use std::time::Duration;

use mdle_runtime::{Nanos, Printable};

use crate::report::ReportWriter;
use crate::run_end::say;

/// Minimum time between two updates of the line.
const EVERY: Duration = Duration::from_millis(100);
/// Maximum length of the line, in characters, so that it never takes two lines of a terminal.
const LETTERS: usize = 76;
/// Width of a progress bar, in characters.
const BAR: usize = 30;

/// A line on standard error that is updated in place, and erased when it is dropped.
pub struct ProgressLine<'e> {
    err: &'e mut dyn Write,
    /// Function that returns the time since the work began.
    now: Box<dyn FnMut() -> Duration + 'e>,
    next: Duration,
    shown: bool,
}

impl fmt::Debug for ProgressLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ProgressLine").field("next", &self.next).field("shown", &self.shown).finish_non_exhaustive()
    }
}

impl<'e> ProgressLine<'e> {
    /// Creates a line on `err`; `now` returns the time since the work began.
    pub fn new(err: &'e mut dyn Write, now: Box<dyn FnMut() -> Duration + 'e>) -> Self {
        Self { err, now, next: EVERY, shown: false }
    }

    /// Shows the report of a run and its progress, if an update is due. `law` is the law of the current atom at time
    /// `t`.
    pub(crate) fn run(&mut self, t: Nanos, law: &str, report: &mut ReportWriter<'_>) {
        let Some(now) = self.due() else { return };
        self.clear();
        report.flush();
        let times = t.seconds() / now.as_secs_f64();
        self.show(&format!("{:.1} s  {times:.0} times as fast as real  {}", t.seconds(), Printable(law)));
    }

    /// Shows a message on a line of its own, which is not erased.
    pub(crate) fn say(&mut self, message: &str) {
        self.clear();
        say(self.err, format_args!("{message}"));
    }

    /// Shows that `done` of `all` runs have finished.
    pub fn runs(&mut self, done: u64, all: u64) {
        let Some(now) = self.due() else { return };
        let full = (BAR as f64 * done as f64 / all.max(1) as f64) as usize;
        let (full, empty) = ("#".repeat(full), ".".repeat(BAR.saturating_sub(full)));
        let left = now.as_secs_f64() / done.max(1) as f64 * all.saturating_sub(done) as f64;
        self.show(&format!("[{full}{empty}] {done} of {all} runs, {left:.0} s to go"));
    }

    /// Shows that the simulation has reached the time `t`; it ends at `end`.
    pub fn simulated(&mut self, t: Nanos, end: Nanos) {
        let Some(now) = self.due() else { return };
        let (t, end) = (t.seconds(), end.seconds());
        let full = ((BAR as f64 * t / end.max(f64::MIN_POSITIVE)) as usize).min(BAR);
        let (full, empty) = ("#".repeat(full), ".".repeat(BAR.saturating_sub(full)));
        let times = t / now.as_secs_f64();
        self.show(&format!("[{full}{empty}] {t:.1} of {end:.0} s, {times:.1} times as fast as real"));
    }

    /// Returns the current time if an update is due; `None` otherwise.
    fn due(&mut self) -> Option<Duration> {
        let now = (self.now)();
        (now >= self.next).then(|| {
            self.next = now + EVERY;
            now
        })
    }

    fn show(&mut self, line: &str) {
        let line: String = line.chars().take(LETTERS).collect();
        // A closed reader is no reason to stop a run. The cursor returns to the start of the line, where other output
        // begins.
        let _ = write!(self.err, "{line}\x1b[K\r").and_then(|()| self.err.flush());
        self.shown = true;
    }

    fn clear(&mut self) {
        if std::mem::take(&mut self.shown) {
            let _ = write!(self.err, "\x1b[K").and_then(|()| self.err.flush());
        }
    }
}

impl Drop for ProgressLine<'_> {
    fn drop(&mut self) {
        self.clear();
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn a_line_is_shown_ten_times_a_second_and_gone_in_the_end() {
        let time = Cell::new(Duration::ZERO);
        let (mut err, mut out) = (Vec::new(), Vec::new());
        out.extend_from_slice(b"one\n");
        let mut report = ReportWriter::new(&mut out, false);
        let mut progress = ProgressLine::new(&mut err, Box::new(|| time.get()));
        for (millis, t) in [(0, 0), (99, 50), (100, 60), (150, 80), (201, 100)] {
            time.set(Duration::from_millis(millis));
            progress.run(Nanos(t * 1_000_000_000), "goAvoid 0 40 20", &mut report);
        }
        drop(progress);
        let shown = "60.0 s  600 times as fast as real  goAvoid 0 40 20\x1b[K\r\x1b[K\
                     100.0 s  498 times as fast as real  goAvoid 0 40 20\x1b[K\r\x1b[K";
        assert_eq!(String::from_utf8(err).unwrap(), shown);
    }

    #[test]
    fn a_bar_grows_with_the_runs_and_no_line_is_longer_than_a_terminal() {
        let mut seconds = 0;
        let mut err = Vec::new();
        let clock = Box::new(|| {
            seconds += 1;
            Duration::from_secs(seconds)
        });
        let mut progress = ProgressLine::new(&mut err, clock);
        for (done, all) in [(1, 4), (2, 4), (4, 4), (u64::MAX / 31, u64::MAX)] {
            progress.runs(done, all);
        }
        drop(progress);
        let shown = String::from_utf8(err).unwrap();
        let lines: Vec<&str> = shown.split("\x1b[K").filter(|line| !line.trim().is_empty()).collect();
        assert_eq!(lines[0], "[#######.......................] 1 of 4 runs, 3 s to go");
        assert!(
            lines[1].contains("2 of 4 runs, 2 s to go") && lines[2].contains("4 of 4 runs, 0 s to go"),
            "{lines:?}"
        );
        assert!(lines.iter().all(|line| line.trim().chars().count() <= LETTERS));
    }
}
