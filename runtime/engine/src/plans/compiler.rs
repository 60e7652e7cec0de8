//! The thread that compiles plans while turns are made, one order after the other.

use std::collections::VecDeque;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use mdle_compiler::load::LoadedPlan;

use super::{EngineAlphabet, StoredPlan, When};
use crate::module::panicked;

/// Maximum number of orders that wait for the compiler.
const WAITING: usize = 16;

/// Source of a text that contains plans.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PlanSource {
    /// A file, by its path.
    File(PathBuf),
    /// A typed text.
    Text(String),
    /// A text that another robot has sent.
    Peer {
        /// Name of the robot.
        robot: String,
        /// Text of the plan.
        text: String,
    },
}

/// The result of compiling a text: its plans and warnings.
pub struct CompiledPlans<A: EngineAlphabet> {
    /// The plans that no other plan of the text uses.
    pub plans: Vec<StoredPlan<A>>,
    /// Warnings as text for people; empty if there are none.
    pub warnings: String,
}

/// Compiles and loads the plans of a text.
///
/// # Errors
/// Fails with the diagnostics as text for people.
pub type Compile<A> = dyn Fn(&PlanSource) -> Result<CompiledPlans<A>, String> + Send;

/// A request that takes longer than a turn allows.
pub(crate) struct Order<A: EngineAlphabet> {
    pub(crate) ticket: u32,
    pub(crate) task: Task<A>,
}

pub(crate) enum Task<A: EngineAlphabet> {
    /// Compile plans, which are then stored, except those of another robot. If a moment is given, the plan takes over
    /// at that moment, provided that the text has only one plan.
    Compile(PlanSource, Option<When>),
    /// Prepare a stored plan to take over at this moment.
    Begin(StoredPlan<A>, When),
}

/// Result of an order.
pub(crate) struct Outcome<A: EngineAlphabet> {
    pub(crate) ticket: u32,
    /// The plans, or the diagnostics.
    pub(crate) product: Result<Product<A>, String>,
}

/// The plans that an order has made.
pub(crate) struct Product<A: EngineAlphabet> {
    /// Plans to be stored, and their warnings.
    pub(crate) compiled: CompiledPlans<A>,
    /// The plan that is to take over, before its first turn; `None` if none is.
    pub(crate) next: Option<Next<A>>,
}

/// A plan that is to take over, before its first turn.
pub(crate) struct Next<A: EngineAlphabet> {
    pub(crate) plan: LoadedPlan<A>,
    /// Names and texts of the plan's files, its own file first.
    pub(crate) files: Arc<[(String, String)]>,
    pub(crate) when: When,
}

/// The compiler of an engine.
pub(crate) enum Compiler<A: EngineAlphabet> {
    /// A thread, which ends when this value is dropped.
    Thread(CompilerThread<A>),
    /// A function that an order waits for, so that every run with the same inputs is the same; and the outcomes.
    AtOnce(Box<Compile<A>>, VecDeque<Outcome<A>>),
}

/// The compiler's thread, which ends when this value is dropped.
pub(crate) struct CompilerThread<A: EngineAlphabet>(Arc<Counter<A>>);

/// Meeting point of the control thread and the compiler.
struct Counter<A: EngineAlphabet> {
    state: Mutex<State<A>>,
    changed: Condvar,
}

struct State<A: EngineAlphabet> {
    waiting: VecDeque<Order<A>>,
    done: VecDeque<Outcome<A>>,
    quits: bool,
}

impl<A: EngineAlphabet> Compiler<A> {
    /// Gives an order. If a plan is to take over, an earlier order of this kind that still waits is cancelled
    /// and returned.
    ///
    /// # Errors
    /// Fails with a sentence if too many orders wait.
    pub(crate) fn order(&mut self, order: Order<A>) -> Result<Option<Order<A>>, String> {
        match self {
            Self::Thread(thread) => thread.order(order),
            Self::AtOnce(compile, done) => {
                done.push_back(order.carry_out(compile));
                Ok(None)
            }
        }
    }

    /// Takes back the waiting order for a plan to take over.
    pub(crate) fn take_back(&self) -> Option<Order<A>> {
        match self {
            Self::Thread(thread) => thread.0.lock().take_back(),
            Self::AtOnce(..) => None,
        }
    }

    /// Returns the outcome of the next order that was carried out; `None` if there is none. Never waits.
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
        let state = State { waiting: VecDeque::new(), done: VecDeque::new(), quits: false };
        let counter = Arc::new(Counter { state: Mutex::new(state), changed: Condvar::new() });
        let own = Arc::clone(&counter);
        thread::Builder::new().name("mdle compiler".to_owned()).spawn(move || own.serve(&compile))?;
        Ok(Self(counter))
    }

    fn order(&self, order: Order<A>) -> Result<Option<Order<A>>, String> {
        let mut state = self.0.lock();
        let superseded = if order.task.takes_over() { state.take_back() } else { None };
        if state.waiting.len() >= WAITING {
            return Err(format!("{WAITING} requests wait for the compiler already: try again later"));
        }
        state.waiting.push_back(order);
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

impl<A: EngineAlphabet> State<A> {
    fn take_back(&mut self) -> Option<Order<A>> {
        let place = self.waiting.iter().position(|order| order.task.takes_over())?;
        self.waiting.remove(place)
    }
}

impl<A: EngineAlphabet> Counter<A> {
    fn lock(&self) -> MutexGuard<'_, State<A>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Carries out orders until the compiler is to quit.
    fn serve(&self, compile: &Compile<A>) {
        let mut state = self.lock();
        loop {
            if state.quits {
                return;
            }
            let Some(order) = state.waiting.pop_front() else {
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

impl<A: EngineAlphabet> Order<A> {
    fn carry_out(self, compile: &Compile<A>) -> Outcome<A> {
        let Self { ticket, task } = self;
        let product = catch_unwind(AssertUnwindSafe(|| task.carry_out(compile)));
        let product = product
            .unwrap_or_else(|payload| Err(format!("the compiler panicked, which is a bug: {}", panicked(payload))));
        Outcome { ticket, product }
    }
}

impl<A: EngineAlphabet> Next<A> {
    fn of(plan: &StoredPlan<A>, when: When) -> Self {
        Self { plan: plan.loaded.plan(), files: Arc::clone(&plan.files), when }
    }
}

impl<A: EngineAlphabet> Task<A> {
    /// Returns `true` if the order is for a plan to take over.
    fn takes_over(&self) -> bool {
        match self {
            Self::Compile(_, when) => when.is_some(),
            Self::Begin(..) => true,
        }
    }

    fn carry_out(self, compile: &Compile<A>) -> Result<Product<A>, String> {
        match self {
            Self::Compile(source, when) => {
                let mut compiled = compile(&source)?;
                let next = match (when, compiled.plans.as_slice()) {
                    (None, _) => None,
                    (Some(when), [only]) => Some(Next::of(only, when)),
                    (Some(_), plans) => {
                        let names = plans.iter().map(|plan| &*plan.name).collect::<Vec<_>>().join(", ");
                        return Err(format!("the text has several plans, and one of them can drive: {names}"));
                    }
                };
                // Only the operator stores plans, who can delete them.
                if matches!(source, PlanSource::Peer { .. }) {
                    compiled.plans.clear();
                }
                Ok(Product { compiled, next })
            }
            Self::Begin(plan, when) => {
                let compiled = CompiledPlans { plans: Vec::new(), warnings: String::new() };
                Ok(Product { compiled, next: Some(Next::of(&plan, when)) })
            }
        }
    }
}
