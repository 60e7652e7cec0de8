//! Editor features of MDLe, for the language server and for the playground in the browser.
//!
//! A feature is a function that receives a checked document as a [`View`](view::View), and returns a result with byte
//! ranges. It does no I/O, and does not depend on a protocol or an operating system.
#![forbid(unsafe_code)]

mod brackets;
pub mod completion;
pub mod context;
pub mod diagnostics;
pub mod fixes;
pub mod formatting;
pub mod hints;
pub mod hover;
pub mod lenses;
pub mod lines;
pub mod mentions;
pub mod outline;
pub mod rename;
pub mod tokens;
pub mod view;
mod words;
