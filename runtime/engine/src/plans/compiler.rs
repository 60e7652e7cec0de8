//! The thread that compiles plans beside the turns: one at a time, and one waits.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;

use mdle_compiler::load::{Loaded, LoadedPlan};

use super::{EngineAlphabet, When};
use crate::module::panicked;

/// Compiles and loads the text of a plan.
///
/// # Errors
/// The diagnostics, for people.
pub type Compile<A> = dyn Fn(&str) -> Result<Arc<Loaded<A>>, String> + Send;

/// A request to replace the plan.
pub(crate) struct Order {
    pub(crate) number: u32,
    pub(crate) text: String,
    pub(crate) when: When,
}

/// Result of an order.
pub(crate) struct Compiled<A: EngineAlphabet> {
    pub(crate) number: u32,
    pub(crate) when: When,
    /// The plan before its first turn, or diagnostics.
    pub(crate) plan: Result<LoadedPlan<A>, String>,
}

/// The thread, which ends when this value is dropped.
pub(crate) struct Compiler<A: EngineAlphabet>(Arc<Counter<A>>);

/// Meeting point of the control thread and the compiler.
struct Counter<A: EngineAlphabet> {
    state: Mutex<State<A>>,
    changed: Condvar,
}

struct State<A: EngineAlphabet> {
    waiting: Option<Order>,
    done: Vec<Compiled<A>>,
    quits: bool,
}

impl<A: EngineAlphabet> Compiler<A> {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system gives no thread.
    pub(crate) fn new(compile: Box<Compile<A>>) -> io::Result<Self> {
        let state = State { waiting: None, done: Vec::new(), quits: false };
        let counter = Arc::new(Counter { state: Mutex::new(state), changed: Condvar::new() });
        let own = Arc::clone(&counter);
        thread::Builder::new().name("mdle compiler".to_owned()).spawn(move || own.serve(&compile))?;
        Ok(Self(counter))
    }

    /// Gives an order; returns the one that has waited and is never carried out now.
    pub(crate) fn order(&self, order: Order) -> Option<Order> {
        let mut state = self.0.state.lock().unwrap_or_else(PoisonError::into_inner);
        let superseded = state.waiting.replace(order);
        self.0.changed.notify_all();
        superseded
    }

    /// Takes back the order that waits.
    pub(crate) fn take_back(&self) -> Option<Order> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner).waiting.take()
    }

    /// Returns the next plan that is compiled; never waits.
    pub(crate) fn done(&self) -> Option<Compiled<A>> {
        let mut state = self.0.state.try_lock().ok()?;
        if state.done.is_empty() { None } else { Some(state.done.remove(0)) }
    }
}

impl<A: EngineAlphabet> Drop for Compiler<A> {
    fn drop(&mut self) {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner).quits = true;
        self.0.changed.notify_all();
    }
}

impl<A: EngineAlphabet> Counter<A> {
    /// Carries out orders until the compiler is to quit.
    fn serve(&self, compile: &Compile<A>) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if state.quits {
                return;
            }
            let Some(Order { number, text, when }) = state.waiting.take() else {
                state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            drop(state);
            let plan = catch_unwind(AssertUnwindSafe(|| compile(&text).map(|loaded| loaded.plan())));
            let plan = plan.unwrap_or_else(|payload| {
                Err(format!("error: the compiler panicked, which is a bug: {}", panicked(payload)))
            });
            state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            state.done.push(Compiled { number, when, plan });
        }
    }
}
