//! Runs that are made again from their record: a [`History`] notes what an engine needs for that besides the robot's
//! outputs, and an engine repeats these changes without modules, threads and people.

mod history;
mod repeats;

pub(crate) use history::History;
pub(crate) use repeats::Repeats;
