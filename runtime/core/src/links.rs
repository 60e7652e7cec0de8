//! States of other robots that a robot receives by its state link, limited to the robots that its plan names (paper,
//! section IV-A).

use crate::{Nanos, Pose, Twist};

/// Maximum number of other robots that one plan names.
pub const PEERS: usize = 8;

/// Age at which the state of another robot is treated as stale, and the link to that robot as down.
pub const STALE: Nanos = Nanos(500_000_000);

/// The newest state of another robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeerState {
    /// Pose of the robot, in the receiver's own odometry coordinates.
    pub pose: Pose,
    /// Measured velocities of the robot.
    pub velocity: Twist,
    /// Time since the state arrived.
    pub age: Nanos,
    /// Number of times that the other robot has entered a scope with a `rendezvous` with the receiver.
    pub rounds: u64,
    /// Number of the atom that the robot's plan was running, counting from 1 in the order of the plan's text;
    /// [`PeerState::OVER`] if the plan was over, and 0 if it had not begun.
    pub atom: u64,
}

impl PeerState {
    /// Value of [`PeerState::atom`] once a plan is over.
    pub const OVER: u64 = u64::MAX;
}

/// Another robot that a plan names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peer {
    /// Name of the robot.
    pub name: &'static str,
    /// Number of times that the receiver had entered a scope with a `rendezvous` with this robot, by the end of the
    /// previous turn.
    pub rounds: u64,
    /// The newest state that has arrived; `None` before the first arrival.
    pub state: Option<PeerState>,
}

impl Peer {
    /// Returns the state of the robot while it is less than [`STALE`] old; `None` otherwise.
    #[must_use]
    pub fn fresh(&self) -> Option<&PeerState> {
        self.state.as_ref().filter(|state| state.age < STALE)
    }

    /// Returns `true` if the robot has entered scopes with a `rendezvous` at least as often as the receiver.
    #[must_use]
    pub fn meets(&self) -> bool {
        self.state.is_some_and(|state| state.rounds >= self.rounds)
    }
}

/// A scope of a plan whose interrupt has a `rendezvous` with another robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Meeting {
    /// Number of the scope's bracket.
    pub scope: u32,
    /// Name of the other robot.
    pub robot: &'static str,
}

/// The robots that a plan names, with their states from the state link; empty without a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Links([Option<Peer>; PEERS]);

impl Links {
    /// Links to no other robot.
    pub const NONE: Self = Self([None; PEERS]);

    /// Adds another robot; returns `false` if there are already [`PEERS`] robots.
    pub fn add(&mut self, peer: Peer) -> bool {
        let Some(place) = self.0.iter_mut().find(|place| place.is_none()) else { return false };
        *place = Some(peer);
        true
    }

    /// Returns the other robots.
    pub fn peers(&self) -> impl Iterator<Item = &Peer> {
        self.0.iter().flatten()
    }

    /// Returns the robot of this name; `None` if the plan names no such robot.
    #[must_use]
    pub fn peer(&self, name: &str) -> Option<&Peer> {
        self.peers().find(|peer| peer.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peer_is_found_by_its_name() {
        let mut links = Links::NONE;
        let peer = |name| Peer { name, rounds: 0, state: None };
        for name in ["a", "b", "c", "d", "e", "f", "g", "h"] {
            assert!(links.add(peer(name)));
        }
        assert!(!links.add(peer("i")), "there is no ninth place");
        assert_eq!(
            ["a", "h", "i", ""].map(|name| links.peer(name).map(|peer| peer.name)),
            [Some("a"), Some("h"), None, None]
        );
    }

    #[test]
    fn a_state_is_fresh_for_half_a_second_and_counts_for_ever() {
        let state =
            PeerState { pose: Pose::ORIGIN, velocity: Twist::default(), age: Nanos(499_999_999), rounds: 2, atom: 1 };
        let peer = |age, rounds| Peer { name: "a", rounds, state: Some(PeerState { age: Nanos(age), ..state }) };
        assert!(peer(499_999_999, 1).fresh().is_some() && peer(500_000_000, 1).fresh().is_none());
        assert_eq!([1, 2, 3].map(|rounds| peer(9_000_000_000, rounds).meets()), [true, true, false]);
        assert!(!Peer { name: "a", rounds: 0, state: None }.meets());
    }
}
