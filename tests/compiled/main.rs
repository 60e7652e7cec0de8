//! Tests packages that contain plans: Rust that `mdlec` writes compiles and behaves like the plan, and cargo builds it
//! anywhere.

mod bare;
mod cache;
mod cargo_configuration;
mod embed;
mod engine_executables;
mod machines;
mod own_module;
mod own_target;
mod random_runs;
mod scenario_executables;
