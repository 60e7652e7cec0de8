//! The recorder of paths: the path that a robot drives under some laws becomes a path that the plan replays.

use mdle_runtime::StoredPath;

/// Records the path driven under some laws, and replaces a path of the robot by it.
pub trait Recorder<Y>: Send {
    /// Writes the recorded path into the output of a turn.
    fn complete(&self, y: &mut Y);

    /// Returns the path that was recorded since the last call in place of an earlier path of its name; `None` if no
    /// path was.
    fn take_replaced(&mut self) -> Option<StoredPath>;

    /// Takes a turn with output `y`. `law` is the text of the law that runs after the turn, `None` if no law does;
    /// `has_changed` is `true` if the plan made transitions. Returns a message for the operator if there is one.
    fn turn(&mut self, y: &Y, law: Option<&str>, has_changed: bool) -> Option<String>;
}
