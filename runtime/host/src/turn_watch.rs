//! Limits the time of a turn. If the code of a plan or a module never returns, it blocks the thread that drives the
//! robot, so another thread ends the program.

use std::cell::RefCell;
use std::io::{self, IsTerminal as _};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::{self, Builder};
use std::time::Duration;

use signal_hook::low_level;

use crate::Time;
use crate::background_writer::{Aside, STACK};
use crate::run_end;

/// Time between two checks of the turns.
const LOOK: Duration = Duration::from_millis(100);
/// Number of consecutive checks that find the same turn before the program ends. Checks are counted instead of time,
/// because a suspended computer makes no checks.
const LOOKS: u32 = 100;
/// Time between the decision to end the program and its end, in which writers can finish text that they have already
/// received.
const LAST_LINES: Duration = Duration::from_millis(300);

/// Runs of a program, whose turns another thread watches.
#[derive(Debug, Clone, Default)]
pub(crate) struct TurnWatch(Arc<Mutex<Vec<ObservedRun>>>);

/// A run, with the last observation of the watching thread.
#[derive(Debug)]
struct ObservedRun {
    run: Weak<WatchedRun>,
    last_turn: u64,
    looks: u32,
}

/// The current turn of a run.
#[derive(Debug)]
pub(crate) struct WatchedRun {
    /// Number of the turn, counted from 1; 0 between two turns.
    turn: AtomicU64,
    time: Time,
    work: Work,
}

/// The module whose code the thread of a run is executing; `None` for other code.
type Work = Arc<Mutex<Option<Arc<str>>>>;

thread_local! {
    /// The module at work in the turn that this thread is making.
    static WORK: RefCell<Option<Work>> = const { RefCell::new(None) };
}

/// Records the module whose code this thread executes from now on; `None` means other code. If a turn never ends, the
/// report names this module. Has no effect on a thread that makes no turns.
pub fn at_work(module: Option<&Arc<str>>) {
    WORK.with_borrow(|work| {
        if let Some(work) = work {
            *work.lock().unwrap_or_else(PoisonError::into_inner) = module.map(Arc::clone);
        }
    });
}

/// A turn that did not end in time.
#[derive(Debug, PartialEq, Eq)]
struct Hung {
    /// Number of the turn, counted from 0.
    turn: u64,
    /// Module whose code has not returned, if it is known.
    module: Option<Arc<str>>,
    /// `true` if the robot's time is the wall clock, so that the robot may still move.
    is_real: bool,
}

impl TurnWatch {
    /// Starts watching the turns of this program. A turn that hangs ends the program with a message on standard error
    /// and exit status 3; `leave_screen` restores the terminal.
    ///
    /// # Errors
    /// Fails if the system cannot create a thread.
    pub(crate) fn begin(err: Aside, leave_screen: fn()) -> io::Result<Self> {
        let watch = Self::default();
        let own = watch.clone();
        let look = move || {
            let hung = loop {
                thread::sleep(LOOK);
                if let Some(hung) = own.look() {
                    break hung;
                }
            };
            leave_screen();
            // The progress line of a fast run has no line break at its end.
            let line = if io::stderr().is_terminal() { "\n" } else { "" };
            err.tell(format!("{line}{}\n", hung.sentence()));
            thread::sleep(LAST_LINES);
            // Skips the exit handlers of the libraries: the thread that hangs may hold locks that they need.
            low_level::exit(run_end::FAULT.into());
        };
        Builder::new().name("turn watch".to_owned()).stack_size(STACK).spawn(look)?;
        Ok(watch)
    }

    /// Returns a run whose turns are watched until it is dropped.
    pub(crate) fn run(&self, time: Time) -> Arc<WatchedRun> {
        let run = Arc::new(WatchedRun { turn: AtomicU64::new(0), time, work: Work::default() });
        self.entries().push(ObservedRun { run: Arc::downgrade(&run), last_turn: 0, looks: 0 });
        run
    }

    /// Checks the turns of all runs. Returns a turn that did not end in time; `None` if there is no such turn.
    fn look(&self) -> Option<Hung> {
        let mut hung = None;
        self.entries().retain_mut(|entry| {
            let Some(run) = entry.run.upgrade() else { return false };
            let turn = run.turn.load(Ordering::Acquire);
            entry.looks = if turn == entry.last_turn && turn > 0 { entry.looks.saturating_add(1) } else { 0 };
            entry.last_turn = turn;
            if entry.looks >= LOOKS {
                let module = run.work.lock().unwrap_or_else(PoisonError::into_inner).clone();
                hung = Some(Hung { turn: turn.saturating_sub(1), module, is_real: run.time == Time::Wall });
            }
            true
        });
        hung
    }

    fn entries(&self) -> MutexGuard<'_, Vec<ObservedRun>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl WatchedRun {
    /// Makes a turn whose time is limited.
    pub(crate) fn make<T>(&self, number: u64, turn: impl FnOnce() -> T) -> T {
        /// Guard that records the end of a turn, also after a panic.
        struct TurnGuard<'r>(&'r WatchedRun);
        impl Drop for TurnGuard<'_> {
            fn drop(&mut self) {
                self.0.turn.store(0, Ordering::Release);
                at_work(None);
                WORK.set(None);
            }
        }
        self.turn.store(number.saturating_add(1), Ordering::Release);
        WORK.set(Some(Arc::clone(&self.work)));
        let _turn = TurnGuard(self);
        turn()
    }
}

impl Hung {
    /// Returns the message about the turn for the operator.
    fn sentence(&self) -> String {
        let Self { turn, module, is_real } = self;
        let came = if *is_real {
            "a fault ended the plan, and the robot may not have stopped"
        } else {
            "a fault stopped the robot"
        };
        let seconds = LOOK.saturating_mul(LOOKS).as_secs();
        let code =
            module.as_ref().map_or("the plan or of a module".to_owned(), |module| format!("the module `{module}`"));
        format!("error: {came}: turn {turn} has not ended after {seconds} s: code of {code} never returns")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pace;

    /// Checks all turns `times` times; returns the number of the first turn that is found not to have ended in time.
    fn looked(watch: &TurnWatch, times: u32) -> Option<u64> {
        (0..times).find_map(|_| watch.look()).map(|hung| hung.turn)
    }

    #[test]
    fn a_turn_that_does_not_end_is_found() {
        let watch = TurnWatch::default();
        let (quick, slow) = (watch.run(Time::Stepped(Pace::Max)), watch.run(Time::Wall));
        quick.make(7, || assert_eq!(looked(&watch, LOOKS), None));
        assert_eq!(looked(&watch, 3 * LOOKS), None, "a run may stand between turns");
        for number in 0..3 {
            slow.make(number, || assert_eq!(looked(&watch, LOOKS - 1), None));
        }
        slow.make(41, || {
            (0..LOOKS).for_each(|_| assert_eq!(watch.look(), None));
            assert_eq!(watch.look(), Some(Hung { turn: 41, module: None, is_real: true }));
        });
        slow.make(42, || {
            at_work(Some(&"ears".into()));
            let hung = (0..=LOOKS).find_map(|_| watch.look()).unwrap();
            assert!(hung.sentence().ends_with("code of the module `ears` never returns"), "{hung:?}");
        });
        let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| quick.make(8, || panic!("a bug"))));
        assert!(panicked.is_err() && looked(&watch, 2 * LOOKS).is_none(), "a panic ends the turn");
        drop((quick, slow));
        assert_eq!((looked(&watch, 1), watch.entries().len()), (None, 0));
    }
}
