//! Reads plan files, the files that they use, and the alphabets of targets, for the stages of [`mdle_compiler`].
//!
//! This crate prints nothing. Errors are returned as an [`InputError`], whose message contains the correction.
#![allow(clippy::disallowed_methods, reason = "what is done here is I/O")]

mod error;
mod input;
pub mod read;
mod settings;
mod target;
mod text;
mod unsaved;

pub use error::{FaultyFile, InputError, Spelling};
pub use input::{Input, RobotGroup, add, plan, read_plan};
pub use settings::{KnownSettings, NamedProcess, RunOption, SafetyEntry, Settings, file_beside};
pub use target::{Target, alphabet, bound, out_of_date, target};
pub use text::{read_text, without_mark};
pub use unsaved::{Unsaved, normal, place};
