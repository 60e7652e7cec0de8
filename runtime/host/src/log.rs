//! The run log in JSON lines, with one object per turn, in the format of `mdlec trace`.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;

use mdle_record::RecordFile;
use mdle_runtime::trace::{Fired, Json, Line};
use mdle_runtime::{Frame, Nanos, Turn};

use crate::Intervention;
use crate::background_writer::{Keeps, Outlet};
use crate::patience::Patience;
use crate::position::Texts;
use crate::supervised::Supervised;
use crate::transitions::{Operand, Transitions};

/// A run log that is being written.
#[derive(Debug)]
pub(crate) struct Log {
    file: Outlet,
    /// `true` if each turn is written to the file immediately; `false` at the fastest pace.
    prompt: bool,
}

/// A turn for the run log.
pub(crate) struct LogEntry<'a> {
    /// Texts of the plan.
    pub(crate) plan: &'a dyn Texts,
    /// Number of the turn, counted from 0.
    pub(crate) turn: u64,
    /// Time of the turn.
    pub(crate) t: Nanos,
    /// State of the plan at the end of the turn.
    pub(crate) state: u64,
    /// Result of the turn, which determines the source of the input.
    pub(crate) kind: Turn<()>,
    /// Index of the atom whose law was applied, in the order of the plan's text; `None` for the null input.
    pub(crate) applied: Option<u32>,
    /// Frame of the applied law, if a `FRAME here` encloses its atom.
    pub(crate) frame: Option<Frame>,
    /// Transitions of the turn, in order.
    pub(crate) transitions: &'a Transitions,
    /// Number of the plan, counted from 1.
    pub(crate) plan_number: u64,
    /// The supervisor's intervention in the turn.
    pub(crate) supervised: &'a Supervised,
}

impl LogEntry<'_> {
    /// Returns the additional keys of a turn with a supervisor as JSON, each preceded by a comma; `None` if there are
    /// no additional keys.
    fn more(&self) -> Option<String> {
        let plan = (self.plan_number > 1).then(|| format!(",\"plan\":{}", self.plan_number));
        let safety = self.supervised.intervention().map(|Intervention { verdict, rule, .. }| {
            format!(",\"safety\":{{\"verdict\":\"{}\",\"rule\":{}}}", verdict.word(), Json(rule))
        });
        let requests: Vec<_> = self.supervised.requests.iter().map(|request| Json(request).to_string()).collect();
        let requests = (!requests.is_empty()).then(|| format!(",\"requests\":[{}]", requests.join(",")));
        let parts = [plan, safety, requests];
        parts.iter().any(Option::is_some).then(|| parts.into_iter().flatten().collect())
    }
}

/// A file that a run is going to write, such as its log. The file is open, but still unchanged. If the file is new,
/// dropping this value removes it.
#[derive(Debug)]
pub(crate) struct UnchangedFile<'p> {
    file: File,
    new: Option<New<'p>>,
}

impl<'p> UnchangedFile<'p> {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub(crate) fn open(path: &'p Path) -> io::Result<Self> {
        match File::create_new(path) {
            Ok(file) => Ok(Self { file, new: Some(New(path)) }),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                let file = OpenOptions::new().write(true).create(true).truncate(false).open(path)?;
                Ok(Self { file, new: None })
            }
            Err(error) => Err(error),
        }
    }

    /// Truncates the file and begins the log. With `prompt`, the log is flushed after each turn.
    ///
    /// # Errors
    /// Fails if the file cannot be truncated.
    pub(crate) fn begin(self, prompt: bool, patience: &Patience) -> io::Result<Log> {
        Ok(Log { file: self.emptied(patience)?, prompt })
    }

    /// Truncates the file and returns a writer to it; from now on, the file is not removed any more.
    ///
    /// # Errors
    /// Fails if the file cannot be truncated.
    pub(crate) fn emptied(self, patience: &Patience) -> io::Result<Outlet> {
        Outlet::open(self.cut()?, Keeps::All, patience)
    }

    /// Truncates the file and returns a writer that converts frames to a record.
    ///
    /// # Errors
    /// Fails if the file cannot be truncated.
    pub(crate) fn recorded(self, patience: &Patience) -> io::Result<Outlet> {
        Outlet::open(RecordFile::new(self.cut()?), Keeps::All, patience)
    }

    /// Truncates the file and returns it; from now on, the file is not removed any more.
    fn cut(self) -> io::Result<File> {
        let Self { file, new } = self;
        // A device or a pipe has no length.
        if file.metadata()?.is_file() {
            file.set_len(0)?;
        }
        if let Some(new) = new {
            std::mem::forget(new);
        }
        Ok(file)
    }
}

/// A newly created file, which is removed when this value is dropped.
#[derive(Debug)]
struct New<'p>(&'p Path);

impl Drop for New<'_> {
    fn drop(&mut self) {
        // The refused start has its own message; an empty file that remains does not need a second message.
        let _ = fs::remove_file(self.0);
    }
}

impl Log {
    /// Writes a turn.
    ///
    /// # Errors
    /// Fails if the file cannot be written, for example because the disk is full.
    pub(crate) fn turn(&mut self, entry: &LogEntry<'_>) -> io::Result<()> {
        let LogEntry { plan, turn, t, state, applied, frame, transitions, .. } = *entry;
        let law = applied.map(|atom| plan.law(atom));
        let source = plan.source();
        let fired = transitions.iter().map(|(transition, operands)| {
            let text = |(number, _): &Operand| source.operand(transition.scope, *number).map(|words| words.text);
            Fired {
                from: transition.from,
                level: usize::from(transition.cause.level()),
                by: transition.cause.by(plan.condition(transition.scope)),
                operands: operands.iter().filter_map(text),
            }
        });
        let line = Line { turn, t, state, law, frame, fired };
        match entry.more() {
            None => writeln!(self.file, "{line}")?,
            Some(more) => {
                let line = line.to_string();
                writeln!(self.file, "{}{more}}}", line.strip_suffix('}').unwrap_or(&line))?;
            }
        }
        if self.prompt { self.flush() } else { Ok(()) }
    }

    /// Passes all text written so far to the system.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub(crate) fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
