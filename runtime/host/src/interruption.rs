//! The signal that ends a program without a robot of its own, such as a run of several simulated ones: the program ends
//! in order, with all that it has written so far.

use std::io::{self, Write};

use crate::run_end::RunEnd;
use crate::signals::Signals;
use crate::{Pace, Time, second_signal};

/// The signals that ask a program to end, noted.
#[derive(Debug)]
pub struct Interruption(Signals);

impl Interruption {
    /// Lets signals that end a program be noted from now on. A second one ends it at once.
    ///
    /// # Errors
    /// The system does not let a signal be caught, or gives no thread.
    pub fn listen() -> io::Result<Self> {
        let signals = Signals::listen()?;
        second_signal::watch(&signals)?;
        signals.robot_runs(Time::Stepped(Pace::Max));
        // Nothing has to be stopped.
        signals.patience().stop_was_tried(None);
        Ok(Self(signals))
    }

    /// Returns `true` once a signal has arrived.
    #[must_use]
    pub fn is_made(&self) -> bool {
        self.0.caught().is_some()
    }

    /// Reports the signal that has arrived; returns the exit status of the program, or `None` without a signal.
    pub fn tell(&self, err: &mut dyn Write) -> Option<u8> {
        let ending = RunEnd::Signal(self.0.caught()?);
        ending.tell(true, err);
        Some(ending.status(&[]))
    }
}
