//! The run log: JSON lines, one object a turn, in the format of `mdlec trace`.

use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use mdle_runtime::{Cause, Nanos, Plan, Transition};

/// A run log that is being written.
#[derive(Debug)]
pub(crate) struct Log<W: Write> {
    file: BufWriter<W>,
    /// Whether each turn reaches the file at once: not at the fastest pace.
    prompt: bool,
}

/// What a log says about a turn.
pub(crate) struct Entry<'a, P> {
    /// The plan, for its texts.
    pub(crate) plan: &'a P,
    /// The number of the turn, from 0.
    pub(crate) turn: u64,
    /// Its time.
    pub(crate) t: Nanos,
    /// The state in which it ended.
    pub(crate) state: u64,
    /// The atom whose law was applied, as written; `None` for the null input.
    pub(crate) applied: Option<u32>,
    /// Its transitions, in order.
    pub(crate) transitions: &'a [Transition],
}

impl Log<File> {
    /// Begins a log, in place of whatever the file held.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn create(path: &Path, prompt: bool) -> io::Result<Self> {
        Ok(Self::new(File::create(path)?, prompt))
    }
}

impl<W: Write> Log<W> {
    /// A log to `file`.
    fn new(file: W, prompt: bool) -> Self {
        Self { file: BufWriter::new(file), prompt }
    }

    /// Writes one turn.
    ///
    /// # Errors
    /// When the file cannot be written, such as when the disk is full.
    pub(crate) fn turn<P: Plan>(&mut self, entry: &Entry<'_, P>) -> io::Result<()> {
        let Entry { plan, turn, t, state, applied, transitions } = *entry;
        write!(self.file, "{{\"turn\":{turn},\"t\":{},\"state\":{state},\"law\":", Seconds(t))?;
        match applied {
            Some(atom) => write!(self.file, "{}", Json(plan.law(atom)))?,
            None => write!(self.file, "null")?,
        }
        write!(self.file, ",\"fired\":[")?;
        for (index, transition) in transitions.iter().enumerate() {
            let comma = if index == 0 { "" } else { "," };
            let by = match transition.cause {
                Cause::Fired(_) => plan.condition(transition.scope),
                Cause::Completed(_) => "completed",
            };
            let (from, level) = (transition.from, transition.cause.level());
            write!(self.file, "{comma}{{\"from\":{from},\"level\":{level},\"by\":{}}}", Json(by))?;
        }
        writeln!(self.file, "]}}")?;
        if self.prompt { self.flush() } else { Ok(()) }
    }

    /// Hands everything written so far to the system.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// A time as a JSON number of seconds, exact to the nanosecond, with at least one decimal.
struct Seconds(Nanos);

impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Nanos(nanos) = self.0;
        let (seconds, mut fraction) = (nanos / 1_000_000_000, nanos % 1_000_000_000);
        let mut digits = 9;
        while digits > 1 && fraction % 10 == 0 {
            fraction /= 10;
            digits -= 1;
        }
        write!(f, "{seconds}.{fraction:0digits$}")
    }
}

/// A text as a JSON string.
struct Json<'a>(&'a str);

impl fmt::Display for Json<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"")?;
        for letter in self.0.chars() {
            match letter {
                '"' => write!(f, "\\\"")?,
                '\\' => write!(f, "\\\\")?,
                '\n' => write!(f, "\\n")?,
                '\r' => write!(f, "\\r")?,
                '\t' => write!(f, "\\t")?,
                '\u{8}' => write!(f, "\\b")?,
                '\u{c}' => write!(f, "\\f")?,
                control if control < ' ' => write!(f, "\\u{:04x}", u32::from(control))?,
                plain => write!(f, "{plain}")?,
            }
        }
        write!(f, "\"")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_exact_and_short() {
        let shown = |nanos| Seconds(Nanos(nanos)).to_string();
        assert_eq!(shown(0), "0.0");
        assert_eq!(shown(100_000_000), "0.1");
        assert_eq!(shown(12_300_000_000), "12.3");
        assert_eq!(shown(7_000_000_000), "7.0");
        assert_eq!(shown(33_333_333), "0.033333333");
        assert_eq!(shown(1_000_000_001), "1.000000001");
        assert_eq!(shown(60_050_000_000), "60.05");
    }

    #[test]
    fn strings_are_escaped() {
        assert_eq!(Json(r#"path "a\b""#).to_string(), r#""path \"a\\b\"""#);
        assert_eq!(Json("a\nb\tc\u{1}\u{7f}π").to_string(), "\"a\\nb\\tc\\u0001\u{7f}π\"");
    }
}
