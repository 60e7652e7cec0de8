//! Recorder of the path that a robot drives: a row for each turn.

use std::io::{self, Write};

use mdle_runtime::{MetersPerSecond, Nanos, Radians};

use crate::background_writer::Outlet;

/// A path that is being recorded.
pub(crate) struct Recorder<W: Write = Outlet> {
    file: W,
    /// The heading in which the plan began, by odometry.
    begun: Option<Radians>,
    /// Nothing more is written after an error, which is reported at the end: a recording is no reason to stop a robot.
    written: io::Result<()>,
}

impl<W: Write> Recorder<W> {
    /// A recording to `file`.
    pub(crate) fn new(mut file: W) -> Self {
        let written = file.write_all(b"time s, heading deg, speed cm/s\n");
        Self { file, begun: None, written }
    }

    /// Writes the row of the turn at time `t`, in which the robot had this heading by odometry, and drove this fast.
    pub(crate) fn take(&mut self, heading: Radians, speed: MetersPerSecond, t: Nanos) {
        let begun = *self.begun.get_or_insert(heading);
        if self.written.is_ok() {
            let degrees = Radians(heading.0 - begun.0).wrapped().degrees();
            let (seconds, speed) = (t.seconds(), speed.0 * 100.0);
            self.written = writeln!(self.file, "{seconds}, {degrees:.4}, {speed:.4}");
        }
    }

    /// Hands the rest to the system.
    ///
    /// # Errors
    /// When not all could be written.
    pub(crate) fn close(mut self) -> io::Result<()> {
        self.written?;
        self.file.flush()
    }
}
