//! The pseudo-terminal through which a driver reaches an emulated robot.

use std::os::fd::OwnedFd;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{fs, io};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::OFlags;
use rustix::io::Errno;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

/// A serial line: both ends of a pseudo-terminal, and the path of the driver's end.
#[derive(Debug)]
pub struct Port {
    ours: OwnedFd,
    /// The driver's end. It is kept open so that the line persists when a driver closes it.
    _theirs: fs::File,
    path: PathBuf,
    link: Option<PathBuf>,
}

impl Port {
    /// Opens a new pseudo-terminal.
    ///
    /// # Errors
    /// Fails if the system has no more pseudo-terminals.
    pub fn open() -> io::Result<Self> {
        let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&ours)?;
        unlockpt(&ours)?;
        let name = ptsname(&ours, Vec::new())?.into_string().map_err(io::Error::other)?;
        let path = PathBuf::from(name);
        // Without this, the device could become the controlling terminal of this program's session, which would end
        // with it.
        let alone = OFlags::NOCTTY.bits() as i32;
        let theirs = fs::File::options().read(true).write(true).custom_flags(alone).open(&path)?;
        // Raw mode: no echo, and no byte has a special meaning.
        let mut settings = tcgetattr(&theirs)?;
        settings.make_raw();
        tcsetattr(&theirs, OptionalActions::Now, &settings)?;
        let flags = rustix::fs::fcntl_getfl(&ours)?;
        rustix::fs::fcntl_setfl(&ours, flags | OFlags::NONBLOCK)?;
        Ok(Self { ours, _theirs: theirs, path, link: None })
    }

    /// Creates a symbolic link at `link` that leads to the device. Replaces an existing symbolic link. The link is
    /// removed when the line is dropped.
    ///
    /// # Errors
    /// Fails if `link` exists and is not a symbolic link, or if the link cannot be created.
    pub fn link(&mut self, link: &Path) -> io::Result<()> {
        if fs::symlink_metadata(link).is_ok_and(|known| known.file_type().is_symlink()) {
            fs::remove_file(link)?;
        }
        std::os::unix::fs::symlink(&self.path, link)?;
        self.link = Some(link.to_owned());
        Ok(())
    }

    /// Returns the path of the device that a driver opens.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the emulator's end of the line.
    pub(crate) fn end(&self) -> &OwnedFd {
        &self.ours
    }

    /// Waits at most `limit` for bytes, and passes them to `take`. Returns `true` if bytes have arrived.
    ///
    /// # Errors
    /// Fails if the line failed.
    pub fn read(&self, limit: Duration, take: &mut dyn FnMut(&[u8])) -> io::Result<bool> {
        let timeout = Timespec { tv_sec: limit.as_secs() as i64, tv_nsec: i64::from(limit.subsec_nanos()) };
        match poll(&mut [PollFd::new(&self.ours, PollFlags::IN)], Some(&timeout)) {
            Ok(0) | Err(Errno::INTR) => return Ok(false),
            Ok(_) => {}
            Err(error) => return Err(error.into()),
        }
        let mut chunk = [0; 512];
        match rustix::io::read(&self.ours, &mut chunk) {
            Ok(count) => take(chunk.get(..count).unwrap_or_default()),
            Err(Errno::AGAIN | Errno::INTR) => return Ok(false),
            Err(error) => return Err(error.into()),
        }
        Ok(true)
    }

    /// Sends `bytes`. If no driver reads them, bytes are lost when the line is full, as on a real serial line.
    ///
    /// # Errors
    /// Fails if the line failed.
    pub fn write(&self, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            match rustix::io::write(&self.ours, bytes) {
                Ok(count) => bytes = bytes.get(count..).unwrap_or_default(),
                Err(Errno::AGAIN) => return Ok(()),
                Err(Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }
}

impl Drop for Port {
    fn drop(&mut self) {
        if let Some(link) = &self.link {
            // Fails if another program has already removed the link.
            let _ = fs::remove_file(link);
        }
    }
}
