//! Reads the text of a file or a pipe that an operator names, such as `/dev/stdin`. A pipe can be read only once, so
//! its text is kept for further calls.

use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind, Read as _};
use std::os::unix::fs::{FileTypeExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::OFlags;

use crate::files::read_text;

/// Maximum time to wait for more text in a pipe, in seconds.
const PATIENCE: i64 = 10;

/// The pipes that have been read, each with its text, because a pipe can be read only once.
static PIPES: Mutex<Vec<(PathBuf, String)>> = Mutex::new(Vec::new());

/// Reads a regular file or a pipe of at most `most` bytes as text.
///
/// # Errors
/// Fails if [`read_text`] fails, or if the pipe is empty or does not end.
pub fn read_piped_text(path: &Path, most: u64) -> io::Result<String> {
    if !fs::metadata(path)?.file_type().is_fifo() {
        return read_text(path, most);
    }
    let mut pipes = PIPES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, text)) = pipes.iter().find(|(known, _)| known == path) {
        return Ok(text.clone());
    }
    let text = String::from_utf8(read_pipe(path, most)?).map_err(|_| io::Error::other("it is not UTF-8 text"))?;
    pipes.push((path.to_owned(), text.clone()));
    Ok(text)
}

/// Reads a pipe to its end.
fn read_pipe(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // Without this flag, opening a pipe that has no writer would wait for one.
    let flags = OFlags::NONBLOCK.bits() as i32;
    let pipe = OpenOptions::new().read(true).custom_flags(flags).open(path)?;
    let mut bytes = Vec::new();
    loop {
        let read = (&pipe).take(most.saturating_add(1).saturating_sub(bytes.len() as u64)).read_to_end(&mut bytes);
        match read {
            Ok(_) if bytes.is_empty() => return Err(io::Error::other("nothing has been written to this pipe")),
            Ok(_) if bytes.len() as u64 > most => return Err(io::Error::other("it is too large")),
            Ok(_) => return Ok(bytes),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                let patience = Timespec { tv_sec: PATIENCE, tv_nsec: 0 };
                if poll(&mut [PollFd::new(&pipe, PollFlags::IN)], Some(&patience))? == 0 {
                    return Err(io::Error::other("nothing more has come by this pipe, and it has not ended"));
                }
            }
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;
    use std::os::fd::AsRawFd as _;
    use std::thread;
    use std::time::Duration;

    use super::*;

    /// Returns the path of a pipe into which a thread writes these texts, with pauses.
    fn piped(texts: &'static [&'static str]) -> (io::PipeReader, PathBuf) {
        let (reader, mut writer) = io::pipe().expect("a pipe");
        let path = PathBuf::from(format!("/proc/self/fd/{}", reader.as_raw_fd()));
        thread::spawn(move || {
            for text in texts {
                thread::sleep(Duration::from_millis(20));
                writer.write_all(text.as_bytes()).expect("the reader is there");
            }
        });
        (reader, path)
    }

    #[test]
    fn a_pipe_is_read_once() {
        let (_reader, path) = piped(&["domain = ", "7\n"]);
        assert_eq!(read_piped_text(&path, 100).expect("a text"), "domain = 7\n");
        assert_eq!(read_piped_text(&path, 100).expect("the same text"), "domain = 7\n");
    }

    #[test]
    fn what_is_no_text_is_refused() {
        let refusal = |texts: &'static [&'static str]| {
            let (_reader, path) = piped(texts);
            read_pipe(&path, 5).expect_err("no text").to_string()
        };
        assert_eq!(refusal(&[]), "nothing has been written to this pipe");
        assert_eq!(refusal(&["abc", "def"]), "it is too large");
        let folder = read_piped_text(&std::env::temp_dir(), 5).expect_err("a folder").to_string();
        assert_eq!(folder, "it is a folder; expected a regular file");
    }
}
