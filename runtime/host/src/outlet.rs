//! Standard output that never makes a robot wait: a thread of its own writes what the turns hand over.

use std::io::{self, Write};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::{Builder, JoinHandle};

/// How many pieces, one a turn with transitions, may wait for a slow reader before pieces are lost.
const WAITING: usize = 256;

/// A writer whose `flush` hands over and returns at once; dropping it waits until all is written.
#[derive(Debug)]
pub(crate) struct Outlet {
    piece: Vec<u8>,
    /// Whether pieces have been lost since the last one that was handed over.
    lost: bool,
    pieces: Option<SyncSender<Vec<u8>>>,
    writer: Option<JoinHandle<io::Result<()>>>,
}

impl Outlet {
    /// Begins to write to `sink`.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub(crate) fn open(sink: impl Write + Send + 'static) -> io::Result<Self> {
        let (pieces, waiting) = sync_channel(WAITING);
        let writer = Builder::new().name("report".to_owned()).spawn(move || write_all(sink, &waiting))?;
        Ok(Self { piece: Vec::new(), lost: false, pieces: Some(pieces), writer: Some(writer) })
    }

    /// Why the thread has ended.
    fn error(&mut self) -> io::Error {
        self.pieces = None;
        match self.writer.take().map(JoinHandle::join) {
            Some(Ok(Err(error))) => error,
            Some(Ok(Ok(())) | Err(_)) | None => io::ErrorKind::BrokenPipe.into(),
        }
    }
}

impl Write for Outlet {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.piece.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.piece.is_empty() {
            return Ok(());
        }
        let mut piece = std::mem::take(&mut self.piece);
        if self.lost {
            piece.splice(0..0, *b"(lines are missing here: nobody read them in time)\n");
        }
        match self.pieces.as_ref().map(|pieces| pieces.try_send(piece)) {
            Some(Ok(())) => self.lost = false,
            Some(Err(TrySendError::Full(_))) => self.lost = true,
            Some(Err(TrySendError::Disconnected(_))) | None => return Err(self.error()),
        }
        Ok(())
    }
}

impl Drop for Outlet {
    fn drop(&mut self) {
        self.pieces = None;
        if let Some(writer) = self.writer.take() {
            // An error that comes only now is about the last lines of a report; the robot stands already.
            let _ = writer.join();
        }
    }
}

/// Writes pieces until there are no more.
fn write_all(mut sink: impl Write, pieces: &Receiver<Vec<u8>>) -> io::Result<()> {
    for piece in pieces {
        sink.write_all(&piece)?;
        sink.flush()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use super::*;

    /// A sink that takes nothing until it is unlocked.
    #[derive(Clone, Default)]
    struct Slow(Arc<Mutex<Vec<u8>>>);

    impl Write for Slow {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_slow_reader_loses_lines_and_the_robot_does_not_wait() {
        let sink = Slow::default();
        let mut outlet = Outlet::open(sink.clone()).unwrap();
        let held = sink.0.lock().unwrap();
        for turn in 0..2 * WAITING {
            writeln!(outlet, "turn {turn}").unwrap();
            outlet.flush().unwrap();
        }
        drop(held);
        while outlet.lost {
            writeln!(outlet, "at last").unwrap();
            outlet.flush().unwrap();
        }
        drop(outlet);
        let text = String::from_utf8(sink.0.lock().unwrap().clone()).unwrap();
        assert!(text.starts_with("turn 0\nturn 1\n"));
        assert!(text.ends_with("(lines are missing here: nobody read them in time)\nat last\n"));
    }

    #[test]
    fn the_end_waits_until_all_is_written() {
        let sink = Slow::default();
        let mut outlet = Outlet::open(sink.clone()).unwrap();
        write!(outlet, "plan over: ").unwrap();
        writeln!(outlet, "bumper (Lab)").unwrap();
        outlet.flush().unwrap();
        drop(outlet);
        assert_eq!(*sink.0.lock().unwrap(), b"plan over: bumper (Lab)\n");
    }

    #[test]
    fn a_reader_that_has_gone_is_found_out() {
        struct Gone;
        impl Write for Gone {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let mut outlet = Outlet::open(Gone).unwrap();
        let error = loop {
            outlet.write_all(b"line\n").unwrap();
            if let Err(error) = outlet.flush() {
                break error;
            }
            std::thread::yield_now();
        };
        assert_eq!(error.kind(), io::ErrorKind::BrokenPipe);
    }
}
