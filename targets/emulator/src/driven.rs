//! An emulated robot that serves its serial line while a test drives it.

use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use crate::port::Port;
use crate::serve::{Emulated, Pace, serve};

/// An emulated robot after a drive, with the results.
#[derive(Debug)]
pub struct Driven<R, T> {
    /// The result of the drive.
    pub result: T,
    /// The result of serving the line: an error if the robot closed it.
    pub served: io::Result<()>,
    /// Emulated robot after the drive.
    pub robot: R,
}

/// Guard that sets its flag when dropped, also in a panic: otherwise the test would wait forever for the thread of the
/// robot.
struct SetAtTheEnd<'f>(&'f AtomicBool);

impl Drop for SetAtTheEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Serves the robot's line on a thread while `drive` runs; `drive` receives the path of the line's device.
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
            // Dropped with this closure: a robot that closes its line closes it for its driver as well.
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
