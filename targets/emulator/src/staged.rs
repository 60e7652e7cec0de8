//! Runs an emulated robot on a thread, in lockstep, while a test observes its state.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::fault::Ailment;
use crate::port::Port;
use crate::serve::{Emulated, Pace, serve};

/// An emulated robot at its line. Dropping this value switches the robot off.
#[derive(Debug)]
pub struct Staged<T> {
    device: PathBuf,
    seen: Arc<SharedState<T>>,
    serving: Option<JoinHandle<io::Result<()>>>,
}

/// State of a robot that a test can observe, and the requests of the test.
#[derive(Debug)]
struct SharedState<T> {
    now: Mutex<T>,
    /// Number of periods that still have to pass without a command.
    idle: AtomicU32,
    /// Body fault that begins at the end of the period; `None` if no fault is requested.
    ailment: Mutex<Option<Ailment>>,
    is_over: AtomicBool,
}

/// The robot, and the state that it shares with the test.
struct WatchedRobot<R, T> {
    robot: R,
    look: fn(&R) -> T,
    period: Duration,
    seen: Arc<SharedState<T>>,
}

impl<T: Clone + Send + 'static> Staged<T> {
    /// Switches on a robot whose world advances by `period` with each command. `look` returns the state that a test can
    /// observe.
    ///
    /// # Errors
    /// Fails if the system has no more pseudo-terminals.
    pub fn new<R: Emulated + Send + 'static>(robot: R, period: Duration, look: fn(&R) -> T) -> io::Result<Self> {
        let port = Port::open()?;
        let device = port.path().to_owned();
        let now = Mutex::new(look(&robot));
        let seen = Arc::new(SharedState {
            now,
            idle: AtomicU32::new(0),
            ailment: Mutex::new(None),
            is_over: AtomicBool::new(false),
        });
        let mut watched = WatchedRobot { robot, look, period, seen: Arc::clone(&seen) };
        let serving = thread::spawn(move || {
            let seen = Arc::clone(&watched.seen);
            serve(&mut watched, &port, Pace::Lockstep(period), &|| !seen.is_over.load(Ordering::Acquire))
        });
        Ok(Self { device, seen, serving: Some(serving) })
    }

    /// Returns the path of the device that a driver opens.
    #[must_use]
    pub fn device(&self) -> &Path {
        &self.device
    }

    /// Returns the current state of the robot.
    #[must_use]
    pub fn now(&self) -> T {
        self.seen.now.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Begins the fault `ailment` of the robot's body at the end of the next period.
    pub fn suffers(&self, ailment: Ailment) {
        *self.seen.ailment.lock().unwrap_or_else(PoisonError::into_inner) = Some(ailment);
    }

    /// Lets `periods` periods pass in which the robot receives no command, and waits until they have passed.
    pub fn left_alone(&self, periods: u32) {
        self.seen.idle.store(periods, Ordering::Release);
        while self.seen.idle.load(Ordering::Acquire) > 0 && self.serving.as_ref().is_some_and(|it| !it.is_finished()) {
            thread::yield_now();
        }
    }
}

impl<T> Drop for Staged<T> {
    fn drop(&mut self) {
        self.seen.is_over.store(true, Ordering::Release);
        if let Some(serving) = self.serving.take() {
            // An error of the robot's thread has already been noticed by the driver.
            let _ = serving.join();
        }
    }
}

impl<R: Emulated, T> Emulated for WatchedRobot<R, T> {
    fn push(&mut self, bytes: &[u8]) {
        self.robot.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        let outcome = self.robot.obey();
        // All earlier requests have been executed by then.
        if outcome.is_none() {
            for _ in 0..self.seen.idle.load(Ordering::Acquire) {
                let _ = self.pass(self.period);
            }
            self.seen.idle.store(0, Ordering::Release);
        }
        outcome
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        self.robot.pass(time)?;
        if let Some(ailment) = self.seen.ailment.lock().unwrap_or_else(PoisonError::into_inner).take() {
            self.robot.suffer(ailment);
        }
        *self.seen.now.lock().unwrap_or_else(PoisonError::into_inner) = (self.look)(&self.robot);
        Ok(())
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        self.robot.take_frames()
    }

    fn can_suffer(ailment: Ailment) -> bool {
        R::can_suffer(ailment)
    }

    fn suffer(&mut self, ailment: Ailment) {
        self.robot.suffer(ailment);
    }
}
