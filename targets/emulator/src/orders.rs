//! Motion commands that an emulated robot has received. Tests check them after a run.

use std::collections::VecDeque;
use std::time::Duration;

/// Maximum number of stored orders.
const KEPT: usize = 64;

/// Kind of a motion command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionOrder {
    /// The command makes the robot move.
    Drive,
    /// The command stops the robot.
    Stand,
    /// The command switches off the motors' current.
    LetGo,
    /// The command sets the brake.
    Brake,
}

/// The last 64 orders that the robot has received, oldest first. Each has the world time at which it arrived.
#[derive(Debug, Clone, Default)]
pub struct OrderLog(VecDeque<(Duration, MotionOrder)>);

impl OrderLog {
    /// Stores an order; `age` is the world time at which it arrived.
    pub fn push(&mut self, age: Duration, order: MotionOrder) {
        if self.0.len() >= KEPT {
            self.0.pop_front();
        }
        self.0.push_back((age, order));
    }

    /// Returns the stored orders, oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (Duration, MotionOrder)> {
        self.0.iter().copied()
    }

    /// Returns the last order and the world time at which it arrived; `None` before the first order.
    #[must_use]
    pub fn last(&self) -> Option<(Duration, MotionOrder)> {
        self.0.back().copied()
    }
}
