//! The state that a robot sends after each turn.

use std::sync::Arc;

use mdle_runtime::{Nanos, Pose, Twist};

use crate::attribute::{AttributeName, Value};

/// State of a robot after a turn.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Name of the robot.
    pub name: String,
    /// Session of the robot, which is a random number for its run; 0 if all robots run in one process.
    pub session: u64,
    /// Number of the state, counted from 1. Within a session, states with higher numbers were sent later.
    pub number: u64,
    /// Age of the state on arrival. The age does not include the minimum transmission time of the source, which is
    /// unknown.
    pub age: Nanos,
    /// Pose by odometry, in the coordinates that all robots share.
    pub pose: Pose,
    /// Measured velocities.
    pub velocity: Twist,
    /// For each other robot, the number of times that the plan has entered a scope with a `rendezvous` with that robot.
    pub rounds: Vec<(String, u64)>,
    /// Number of the atom that the robot's plan runs, as in [`PeerState::atom`](mdle_runtime::PeerState::atom).
    pub atom: u64,
    /// Values of the attributes that the robot shares.
    pub attributes: Vec<SharedValue>,
}

/// Value of an attribute that a robot shares with other robots.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedValue {
    /// Name of the attribute on the robot that shares it.
    pub name: AttributeName,
    /// Value of the attribute; its kind is one that plans can read as a number.
    pub value: Value,
    /// Age of the value at the time when the state was measured.
    pub age: Nanos,
}

impl SharedValue {
    /// Returns the name that the attribute has on other robots: there, the module's name is preceded by `robot`, the
    /// name of the robot that shares the attribute.
    #[must_use]
    pub fn name_from(&self, robot: &str) -> AttributeName {
        let AttributeName { module, attribute } = &self.name;
        AttributeName { module: format!("{robot}_{module}").into(), attribute: Arc::clone(attribute) }
    }
}

impl State {
    /// Returns a state of the robot `name` at the origin.
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

    /// Returns `true` if this state is newer than `known`, an earlier state of the same robot.
    pub(super) fn replaces(&self, known: &Self) -> bool {
        // A program that was restarted counts from 1 again.
        self.session != known.session || self.number > known.number
    }

    /// Returns the number of times that the plan has entered a scope with a `rendezvous` with the robot `robot`.
    #[must_use]
    pub fn rounds_with(&self, robot: &str) -> u64 {
        self.rounds.iter().find(|(name, _)| name == robot).map_or(0, |(_, count)| *count)
    }
}
