//! Background modules, which the paper calls unregistered: they run on threads of their own, and exchange values at
//! turn breaks only (paper, section III-E).

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use mdle_runtime::Nanos;

use super::{Fault, Ports};
use crate::attribute::{Attribute, In, Out, Reading, Value};

/// Number of times that a break looks for an offer before it gives a module up.
const LOOKS: u32 = 50;

/// A module that runs in the background.
pub trait Background: Send + 'static {
    /// Runs on a thread of its own until an exchange returns [`Stopped`]. When it returns, the module has ended.
    ///
    /// # Errors
    /// Why the module cannot go on, for the operator.
    fn run(self: Box<Self>, exchange: Exchange) -> Result<(), Fault>;
}

/// The module is to end: the engine ends, or the module is unloaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stopped;

/// Place where a background module and the turn breaks meet.
#[derive(Debug)]
pub struct Exchange {
    gate: Arc<Gate>,
    ports: Ports,
}

impl Exchange {
    pub(crate) const fn new(gate: Arc<Gate>, ports: Ports) -> Self {
        Self { gate, ports }
    }

    /// Publishes what `fill` publishes at the next break, and waits for that break. Values that the module reads are
    /// then as of that break.
    ///
    /// # Errors
    /// The module is to end.
    pub fn exchange<R>(&mut self, fill: impl FnOnce(&mut Offer<'_>) -> R) -> Result<R, Stopped> {
        // The gate is not locked meanwhile: code that hangs or panics here hinders nobody.
        let result = fill(&mut Offer(&mut self.ports));
        self.ports = self.gate.hand_over(std::mem::take(&mut self.ports))?;
        Ok(result)
    }

    /// Returns the time of the last break, and the values that the module reads as of that break, in the order of its
    /// declaration.
    pub(crate) fn readings(&self) -> (Nanos, &[Option<Reading>]) {
        (self.ports.now, &self.ports.ins)
    }

    /// Returns `true` once the module is to end, for code that waits for something else than a break.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.gate.lock().is_stopped
    }
}

/// Values that a background module hands over at its next exchange.
#[derive(Debug)]
pub struct Offer<'o>(&'o mut Ports);

impl Offer<'_> {
    /// Returns the time of the turn that ended with the last break, on the engine's clock; zero before the first.
    #[must_use]
    pub fn now(&self) -> Nanos {
        self.0.now
    }

    /// Returns the value of an attribute as of the last exchange, or of a setting.
    #[must_use]
    pub fn get<T: Attribute>(&self, attribute: In<T>) -> Option<T> {
        self.0.get(attribute)
    }

    /// Returns the value with the time at which it was published.
    #[must_use]
    pub fn reading<T>(&self, attribute: In<T>) -> Option<&Reading> {
        self.0.reading(attribute)
    }

    /// Publishes a value at the next break; a value with a NaN is never published.
    pub fn publish<T: Attribute>(&mut self, attribute: Out<T>, value: T) {
        self.0.publish(attribute, value);
    }

    /// Publishes a value of the attribute at this place in the declaration, whose kind it has.
    pub(crate) fn put(&mut self, place: usize, value: Value) {
        if let Some(out) = self.0.outs.get_mut(place) {
            *out = Some(value);
        }
    }
}

/// Exchange of values between a thread in the background and the breaks. It is locked for moments only.
#[derive(Debug, Default)]
pub(crate) struct Gate {
    meeting: Mutex<Meeting>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Meeting {
    /// `true` once the module may run.
    has_begun: bool,
    /// Values of a module that waits for a break.
    offered: Option<Ports>,
    /// Values that a break has returned to the module.
    returned: Option<Ports>,
    is_stopped: bool,
    /// End of the module's thread, once it has ended.
    ended: Option<ThreadEnd>,
}

/// End of the thread of a background module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ThreadEnd {
    /// The module was to end, or has nothing left to do.
    Returned,
    /// The module cannot go on: a sentence.
    Failed(String),
    /// The module's code panicked: the message.
    Panicked(String),
}

impl Meeting {
    /// Returns `true` while the module neither waits for a break nor has ended.
    const fn is_awaited(&self) -> bool {
        self.offered.is_none() && self.ended.is_none()
    }
}

impl Gate {
    fn lock(&self) -> MutexGuard<'_, Meeting> {
        self.meeting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'g>(&'g self, meeting: MutexGuard<'g, Meeting>) -> MutexGuard<'g, Meeting> {
        self.changed.wait(meeting).unwrap_or_else(PoisonError::into_inner)
    }

    /// On the module's thread: waits until the module may run; `false` if it never may.
    pub(crate) fn wait_for_begin(&self) -> bool {
        let mut meeting = self.lock();
        while !meeting.has_begun && !meeting.is_stopped {
            meeting = self.wait(meeting);
        }
        !meeting.is_stopped
    }

    /// On the module's thread: offers values, and waits for the break that takes them.
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

    /// On the module's thread: notes that it has ended.
    pub(crate) fn has_ended(&self, end: ThreadEnd) {
        self.lock().ended = Some(end);
        self.changed.notify_all();
    }

    /// Lets the module run.
    pub(crate) fn begin(&self) {
        self.lock().has_begun = true;
        self.changed.notify_all();
    }

    /// At a break: takes the values of a module that waits; never waits itself. A module that has the lock at this
    /// moment is served at the next break.
    pub(crate) fn take_offer(&self) -> Option<Ports> {
        self.meeting.try_lock().ok()?.offered.take()
    }

    /// At the end of the break: returns the values to the module, which goes on.
    pub(crate) fn give_back(&self, ports: Ports) {
        self.lock().returned = Some(ports);
        self.changed.notify_all();
    }

    /// Waits until the module waits for a break, or has ended; returns `false` if neither is so within this time.
    /// Each of [`LOOKS`] counts as its part of the time, however late this thread goes on: a process that was
    /// stopped, or that a busy machine kept waiting, gives up no module for that.
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

    /// Returns how the module's thread has ended, once.
    pub(crate) fn take_end(&self) -> Option<ThreadEnd> {
        self.meeting.try_lock().ok()?.ended.take()
    }

    /// Asks the module to end; its exchanges fail from now on.
    pub(crate) fn stop(&self) {
        self.lock().is_stopped = true;
        self.changed.notify_all();
    }

    /// Waits for at most this time until the module's thread has ended.
    pub(crate) fn wait_for_end(&self, patience: Duration) {
        let lasts = |meeting: &mut Meeting| meeting.ended.is_none();
        drop(self.changed.wait_timeout_while(self.lock(), patience, lasts));
    }
}
