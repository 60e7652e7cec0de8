//! Detects which lines have a connected driver. For this purpose, it uses the system's notifications (inotify) that a
//! device was opened or closed.

use std::mem::MaybeUninit;
use std::os::fd::OwnedFd;
use std::path::Path;
use std::{io, iter};

use rustix::fs::inotify::{self, CreateFlags, ReadFlags, Reader, WatchFlags};
use rustix::io::Errno;

/// State of each line, in order; each state shows if a driver is connected to its line.
#[derive(Debug)]
pub(crate) struct Presence {
    watch: OwnedFd,
    lines: Vec<Observation>,
}

/// Last observed state of a line.
#[derive(Debug, Clone, Copy)]
struct Observation {
    /// Number that identifies the line in the system's notifications.
    number: i32,
    /// Number of programs that have opened the line and not closed it.
    users: u32,
    /// `true` if a program has ever opened the line.
    has_begun: bool,
}

impl Presence {
    /// Starts to watch the lines `devices` for drivers.
    ///
    /// # Errors
    /// Fails if the system cannot watch this number of devices.
    pub(crate) fn of<'p>(devices: impl Iterator<Item = &'p Path>) -> io::Result<Self> {
        let watch = inotify::init(CreateFlags::NONBLOCK | CreateFlags::CLOEXEC)?;
        let events = WatchFlags::OPEN | WatchFlags::CLOSE_WRITE | WatchFlags::CLOSE_NOWRITE;
        let seen = |device: &Path| inotify::add_watch(&watch, device, events);
        let lines = devices.map(|device| Ok(Observation { number: seen(device)?, users: 0, has_begun: false }));
        let lines = lines.collect::<io::Result<_>>()?;
        Ok(Self { watch, lines })
    }

    /// Returns a file descriptor that becomes readable when a driver has connected or disconnected.
    pub(crate) fn end(&self) -> &OwnedFd {
        &self.watch
    }

    /// Updates the state of all lines from the pending notifications.
    ///
    /// # Errors
    /// Fails if the system's notifications cannot be read.
    pub(crate) fn look(&mut self) -> io::Result<()> {
        let mut buffer = [MaybeUninit::uninit(); 1024];
        let mut reader = Reader::new(&self.watch, &mut buffer);
        let events = iter::from_fn(|| match reader.next() {
            Ok(event) => Some(Ok((event.wd(), event.events()))),
            Err(Errno::AGAIN | Errno::INTR) => None,
            Err(error) => Some(Err(error)),
        });
        for event in events {
            let (number, events) = event?;
            for line in self.lines.iter_mut().filter(|line| line.number == number) {
                if events.contains(ReadFlags::OPEN) {
                    (line.users, line.has_begun) = (line.users.saturating_add(1), true);
                } else {
                    line.users = line.users.saturating_sub(1);
                }
            }
        }
        Ok(())
    }

    /// Returns `true` if a driver has been connected to every line at least once.
    pub(crate) fn all_have_begun(&self) -> bool {
        self.lines.iter().all(|line| line.has_begun)
    }

    /// Returns, for each line in order, `true` if a driver is connected to it.
    pub(crate) fn are_open(&self) -> impl Iterator<Item = bool> {
        self.lines.iter().map(|line| line.users > 0)
    }
}
