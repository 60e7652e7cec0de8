//! Holds back a report until the live view has left the screen. If the report is very long, only its last part is
//! shown.

use std::io::{self, Write};

/// Maximum size of the stored text, in bytes. If the text is longer, its first half is dropped.
const MOST: usize = 1 << 20;

/// A writer that stores all text until it is flushed.
pub(crate) struct HeldReport<W> {
    to: W,
    text: Vec<u8>,
    cut: bool,
}

impl<W: Write> HeldReport<W> {
    /// Creates an empty writer, which will write to `to` when it is flushed.
    pub(crate) fn new(to: W) -> Self {
        Self { to, text: Vec::new(), cut: false }
    }
}

impl<W: Write> Write for HeldReport<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.text.extend_from_slice(bytes);
        if self.text.len() > MOST {
            let line_end = self.text.iter().skip(MOST / 2).position(|byte| *byte == b'\n');
            self.text.drain(..line_end.map_or(0, |end| MOST / 2 + end + 1));
            self.cut = true;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if std::mem::take(&mut self.cut) {
            self.to.write_all(b"(lines are missing here: there were too many)\n")?;
        }
        self.to.write_all(&std::mem::take(&mut self.text))?;
        self.to.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_comes_at_the_end_and_the_last_of_too_much() {
        let mut report = HeldReport::new(Vec::new());
        report.write_all(b"one\n").unwrap();
        assert_eq!(report.to, b"");
        report.flush().unwrap();
        assert_eq!(report.to, b"one\n");
        report.to.clear();
        let lines: Vec<String> = (0..300_000).map(|number| format!("line {number}\n")).collect();
        lines.iter().for_each(|line| report.write_all(line.as_bytes()).unwrap());
        assert!(report.text.len() <= MOST);
        report.flush().unwrap();
        let text = String::from_utf8(report.to).unwrap();
        let (first, rest) = text.split_once('\n').unwrap();
        assert_eq!(first, "(lines are missing here: there were too many)");
        assert!(lines.concat().ends_with(rest) && rest.starts_with("line ") && rest.len() > MOST / 2);
    }
}
