//! Signals that ask the program to end: they are noted, so that the robot is stopped first.

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

/// A signal that asks the program to end, by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Signal(u8);

/// The signals that end a program by default and can be caught, without those that mean something else here: SIGUSR1
/// asks for the timing, SIGPIPE and SIGXFSZ are errors of the file that is written.
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
/// The first and the last real-time signal. A C library keeps some of the first ones to itself.
const REAL_TIME: (u8, u8) = (34, 64);

impl Signal {
    /// Ctrl-C.
    #[cfg(test)]
    pub(crate) const INTERRUPT: Self = Self::of(Number::INT);
    /// A polite `kill`.
    #[cfg(test)]
    pub(crate) const TERMINATE: Self = Self::of(Number::TERM);
    /// The terminal is gone, such as a lost connection to the robot's computer.
    #[cfg(test)]
    pub(crate) const HANG_UP: Self = Self::of(Number::HUP);

    const fn of(number: Number) -> Self {
        Self(number.as_raw() as u8)
    }

    /// The signals that end a run.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        NAMED.into_iter().map(|(number, _)| Self::of(number)).chain((REAL_TIME.0..=REAL_TIME.1).map(Self))
    }

    /// Returns the signal's name, for the operator.
    pub(crate) fn name(self) -> Cow<'static, str> {
        match NAMED.into_iter().find(|(number, _)| Self::of(*number) == self) {
            Some((_, name)) => name.into(),
            None => format!("SIGRTMIN+{}", self.0.saturating_sub(REAL_TIME.0)).into(),
        }
    }

    /// Returns the signal's number; a shell reports 128 more as the status of a program that the signal ended.
    pub(crate) fn number(self) -> u8 {
        self.0
    }

    fn is_real_time(self) -> bool {
        self.0 >= REAL_TIME.0
    }

    /// Returns `true` if a program that was started with this signal ignored goes on ignoring it.
    ///
    /// `nohup` asks for that. A script's shell starts jobs in the background with SIGINT and SIGQUIT ignored, which is
    /// not intended: a person who presses Ctrl-C wants the robot to stop.
    fn may_be_ignored(self) -> bool {
        ![Number::INT, Number::QUIT, Number::TERM].map(Self::of).contains(&self)
    }
}

/// The signals caught so far.
#[derive(Debug)]
pub(crate) struct Signals {
    /// The number of the signal that arrived last; 0 before the first.
    caught: Arc<AtomicUsize>,
    /// `true` if a signal ends the program at once, as it does by default.
    deadly: Arc<AtomicBool>,
    /// `true` if SIGUSR1 has arrived, which asks how late the turns are.
    timing: Arc<AtomicBool>,
    /// The signals that are noted: all but those that were ignored already.
    noted: Vec<Signal>,
    patience: Patience,
}

impl Signals {
    /// Listens to the signals of this process. They still end it at once, until [`Signals::robot_runs`].
    ///
    /// # Errors
    /// When the system does not let a signal be caught.
    pub(crate) fn listen() -> io::Result<Self> {
        let mut signals = Self { deadly: Arc::new(AtomicBool::new(true)), ..Self::unheard() };
        flag::register(Number::USR1.as_raw(), Arc::clone(&signals.timing))?;
        // Ignored in effect: the write fails that would make the file too long.
        flag::register(Number::XFSZ.as_raw(), Arc::default())?;
        let ignored = ignored();
        for signal in Signal::all() {
            if signal.may_be_ignored() && ignored & (1 << (signal.number() - 1)) != 0 {
                continue;
            }
            match signals.note(signal) {
                Err(_) if signal.is_real_time() => {}
                Err(error) => return Err(error),
                Ok(()) => signals.noted.push(signal),
            }
        }
        // A program inherits the signals that its parent had blocked, and would never receive them.
        SigSet::all().thread_unblock()?;
        Ok(signals)
    }

    /// Lets a signal be noted, or end the program while signals end it at once.
    fn note(&self, signal: Signal) -> io::Result<()> {
        let number = i32::from(signal.number());
        if signal == Signal::of(Number::BUS) {
            // A real bus error comes again and again: only one from outside is noted.
            let noted = Arc::new(AtomicBool::new(false));
            flag::register_conditional_shutdown(number, 128 + number, Arc::clone(&noted))?;
            flag::register(number, noted)?;
        }
        flag::register_usize(number, Arc::clone(&self.caught), usize::from(signal.number()))?;
        // What signal-hook does not know the name of it cannot do as the system does.
        match flag::register_conditional_default(number, Arc::clone(&self.deadly)) {
            Ok(_) => Ok(()),
            Err(_) => flag::register_conditional_shutdown(number, 128 + number, Arc::clone(&self.deadly)).map(|_| ()),
        }
    }

    /// Lets signals only be noted from now on: the robot must be stopped first. Output must not delay a robot in real
    /// time.
    pub(crate) fn robot_runs(&self, time: Time) {
        self.deadly.store(false, Ordering::SeqCst);
        if time == Time::Wall {
            self.patience.robot_drives();
        }
    }

    /// The signals that are noted.
    pub(crate) fn noted(&self) -> &[Signal] {
        &self.noted
    }

    /// The time that writers wait for their readers.
    pub(crate) fn patience(&self) -> &Patience {
        &self.patience
    }

    /// Returns `true` if a signal ends the program at once.
    pub(crate) fn are_deadly(&self) -> bool {
        self.deadly.load(Ordering::SeqCst)
    }

    /// Returns the signal that arrived last, if any.
    pub(crate) fn caught(&self) -> Option<Signal> {
        u8::try_from(self.caught.load(Ordering::SeqCst)).ok().filter(|number| *number > 0).map(Signal)
    }

    /// Returns the request by which code that opens a robot learns of a signal.
    pub(crate) fn stop_request(&self) -> StopRequest {
        StopRequest::of(&self.caught)
    }

    /// Returns `true` if SIGUSR1 has arrived since the last call, which asks how late the turns are.
    pub(crate) fn timing_is_asked_for(&self) -> bool {
        self.timing.swap(false, Ordering::SeqCst)
    }

    /// Signals that only [`Signals::raise`] raises.
    pub(crate) fn unheard() -> Self {
        let caught = Arc::default();
        let patience = Patience::new(StopRequest::of(&caught));
        Self { caught, deadly: Arc::default(), timing: Arc::default(), noted: Vec::new(), patience }
    }

    /// Another handle on the same signals.
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

    /// Ends the process as the system does by default for this signal.
    #[cfg(test)]
    pub(crate) fn raise(&self, signal: Signal) {
        self.caught.store(usize::from(signal.number()), Ordering::SeqCst);
    }
}

/// Returns the signals that this process ignores since its start, a bit for each from SIGHUP; 0 if that is unknown.
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
        let names: std::collections::BTreeSet<_> = Signal::all().map(Signal::name).collect();
        assert_eq!(names.len(), 16 + 31);
        assert_eq!((Signal(1).name(), Signal(34).name()), ("SIGHUP".into(), "SIGRTMIN+0".into()));
    }
}
