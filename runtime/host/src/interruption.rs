//! Handles signals for a program without a robot of its own, such as a program that makes several simulated runs. After
//! a signal, the program ends in an orderly way, and writes its output so far.

use std::io::{self, Write};

use crate::run_end::RunEnd;
use crate::signals::Signals;
use crate::{Pace, Time, second_signal};

/// Record of the signals that request the end of a program.
#[derive(Debug)]
pub struct Interruption(Signals);

impl Interruption {
    /// Starts recording signals that request the end of the program. A second signal ends the program at once.
    ///
    /// # Errors
    /// Fails if the system does not permit catching a signal, or cannot create a thread.
    pub fn listen() -> io::Result<Self> {
        let signals = Signals::listen()?;
        second_signal::watch(&signals)?;
        signals.robot_runs(Time::Stepped(Pace::Max));
        // There is no robot to stop.
        signals.patience().stop_was_tried(None);
        Ok(Self(signals))
    }

    /// Returns `true` once a signal has arrived.
    #[must_use]
    pub fn is_made(&self) -> bool {
        self.0.caught().is_some()
    }

    /// Reports the signal that has arrived, and returns the exit status of the program; `None` if no signal has
    /// arrived.
    pub fn tell(&self, err: &mut dyn Write) -> Option<u8> {
        let ending = RunEnd::Signal(self.0.caught()?);
        ending.tell(true, err);
        Some(ending.status(&[]))
    }
}
