//! The state that a robot sends each turn.

use mdle_runtime::{Pose, Twist};

/// State of a robot after a turn.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Name of the robot.
    pub name: String,
    /// Number of the state, from 1: a state with a higher number was sent later.
    pub number: u64,
    /// Pose by odometry, in the axes that all robots share.
    pub pose: Pose,
    /// Measured velocities.
    pub velocity: Twist,
    /// Number of scopes with a `rendezvous` with each other robot that the robot's plan has entered.
    pub rounds: Vec<(String, u64)>,
    /// Number of the atom that the robot's plan runs, as in [`PeerState::atom`](mdle_runtime::PeerState::atom).
    pub atom: u64,
}

impl State {
    /// Returns the number of entered scopes with a `rendezvous` with this robot.
    #[must_use]
    pub fn rounds_with(&self, robot: &str) -> u64 {
        self.rounds.iter().find(|(name, _)| name == robot).map_or(0, |(_, count)| *count)
    }
}
