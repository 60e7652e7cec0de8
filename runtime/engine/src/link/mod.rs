//! The state link: robots tell each other their poses, velocities and rounds (paper, sections III and IV-D).
//!
//! A [`Link`] carries states: [`Air`] between robots of one process, [`Tcp`] between processes and machines.
//! [`StateLink`] is the module of one robot: before a turn it writes the states that have arrived into the
//! output, and after the turn it sends the robot's own state. It never waits.

mod air;
mod frame;
mod rounds;
mod state;
mod tcp;

use mdle_host::Transitions;
use mdle_runtime::{Links, Machine, Meters, Nanos, Output, Peer, PeerState, Plan, Pose, Radians};

pub use air::{Air, Faults};
use rounds::Rounds;
pub use state::State;
pub use tcp::{Tcp, TcpSettings};

/// A medium by which a robot sends its states to other robots, and receives theirs.
pub trait Link: Send {
    /// Sends the robot's state at time `now`, without waiting.
    fn send(&mut self, state: &State, now: Nanos);
    /// Calls `take` with each state that has arrived by `now`, in any order.
    fn receive(&mut self, now: Nanos, take: &mut dyn FnMut(State));
    /// Calls `say` with each message for the operator since the last call.
    fn messages(&mut self, _say: &mut dyn FnMut(&str)) {}
}

/// The state link of one robot.
pub struct StateLink {
    link: Box<dyn Link>,
    name: String,
    /// Pose at which the robot's odometry began, in the axes that all robots share.
    start: Pose,
    /// Number of the state that was sent last.
    sent: u64,
    /// The newest state of each other robot, with the time at which it arrived.
    known: Vec<(State, Nanos)>,
    rounds: Rounds,
}

impl StateLink {
    /// Returns the link of the robot of this name, whose odometry begins at `start` in the axes that all robots share.
    #[must_use]
    pub fn new(link: Box<dyn Link>, name: &str, start: Pose) -> Self {
        Self { link, name: name.to_owned(), start, sent: 0, known: Vec::new(), rounds: Rounds::default() }
    }

    /// Returns what is known of the robots of these names in the turn at time `now`.
    pub(crate) fn sense(&mut self, robots: impl Iterator<Item = &'static str>, now: Nanos) -> Links {
        let Self { link, known, name, .. } = self;
        link.receive(now, &mut |state| match known.iter_mut().find(|(old, _)| old.name == state.name) {
            // What was sent later counts, in whatever order it arrives.
            Some(place) if place.0.number < state.number => *place = (state, now),
            Some(_) => {}
            None if state.name == *name => {}
            None => known.push((state, now)),
        });
        let mut links = Links::NONE;
        for name in robots {
            if links.peer(name).is_none() {
                links.add(self.peer(name, now));
            }
        }
        links
    }

    /// Sends the state of the robot after a turn of its plan at time `now`.
    pub(crate) fn tell<P: Plan>(
        &mut self,
        y: &P::Output,
        plan: Option<(u64, &Machine<P>)>,
        transitions: &Transitions,
        now: Nanos,
    ) {
        if let Some((number, machine)) = plan {
            self.rounds.turn(number, machine.plan(), transitions);
        }
        self.sent = self.sent.saturating_add(1);
        let state = State {
            name: self.name.clone(),
            number: self.sent,
            pose: outward(&self.start, &y.here()),
            velocity: y.velocities(),
            rounds: self.rounds.counts().map(|(robot, count)| (robot.to_owned(), count)).collect(),
            atom: plan.map_or(0, |(_, machine)| machine.atom().map_or(PeerState::OVER, |atom| u64::from(atom) + 1)),
        };
        self.link.send(&state, now);
    }

    /// Calls `say` with each message for the operator since the last call.
    pub(crate) fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        self.link.messages(say);
    }

    /// Returns the known state of the robot of this name.
    fn peer(&self, robot: &'static str, now: Nanos) -> Peer {
        let known = self.known.iter().find(|(state, _)| state.name == robot);
        let state = known.map(|(state, at)| PeerState {
            pose: inward(&self.start, &state.pose),
            velocity: state.velocity,
            age: now.since(*at),
            rounds: state.rounds_with(&self.name),
            atom: state.atom,
        });
        Peer { name: robot, rounds: self.rounds.with(robot), state }
    }
}

/// Converts a pose of the robot's own odometry to the axes that all robots share.
fn outward(start: &Pose, own: &Pose) -> Pose {
    let (sin, cos) = (libm::sin(start.theta.0), libm::cos(start.theta.0));
    let (x, y) = (own.x.0, own.y.0);
    Pose {
        x: Meters(start.x.0 + cos * x - sin * y),
        y: Meters(start.y.0 + sin * x + cos * y),
        theta: Radians(start.theta.0 + own.theta.0).wrapped(),
    }
}

/// Converts a pose in the shared axes to those of the robot's own odometry.
fn inward(start: &Pose, shared: &Pose) -> Pose {
    let (sin, cos) = (libm::sin(start.theta.0), libm::cos(start.theta.0));
    let (x, y) = (shared.x.0 - start.x.0, shared.y.0 - start.y.0);
    Pose {
        x: Meters(cos * x + sin * y),
        y: Meters(cos * y - sin * x),
        theta: Radians(shared.theta.0 - start.theta.0).wrapped(),
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::Twist;

    use super::*;

    fn pose(x: f64, y: f64, degrees: f64) -> Pose {
        Pose { x: Meters(x), y: Meters(y), theta: Radians::from_degrees(degrees) }
    }

    #[test]
    fn poses_go_to_the_shared_axes_and_back() {
        let start = pose(2.0, 1.0, 90.0);
        let shared = outward(&start, &pose(3.0, 0.5, 45.0));
        let near =
            |one: &Pose, other: &Pose| one.distance(other).0 < 1e-12 && (one.theta.0 - other.theta.0).abs() < 1e-12;
        assert!(near(&shared, &pose(1.5, 4.0, 135.0)), "{shared:?}");
        assert!(near(&inward(&start, &shared), &pose(3.0, 0.5, 45.0)));
    }

    /// A link on which states arrive in this order, one at a time.
    struct Script(Vec<State>);

    impl Link for Script {
        fn send(&mut self, _: &State, _: Nanos) {}

        fn receive(&mut self, _: Nanos, take: &mut dyn FnMut(State)) {
            if !self.0.is_empty() {
                take(self.0.remove(0));
            }
        }
    }

    #[test]
    fn the_newest_state_counts_and_its_age_begins_when_it_arrives() {
        let state = |number, x| State {
            name: "ada".to_owned(),
            number,
            pose: pose(x, 0.0, 0.0),
            velocity: Twist::default(),
            rounds: vec![("bob".to_owned(), number)],
            atom: number,
        };
        let own = State { name: "bob".to_owned(), ..state(9, 9.0) };
        let script = Script(vec![own, state(2, 2.0), state(1, 1.0), state(3, 3.0)]);
        let mut link = StateLink::new(Box::new(script), "bob", pose(1.0, 0.0, 0.0));
        let mut seen = Vec::new();
        for turn in 0..5 {
            let links = link.sense(["ada"].into_iter(), Nanos(turn));
            let peer = *links.peer("ada").unwrap();
            seen.push(peer.state.map(|state| (state.pose.x.0, state.age.0, state.rounds, state.atom)));
        }
        assert_eq!(
            seen,
            [None, Some((1.0, 0, 2, 2)), Some((1.0, 1, 2, 2)), Some((2.0, 0, 3, 3)), Some((2.0, 1, 3, 3))]
        );
    }
}
