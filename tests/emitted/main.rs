//! Tests of the Rust that `mdlec` writes: its text, names and bindings.

mod bind;
mod names;
mod text;
