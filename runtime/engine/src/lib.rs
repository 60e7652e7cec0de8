//! The Modular Engine (paper, section III), which runs modules and plans together in the turns of a robot.
//!
//! A module implements [`Module`] or [`Background`], and declares the attributes that it publishes and reads with
//! [`Declare`].
#![forbid(unsafe_code)]

mod attribute;
mod board;
mod engine;
mod fork;
mod library;
pub mod link;
mod module;
mod plans;
mod process;
mod recorder;
mod replay;
pub mod safety;
pub mod shell;
#[cfg(test)]
mod tests;
pub mod tree;

pub use attribute::{Attribute, AttributeKind, AttributeName, In, Out, Reading, Value};
pub use board::{Board, Post};
pub use engine::{Arrivals, End, Engine, Event, HoldEffect, ModuleState, Modules, Service};
pub use fork::Threads;
pub use library::Library;
pub use module::{
    About, Background, Candidate, Declare, Exchange, Fault, Module, Offer, PLAN, Refusal, Relevance, Stopped, Turn,
};
pub use plans::{
    Compile, CompiledPlans, EngineAlphabet, MOST_STORED, NoTrial, PlanEvent, PlanFacts, PlanSource, Plans, StoredPlan,
    TRIAL, When,
};
pub use recorder::Recorder;
