//! Interface of a robot, which is a kinetic state machine (paper, Eq. 1: an output `y` for an input `u`).

use core::time::Duration;

use crate::{Links, Nanometers, Nanos, Pose, Published, Twist};

/// A robot, which takes an input, returns the output that follows, and can be stopped.
///
/// Once an `exchange` has failed, the robot is stopped and not used again. An implementation must leave the hardware's
/// own watchdog armed, so that the robot also stops when the program dies.
pub trait Robot {
    /// Output `y` of the sensors, which includes all values that this robot's quarks read.
    type Output: Output;
    /// Input `u` of the actuators; its default is the null input.
    type Input: Default;
    /// Reason why an exchange failed, as a sentence for the operator.
    type Error: core::fmt::Display;

    /// Applies `input` for one period and returns the output that follows.
    ///
    /// # Errors
    /// Fails if the robot does not answer, answers nonsense, or reports that it cannot move.
    fn exchange(&mut self, input: &Self::Input) -> Result<Self::Output, Self::Error>;

    /// Stops the robot with its own stop command. Called at the end of every run, for whatever reason the run ends.
    ///
    /// # Errors
    /// Fails if the command could not be delivered; the hardware's watchdog then stops the robot.
    fn stop(&mut self) -> Result<(), Self::Error>;

    /// Returns the maximum wall-clock time without a command after which the robot may still be driven: the timeout of
    /// the robot's own watchdog, or the time for which its data stay fresh. After a longer gap, for example when the
    /// program was suspended, the run ends with a fault before a command is sent. `None` means two seconds more than
    /// the period. Simulated time has no gaps.
    fn longest_gap(&self) -> Option<Duration> {
        None
    }
}

/// The part of the output that all robots have in common. The traits of [`crate::capability`] add the rest.
pub trait Output {
    /// Returns the pose by odometry; the origin on a robot without odometry. The heading of this pose determines the
    /// frame of a plan that begins now.
    fn here(&self) -> Pose {
        Pose::ORIGIN
    }

    /// Returns the reading of an odometer that measures the length of the path driven; `None` on a robot without an
    /// odometer. Without an odometer, the machine adds up the distances between [`Output::here`] of successive turns.
    fn way(&self) -> Option<Nanometers> {
        None
    }

    /// Stores the numbers that modules have published for the plan. An engine calls this function before each turn; an
    /// output whose quarks read no modules ignores the numbers.
    fn take_published(&mut self, _published: Published) {}

    /// Stores the states of other robots from the state link. An engine calls this function before each turn; an output
    /// whose quarks name no robots ignores them.
    fn take_links(&mut self, _links: Links) {}

    /// Returns the velocities of the robot, which the state link sends to other robots; zero on a robot that
    /// does not measure them.
    fn velocities(&self) -> Twist {
        Twist::default()
    }

    /// Returns the age of the oldest number of a module that the plan or a safety rule reads; zero if they read none.
    fn oldest_published(&self) -> Nanos {
        Nanos::ZERO
    }

    /// Returns the age of the measurements in this output: the time since the last exchange that brought new
    /// measurements; zero if this exchange brought new ones.
    fn data_age(&self) -> Nanos {
        Nanos::ZERO
    }
}
