//! Background modules, which the paper calls unregistered: they run on their own threads, and exchange values only at
//! turn breaks (paper, section III-E).

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use mdle_runtime::Nanos;

use super::{Fault, Ports};
use crate::attribute::{Attribute, In, Out, Reading, Value};

/// Number of equal parts into which a turn break divides its maximum wait for a module's values.
const LOOKS: u32 = 50;

/// A module that runs in the background.
pub trait Background: Send + 'static {
    /// Runs on its own thread until an exchange returns [`Stopped`]. The module ends when this function returns.
    ///
    /// # Errors
    /// Returns the reason why the module cannot continue, for the operator.
    fn run(self: Box<Self>, exchange: Exchange) -> Result<(), Fault>;
}

/// Signals that the module has to end, because the engine ends or the module is unloaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stopped;

/// Connection of a background module to the turn breaks, at which it exchanges values.
#[derive(Debug)]
pub struct Exchange {
    gate: Arc<Gate>,
    ports: Ports,
}

impl Exchange {
    pub(crate) const fn new(gate: Arc<Gate>, ports: Ports) -> Self {
        Self { gate, ports }
    }

    /// Calls `fill`, which offers values, and waits for the turn break that publishes these values. Afterwards, the
    /// values that the module reads are those of that turn break.
    ///
    /// # Errors
    /// Fails if the module has to end.
    pub fn exchange<R>(&mut self, fill: impl FnOnce(&mut Offer<'_>) -> R) -> Result<R, Stopped> {
        // The gate is not locked during the call: code that hangs or panics here blocks nothing else.
        let result = fill(&mut Offer(&mut self.ports));
        self.ports = self.gate.hand_over(std::mem::take(&mut self.ports))?;
        Ok(result)
    }

    /// Returns the time of the last turn break, and the values that the module reads, as of this turn break and in the
    /// order of the module's declaration.
    pub(crate) fn readings(&self) -> (Nanos, &[Option<Reading>]) {
        (self.ports.now, &self.ports.ins)
    }

    /// Returns `true` once the module has to end. Needed by code that waits for something other than a turn break.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.gate.lock().is_stopped
    }
}

/// Values that a background module offers at its next exchange.
#[derive(Debug)]
pub struct Offer<'o>(&'o mut Ports);

impl Offer<'_> {
    /// Returns the start time, on the engine's clock, of the turn before the last turn break; zero before the first
    /// turn break.
    #[must_use]
    pub fn now(&self) -> Nanos {
        self.0.now
    }

    /// Returns the value of an attribute as of the last exchange, or the value of a setting. Returns `None` before a
    /// module has published the attribute, and after its module was unloaded.
    #[must_use]
    pub fn get<T: Attribute>(&self, attribute: In<T>) -> Option<T> {
        self.0.get(attribute)
    }

    /// Returns the value that [`Offer::get`] returns, with the time at which it was published; for a setting, with the
    /// time at which it was changed.
    #[must_use]
    pub fn reading<T>(&self, attribute: In<T>) -> Option<&Reading> {
        self.0.reading(attribute)
    }

    /// Publishes a value at the next turn break; a value that contains NaN is not published.
    pub fn publish<T: Attribute>(&mut self, attribute: Out<T>, value: T) {
        self.0.publish(attribute, value);
    }

    /// Publishes a value of the attribute with the index `place` in the declaration; the value must have the
    /// attribute's kind.
    pub(crate) fn put(&mut self, place: usize, value: Value) {
        if let Some(out) = self.0.outs.get_mut(place) {
            *out = Some(value);
        }
    }
}

/// Exchange of values between the thread of a background module and the turn breaks. Its lock is held only briefly.
#[derive(Debug, Default)]
pub(crate) struct Gate {
    meeting: Mutex<BreakMeeting>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct BreakMeeting {
    /// `true` once the module may run.
    has_begun: bool,
    /// Values that a waiting module offers to the next turn break; `None` if the module does not wait.
    offered: Option<Ports>,
    /// Values that a turn break has returned to the module; `None` once the module has taken them.
    returned: Option<Ports>,
    is_stopped: bool,
    /// Reason why the module's thread has ended; `None` before the end, and once a turn break has taken the reason.
    ended: Option<ThreadEnd>,
    /// `true` once the module's thread has ended.
    has_ended: bool,
}

/// Reason why the thread of a background module has ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ThreadEnd {
    /// The module's code returned, because the module was asked to end or has nothing left to do.
    Returned,
    /// The module cannot continue; contains the reason as a sentence.
    Failed(String),
    /// The module's code panicked; contains the panic message.
    Panicked(String),
}

impl BreakMeeting {
    /// Returns `true` unless the module waits for a turn break or has ended.
    const fn is_awaited(&self) -> bool {
        self.offered.is_none() && !self.has_ended
    }
}

impl Gate {
    fn lock(&self) -> MutexGuard<'_, BreakMeeting> {
        self.meeting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'g>(&'g self, meeting: MutexGuard<'g, BreakMeeting>) -> MutexGuard<'g, BreakMeeting> {
        self.changed.wait(meeting).unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits, on the module's thread, until the module may run; returns `false` if the module was stopped before.
    pub(crate) fn wait_for_begin(&self) -> bool {
        let mut meeting = self.lock();
        while !meeting.has_begun && !meeting.is_stopped {
            meeting = self.wait(meeting);
        }
        !meeting.is_stopped
    }

    /// Offers values, on the module's thread, and waits for the turn break that takes them.
    fn hand_over(&self, ports: Ports) -> Result<Ports, Stopped> {
        let mut meeting = self.lock();
        meeting.offered = Some(ports);
        self.changed.notify_all();
        loop {
            if meeting.is_stopped {
                return Err(Stopped);
            }
            match meeting.returned.take() {
                Some(ports) => return Ok(ports),
                None => meeting = self.wait(meeting),
            }
        }
    }

    /// Records, on the module's thread, that the thread has ended.
    pub(crate) fn has_ended(&self, end: ThreadEnd) {
        let mut meeting = self.lock();
        (meeting.ended, meeting.has_ended) = (Some(end), true);
        drop(meeting);
        self.changed.notify_all();
    }

    /// Lets the module run.
    pub(crate) fn begin(&self) {
        self.lock().has_begun = true;
        self.changed.notify_all();
    }

    /// Removes and returns the values of a module that waits for a turn break; `None` if the module does not wait.
    /// Never blocks: if the module holds the lock, it is served at the next turn break.
    pub(crate) fn take_offer(&self) -> Option<Ports> {
        self.meeting.try_lock().ok()?.offered.take()
    }

    /// Returns the values to the module at the end of a turn break; the module then continues.
    pub(crate) fn give_back(&self, ports: Ports) {
        self.lock().returned = Some(ports);
        self.changed.notify_all();
    }

    /// Waits until the module waits for a turn break or has ended; returns `false` if neither happens within
    /// `patience`. The time is measured by [`LOOKS`] checks, each of which counts as an equal part of `patience` even
    /// if this thread is delayed. Therefore, no module is given up because the process was suspended or the computer
    /// was busy.
    pub(crate) fn wait_for_offer(&self, patience: Duration) -> bool {
        let mut meeting = self.lock();
        for _ in 0..LOOKS {
            let waited = self.changed.wait_timeout_while(meeting, patience / LOOKS, |meeting| meeting.is_awaited());
            meeting = waited.unwrap_or_else(PoisonError::into_inner).0;
            if !meeting.is_awaited() {
                return true;
            }
        }
        false
    }

    /// Returns the reason why the module's thread has ended. Returns `None` before the thread has ended, after the
    /// reason was returned once, and while the module holds the lock.
    pub(crate) fn take_end(&self) -> Option<ThreadEnd> {
        self.meeting.try_lock().ok()?.ended.take()
    }

    /// Asks the module to end; all further exchanges fail.
    pub(crate) fn stop(&self) {
        self.lock().is_stopped = true;
        self.changed.notify_all();
    }

    /// Waits at most `patience` for the module's thread to end.
    pub(crate) fn wait_for_end(&self, patience: Duration) {
        let lasts = |meeting: &mut BreakMeeting| !meeting.has_ended;
        drop(self.changed.wait_timeout_while(self.lock(), patience, lasts));
    }
}
