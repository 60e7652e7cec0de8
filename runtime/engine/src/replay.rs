//! Replays recorded runs. For a replay, an engine needs the robot's outputs and the changes that a [`History`] has
//! collected. The engine repeats these changes without modules, threads or users.

mod history;
mod repeats;

pub(crate) use history::History;
pub(crate) use repeats::Repeats;
