//! The thread that opens and writes the files of a recorder.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender};
use std::sync::{Arc, Mutex, PoisonError};

use mdle_record::{RecordFile, Records};

/// Progress of the thread that writes a record.
#[derive(Debug, Default)]
pub(super) struct WriterProgress {
    pub(super) bytes: AtomicU64,
    /// Reason why writing has failed, and the number of turns in the file; `None` while writing has not failed.
    pub(super) fault: Mutex<Option<(String, u64)>>,
}

/// An order for the thread that writes records.
#[derive(Debug)]
pub(super) enum WriterOrder {
    Open(PathBuf),
    Write(Vec<u8>),
    Close,
}

/// Carries out orders until the channel is closed.
pub(super) fn write_all(
    orders: &Receiver<WriterOrder>,
    opened: &Sender<Result<(), String>>,
    progress: &Arc<WriterProgress>,
) {
    let (mut record, mut name): (Option<RecordFile<CountingFile>>, _) = (None, PathBuf::new());
    for order in orders {
        let written = match order {
            WriterOrder::Open(path) => {
                progress.bytes.store(0, Ordering::Relaxed);
                let file = created(&path);
                name = path;
                let _ = opened.send(file.as_ref().map(|_| ()).map_err(Clone::clone));
                record = file.ok().map(|file| RecordFile::new(CountingFile { file, progress: Arc::clone(progress) }));
                Ok(())
            }
            WriterOrder::Write(bytes) => record.as_mut().map_or(Ok(()), |record| record.write_all(&bytes)),
            WriterOrder::Close => {
                record = None;
                Ok(())
            }
        };
        if let Err(error) = written {
            record = None;
            let fault = (error.to_string(), readable_turns(&name));
            *progress.fault.lock().unwrap_or_else(PoisonError::into_inner) = Some(fault);
        }
    }
}

/// Returns the number of turns that can be read from a record that may be cut off anywhere.
fn readable_turns(path: &Path) -> u64 {
    let records = File::open(path).ok().and_then(|file| Some(Records::open(file).ok()?.1));
    records.map_or(0, |records| records.take_while(Result::is_ok).map(|_| 1).sum())
}

/// Creates the file of a record; fails if the file already exists.
fn created(path: &Path) -> Result<File, String> {
    File::create_new(path).map_err(|error| {
        if error.kind() == io::ErrorKind::AlreadyExists {
            format!("{} is there already: name a new file", path.display())
        } else {
            format!("{} cannot be written: {error}", path.display())
        }
    })
}

/// A file that counts the bytes written to it.
struct CountingFile {
    file: File,
    progress: Arc<WriterProgress>,
}

impl Write for CountingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.progress.bytes.fetch_add(u64::try_from(written).unwrap_or(u64::MAX), Ordering::Relaxed);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
