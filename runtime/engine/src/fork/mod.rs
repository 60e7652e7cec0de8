//! Runs the modules of a turn on several threads: workers take modules from a list, and the control thread only waits
//! for the workers, until a deadline (paper, section III-A).

mod seat;
#[cfg(test)]
mod tests;

use std::hint::spin_loop;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use mdle_runtime::Nanos;
use rustix::thread::futex;
use rustix::time::Timespec;
pub(crate) use seat::{Seat, Task, TurnProgress};

/// Number of modules for which a new round has room. A larger round allocates memory when it is first used.
const ROOM: usize = 32;
/// Maximum expected duration of a round that is run by a single worker. Waking a second worker would take longer than
/// such a round.
const SMALL: Duration = Duration::from_micros(50);
/// Maximum time for which the control thread polls for the end of a small round before it sleeps. Waking the thread
/// would take about as long.
const LOOKS: Duration = Duration::from_micros(200);

/// Threads on which modules make their turns.
#[derive(Debug, Clone, Copy)]
pub enum Threads {
    /// The control thread runs the modules itself, one after the other and without a deadline.
    Sequential,
    /// Worker threads. Contains their number, at least one, and a function that each worker calls first, for example to
    /// set its priority.
    Workers(usize, fn()),
}

/// Threads that run the turns of modules.
pub(crate) struct Fork<Y> {
    crew: Option<Crew<Y>>,
    /// Rounds that are reused. [`RoundExchange`] keeps the last round, and each worker may use an earlier round for a
    /// short time longer; the fork begins with one round more than these, so that a turn finds an unused round. A
    /// module that hangs keeps its round forever.
    rounds: Vec<Arc<Round<Y>>>,
}

/// Modules of one turn, and their progress.
struct Round<Y> {
    y: Option<Y>,
    number: u64,
    now: Nanos,
    seats: Vec<Arc<Seat<Y>>>,
    /// Expected duration of the round: the sum of the modules' mean turn times.
    cost: Duration,
    /// Position of the next module to be taken.
    next: AtomicUsize,
    /// Number of modules that have not finished. The control thread waits until this number is zero.
    left: AtomicU32,
}

/// The workers, and the data that they share with the control thread.
struct Crew<Y> {
    call: Arc<RoundExchange<Y>>,
    workers: usize,
    /// `true` if the computer has several cores, so that the control thread and the workers can run at the same time.
    is_parallel: bool,
    prepare: fn(),
}

/// Data through which the control thread passes rounds to the workers.
struct RoundExchange<Y> {
    round: Mutex<Option<Arc<Round<Y>>>>,
    /// Number of rounds so far. Workers wait until this number changes.
    epoch: AtomicU32,
    quit: AtomicBool,
}

impl<Y: Send + Sync + 'static> Fork<Y> {
    /// Starts the threads.
    ///
    /// # Errors
    /// Fails if the system cannot create the threads.
    pub(crate) fn new(threads: Threads) -> io::Result<Self> {
        let crew = match threads {
            Threads::Sequential => None,
            Threads::Workers(workers, prepare) => Some(Crew::new(workers.max(1), prepare)?),
        };
        let used = crew.as_ref().map_or(0, |crew| crew.workers + 1);
        let rounds = (0..=used).map(|_| Arc::new(Round::default())).collect();
        Ok(Self { crew, rounds })
    }

    /// Makes a turn of these modules. Threads take the modules in this order; modules that have not finished at the
    /// deadline are late or skipped.
    pub(crate) fn turn<'s>(
        &mut self,
        y: Y,
        number: u64,
        now: Nanos,
        seats: impl Iterator<Item = &'s Arc<Seat<Y>>>,
        deadline: Option<Instant>,
    ) where
        Y: 's,
    {
        let round = self.round(y, number, now, seats);
        match &self.crew {
            None => _ = round.work(),
            Some(crew) => {
                crew.call(&round);
                if !crew.makes_alone(&round, deadline) {
                    crew.wake_all();
                    round.wait(deadline);
                }
                crew.replace(round.seats.iter().filter(|seat| seat.cut()).count());
            }
        }
        self.rounds.push(round);
    }

    /// Prepares a round. Does not allocate if an unused round is large enough.
    fn round<'s>(
        &mut self,
        y: Y,
        number: u64,
        now: Nanos,
        seats: impl Iterator<Item = &'s Arc<Seat<Y>>>,
    ) -> Arc<Round<Y>>
    where
        Y: 's,
    {
        let free = self.rounds.iter_mut().position(|round| Arc::get_mut(round).is_some());
        let mut round = free.map_or_else(|| Arc::new(Round::default()), |free| self.rounds.swap_remove(free));
        // A module that hangs keeps its round.
        if free.is_none() && self.rounds.len() > 8 {
            self.rounds.clear();
        }
        if let Some(round) = Arc::get_mut(&mut round) {
            round.y = Some(y);
            (round.number, round.now) = (number, now);
            round.seats.clear();
            round.seats.extend(seats.map(Arc::clone));
            round.seats.iter().for_each(|seat| seat.queue());
            round.cost = round.seats.iter().map(|seat| seat.cost()).sum();
            *round.next.get_mut() = 0;
            *round.left.get_mut() = u32::try_from(round.seats.len()).unwrap_or(u32::MAX);
        }
        round
    }
}

impl<Y> Default for Round<Y> {
    fn default() -> Self {
        Self {
            y: None,
            number: 0,
            now: Nanos::ZERO,
            seats: Vec::with_capacity(ROOM),
            cost: Duration::ZERO,
            next: AtomicUsize::new(0),
            left: AtomicU32::new(0),
        }
    }
}

impl<Y> Round<Y> {
    /// Takes modules and runs them until no module is left. Returns `false` if a module was late, because another
    /// thread has then replaced this one.
    fn work(&self) -> bool {
        let Some(y) = &self.y else { return true };
        while let Some(seat) = self.seats.get(self.next.fetch_add(1, Ordering::AcqRel)) {
            let was_late = seat.run(y, self.number, self.now);
            if self.left.fetch_sub(1, Ordering::AcqRel) == 1 {
                wake(&self.left, 1);
            }
            if was_late {
                return false;
            }
        }
        true
    }

    /// Polls for the end of the round until the time `until`; returns `true` if all modules have finished.
    fn ends_before(&self, until: Instant) -> bool {
        while self.left.load(Ordering::Acquire) > 0 {
            if Instant::now() >= until {
                return false;
            }
            spin_loop();
        }
        true
    }

    /// Waits until all modules have finished, or until the deadline.
    fn wait(&self, deadline: Option<Instant>) {
        loop {
            let left = self.left.load(Ordering::Acquire);
            if left == 0 || deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                return;
            }
            wait(&self.left, left, deadline);
        }
    }
}

impl<Y: Send + Sync + 'static> Crew<Y> {
    fn new(workers: usize, prepare: fn()) -> io::Result<Self> {
        let call = RoundExchange { round: Mutex::default(), epoch: AtomicU32::new(0), quit: AtomicBool::new(false) };
        let is_parallel = thread::available_parallelism().is_ok_and(|cores| cores.get() > 1);
        let crew = Self { call: Arc::new(call), workers, is_parallel, prepare };
        (0..workers).try_for_each(|_| crew.hire())?;
        Ok(crew)
    }

    fn hire(&self) -> io::Result<()> {
        let (call, prepare) = (Arc::clone(&self.call), self.prepare);
        let seen = call.epoch.load(Ordering::Acquire);
        let worker = move || {
            prepare();
            call.answer(seen);
        };
        thread::Builder::new().name("mdle worker".to_owned()).spawn(worker).map(|_| ())
    }

    /// Starts a replacement for each worker that is still running a late module. If the system cannot create a thread,
    /// the remaining workers continue without the replacement.
    fn replace(&self, late: usize) {
        (0..late).for_each(|_| _ = self.hire());
    }

    /// Passes a round to the workers, but does not wake them.
    fn call(&self, round: &Arc<Round<Y>>) {
        *self.call.round.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::clone(round));
        self.call.epoch.fetch_add(1, Ordering::AcqRel);
    }

    /// If the round is small, wakes a single worker and polls for the end of the round. Returns `true` if the round has
    /// ended.
    fn makes_alone(&self, round: &Round<Y>, deadline: Option<Instant>) -> bool {
        let is_small = self.is_parallel && round.cost <= SMALL;
        is_small && {
            wake(&self.call.epoch, 1);
            let until = Instant::now() + LOOKS;
            round.ends_before(deadline.map_or(until, |deadline| deadline.min(until)))
        }
    }

    fn wake_all(&self) {
        wake(&self.call.epoch, u32::try_from(self.workers).unwrap_or(u32::MAX));
    }
}

impl<Y> RoundExchange<Y> {
    /// Runs rounds on a worker until the workers have to end or this worker has been replaced.
    fn answer(&self, mut seen: u32) {
        loop {
            wait(&self.epoch, seen, None);
            if self.quit.load(Ordering::Acquire) {
                return;
            }
            let epoch = self.epoch.load(Ordering::Acquire);
            if epoch == seen {
                continue;
            }
            seen = epoch;
            let round = self.round.lock().unwrap_or_else(PoisonError::into_inner).clone();
            if round.is_some_and(|round| !round.work()) {
                return;
            }
        }
    }
}

impl<Y> Drop for Crew<Y> {
    /// Asks the workers to end, without waiting for a module that hangs.
    fn drop(&mut self) {
        self.call.quit.store(true, Ordering::Release);
        self.call.epoch.fetch_add(1, Ordering::AcqRel);
        wake(&self.call.epoch, u32::MAX >> 1);
    }
}

/// Waits while `word` has the value `value`, but not beyond the deadline; may return early.
fn wait(word: &AtomicU32, value: u32, deadline: Option<Instant>) {
    let left = deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()));
    let left = left.map(|left| Timespec {
        tv_sec: i64::try_from(left.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: left.subsec_nanos().into(),
    });
    // An error means that the value has changed, a signal arrived, or the time is over: the caller checks again.
    let _ = futex::wait(word, futex::Flags::PRIVATE, value, left.as_ref());
}

/// Wakes at most `count` threads that wait for `word` to change.
fn wake(word: &AtomicU32, count: u32) {
    let _ = futex::wake(word, futex::Flags::PRIVATE, count);
}
