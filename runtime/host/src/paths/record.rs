//! Records the path that a robot drives; each turn becomes a row.

use std::io::{self, Write};

use mdle_runtime::{MetersPerSecond, Nanos, Radians};

use crate::background_writer::Outlet;

/// A path that is being recorded.
pub(crate) struct PathRecording<W: Write = Outlet> {
    file: W,
    /// Heading by odometry in the first row; `None` before the first row.
    begun: Option<Radians>,
    /// Result of writing so far. After an error, nothing more is written. The error is reported at the end of the run,
    /// because it is no reason for stopping a robot.
    written: io::Result<()>,
}

impl<W: Write> PathRecording<W> {
    /// Creates a recorder that writes to `file`.
    pub(crate) fn new(mut file: W) -> Self {
        let written = file.write_all(b"time s, heading deg, speed cm/s\n");
        Self { file, begun: None, written }
    }

    /// Writes the row of the turn at time `t`, in which the robot had this heading and speed by odometry.
    pub(crate) fn take(&mut self, heading: Radians, speed: MetersPerSecond, t: Nanos) {
        let begun = *self.begun.get_or_insert(heading);
        if self.written.is_ok() {
            let degrees = Radians(heading.0 - begun.0).wrapped().degrees();
            let (seconds, speed) = (t.seconds(), speed.0 * 100.0);
            self.written = writeln!(self.file, "{seconds}, {degrees:.4}, {speed:.4}");
        }
    }

    /// Passes the remaining rows to the system.
    ///
    /// # Errors
    /// Fails if a row could not be written.
    pub(crate) fn close(mut self) -> io::Result<()> {
        self.written?;
        self.file.flush()
    }
}
