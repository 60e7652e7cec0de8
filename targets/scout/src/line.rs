//! The line to a Scout: questions and their answers.

use std::time::{Duration, Instant};

use mdle_serial::LineFault;

use crate::command::Command;
use crate::fault::Fault;
use crate::frame::Frame;

/// Bits a second, 8N1.
pub(crate) const SPEED: u32 = 38_400;
/// The most that is read at once.
const CHUNK: usize = 512;
/// After so long without a byte, more than forty bytes' worth, nothing more comes of an answer.
const QUIET: Duration = Duration::from_millis(20);
/// The type of the answer to a command that the robot does not take.
const REFUSED: u8 = 8;

/// An open line.
#[derive(Debug)]
pub(crate) struct Line {
    line: mdle_serial::Line,
    /// What has come in and is no whole frame yet.
    waiting: Vec<u8>,
}

impl Line {
    /// Opens a serial port, or `tcp:ADDRESS:PORT`. Nothing is sent.
    ///
    /// # Errors
    /// It is missing, busy, no terminal, or nobody listens.
    pub(crate) fn open(device: &str) -> Result<Self, Fault> {
        Ok(Self { line: mdle_serial::Line::open(device, SPEED)?, waiting: Vec::with_capacity(2 * CHUNK) })
    }

    /// Says `command` and waits for its answer until `deadline`. What came in before is thrown away, as a Scout never
    /// speaks first. A garbled answer is asked for once more, as each command can be said twice; silence is not, or an
    /// answer that was only late would be taken for the next one's.
    ///
    /// # Errors
    /// The line is closed, or by the deadline there was no answer, or none that was whole.
    pub(crate) fn ask(&mut self, command: &Command, deadline: Instant) -> Result<Frame, Fault> {
        self.drain()?;
        match self.ask_once(command, deadline) {
            Err(garbled @ Fault::Garbled(_)) => {
                // The rest of it is nobody's answer.
                if !self.settles(deadline)? {
                    return Err(garbled);
                }
                match self.ask_once(command, deadline) {
                    // It says more than the silence behind it.
                    Err(Fault::Line(LineFault::Silent)) => Err(garbled),
                    other => other,
                }
            }
            other => other,
        }
    }

    /// Says `command` without waiting for the answer.
    ///
    /// # Errors
    /// The line is closed, or takes nothing until `deadline`.
    pub(crate) fn say(&mut self, command: &Command, deadline: Instant) -> Result<(), Fault> {
        Ok(self.line.write(&command.frame().bytes(), deadline)?)
    }

    /// The same without a second question.
    fn ask_once(&mut self, command: &Command, deadline: Instant) -> Result<Frame, Fault> {
        self.say(command, deadline)?;
        let mut wrong = None;
        loop {
            match self.frame(deadline) {
                Ok(frame) if frame.kind == command.kind() => return Ok(frame),
                Ok(Frame { kind: REFUSED, .. }) => return Err(Fault::Refused(command.kind())),
                // The right answer may be behind it.
                Ok(frame) => wrong = Some(frame.kind),
                Err(Fault::Line(LineFault::Silent)) => {
                    let wrong = wrong.map(|answered| Fault::Wrong { asked: command.kind(), answered });
                    return Err(wrong.unwrap_or(Fault::Line(LineFault::Silent)));
                }
                Err(fault) => return Err(fault),
            }
        }
    }

    /// Throws away what comes in until nothing has come for a while; whether that was before `deadline`.
    fn settles(&mut self, deadline: Instant) -> Result<bool, Fault> {
        loop {
            self.waiting.clear();
            match self.line.hear(deadline.min(Instant::now() + QUIET)) {
                Ok(()) => self.take_in()?,
                Err(LineFault::Silent) => return Ok(Instant::now() < deadline),
                Err(fault) => return Err(fault.into()),
            };
        }
    }

    /// The next frame.
    fn frame(&mut self, deadline: Instant) -> Result<Frame, Fault> {
        loop {
            match Frame::read(&self.waiting).map_err(Fault::Garbled)? {
                Some((frame, count)) => {
                    self.waiting.drain(..count);
                    return Ok(frame);
                }
                None => {
                    self.line.hear(deadline)?;
                    self.take_in()?;
                }
            }
        }
    }

    /// Throws away what has come in.
    fn drain(&mut self) -> Result<(), Fault> {
        // A robot that never stops talking is found out where its answer is read.
        let most = 64;
        for _ in 0..most {
            self.waiting.clear();
            if !self.take_in()? {
                break;
            }
        }
        self.waiting.clear();
        Ok(())
    }

    /// Takes in what is there; whether there was anything.
    fn take_in(&mut self) -> Result<bool, Fault> {
        let mut chunk = [0; CHUNK];
        let count = self.line.read(&mut chunk)?;
        self.waiting.extend_from_slice(chunk.get(..count).unwrap_or_default());
        Ok(count > 0)
    }
}
