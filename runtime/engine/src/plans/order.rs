//! Orders to the compiler: the texts and plans that they are about, and their outcomes.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;

use mdle_compiler::load::LoadedPlan;

use super::{EngineAlphabet, StoredPlan, When};
use crate::module::panicked;

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
    /// Compile plans, which are then stored unless another robot has sent them. If a moment is given, the plan takes
    /// over at that moment; the text must then have only one plan.
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

/// The plans that result from an order.
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

impl<A: EngineAlphabet> Order<A> {
    pub(crate) fn carry_out(self, compile: &Compile<A>) -> Outcome<A> {
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
    /// Returns `true` if another robot has sent the plan.
    pub(crate) fn is_sent(&self) -> bool {
        matches!(self, Self::Compile(PlanSource::Peer { .. }, _))
    }

    /// Returns `true` if the order is for a plan to take over.
    pub(crate) fn takes_over(&self) -> bool {
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
