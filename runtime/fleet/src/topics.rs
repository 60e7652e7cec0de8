//! Key expressions under which robots publish: `mdle/ROBOT/state`, and `mdle/ROBOT/letters/RECIPIENT`. A robot's name
//! contains no character with a special meaning in key expressions (docs/src/many_robots.md).

/// Returns the key under which the robot of this name publishes its state.
pub(crate) fn of_states(robot: &str) -> String {
    format!("mdle/{robot}/state")
}

/// Returns the key under which the robot `from` publishes its letters to the robot `to`.
pub(crate) fn of_letters(from: &str, to: &str) -> String {
    format!("mdle/{from}/letters/{to}")
}
