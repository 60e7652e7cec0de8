//! Tests of the state machines of plans: all interpreters agree, and so do files, pictures, the analysis and Theorem 1.

mod allocations;
mod analysis;
mod differential;
mod engine;
mod fsm_files;
mod golden;
mod loaded;
mod matrices;
mod operators_plans;
mod pictures;
mod scxml;
mod sent_plans;
mod theorem;
mod validation;
