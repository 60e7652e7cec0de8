//! The state that a robot sends each turn.

use std::sync::Arc;

use mdle_runtime::{Nanos, Pose, Twist};

use crate::attribute::{AttributeName, Value};

/// State of a robot after a turn.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Name of the robot.
    pub name: String,
    /// Session of the robot: a random number for its run, 0 if all robots run in one process.
    pub session: u64,
    /// Number of the state, from 1: of two states of a session, the one with the higher number was sent later.
    pub number: u64,
    /// Age of the state when it is received, without the minimum transmission time of its source, which is not known.
    pub age: Nanos,
    /// Pose by odometry, in the axes that all robots share.
    pub pose: Pose,
    /// Measured velocities.
    pub velocity: Twist,
    /// For each other robot, the number of scopes that the robot's plan has entered and that have a `rendezvous` with
    /// the other robot.
    pub rounds: Vec<(String, u64)>,
    /// Number of the atom that the robot's plan runs, as in [`PeerState::atom`](mdle_runtime::PeerState::atom).
    pub atom: u64,
    /// Values of the attributes that the robot shares.
    pub attributes: Vec<SharedValue>,
}

/// Value of an attribute that a robot shares with other robots.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedValue {
    /// Name of the attribute on the robot that publishes it.
    pub name: AttributeName,
    /// The value, of a kind that plans read as a number.
    pub value: Value,
    /// Age of the value when the state was measured.
    pub age: Nanos,
}

impl SharedValue {
    /// Returns the name that the attribute has on other robots, where the name of its module is preceded by the name of
    /// the robot that shares it.
    #[must_use]
    pub fn name_from(&self, robot: &str) -> AttributeName {
        let AttributeName { module, attribute } = &self.name;
        AttributeName { module: format!("{robot}_{module}").into(), attribute: Arc::clone(attribute) }
    }
}

impl State {
    /// Returns a state of the robot of this name, at the origin.
    #[cfg(test)]
    pub(crate) fn of(name: &str, number: u64) -> Self {
        Self {
            name: name.to_owned(),
            session: 5,
            number,
            age: Nanos::ZERO,
            pose: Pose::ORIGIN,
            velocity: Twist::default(),
            rounds: Vec::new(),
            atom: 1,
            attributes: Vec::new(),
        }
    }

    /// Returns `true` if this state is newer than `known`, a state of the same robot that arrived before.
    pub(super) fn replaces(&self, known: &Self) -> bool {
        // A program that was started again counts from 1.
        self.session != known.session || self.number > known.number
    }

    /// Returns the number of scopes that the plan has entered and that have a `rendezvous` with the robot `robot`.
    #[must_use]
    pub fn rounds_with(&self, robot: &str) -> u64 {
        self.rounds.iter().find(|(name, _)| name == robot).map_or(0, |(_, count)| *count)
    }
}
