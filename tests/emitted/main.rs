//! Code and packages that `mdlec` writes: they compile, do what plans mean, and cargo builds them anywhere.

mod bare;
mod bind;
mod cache;
mod cargo_configuration;
mod embed;
mod machines;
mod names;
mod own_module;
mod own_target;
mod text;
