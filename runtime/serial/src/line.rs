//! A line to a robot. This is either a serial port (8N1, without flow control) or a TCP connection to a numeric
//! address.

use std::fmt;
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

/// Timeout for connecting to a robot.
const CONNECT: Duration = Duration::from_secs(1);

/// An open line to a robot.
#[derive(Debug)]
pub struct Line {
    port: OwnedFd,
}

/// Error of a connection to a robot. The connection cannot be opened, or reading or writing failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LineFault {
    /// A device cannot be opened. Contains the name of the device, and the reason.
    Open(String, String),
    /// Another program uses the device with this name.
    Busy(String),
    /// The device with this name is not a serial port.
    NotSerial(String),
    /// No bytes arrived, or none could be sent, before the deadline.
    Silent,
    /// The line was closed at the other end.
    Closed,
    /// The line failed; contains the reason.
    Failed(String),
}

impl LineFault {
    /// Converts a system error of the serial line to a fault. The system reports an unplugged device as `EIO`.
    fn of(error: Errno) -> Self {
        match error {
            Errno::IO | Errno::NXIO | Errno::NODEV | Errno::CONNRESET | Errno::PIPE => Self::Closed,
            _ => Self::Failed(error.to_string()),
        }
    }

    /// Writes the message about this fault for the operator; `robot` is the name of the robot, such as `the Scout`.
    ///
    /// # Errors
    /// Fails if the formatter failed.
    pub fn tell(&self, robot: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Open(device, why) => {
                write!(f, "{robot}'s line {device} cannot be opened: {why}; name its device with `--device`")
            }
            Self::Busy(device) => write!(f, "another program has {robot}'s line {device}: end that one first"),
            Self::NotSerial(device) => write!(f, "{device} is no serial port: name {robot}'s with `--device`"),
            Self::Silent => write!(f, "{robot} does not answer: is it switched on, and is this its line?"),
            Self::Closed => write!(f, "{robot}'s line was cut: check the cable"),
            Self::Failed(why) => write!(f, "{robot}'s line failed: {why}"),
        }
    }
}

impl Line {
    /// Opens a serial port at `speed` bits per second, or connects to `tcp:ADDRESS:PORT`. Sends nothing.
    ///
    /// # Errors
    /// Fails if the device is missing, busy or not a terminal, or if no program listens at the address.
    pub fn open(device: &str, speed: u32) -> Result<Self, LineFault> {
        let port = match device.strip_prefix("tcp:") {
            Some(address) => connect(address)?,
            None => serial(Path::new(device), speed)?,
        };
        Ok(Self { port })
    }

    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// Fails if the line is closed, or if it does not accept all bytes before `deadline`.
    pub fn write(&self, bytes: &[u8], deadline: Instant) -> Result<(), LineFault> {
        let mut left = bytes;
        while !left.is_empty() {
            self.wait(PollFlags::OUT, deadline)?;
            match rustix::io::write(&self.port, left) {
                Ok(count) => left = left.get(count..).unwrap_or_default(),
                Err(Errno::AGAIN | Errno::INTR) => {}
                Err(error) => return Err(LineFault::of(error)),
            }
        }
        Ok(())
    }

    /// Reads the bytes that have arrived, up to the length of `into`; returns their number.
    ///
    /// # Errors
    /// Fails if the line is closed.
    pub fn read(&self, into: &mut [u8]) -> Result<usize, LineFault> {
        match rustix::io::read(&self.port, into) {
            Ok(0) => Err(LineFault::Closed),
            Ok(count) => Ok(count),
            Err(Errno::AGAIN | Errno::INTR) => Ok(0),
            Err(error) => Err(LineFault::of(error)),
        }
    }

    /// Waits until bytes have arrived.
    ///
    /// # Errors
    /// Fails if no bytes have arrived before `deadline`, or if the line failed.
    pub fn hear(&self, deadline: Instant) -> Result<(), LineFault> {
        self.wait(PollFlags::IN, deadline)
    }

    /// Waits until the line is ready for the operations `what`.
    fn wait(&self, what: PollFlags, deadline: Instant) -> Result<(), LineFault> {
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(LineFault::Silent);
            }
            let timeout = Timespec { tv_sec: left.as_secs() as i64, tv_nsec: i64::from(left.subsec_nanos()) };
            let mut ports = [PollFd::new(&self.port, what)];
            match poll(&mut ports, Some(&timeout)) {
                Ok(0) | Err(Errno::INTR) => {}
                Ok(_) => return Ok(()),
                Err(error) => return Err(LineFault::of(error)),
            }
        }
    }
}

/// Opens a serial port in raw mode, and locks it against other programs that request a lock.
fn serial(path: &Path, speed: u32) -> Result<OwnedFd, LineFault> {
    let device = path.display().to_string();
    // Does not wait for a carrier, and does not make the port this program's terminal.
    let flags = (OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32;
    let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(path);
    let file: File = file.map_err(|error| {
        let is_busy = error.kind() == io::ErrorKind::ResourceBusy;
        if is_busy { LineFault::Busy(device.clone()) } else { LineFault::Open(device.clone(), error.to_string()) }
    })?;
    if !termios::isatty(&file) {
        return Err(LineFault::NotSerial(device));
    }
    // Other errors are ignored, because a file system may not support locks.
    if rustix::fs::flock(&file, FlockOperation::NonBlockingLockExclusive) == Err(Errno::WOULDBLOCK) {
        return Err(LineFault::Busy(device));
    }
    let refused = |error: Errno| LineFault::Open(device.clone(), format!("it cannot be set to {speed} 8N1: {error}"));
    let mut settings = termios::tcgetattr(&file).map_err(refused)?;
    settings.make_raw();
    settings.set_speed(speed).map_err(refused)?;
    settings.control_modes |= termios::ControlModes::CLOCAL | termios::ControlModes::CREAD;
    settings.control_modes -= termios::ControlModes::CSTOPB | termios::ControlModes::CRTSCTS;
    termios::tcsetattr(&file, OptionalActions::Flush, &settings).map_err(refused)?;
    Ok(file.into())
}

/// Connects to a numeric address.
fn connect(address: &str) -> Result<OwnedFd, LineFault> {
    let name = format!("tcp:{address}");
    let address: SocketAddr = address.parse().map_err(|_| {
        LineFault::Open(name.clone(), "expected an address and a port, as in `tcp:192.168.1.7:65001`".to_owned())
    })?;
    let refused = |error: io::Error| LineFault::Open(name.clone(), error.to_string());
    let stream = TcpStream::connect_timeout(&address, CONNECT).map_err(refused)?;
    // A command must be sent at once, and not wait for later commands.
    stream.set_nodelay(true).map_err(refused)?;
    stream.set_nonblocking(true).map_err(refused)?;
    Ok(stream.into())
}
