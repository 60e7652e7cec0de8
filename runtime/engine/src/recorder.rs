//! The path recorder: records a path that the robot drives, so that the plan can replay it later.

use mdle_runtime::StoredPath;

/// Records the path driven under certain laws, and replaces a path of the robot with it.
pub trait Recorder<Y>: Send {
    /// Adds the recorded path to the output of a turn.
    fn complete(&self, y: &mut Y);

    /// Returns the newly recorded path if it has replaced a path with the same name since the last call; `None`
    /// otherwise.
    fn take_replaced(&mut self) -> Option<StoredPath>;

    /// Processes a turn with output `y`. `law` is the text of the law that runs after the turn; `None` if no law runs.
    /// `has_changed` is `true` if the plan made transitions in the turn. May return a message for the operator.
    fn turn(&mut self, y: &Y, law: Option<&str>, has_changed: bool) -> Option<String>;
}
