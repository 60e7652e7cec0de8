//! The motion commands that an emulated robot has received: what a test asks for when a run is over.

use std::collections::VecDeque;
use std::time::Duration;

/// Maximum number of orders that are kept.
const KEPT: usize = 64;

/// The meaning of a motion command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Order to move.
    Drive,
    /// Order to stop.
    Stand,
    /// Order to switch off the motors' current.
    LetGo,
    /// Order to set the brake.
    Brake,
}

/// The orders that have arrived, the oldest first, each with the age of the robot's world. The last 64 are kept.
#[derive(Debug, Clone, Default)]
pub struct Orders(VecDeque<(Duration, Order)>);

impl Orders {
    /// Records an order that has arrived at this age.
    pub fn push(&mut self, age: Duration, order: Order) {
        if self.0.len() >= KEPT {
            self.0.pop_front();
        }
        self.0.push_back((age, order));
    }

    /// Returns the orders that are kept.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (Duration, Order)> {
        self.0.iter().copied()
    }

    /// Returns the last order, and the age at which it arrived.
    #[must_use]
    pub fn last(&self) -> Option<(Duration, Order)> {
        self.0.back().copied()
    }
}
