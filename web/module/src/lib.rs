//! The module that the playground loads into a browser. It contains the compiler, the language service and the
//! simulator, which a page uses through one function.
//!
//! A page sends a request as JSON and receives an answer as JSON, through the functions of [`page`]. The module imports
//! nothing: it has no clock, no files and no network, so the same request has the same answer everywhere.

mod ask;
mod causes;
mod course;
mod document;
mod draft;
mod editing;
mod export;
mod floor;
mod frame;
pub mod page;
mod plan;
mod robot;
mod run;
mod setup;
mod tools;
mod trial;
mod why;

pub use ask::PageSession;
