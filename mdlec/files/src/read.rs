//! Reads a file that a user names: standard input, or a regular file up to a maximum size. Never waits for the writer
//! of a pipe.

use std::fmt;
use std::fs::{self, FileType, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::Path;

use rustix::fs::OFlags;

/// Maximum size, in bytes, of a plan, of an alphabet, or of a file that a plan uses. Files written by hand are
/// far smaller.
pub const LARGEST_PLAN: u64 = 64_000_000;
/// Maximum size, in bytes, of a machine or a script, which programs write.
pub const LARGEST_DATA: u64 = 1_000_000_000;

/// Reason why a file is not read.
#[derive(Debug)]
pub enum Unread {
    /// The file is not a regular file; contains the kind of the file.
    Irregular(&'static str),
    /// The file is larger than this maximum, in bytes.
    TooLarge(u64),
    /// The end of the file is not known, because a writer may append more.
    Endless,
    /// Error of the system.
    System(io::Error),
}

impl Unread {
    /// Returns `true` if the file does not exist.
    #[must_use]
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::System(error) if error.kind() == io::ErrorKind::NotFound)
    }

    /// Returns a hint for users of commands that can read standard input.
    #[must_use]
    pub fn help(&self) -> &'static str {
        match self {
            Self::Irregular("pipe") | Self::Endless => "\nhelp: `-` in its place reads standard input",
            Self::Irregular(_) | Self::TooLarge(_) | Self::System(_) => "",
        }
    }

    /// Returns the error message for a file, in which the file is called `name`.
    #[must_use]
    pub fn of(&self, name: impl fmt::Display) -> String {
        match self {
            Self::Irregular(what) => format!("`{name}` is a {what}, not a file"),
            Self::TooLarge(most) => format!("`{name}` is larger than {} MB, which is the most", most / 1_000_000),
            Self::Endless => format!("`{name}` does not end: expected a file"),
            Self::System(error) => format!("cannot read `{name}`: {error}"),
        }
    }
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// Fails if the file cannot be read, is larger, or is not a regular file.
pub fn file(path: &Path, most: u64) -> Result<Vec<u8>, Unread> {
    // Opening a device or a pipe can already have side effects.
    regular(fs::metadata(path).map_err(Unread::System)?.file_type())?;
    let flags = (OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32;
    let file = OpenOptions::new().read(true).custom_flags(flags).open(path).map_err(Unread::System)?;
    let metadata = file.metadata().map_err(Unread::System)?;
    // Another file may have replaced the first one in the meantime.
    regular(metadata.file_type())?;
    if metadata.len() > most { Err(Unread::TooLarge(most)) } else { whole(file, most) }
}

/// Reads standard input, at most `most` bytes.
///
/// # Errors
/// Fails if standard input cannot be read or is longer.
pub fn standard_input(most: u64) -> Result<Vec<u8>, Unread> {
    whole(io::stdin().lock(), most)
}

fn whole(from: impl Read, most: u64) -> Result<Vec<u8>, Unread> {
    let mut bytes = Vec::new();
    from.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(|error| {
        if error.kind() == io::ErrorKind::WouldBlock { Unread::Endless } else { Unread::System(error) }
    })?;
    if bytes.len() as u64 > most { Err(Unread::TooLarge(most)) } else { Ok(bytes) }
}

fn regular(found: FileType) -> Result<(), Unread> {
    if found.is_file() {
        Ok(())
    } else if found.is_dir() {
        Err(Unread::Irregular("folder"))
    } else if found.is_fifo() {
        Err(Unread::Irregular("pipe"))
    } else if found.is_socket() {
        Err(Unread::Irregular("socket"))
    } else {
        Err(Unread::Irregular("device"))
    }
}
