//! A registered module with its ports and the progress of its turn.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use mdle_host::at_work;
use mdle_runtime::Nanos;

use crate::module::{Fault, Module, Ports, Turn, panicked};

/// A registered module, shared by the threads that run the modules of a turn. Contains the progress of the module's
/// turn, and the mean time of its turns (the cost).
pub(crate) struct Seat<Y> {
    /// Name of the module.
    name: Arc<str>,
    progress: AtomicU8,
    /// Mean time of a turn, in nanoseconds.
    cost: AtomicU64,
    occupant: Mutex<Occupant<Y>>,
}

/// A registered module with its values, behind a lock. The thread that runs the module holds the lock; between turns,
/// the engine holds it.
pub(crate) struct Occupant<Y> {
    module: Box<dyn Module<Y>>,
    pub(crate) ports: Ports,
    /// Task of the module in the next round.
    pub(crate) task: Task,
    /// Reason why the module cannot continue; `None` if it can.
    pub(crate) fault: Option<Fault>,
}

/// Task of a module in a round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Task {
    /// Call [`Module::start`], then make a turn.
    Start,
    /// Make a turn.
    Turn,
    /// Call [`Module::stop`].
    Stop,
}

/// Progress of a module's turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TurnProgress {
    /// The module has no task, or has finished it.
    Done,
    /// No thread has taken the module yet.
    Queued,
    /// A thread is running the module.
    Running,
    /// A thread is still running the module after the deadline.
    Late,
    /// No thread had taken the module at the deadline.
    Skipped,
}

const PROGRESS: [TurnProgress; 5] =
    [TurnProgress::Done, TurnProgress::Queued, TurnProgress::Running, TurnProgress::Late, TurnProgress::Skipped];

impl<Y> Seat<Y> {
    pub(crate) fn new(name: Arc<str>, module: Box<dyn Module<Y>>, ports: Ports) -> Arc<Self> {
        let occupant = Occupant { module, ports, task: Task::Start, fault: None };
        let (progress, cost) = (AtomicU8::new(TurnProgress::Done as u8), AtomicU64::new(0));
        Arc::new(Self { name, progress, cost, occupant: Mutex::new(occupant) })
    }

    /// Returns the progress of the last turn.
    pub(crate) fn progress(&self) -> TurnProgress {
        PROGRESS.get(usize::from(self.progress.load(Ordering::Acquire))).copied().unwrap_or(TurnProgress::Done)
    }

    /// Returns the mean time of a turn; zero before the first turn.
    pub(crate) fn cost(&self) -> Duration {
        Duration::from_nanos(self.cost.load(Ordering::Relaxed))
    }

    /// Queues the module for a round.
    pub(crate) fn queue(&self) {
        self.progress.store(TurnProgress::Queued as u8, Ordering::Release);
    }

    /// Ends the round for this module at the deadline: from now on, no thread may start the module. Returns `true` if a
    /// thread is already running the module, which is then late.
    pub(crate) fn cut(&self) -> bool {
        !self.moved(TurnProgress::Queued, TurnProgress::Skipped)
            && self.moved(TurnProgress::Running, TurnProgress::Late)
    }

    /// Locks the module between rounds; `None` if a thread is still running it.
    pub(crate) fn occupant(&self) -> Option<MutexGuard<'_, Occupant<Y>>> {
        match self.occupant.try_lock() {
            Ok(occupant) => Some(occupant),
            Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    /// Runs the module if no other thread has taken it; returns `true` if the module was late.
    pub(crate) fn run(&self, y: &Y, number: u64, now: Nanos) -> bool {
        if !self.moved(TurnProgress::Queued, TurnProgress::Running) {
            return false;
        }
        let mut occupant = self.occupant.lock().unwrap_or_else(PoisonError::into_inner);
        let begun = Instant::now();
        at_work(Some(&self.name));
        occupant.run(y, number, now);
        at_work(None);
        drop(occupant);
        let cost = (self.cost().saturating_mul(7).saturating_add(begun.elapsed())) / 8;
        self.cost.store(u64::try_from(cost.as_nanos()).unwrap_or(u64::MAX), Ordering::Relaxed);
        self.progress.swap(TurnProgress::Done as u8, Ordering::AcqRel) == TurnProgress::Late as u8
    }

    fn moved(&self, from: TurnProgress, to: TurnProgress) -> bool {
        self.progress.compare_exchange(from as u8, to as u8, Ordering::AcqRel, Ordering::Acquire).is_ok()
    }
}

impl<Y> Occupant<Y> {
    fn run(&mut self, y: &Y, number: u64, now: Nanos) {
        let Self { module, ports, task, fault } = self;
        let result = catch_unwind(AssertUnwindSafe(|| {
            match task {
                Task::Start => module.start(),
                Task::Turn => {}
                Task::Stop => {
                    module.stop();
                    return Ok(());
                }
            }
            module.turn(&mut Turn { number, now, y, ports })
        }));
        *fault = match result {
            Ok(result) => result.err(),
            Err(payload) => Some(Fault(format!("its code panicked, which is a bug: {}", panicked(payload)))),
        };
    }
}
