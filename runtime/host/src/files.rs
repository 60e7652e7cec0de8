//! Reads files that an operator names. Only regular files up to a maximum size are read, because reading a pipe would
//! wait for a writer.

use std::fs::{self, FileType, OpenOptions};
use std::io::{self, Read as _};
use std::os::unix::fs::{FileTypeExt as _, OpenOptionsExt as _};
use std::path::Path;

use rustix::fs::OFlags;

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// Fails if the system reports an error, or if the file is not regular or is larger than `most` bytes. The message is
/// the end of a sentence about the file.
pub fn read_file(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // Opening a device or a pipe may already have an effect.
    regular(fs::metadata(path)?.file_type())?;
    let flags = (OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32;
    let file = OpenOptions::new().read(true).custom_flags(flags).open(path)?;
    let metadata = file.metadata()?;
    // The path may lead to another file by now.
    regular(metadata.file_type())?;
    let too_large = || io::Error::other(format!("it is larger than {}, which is the most", size(most)));
    if metadata.len() > most {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    file.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(|error| {
        let waits = error.kind() == io::ErrorKind::WouldBlock;
        if waits { io::Error::other("it does not end; expected a regular file") } else { error }
    })?;
    if bytes.len() as u64 > most { Err(too_large()) } else { Ok(bytes) }
}

/// Reads a regular file of at most `most` bytes as text.
///
/// # Errors
/// Fails if [`read_file`] fails, or if the file is not UTF-8 text.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read_file(path, most)?).map_err(|_| io::Error::other("it is not UTF-8 text"))
}

/// Checks that a file is regular; the error names the type of the file.
fn regular(kind: FileType) -> io::Result<()> {
    let what = if kind.is_file() {
        return Ok(());
    } else if kind.is_dir() {
        "folder"
    } else if kind.is_fifo() {
        "pipe"
    } else if kind.is_socket() {
        "socket"
    } else {
        "device"
    };
    Err(io::Error::other(format!("it is a {what}; expected a regular file")))
}

/// Formats a size in megabytes if it is a whole number of megabytes, and in bytes if not.
fn size(bytes: u64) -> String {
    if bytes.is_multiple_of(1_000_000) { format!("{} MB", bytes / 1_000_000) } else { format!("{bytes} bytes") }
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::path::PathBuf;

    use super::*;

    /// Returns a path for a file of a test.
    fn place(name: &str) -> PathBuf {
        let place = std::env::temp_dir().join(format!("mdle-files-{}-{name}", std::process::id()));
        let _ = fs::remove_file(&place);
        place
    }

    #[test]
    fn only_regular_files_are_read() {
        let refusal = |path: &Path| read_file(path, 1_000_000).expect_err("no regular file").to_string();
        assert_eq!(refusal(Path::new("/dev/zero")), "it is a device; expected a regular file");
        assert_eq!(refusal(&std::env::temp_dir()), "it is a folder; expected a regular file");
        let pipe = place("pipe");
        rustix::fs::mknodat(rustix::fs::CWD, &pipe, rustix::fs::FileType::Fifo, rustix::fs::Mode::RUSR, 0)
            .expect("a pipe");
        assert_eq!(refusal(&pipe), "it is a pipe; expected a regular file");
        fs::remove_file(&pipe).expect("it was there");
        assert_eq!(read_file(&pipe, 1).expect_err("it is gone").kind(), io::ErrorKind::NotFound);
    }

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let file = place("large");
        fs::write(&file, "größe").expect("a file");
        assert_eq!(read_text(&file, 7).expect("it is as long as it may be"), "größe");
        assert_eq!(
            read_file(&file, 6).expect_err("a byte too many").to_string(),
            "it is larger than 6 bytes, which is the most"
        );
        File::options().write(true).open(&file).and_then(|file| file.set_len(1 << 40)).expect("a file with a hole");
        let refused = read_text(&file, 2_000_000).expect_err("a tebibyte").to_string();
        assert_eq!(refused, "it is larger than 2 MB, which is the most");
        fs::write(&file, b"\xFF").expect("a file");
        assert_eq!(read_text(&file, 9).expect_err("no text").to_string(), "it is not UTF-8 text");
        fs::remove_file(&file).expect("it was there");
    }

    #[test]
    fn files_whose_size_the_system_does_not_tell_are_read() {
        assert!(read_text(Path::new("/proc/self/status"), 1_000_000).expect("it can be read").contains("Name:"));
    }
}
