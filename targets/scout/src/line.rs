//! The line to a Scout: a serial port at 38400 8N1, or TCP to a literal address; questions and their answers.

use std::fs::{File, OpenOptions};
use std::io;
use std::net::{SocketAddr, TcpStream};
use std::os::fd::OwnedFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FlockOperation, OFlags};
use rustix::io::Errno;
use rustix::termios::{self, OptionalActions};

use crate::command::Command;
use crate::fault::Fault;
use crate::frame::Frame;

/// How long a robot may take to accept a connection.
const CONNECT: Duration = Duration::from_secs(1);
/// The most that is read at once.
const CHUNK: usize = 512;
/// After so long without a byte, more than forty bytes' worth, nothing more comes of an answer.
const QUIET: Duration = Duration::from_millis(20);
/// The type of the answer to a command that the robot does not take.
const REFUSED: u8 = 8;

/// An open line.
#[derive(Debug)]
pub(crate) struct Line {
    port: OwnedFd,
    /// What has come in and is no whole frame yet.
    waiting: Vec<u8>,
}

impl Line {
    /// Opens a serial port, or `tcp:ADDRESS:PORT`. Nothing is sent.
    ///
    /// # Errors
    /// It is missing, busy, no terminal, or nobody listens.
    pub(crate) fn open(device: &str) -> Result<Self, Fault> {
        let port = match device.strip_prefix("tcp:") {
            Some(address) => connect(address)?,
            None => serial(Path::new(device))?,
        };
        Ok(Self { port, waiting: Vec::new() })
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
                    Err(Fault::Silent) => Err(garbled),
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
        let bytes = command.frame().bytes();
        let mut left = &bytes[..];
        while !left.is_empty() {
            self.wait(PollFlags::OUT, deadline)?;
            match rustix::io::write(&self.port, left) {
                Ok(count) => left = left.get(count..).unwrap_or_default(),
                Err(Errno::AGAIN | Errno::INTR) => {}
                Err(error) => return Err(Fault::of_line(error)),
            }
        }
        Ok(())
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
                Err(Fault::Silent) => {
                    let wrong = wrong.map(|answered| Fault::Wrong { asked: command.kind(), answered });
                    return Err(wrong.unwrap_or(Fault::Silent));
                }
                Err(fault) => return Err(fault),
            }
        }
    }

    /// Throws away what comes in until nothing has come for a while; whether that was before `deadline`.
    fn settles(&mut self, deadline: Instant) -> Result<bool, Fault> {
        loop {
            self.waiting.clear();
            match self.wait(PollFlags::IN, deadline.min(Instant::now() + QUIET)) {
                Ok(()) => self.take_in()?,
                Err(Fault::Silent) => return Ok(Instant::now() < deadline),
                Err(fault) => return Err(fault),
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
                    self.wait(PollFlags::IN, deadline)?;
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
        match rustix::io::read(&self.port, &mut chunk) {
            Ok(0) => Err(Fault::Closed),
            Ok(count) => {
                self.waiting.extend_from_slice(chunk.get(..count).unwrap_or_default());
                Ok(true)
            }
            Err(Errno::AGAIN | Errno::INTR) => Ok(false),
            Err(error) => Err(Fault::of_line(error)),
        }
    }

    /// Waits until the line is ready for this.
    fn wait(&self, what: PollFlags, deadline: Instant) -> Result<(), Fault> {
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(Fault::Silent);
            }
            let timeout = Timespec { tv_sec: left.as_secs() as i64, tv_nsec: i64::from(left.subsec_nanos()) };
            let mut ports = [PollFd::new(&self.port, what)];
            match poll(&mut ports, Some(&timeout)) {
                Ok(0) | Err(Errno::INTR) => {}
                Ok(_) => return Ok(()),
                Err(error) => return Err(Fault::of_line(error)),
            }
        }
    }
}

/// Opens a serial port, raw, at 38400 8N1, and locks it against other programs that ask for a lock.
fn serial(path: &Path) -> Result<OwnedFd, Fault> {
    let device = path.display().to_string();
    // Without waiting for a carrier, and without making it this program's terminal.
    let flags = (OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32;
    let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(path);
    let file: File = file.map_err(|error| {
        let is_busy = error.kind() == io::ErrorKind::ResourceBusy;
        if is_busy { Fault::Busy(device.clone()) } else { Fault::Open(device.clone(), error.to_string()) }
    })?;
    if !termios::isatty(&file) {
        return Err(Fault::NotSerial(device));
    }
    // A file system without locks cannot say who else is there.
    if rustix::fs::flock(&file, FlockOperation::NonBlockingLockExclusive) == Err(Errno::WOULDBLOCK) {
        return Err(Fault::Busy(device));
    }
    let refused = |error: Errno| Fault::Open(device.clone(), format!("it cannot be set to 38400 8N1: {error}"));
    let mut settings = termios::tcgetattr(&file).map_err(refused)?;
    settings.make_raw();
    settings.set_speed(38400).map_err(refused)?;
    settings.control_modes |= termios::ControlModes::CLOCAL | termios::ControlModes::CREAD;
    settings.control_modes -= termios::ControlModes::CSTOPB | termios::ControlModes::CRTSCTS;
    termios::tcsetattr(&file, OptionalActions::Flush, &settings).map_err(refused)?;
    Ok(file.into())
}

/// Connects to a literal address.
fn connect(address: &str) -> Result<OwnedFd, Fault> {
    let said = format!("tcp:{address}");
    let address: SocketAddr = address.parse().map_err(|_| {
        Fault::Open(said.clone(), "an address and a port are meant, as in `tcp:192.168.1.7:65001`".to_owned())
    })?;
    let refused = |error: io::Error| Fault::Open(said.clone(), error.to_string());
    let stream = TcpStream::connect_timeout(&address, CONNECT).map_err(refused)?;
    // A command must not wait until there are more.
    stream.set_nodelay(true).map_err(refused)?;
    stream.set_nonblocking(true).map_err(refused)?;
    Ok(stream.into())
}
