//! Signals that ask the program to end: they are noted, so that the robot is stopped first.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1};
use signal_hook::flag;

use crate::StopRequest;

/// A signal that asks the program to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Signal {
    /// The terminal is gone, such as a lost connection to the robot's computer.
    HangUp,
    /// Ctrl-C.
    Interrupt,
    /// A polite `kill`.
    Terminate,
}

impl Signal {
    const ALL: [Self; 3] = [Self::HangUp, Self::Interrupt, Self::Terminate];

    /// Its name, for the operator.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::HangUp => "SIGHUP",
            Self::Interrupt => "SIGINT",
            Self::Terminate => "SIGTERM",
        }
    }

    /// Its number; a shell reports 128 more as the status of a program that it ended.
    pub(crate) fn number(self) -> u8 {
        match self {
            Self::HangUp => 1,
            Self::Interrupt => 2,
            Self::Terminate => 15,
        }
    }

    /// Its number as the system takes it.
    fn raw(self) -> i32 {
        match self {
            Self::HangUp => SIGHUP,
            Self::Interrupt => SIGINT,
            Self::Terminate => SIGTERM,
        }
    }
}

/// The signals caught so far.
#[derive(Debug)]
pub(crate) struct Signals {
    /// The number of the signal that came last; 0 before the first.
    caught: Arc<AtomicUsize>,
    /// Whether a signal ends the program at once, as it does by default.
    deadly: Arc<AtomicBool>,
    /// Whether SIGUSR1 came: how late are the turns?
    timing: Arc<AtomicBool>,
}

impl Signals {
    /// Listens to the signals of this process. They still end it at once, until [`Signals::robot_runs`].
    ///
    /// # Errors
    /// When the system does not let a signal be caught.
    pub(crate) fn listen() -> io::Result<Self> {
        let signals = Self { caught: Arc::default(), deadly: Arc::new(AtomicBool::new(true)), timing: Arc::default() };
        flag::register(SIGUSR1, Arc::clone(&signals.timing))?;
        for signal in Signal::ALL {
            // Whoever started the program with `nohup` wants it to outlive the terminal.
            if signal == Signal::HangUp && ignored(signal) {
                continue;
            }
            flag::register_usize(signal.raw(), Arc::clone(&signals.caught), usize::from(signal.number()))?;
            flag::register_conditional_default(signal.raw(), Arc::clone(&signals.deadly))?;
        }
        Ok(signals)
    }

    /// From here on a signal is only noted: the robot must be stopped first.
    pub(crate) fn robot_runs(&self) {
        self.deadly.store(false, Ordering::SeqCst);
    }

    /// The robot stands and all is written: a signal may end at once whatever still holds the program up.
    pub(crate) fn robot_stands(&self) {
        self.deadly.store(true, Ordering::SeqCst);
    }

    /// The signal that came last, if one came.
    pub(crate) fn caught(&self) -> Option<Signal> {
        let number = self.caught.load(Ordering::SeqCst);
        Signal::ALL.into_iter().find(|signal| usize::from(signal.number()) == number)
    }

    /// Tells code that opens a robot whether a signal came.
    pub(crate) fn stop_request(&self) -> StopRequest {
        StopRequest::of(&self.caught)
    }

    /// Whether it has been asked, since this was asked last, how late the turns are.
    pub(crate) fn timing_is_asked_for(&self) -> bool {
        self.timing.swap(false, Ordering::SeqCst)
    }

    /// Signals that only [`Signals::raise`] raises.
    #[cfg(test)]
    pub(crate) fn unheard() -> Self {
        Self { caught: Arc::default(), deadly: Arc::default(), timing: Arc::default() }
    }

    /// Another handle on the same signals.
    #[cfg(test)]
    pub(crate) fn share(&self) -> Self {
        Self { caught: Arc::clone(&self.caught), deadly: Arc::clone(&self.deadly), timing: Arc::clone(&self.timing) }
    }

    /// Does what the system does when the signal comes.
    #[cfg(test)]
    pub(crate) fn raise(&self, signal: Signal) {
        self.caught.store(usize::from(signal.number()), Ordering::SeqCst);
    }
}

/// Whether this process was started with the signal ignored; where that cannot be found out, it was not.
fn ignored(signal: Signal) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask & (1 << (signal.number() - 1)) != 0
}
