//! Runs that are repeated from their record. A [`History`] collects the data that an engine needs for this in
//! addition to the robot's outputs; an engine then repeats these changes without modules, threads or people.

mod history;
mod repeats;

pub(crate) use history::History;
pub(crate) use repeats::Repeats;
