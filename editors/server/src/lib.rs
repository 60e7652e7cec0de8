//! What an editor shows of a plan: a feature is a function from a [`View`](view::View), a checked document, to an answer
//! in places of bytes.

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
