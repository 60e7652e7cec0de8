//! Sends commands to the robot. A watchdog stops the robot if no motion is commanded for too long.
//!
//! The controller stops the robot if the line is silent for some time, but it is not documented for how long.
//! Therefore, a thread of this program stops the robot earlier; the controller's timeout matters only if the program
//! dies.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use mdle_serial::{Line, Moment};

use crate::fault::Fault;
use crate::frame::FrameBytes;

/// Timeout for the line to accept the watchdog's commands.
const STOPPING: Duration = Duration::from_millis(100);

/// The line for sending to the robot, with a watchdog that supervises the motion commands.
#[derive(Debug)]
pub(crate) struct Mouth {
    shared: Arc<SharedLine>,
    watching: Option<JoinHandle<()>>,
    /// Time without a motion command after which the watchdog stops the robot; `None` without a watchdog.
    limit: Option<Duration>,
}

#[derive(Debug)]
struct SharedLine {
    line: Line,
    watch: Mutex<Watchdog>,
    over: Condvar,
}

/// State of the watchdog.
#[derive(Debug)]
struct Watchdog {
    /// Time of the last motion command; `None` if the watchdog is disarmed.
    last_motion: Option<Moment>,
    /// `true` once the watchdog has stopped the robot.
    has_bitten: bool,
    is_over: bool,
}

impl SharedLine {
    fn watch(&self) -> MutexGuard<'_, Watchdog> {
        // A panic cannot leave this state inconsistent.
        self.watch.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Mouth {
    /// Creates a sender of commands to `line`. `watchdog` contains a time limit and stop commands: the stop commands
    /// are sent if no motion command follows the last one within the limit.
    pub(crate) fn new(line: Line, watchdog: Option<(Duration, [FrameBytes; 2])>) -> Self {
        let watch = Watchdog { last_motion: None, has_bitten: false, is_over: false };
        let limit = watchdog.as_ref().map(|(limit, _)| *limit);
        let shared = Arc::new(SharedLine { line, watch: Mutex::new(watch), over: Condvar::new() });
        let watching = watchdog.and_then(|(limit, stop)| {
            let shared = Arc::clone(&shared);
            let thread = thread::Builder::new().name("watchdog".to_owned());
            // If no thread can be created, only the controller's timeout remains.
            thread.spawn(move || keep_watch(&shared, limit, &stop)).ok()
        });
        Self { shared, watching, limit }
    }

    /// Returns the line, so that reports can be read from it.
    pub(crate) fn line(&self) -> &Line {
        &self.shared.line
    }

    /// Sends a command other than a motion command.
    ///
    /// # Errors
    /// Fails if the line is closed, or accepts no bytes before `deadline`.
    pub(crate) fn say(&self, frame: &FrameBytes, deadline: Instant) -> Result<(), Fault> {
        // The lock prevents the watchdog from sending a command in the middle of this one.
        let _watch = self.shared.watch();
        Ok(self.shared.line.write(frame.bytes(), deadline)?)
    }

    /// Sends a motion command, and restarts the watchdog's timeout.
    ///
    /// # Errors
    /// Fails if the line is closed or accepts no bytes before `deadline`, or if the watchdog has stopped the robot.
    pub(crate) fn say_motion(&self, frame: &FrameBytes, deadline: Instant) -> Result<(), Fault> {
        let mut watch = self.shared.watch();
        self.is_in_time(&watch)?;
        watch.last_motion = Some(Moment::now());
        Ok(self.shared.line.write(frame.bytes(), deadline)?)
    }

    /// Checks that the limit of the watchdog has not been exceeded.
    ///
    /// # Errors
    /// Fails if the last motion command is too old, or if the watchdog has stopped the robot.
    pub(crate) fn is_awake(&self) -> Result<(), Fault> {
        self.is_in_time(&self.shared.watch())
    }

    fn is_in_time(&self, watch: &Watchdog) -> Result<(), Fault> {
        let Some(limit) = self.limit else { return Ok(()) };
        // If this program or the computer was suspended, the watchdog was suspended too.
        let is_late = watch.has_bitten || watch.last_motion.is_some_and(|time| time.elapsed() >= limit);
        if is_late { Err(Fault::Overslept(limit.as_millis() as u64)) } else { Ok(()) }
    }

    /// Disarms the watchdog, because the robot is being stopped.
    pub(crate) fn ends(&self) {
        let mut watch = self.shared.watch();
        (watch.last_motion, watch.has_bitten) = (None, false);
    }
}

impl Drop for Mouth {
    fn drop(&mut self) {
        self.shared.watch().is_over = true;
        self.shared.over.notify_all();
        if let Some(watching) = self.watching.take() {
            // The thread returns no result, and a panic in it needs no handling here.
            let _ = watching.join();
        }
    }
}

/// Runs the watchdog until the sender is dropped.
fn keep_watch(shared: &SharedLine, limit: Duration, stop: &[FrameBytes; 2]) {
    let mut watch = shared.watch();
    while !watch.is_over {
        let silent = watch.last_motion.map(Moment::elapsed);
        if silent.is_some_and(|silent| silent >= limit) {
            (watch.last_motion, watch.has_bitten) = (None, true);
            let deadline = Instant::now() + STOPPING;
            for frame in stop {
                // If the line accepts no bytes, nothing else can be done.
                let _ = shared.line.write(frame.bytes(), deadline);
            }
        }
        let left = silent.map_or(limit, |silent| limit.saturating_sub(silent)).max(Duration::from_millis(1));
        watch = shared.over.wait_timeout(watch, left).unwrap_or_else(PoisonError::into_inner).0;
    }
}
