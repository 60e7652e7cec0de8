//! The terminal of a session. Reports of the run are printed above the line that the user is typing.

use std::io::{self, BufRead as _, BufReader, PipeReader, PipeWriter, Write as _};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::Builder;
use std::time::Duration;

use mdle_engine::shell::{PrintAbove, TerminalLines};
use mdle_engine::tree::Hub;
use rustix::termios::{OptionalActions, Termios, tcgetattr, tcsetattr};

/// Line that marks the end of the run's reports.
const END: &[u8] = b"\0\n";
/// Line that changes nothing on the screen. Once the terminal has accepted it, all earlier lines have been printed.
const NOTHING: &str = "\x1b[A\n";
/// Maximum wait for the last report to be printed.
const LAST: Duration = Duration::from_millis(500);
/// Interval at which a thread that waits for a report of a watched attribute checks whether the run has ended.
const LOOK: Duration = Duration::from_millis(200);

/// A terminal that a session uses.
#[derive(Debug)]
pub(crate) struct HeldTerminal {
    /// Settings of the terminal before the session; `None` if they could not be read.
    before: Option<Termios>,
    /// Stream to which the run writes its reports.
    reports: PipeWriter,
    printed: std::sync::mpsc::Receiver<()>,
}

/// The part of a session's terminal that prints reports.
#[derive(Debug)]
pub(crate) struct Printing {
    reports: PipeReader,
    printed: Sender<()>,
}

impl HeldTerminal {
    /// Takes control of the terminal of this process.
    ///
    /// # Errors
    /// Fails if the system cannot create a pipe.
    pub(crate) fn take() -> io::Result<(Self, Printing)> {
        let (reader, reports) = io::pipe()?;
        let (sender, printed) = channel();
        let before = tcgetattr(io::stdin()).ok();
        Ok((Self { before, reports, printed }, Printing { reports: reader, printed: sender }))
    }

    /// Returns the stream to which the run writes its reports.
    pub(crate) fn reports(&self) -> &PipeWriter {
        &self.reports
    }

    /// Waits until all reports of the run are printed, and then restores the terminal.
    pub(crate) fn give_back(mut self) {
        let _ = self.reports.write_all(END);
        let _ = self.printed.recv_timeout(LAST);
        if let Some(before) = self.before {
            // Line editing has changed the settings of the terminal.
            let _ = tcsetattr(io::stdin(), OptionalActions::Now, &before);
        }
        let _ = writeln!(io::stderr());
    }
}

impl Printing {
    /// Opens the terminal for typing, and starts threads that print the reports of the run and the hub.
    ///
    /// # Errors
    /// Fails if the terminal cannot be used, or if the system cannot create the threads; reports of the run are printed
    /// nevertheless.
    pub(crate) fn begin(self, hub: &Hub) -> io::Result<TerminalLines> {
        let (terminal, print): (_, Box<PrintAbove>) = match TerminalLines::open(hub.clone()) {
            Ok((terminal, print)) => (Ok(terminal), print),
            Err(error) => (Err(error), Box::new(|text: &str| io::stderr().write_all(text.as_bytes()))),
        };
        let print = Arc::new(Mutex::new(print));
        let (watched, hub) = (Arc::clone(&print), hub.clone());
        Builder::new().name("reports".to_owned()).spawn(move || self.print(&print))?;
        Builder::new().name("watched".to_owned()).spawn(move || {
            loop {
                match hub.report(LOOK) {
                    Some(report) => say(&watched, &format!("{report}\n")),
                    None if hub.has_ended() => break,
                    None => {}
                }
            }
        })?;
        terminal
    }

    /// Prints the reports of the run until their end.
    fn print(self, print: &Mutex<Box<PrintAbove>>) {
        let (mut reports, mut line) = (BufReader::new(self.reports), Vec::new());
        while reports.read_until(b'\n', &mut line).is_ok_and(|read| read > 0) && line != END {
            say(print, &String::from_utf8_lossy(&line));
            line.clear();
        }
        (0..2).for_each(|_| say(print, NOTHING));
        let _ = self.printed.send(());
    }
}

fn say(print: &Mutex<Box<PrintAbove>>, text: &str) {
    // A closed terminal is not a reason to stop.
    let _ = (print.lock().unwrap_or_else(PoisonError::into_inner))(text);
}
