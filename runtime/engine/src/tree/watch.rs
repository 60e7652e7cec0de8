//! Attributes that a front end watches. Changed values are reported, at a rate that users can read.

use std::sync::mpsc::SyncSender;

use mdle_runtime::Nanos;

/// Minimum time between two reports of an attribute, on the robot's clock.
const APART: Nanos = Nanos(200_000_000);
/// Maximum number of watched attributes.
const MOST: usize = 32;
/// Maximum number of reports that wait for a front end.
pub(super) const REPORTS: usize = 1024;

/// The watched attributes.
#[derive(Debug)]
pub(super) struct Watches {
    watched: Vec<WatchedPath>,
    reports: SyncSender<String>,
}

#[derive(Debug)]
struct WatchedPath {
    path: String,
    /// Last reported value; `None` before the first report.
    reported: Option<String>,
    /// Earliest time at which the attribute may be reported again.
    next: Nanos,
}

impl Watches {
    pub(super) fn new(reports: SyncSender<String>) -> Self {
        Self { watched: Vec::new(), reports }
    }

    /// Starts watching an attribute.
    ///
    /// # Errors
    /// Fails with a sentence if too many attributes are watched.
    pub(super) fn add(&mut self, path: &str) -> Result<(), String> {
        if self.watched.iter().any(|watched| watched.path == path) {
            return Ok(());
        }
        if self.watched.len() >= MOST {
            return Err(format!("{MOST} attributes are watched, which is the most: `unwatch` one"));
        }
        self.watched.push(WatchedPath { path: path.to_owned(), reported: None, next: Nanos::ZERO });
        Ok(())
    }

    /// Stops watching an attribute.
    ///
    /// # Errors
    /// Fails with a sentence if the attribute is not watched.
    pub(super) fn remove(&mut self, path: &str) -> Result<(), String> {
        let place = self.watched.iter().position(|watched| watched.path == path);
        let place = place.ok_or_else(|| format!("`{path}` is not watched"))?;
        self.watched.remove(place);
        Ok(())
    }

    /// Returns `true` if an attribute may be reported at time `t`.
    pub(super) fn are_due(&self, t: Nanos) -> bool {
        self.watched.iter().any(|watched| t >= watched.next)
    }

    /// Reports the attributes that have changed; `value` returns the displayed value of a path.
    pub(super) fn report(&mut self, t: Nanos, value: impl Fn(&str) -> String) {
        let Self { watched, reports } = self;
        for WatchedPath { path, reported, next } in watched.iter_mut().filter(|watched| t >= watched.next) {
            let value = value(path);
            // A report that does not fit into the queue is tried again later.
            if reported.as_ref() != Some(&value)
                && reports.try_send(format!("{:.1} s  {path} {value}", t.seconds())).is_ok()
            {
                *reported = Some(value);
                *next = Nanos(t.0.saturating_add(APART.0));
            }
        }
    }
}
