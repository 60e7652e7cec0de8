//! Signals that request the end of the program. The program only records them, so that it can stop the robot first.

use std::borrow::Cow;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use nix::sys::signal::SigSet;
use rustix::process::Signal as Number;
use signal_hook::flag;

use crate::Time;
use crate::patience::Patience;
use crate::stop_request::StopRequest;

/// A signal that requests the end of the program, given by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ProcessSignal(u8);

/// Signals that end a program by default and can be caught. Signals with another meaning are omitted: SIGUSR1 requests
/// a report of the timing, and SIGPIPE and SIGXFSZ indicate errors of the file that is being written.
const NAMED: [(Number, &str); 16] = [
    (Number::HUP, "SIGHUP"),
    (Number::INT, "SIGINT"),
    (Number::QUIT, "SIGQUIT"),
    (Number::TRAP, "SIGTRAP"),
    (Number::ABORT, "SIGABRT"),
    (Number::BUS, "SIGBUS"),
    (Number::USR2, "SIGUSR2"),
    (Number::ALARM, "SIGALRM"),
    (Number::TERM, "SIGTERM"),
    (Number::STKFLT, "SIGSTKFLT"),
    (Number::XCPU, "SIGXCPU"),
    (Number::VTALARM, "SIGVTALRM"),
    (Number::PROF, "SIGPROF"),
    (Number::IO, "SIGIO"),
    (Number::POWER, "SIGPWR"),
    (Number::SYS, "SIGSYS"),
];
/// Numbers of the first and the last real-time signal. A C library reserves some of the first real-time signals for
/// itself.
const REAL_TIME: (u8, u8) = (34, 64);

impl ProcessSignal {
    /// The signal SIGINT, which Ctrl-C sends.
    #[cfg(test)]
    pub(crate) const INTERRUPT: Self = Self::of(Number::INT);
    /// The signal SIGTERM, which `kill` sends by default.
    #[cfg(test)]
    pub(crate) const TERMINATE: Self = Self::of(Number::TERM);
    /// The signal SIGHUP: the terminal was closed, for example because the connection to the robot's computer was lost.
    #[cfg(test)]
    pub(crate) const HANG_UP: Self = Self::of(Number::HUP);

    const fn of(number: Number) -> Self {
        Self(number.as_raw() as u8)
    }

    /// Returns the signals that end a run.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        NAMED.into_iter().map(|(number, _)| Self::of(number)).chain((REAL_TIME.0..=REAL_TIME.1).map(Self))
    }

    /// Returns the name of the signal for the operator.
    pub(crate) fn name(self) -> Cow<'static, str> {
        match NAMED.into_iter().find(|(number, _)| Self::of(*number) == self) {
            Some((_, name)) => name.into(),
            None => format!("SIGRTMIN+{}", self.0.saturating_sub(REAL_TIME.0)).into(),
        }
    }

    /// Returns the number of the signal. If a signal ends a program, a shell reports the exit status 128 plus this
    /// number.
    pub(crate) fn number(self) -> u8 {
        self.0
    }

    fn is_real_time(self) -> bool {
        self.0 >= REAL_TIME.0
    }

    /// Returns `true` if the program continues to ignore a signal that was already ignored when the program started.
    ///
    /// `nohup` requires this for SIGHUP. However, a script's shell starts background jobs with SIGINT and SIGQUIT
    /// ignored, although a person who presses Ctrl-C wants the robot to stop; the program therefore handles these two
    /// signals, and SIGTERM, in any case.
    fn may_be_ignored(self) -> bool {
        ![Number::INT, Number::QUIT, Number::TERM].map(Self::of).contains(&self)
    }
}

/// Record of the signals that have arrived.
#[derive(Debug)]
pub(crate) struct Signals {
    /// Number of the last signal that has arrived; 0 before the first.
    caught: Arc<AtomicUsize>,
    /// `true` if a signal ends the program immediately, as signals do by default.
    deadly: Arc<AtomicBool>,
    /// `true` if SIGUSR1 has arrived, which requests a report of the timing of turns.
    timing: Arc<AtomicBool>,
    /// Signals that are recorded: all signals except those that were ignored at the program's start.
    noted: Vec<ProcessSignal>,
    patience: Patience,
}

impl Signals {
    /// Starts recording the signals of this process. Until [`Signals::robot_runs`] is called, signals still end the
    /// process immediately.
    ///
    /// # Errors
    /// Fails if the system does not permit catching a signal.
    pub(crate) fn listen() -> io::Result<Self> {
        let mut signals = Self { deadly: Arc::new(AtomicBool::new(true)), ..Self::unheard() };
        flag::register(Number::USR1.as_raw(), Arc::clone(&signals.timing))?;
        // Has the effect of ignoring the signal: the write that exceeds the size limit fails instead.
        flag::register(Number::XFSZ.as_raw(), Arc::default())?;
        let ignored = ignored();
        for signal in ProcessSignal::all() {
            if signal.may_be_ignored() && ignored & (1 << (signal.number() - 1)) != 0 {
                continue;
            }
            match signals.note(signal) {
                Err(_) if signal.is_real_time() => {}
                Err(error) => return Err(error),
                Ok(()) => signals.noted.push(signal),
            }
        }
        // A program inherits the signals that its parent has blocked, and would never receive them.
        SigSet::all().thread_unblock()?;
        Ok(signals)
    }

    /// Installs a handler for a signal. The handler records the signal, or ends the program while signals still end it
    /// immediately.
    fn note(&self, signal: ProcessSignal) -> io::Result<()> {
        let number = i32::from(signal.number());
        if signal == ProcessSignal::of(Number::BUS) {
            // A real bus error recurs at once, so a second SIGBUS ends the program; a single one, sent from outside, is
            // recorded.
            let noted = Arc::new(AtomicBool::new(false));
            flag::register_conditional_shutdown(number, 128 + number, Arc::clone(&noted))?;
            flag::register(number, noted)?;
        }
        flag::register_usize(number, Arc::clone(&self.caught), usize::from(signal.number()))?;
        // signal-hook cannot reproduce the default effect of a signal that it does not know by name.
        match flag::register_conditional_default(number, Arc::clone(&self.deadly)) {
            Ok(_) => Ok(()),
            Err(_) => flag::register_conditional_shutdown(number, 128 + number, Arc::clone(&self.deadly)).map(|_| ()),
        }
    }

    /// Stops signals from ending the program. From now on, they are only recorded, because the robot must be stopped
    /// first. Also from now on, writing output does not delay a robot in real time.
    pub(crate) fn robot_runs(&self, time: Time) {
        self.deadly.store(false, Ordering::SeqCst);
        if time == Time::Wall {
            self.patience.robot_drives();
        }
    }

    /// Returns the signals that are recorded.
    pub(crate) fn noted(&self) -> &[ProcessSignal] {
        &self.noted
    }

    /// Returns the phase of the run, which determines how long writers wait for their readers.
    pub(crate) fn patience(&self) -> &Patience {
        &self.patience
    }

    /// Returns `true` if a signal ends the program immediately.
    pub(crate) fn are_deadly(&self) -> bool {
        self.deadly.load(Ordering::SeqCst)
    }

    /// Returns the last signal that has arrived; `None` before the first.
    pub(crate) fn caught(&self) -> Option<ProcessSignal> {
        u8::try_from(self.caught.load(Ordering::SeqCst)).ok().filter(|number| *number > 0).map(ProcessSignal)
    }

    /// Returns the request to end the run that a signal makes, for code that connects to a robot.
    pub(crate) fn stop_request(&self) -> StopRequest {
        StopRequest::of(&self.caught)
    }

    /// Returns `true` if SIGUSR1 has arrived since the last call; this signal requests a report of the timing of turns.
    pub(crate) fn timing_is_asked_for(&self) -> bool {
        self.timing.swap(false, Ordering::SeqCst)
    }

    /// Returns a record of signals that only [`Signals::raise`] can raise.
    pub(crate) fn unheard() -> Self {
        let caught = Arc::default();
        let patience = Patience::new(StopRequest::of(&caught));
        Self { caught, deadly: Arc::default(), timing: Arc::default(), noted: Vec::new(), patience }
    }

    /// Returns another handle to the same record.
    pub(crate) fn share(&self) -> Self {
        let Self { caught, deadly, timing, noted, patience } = self;
        Self {
            caught: Arc::clone(caught),
            deadly: Arc::clone(deadly),
            timing: Arc::clone(timing),
            noted: noted.clone(),
            patience: patience.clone(),
        }
    }

    /// Records this signal as if it had arrived.
    #[cfg(test)]
    pub(crate) fn raise(&self, signal: ProcessSignal) {
        self.caught.store(usize::from(signal.number()), Ordering::SeqCst);
    }
}

/// Returns the signals that this process has ignored since its start, as bits; the lowest bit is SIGHUP. Returns 0 if
/// the signals are unknown.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_signal_has_a_name_of_its_own() {
        let names: std::collections::BTreeSet<_> = ProcessSignal::all().map(ProcessSignal::name).collect();
        assert_eq!(names.len(), 16 + 31);
        assert_eq!((ProcessSignal(1).name(), ProcessSignal(34).name()), ("SIGHUP".into(), "SIGRTMIN+0".into()));
    }
}
