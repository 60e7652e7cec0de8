//! Runs an emulated robot on a thread while a test drives it over its serial line.

use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use crate::port::Port;
use crate::serve::{Emulated, Pace, serve};

/// Results of a drive, and the emulated robot after the drive.
#[derive(Debug)]
pub struct Driven<R, T> {
    /// Result of the test's function.
    pub result: T,
    /// Result of serving the line; an error if the robot closed the line.
    pub served: io::Result<()>,
    /// Emulated robot after the drive.
    pub robot: R,
}

/// Guard that sets its flag when it is dropped, even during a panic. Without it, the test would wait forever for the
/// robot's thread.
struct SetAtTheEnd<'f>(&'f AtomicBool);

impl Drop for SetAtTheEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Serves the robot's line on a thread while `drive` runs; `drive` receives the path of the device.
///
/// # Errors
/// Fails if the system has no more pseudo-terminals.
pub fn driven<R: Emulated + Send, T>(
    mut robot: R,
    pace: Pace,
    drive: impl FnOnce(&Path) -> T,
) -> io::Result<Driven<R, T>> {
    let (port, over) = (Port::open()?, AtomicBool::new(false));
    let device = port.path().to_owned();
    let (result, served) = thread::scope(|scope| {
        let serving = scope.spawn(|| {
            // Moved into the closure so that it is dropped with it: if the robot closes its line, the driver sees it
            // closed.
            let port = port;
            serve(&mut robot, &port, pace, &|| !over.load(Ordering::Relaxed))
        });
        let end = SetAtTheEnd(&over);
        let result = drive(&device);
        drop(end);
        (result, serving.join().unwrap_or_else(|_| Err(io::Error::other("the robot's thread panicked"))))
    });
    Ok(Driven { result, served, robot })
}
