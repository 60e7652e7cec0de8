//! The line on standard error by which a fast run shows that it goes on: only on a terminal, and never left behind.

use std::io::Write;
use std::time::Duration;

use mdle_runtime::Nanos;

use crate::report::Report;

/// From one look to the next.
const EVERY: Duration = Duration::from_millis(100);
/// The longest line, in letters: none may need two lines of a terminal.
const LETTERS: usize = 76;
/// The letters of a bar.
const BAR: u64 = 30;

/// A line that is written over and over, and gone when it is dropped.
pub(crate) struct Progress<'e> {
    err: &'e mut dyn Write,
    /// The time since it began.
    now: Box<dyn FnMut() -> Duration + 'e>,
    next: Duration,
    shown: bool,
}

impl<'e> Progress<'e> {
    /// A line on `err`, by this clock.
    pub(crate) fn new(err: &'e mut dyn Write, now: Box<dyn FnMut() -> Duration + 'e>) -> Self {
        Self { err, now, next: EVERY, shown: false }
    }

    /// A run has come to time `t`, with this atom. What it has reported is shown first, if it is time to show anything.
    pub(crate) fn run(&mut self, t: Nanos, state: u64, law: &str, report: &mut Report<'_>) {
        let Some(now) = self.due() else { return };
        self.clear();
        report.flush();
        let times = t.seconds() / now.as_secs_f64();
        self.show(&format!("{:.1} s  {times:.0} times as fast as real  atom {state} {law}", t.seconds()));
    }

    /// So many runs of all are done.
    pub(crate) fn runs(&mut self, done: u64, all: u64) {
        let Some(now) = self.due() else { return };
        let full = usize::try_from(BAR * done / all.max(1)).unwrap_or(0);
        let (full, empty) = ("#".repeat(full), ".".repeat(usize::try_from(BAR).unwrap_or(0).saturating_sub(full)));
        let left = now.as_secs_f64() / done.max(1) as f64 * all.saturating_sub(done) as f64;
        self.show(&format!("[{full}{empty}] {done} of {all} runs, {left:.0} s to go"));
    }

    /// The time, if it is time to show something.
    fn due(&mut self) -> Option<Duration> {
        let now = (self.now)();
        (now >= self.next).then(|| {
            self.next = now + EVERY;
            now
        })
    }

    fn show(&mut self, line: &str) {
        let line: String = line.chars().take(LETTERS).collect();
        // Whoever reads it no more is no reason to stop a run. The cursor goes back, so that other output begins there.
        let _ = write!(self.err, "{line}\x1b[K\r").and_then(|()| self.err.flush());
        self.shown = true;
    }

    fn clear(&mut self) {
        if std::mem::take(&mut self.shown) {
            let _ = write!(self.err, "\x1b[K").and_then(|()| self.err.flush());
        }
    }
}

impl Drop for Progress<'_> {
    fn drop(&mut self) {
        self.clear();
    }
}
