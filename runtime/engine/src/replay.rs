//! Replays recorded runs. A [`History`] collects the data that an engine needs for a replay in addition to the robot's
//! outputs; an engine then repeats these changes without modules, threads or users.

mod history;
mod repeats;

pub(crate) use history::History;
pub(crate) use repeats::Repeats;
