//! The interrupts that observe another robot over the state link: `sync` and `rendezvous` (paper, sections IV-A and
//! IV-D), and `past`.

use mdle_runtime::Interrupt;
use mdle_runtime::capability::StateLink;

/// The interrupt `sync`, which fires while the newest state of the robot is fresh, that is, while the state link to
/// this robot is up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sync(&'static str);

impl Sync {
    /// Creates the quark `sync robot`.
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

/// The interrupt `rendezvous`. It fires once the other robot has entered at least as many scopes with a `rendezvous`
/// with this robot as this robot has entered with a `rendezvous` with the other (docs/src/reference/semantics.md, 2.6).
/// Lost or delayed messages cannot undo it, because both counts only increase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rendezvous(&'static str);

impl Rendezvous {
    /// Creates the quark `rendezvous robot`.
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

/// The interrupt `past`, which fires once the plan of another robot has reached an atom, counted from 1 in the order of
/// the plan's text: while that plan runs this atom or a later one, or has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Past {
    robot: &'static str,
    atom: u64,
}

impl Past {
    /// Creates the quark `past robot atom`.
    #[must_use]
    pub const fn new(robot: &'static str, atom: u64) -> Self {
        Self { robot, atom }
    }
}

impl<Y: StateLink> Interrupt<Y> for Past {
    fn fired(&self, y: &Y) -> bool {
        let state = y.peer(self.robot).and_then(|peer| peer.state);
        state.is_some_and(|state| state.atom >= self.atom)
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Nanos, Peer, PeerState, Pose, Twist};

    use super::*;
    use crate::trial::Sensed;

    /// Returns the output of a robot that has entered `own` rounds with the robot `ada`. The state of `ada` has this
    /// age and reports that `ada` has entered `theirs` rounds.
    fn linked(own: u64, age: u64, theirs: u64) -> Sensed {
        let state =
            PeerState { pose: Pose::ORIGIN, velocity: Twist::default(), age: Nanos(age), rounds: theirs, atom: 1 };
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
    fn past_fires_from_an_atom_on_and_after_the_plan() {
        let fired = |runs: u64, atom: u64| {
            let mut y = linked(0, 9_000_000_000, 0);
            let mut peer = *y.published.links().peer("ada").unwrap();
            peer.state = peer.state.map(|state| PeerState { atom: runs, ..state });
            y.published = y.published.with_links(mdle_runtime::Links::NONE);
            y.link(peer);
            Past::new("ada", atom).fired(&y)
        };
        assert_eq!([1, 2, 3, 4].map(|runs| fired(runs, 3)), [false, false, true, true]);
        assert!(
            fired(PeerState::OVER, 3) && !fired(0, 1),
            "an old state counts, and a plan that has not begun does not"
        );
        assert!(!Past::new("bob", 1).fired(&linked(0, 0, 0)) && !Past::new("ada", 1).fired(&Sensed::default()));
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
