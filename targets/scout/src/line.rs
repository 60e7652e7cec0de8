//! The serial line to a Scout: sends commands and receives their answers.

use std::time::{Duration, Instant};

use mdle_serial::LineFault;

use crate::command::Command;
use crate::fault::Fault;
use crate::frame::Frame;
use crate::reader::{CHUNK, Reader};

/// Speed of the line in bits per second, 8N1.
pub(crate) const SPEED: u32 = 38_400;
/// Time of silence that ends an answer. More than forty bytes could be transmitted in this time.
const QUIET: Duration = Duration::from_millis(20);
/// Type of the answer to a rejected command.
const REFUSED: u8 = 8;

/// An open line to a Scout.
#[derive(Debug)]
pub(crate) struct ScoutLine {
    line: mdle_serial::Line,
    reader: Reader,
}

impl ScoutLine {
    /// Opens the serial port `device`, or connects to `tcp:ADDRESS:PORT`. Sends nothing.
    ///
    /// # Errors
    /// Fails if the device is missing, busy or not a terminal, or if no program listens at the address.
    pub(crate) fn open(device: &str) -> Result<Self, Fault> {
        Ok(Self { line: mdle_serial::Line::open(device, SPEED)?, reader: Reader::default() })
    }

    /// Sends `command`, and waits for its answer until `deadline`. Discards bytes that were received earlier, because a
    /// Scout sends bytes only in answer to a command; also skips noise around the answer. After an answer with a wrong
    /// checksum, the command is sent once more, because every command can be repeated. After silence, it is not
    /// repeated, because a late answer would be mistaken for the answer to the next command.
    ///
    /// # Errors
    /// Fails if the line is closed, or if no complete answer arrived before the deadline.
    pub(crate) fn ask(&mut self, command: &Command, deadline: Instant) -> Result<Frame, Fault> {
        self.ask_while(command, deadline, &|| Ok(()))
    }

    /// Sends `command`, and waits for its answer as [`ScoutLine::ask`] does. Stops waiting when `go_on` returns an
    /// error.
    ///
    /// # Errors
    /// Fails if [`ScoutLine::ask`] or `go_on` fails.
    pub(crate) fn ask_while(
        &mut self,
        command: &Command,
        deadline: Instant,
        go_on: &dyn Fn() -> Result<(), Fault>,
    ) -> Result<Frame, Fault> {
        self.drain()?;
        match self.ask_once(command, deadline, go_on) {
            Err(garbled @ Fault::Garbled(_)) if Instant::now() < deadline => {
                match self.ask_once(command, deadline, go_on) {
                    // The malformed answer is more informative than the silence after it.
                    Err(Fault::Line(LineFault::Silent)) => Err(garbled),
                    other => other,
                }
            }
            other => other,
        }
    }

    /// Sends `command` without waiting for the answer.
    ///
    /// # Errors
    /// Fails if the line is closed, or if it accepts no bytes before `deadline`.
    pub(crate) fn say(&mut self, command: &Command, deadline: Instant) -> Result<(), Fault> {
        Ok(self.line.write(&command.frame().bytes(), deadline)?)
    }

    /// Sends `command` once. A malformed answer of full length is reported as soon as the line is quiet; any other
    /// error is reported at the deadline.
    fn ask_once(
        &mut self,
        command: &Command,
        deadline: Instant,
        go_on: &dyn Fn() -> Result<(), Fault>,
    ) -> Result<Frame, Fault> {
        self.reader.clear();
        self.say(command, deadline)?;
        let mut wrong = None;
        loop {
            while let Some(frame) = self.reader.next_frame() {
                match frame.kind {
                    kind if kind == command.kind() => return Ok(frame),
                    REFUSED => return Err(Fault::Refused(command.kind())),
                    // The right answer may follow.
                    other => wrong = Some(other),
                }
            }
            go_on()?;
            match self.line.hear(deadline.min(Instant::now() + QUIET)) {
                Ok(()) => {
                    self.take_in()?;
                }
                Err(LineFault::Silent) => {
                    if let Some(frame) = self.reader.after_false_start(command.kind()) {
                        return Ok(frame);
                    }
                    if self.reader.was_whole() || Instant::now() >= deadline {
                        return Err(self.unanswered(command, wrong));
                    }
                }
                Err(fault) => return Err(fault.into()),
            }
        }
    }

    /// Returns the fault about a missing answer to `command`. If an answer to another command arrived, `wrong` is its
    /// type.
    fn unanswered(&self, command: &Command, wrong: Option<u8>) -> Fault {
        let wrong = wrong.map(|answered| Fault::Wrong { asked: command.kind(), answered });
        let garbled = self.reader.garbled().map(Fault::Garbled);
        wrong.or(garbled).unwrap_or(Fault::Line(LineFault::Silent))
    }

    /// Discards the bytes that have arrived.
    fn drain(&mut self) -> Result<(), Fault> {
        // If the robot sends without end, the error is detected when the answer is read.
        let most = 64;
        for _ in 0..most {
            self.reader.clear();
            if !self.take_in()? {
                break;
            }
        }
        Ok(())
    }

    /// Reads the bytes that have arrived. Returns `true` if there were any bytes.
    fn take_in(&mut self) -> Result<bool, Fault> {
        let mut chunk = [0; CHUNK];
        let count = self.line.read(&mut chunk)?;
        self.reader.push(chunk.get(..count).unwrap_or_default());
        Ok(count > 0)
    }
}
