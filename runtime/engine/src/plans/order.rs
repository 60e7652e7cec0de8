//! Orders to the compiler, with their sources and outcomes.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;

use mdle_compiler::load::LoadedPlan;

use super::{EngineAlphabet, StoredPlan, When};
use crate::module::panicked;

/// Source of the text of plans.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PlanSource {
    /// A file, given by its path.
    File(PathBuf),
    /// Text that a user has typed.
    Text(String),
    /// Text that another robot has sent.
    Peer {
        /// Name of the robot.
        robot: String,
        /// Text of the plan.
        text: String,
    },
}

/// Result of compiling a text: plans and warnings.
pub struct CompiledPlans<A: EngineAlphabet> {
    /// Plans of the text that no other plan of the text uses.
    pub plans: Vec<StoredPlan<A>>,
    /// Warnings in readable form; empty if there are no warnings.
    pub warnings: String,
}

/// A function that compiles and loads the plans in a source text.
///
/// # Errors
/// Fails with the diagnostics as text for people.
pub type Compile<A> = dyn Fn(&PlanSource) -> Result<CompiledPlans<A>, String> + Send;

/// A request that takes longer than a turn allows.
pub(crate) struct Order<A: EngineAlphabet> {
    pub(crate) ticket: u32,
    pub(crate) task: SlowTask<A>,
}

pub(crate) enum SlowTask<A: EngineAlphabet> {
    /// Compile plans, and store them unless another robot has sent them. If a moment is given, the plan takes over at
    /// that moment; the text must then contain exactly one plan.
    Compile(PlanSource, Option<When>),
    /// Prepare a stored plan to take over at this moment.
    Begin(StoredPlan<A>, When),
}

/// Result of an order.
pub(crate) struct Outcome<A: EngineAlphabet> {
    pub(crate) ticket: u32,
    /// The resulting plans, or the diagnostics as text for people.
    pub(crate) product: Result<Product<A>, String>,
}

/// Plans that result from an order.
pub(crate) struct Product<A: EngineAlphabet> {
    /// Plans to be stored, and their warnings.
    pub(crate) compiled: CompiledPlans<A>,
    /// The plan that takes over; `None` if no plan takes over. It has not made a turn yet.
    pub(crate) next: Option<NextPlan<A>>,
}

/// A plan that takes over and has not made a turn yet.
pub(crate) struct NextPlan<A: EngineAlphabet> {
    pub(crate) plan: LoadedPlan<A>,
    /// Name and text of each file of the plan, the plan's own file first.
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

impl<A: EngineAlphabet> NextPlan<A> {
    fn of(plan: &StoredPlan<A>, when: When) -> Self {
        Self { plan: plan.loaded.plan(), files: Arc::clone(&plan.files), when }
    }
}

impl<A: EngineAlphabet> SlowTask<A> {
    /// Returns `true` if another robot has sent the plan.
    pub(crate) fn is_sent(&self) -> bool {
        matches!(self, Self::Compile(PlanSource::Peer { .. }, _))
    }

    /// Returns `true` if the order contains a plan that takes over.
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
                    (Some(when), [only]) => Some(NextPlan::of(only, when)),
                    (Some(_), plans) => {
                        let names = plans.iter().map(|plan| &*plan.name).collect::<Vec<_>>().join(", ");
                        return Err(format!("the text has several plans, and one of them can drive: {names}"));
                    }
                };
                // Plans of other robots are not stored: only the operator could delete them.
                if matches!(source, PlanSource::Peer { .. }) {
                    compiled.plans.clear();
                }
                Ok(Product { compiled, next })
            }
            Self::Begin(plan, when) => {
                let compiled = CompiledPlans { plans: Vec::new(), warnings: String::new() };
                Ok(Product { compiled, next: Some(NextPlan::of(&plan, when)) })
            }
        }
    }
}
