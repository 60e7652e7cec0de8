//! Compiles plans on a separate thread while turns continue. Carries out one order at a time; orders of the operator
//! come first.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use super::EngineAlphabet;
use super::order::{Compile, Order, Outcome};

/// Maximum number of the operator's orders that wait for the compiler.
const WAITING: usize = 16;

/// The compiler of an engine.
pub(crate) enum Compiler<A: EngineAlphabet> {
    /// A separate thread, which ends when this value is dropped.
    Thread(CompilerThread<A>),
    /// Carries out each order immediately, so that runs with the same inputs are equal. Contains the function that
    /// compiles, and the outcomes of finished orders.
    AtOnce(Box<Compile<A>>, VecDeque<Outcome<A>>),
}

/// Orders to replace the plan that were waiting for the compiler: one from the operator, and one from another robot.
type WaitingOrders<A> = [Option<Order<A>>; 2];

/// The compiler's thread, which ends when this value is dropped.
pub(crate) struct CompilerThread<A: EngineAlphabet>(Arc<Counter<A>>);

/// Data that the control thread and the compiler's thread share.
struct Counter<A: EngineAlphabet> {
    state: Mutex<CompilerState<A>>,
    changed: Condvar,
}

struct CompilerState<A: EngineAlphabet> {
    /// Orders of the operator that wait.
    waiting: VecDeque<Order<A>>,
    /// Newest order of another robot. The compiler carries it out after all orders of the operator.
    sent: Option<Order<A>>,
    done: VecDeque<Outcome<A>>,
    quits: bool,
}

impl<A: EngineAlphabet> Compiler<A> {
    /// Passes an order to the compiler. An order to replace the plan cancels and returns earlier orders of this type
    /// that still wait. However, an order of another robot does not cancel an order of the operator.
    ///
    /// # Errors
    /// Fails with a sentence if too many orders wait.
    pub(crate) fn order(&mut self, order: Order<A>) -> Result<WaitingOrders<A>, String> {
        match self {
            Self::Thread(thread) => thread.order(order),
            Self::AtOnce(compile, done) => {
                done.push_back(order.carry_out(compile));
                Ok([None, None])
            }
        }
    }

    /// Removes and returns all waiting orders that contain a plan to take over.
    pub(crate) fn take_back(&self) -> WaitingOrders<A> {
        match self {
            Self::Thread(thread) => thread.0.lock().take_back(),
            Self::AtOnce(..) => [None, None],
        }
    }

    /// Removes and returns the waiting order of another robot; `None` if no such order waits.
    pub(crate) fn take_back_sent(&self) -> Option<Order<A>> {
        match self {
            Self::Thread(thread) => thread.0.lock().sent.take(),
            Self::AtOnce(..) => None,
        }
    }

    /// Returns the outcome of the next finished order; `None` if no order is finished. Never waits.
    pub(crate) fn done(&mut self) -> Option<Outcome<A>> {
        match self {
            Self::Thread(thread) => thread.done(),
            Self::AtOnce(_, done) => done.pop_front(),
        }
    }
}

impl<A: EngineAlphabet> CompilerThread<A> {
    /// Starts the thread.
    ///
    /// # Errors
    /// Fails if the system cannot create the thread.
    pub(crate) fn new(compile: Box<Compile<A>>) -> io::Result<Self> {
        let state = CompilerState { waiting: VecDeque::new(), sent: None, done: VecDeque::new(), quits: false };
        let counter = Arc::new(Counter { state: Mutex::new(state), changed: Condvar::new() });
        let own = Arc::clone(&counter);
        thread::Builder::new().name("mdle compiler".to_owned()).spawn(move || own.serve(&compile))?;
        Ok(Self(counter))
    }

    fn order(&self, order: Order<A>) -> Result<WaitingOrders<A>, String> {
        let mut state = self.0.lock();
        let superseded = if order.task.is_sent() {
            [state.sent.replace(order), None]
        } else {
            let takes_over = order.task.takes_over();
            let own = if takes_over { state.take_back_own() } else { None };
            if state.waiting.len() >= WAITING {
                return Err(format!("{WAITING} requests wait for the compiler already: try again later"));
            }
            state.waiting.push_back(order);
            [own, state.sent.take_if(|_| takes_over)]
        };
        self.0.changed.notify_all();
        Ok(superseded)
    }

    fn done(&self) -> Option<Outcome<A>> {
        self.0.state.try_lock().ok()?.done.pop_front()
    }
}

impl<A: EngineAlphabet> Drop for CompilerThread<A> {
    fn drop(&mut self) {
        self.0.lock().quits = true;
        self.0.changed.notify_all();
    }
}

impl<A: EngineAlphabet> CompilerState<A> {
    fn take_back(&mut self) -> WaitingOrders<A> {
        [self.take_back_own(), self.sent.take()]
    }

    /// Removes and returns the operator's waiting order to replace the plan; `None` if no such order waits.
    fn take_back_own(&mut self) -> Option<Order<A>> {
        let place = self.waiting.iter().position(|order| order.task.takes_over())?;
        self.waiting.remove(place)
    }
}

impl<A: EngineAlphabet> Counter<A> {
    fn lock(&self) -> MutexGuard<'_, CompilerState<A>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Carries out orders until the compiler has to quit.
    fn serve(&self, compile: &Compile<A>) {
        let mut state = self.lock();
        loop {
            if state.quits {
                return;
            }
            let Some(order) = state.waiting.pop_front().or_else(|| state.sent.take()) else {
                state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            drop(state);
            let outcome = order.carry_out(compile);
            state = self.lock();
            state.done.push_back(outcome);
        }
    }
}
