//! `sync` and `rendezvous`: wait for another robot by the state link (paper, sections IV-A and IV-D).

use mdle_runtime::Interrupt;
use mdle_runtime::capability::StateLink;

/// Fires while the state link to the robot is up: while its newest state is fresh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sync(&'static str);

impl Sync {
    /// The quark `sync robot`.
    #[must_use]
    pub const fn new(robot: &'static str) -> Self {
        Self(robot)
    }
}

impl<Y: StateLink> Interrupt<Y> for Sync {
    fn fired(&self, y: &Y) -> bool {
        y.peer(self.0).is_some_and(|peer| peer.fresh().is_some())
    }
}

/// Fires once the robot has entered as many scopes with a `rendezvous` with this one as this one has with it
/// (docs/src/reference/semantics.md, 2.6). Neither loss nor delay can undo it, since both only count up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rendezvous(&'static str);

impl Rendezvous {
    /// The quark `rendezvous robot`.
    #[must_use]
    pub const fn new(robot: &'static str) -> Self {
        Self(robot)
    }
}

impl<Y: StateLink> Interrupt<Y> for Rendezvous {
    fn fired(&self, y: &Y) -> bool {
        y.peer(self.0).is_some_and(mdle_runtime::Peer::meets)
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Nanos, Peer, PeerState, Pose, Twist};

    use super::*;
    use crate::trial::Sensed;

    /// The output of a robot that has entered `own` rounds with `ada`, whose state has this age and the count `theirs`.
    fn linked(own: u64, age: u64, theirs: u64) -> Sensed {
        let state = PeerState { pose: Pose::ORIGIN, velocity: Twist::default(), age: Nanos(age), rounds: theirs };
        let mut y = Sensed::default();
        y.link(Peer { name: "ada", rounds: own, state: Some(state) });
        y
    }

    #[test]
    fn sync_fires_while_the_state_is_fresh() {
        let fired = |robot, y: &Sensed| Sync::new(robot).fired(y);
        assert!(fired("ada", &linked(0, 0, 0)) && fired("ada", &linked(0, 499_999_999, 0)));
        assert!(!fired("ada", &linked(0, 500_000_000, 0)) && !fired("bob", &linked(0, 0, 0)));
        assert!(!fired("ada", &Sensed::default()), "without a link there is no other robot");
    }

    #[test]
    fn rendezvous_fires_once_the_other_has_counted_as_far() {
        let fired = |own, age, theirs| Rendezvous::new("ada").fired(&linked(own, age, theirs));
        assert_eq!(
            [(1, 0), (1, 1), (1, 2), (2, 1)].map(|(own, theirs)| fired(own, 0, theirs)),
            [false, true, true, false]
        );
        assert!(fired(1, 9_000_000_000, 1), "a count does not age");
        assert!(!Rendezvous::new("bob").fired(&linked(1, 0, 1)) && !Rendezvous::new("ada").fired(&Sensed::default()));
    }
}
