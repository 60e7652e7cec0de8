//! The Modular Engine (section III of the paper), in which modules and plans make a robot's turns together.
//!
//! To implement a module: [`Module`] or [`Background`], and [`Declare`], which declares the attributes that the
//! module publishes and reads.
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
    Compile, CompiledPlans, EngineAlphabet, MOST_STORED, NoTrial, PlanEvent, PlanSource, Plans, StoredPlan, TRIAL, When,
};
pub use recorder::Recorder;
