//! Writes the poses of a crowd as a table, which grows during the run.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use mdle_runtime::Nanos;
use mdle_runtime::trace::Seconds;

use super::turns::Turns;

/// The file of a crowd's poses.
pub(super) struct Trail {
    path: PathBuf,
    file: BufWriter<File>,
    /// Result of writing so far. After the first error, nothing more is written.
    written: io::Result<()>,
}

impl Trail {
    /// Creates the file.
    ///
    /// # Errors
    /// Fails with a message if the file cannot be created.
    pub(super) fn create(path: &Path) -> Result<Self, String> {
        let file = File::create(path).map_err(|error| format!("{} cannot be written: {error}", path.display()))?;
        let mut file = BufWriter::new(file);
        let written = file.write_all(b"t,robot,x,y,heading\n");
        Ok(Self { path: path.to_owned(), file, written })
    }

    /// Writes the poses at time `t`.
    pub(super) fn turn(&mut self, turns: &mut Turns, t: Nanos) {
        let Self { file, written, .. } = self;
        turns.poses(|number, pose| {
            if written.is_ok() {
                let (x, y, heading) = (pose.x.0, pose.y.0, pose.theta.degrees());
                *written = writeln!(file, "{},{number},{x},{y},{heading}", Seconds(t));
            }
        });
    }

    /// Returns `true` if the file could not be written.
    pub(super) fn has_failed(&self) -> bool {
        self.written.is_err()
    }

    /// Writes all buffered lines.
    ///
    /// # Errors
    /// Fails with a message if not everything could be written.
    pub(super) fn close(mut self) -> Result<(), String> {
        let written = self.written.and_then(|()| self.file.flush());
        written.map_err(|error| format!("{} cannot be written: {error}", self.path.display()))
    }
}
