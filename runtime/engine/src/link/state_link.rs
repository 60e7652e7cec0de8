//! The state link of one robot: collects the states of other robots, and sends the robot's own state.

use mdle_host::Transitions;
use mdle_runtime::{Links, Machine, Meters, ModuleRead, Nanos, Output, Peer, PeerState, Plan, Pose, Radians};

use super::foreign_names::ForeignNames;
use super::orders::PlanExchange;
use super::rounds::Rounds;
use super::state_frame::ATTRIBUTES;
use super::{Foreign, Link, SharedValue, State};
use crate::attribute::{AGE, Reading, Value};
use crate::board::Board;
use crate::plans::{EngineAlphabet, Plans, When};

/// The state link of one robot.
pub struct StateLink {
    link: Box<dyn Link>,
    name: String,
    /// Pose, in the coordinates that all robots share, at which the robot's odometry is zero.
    start: Pose,
    /// Number of the last state that was sent.
    sent: u64,
    /// The newest state of each other robot.
    known: Vec<NewestState>,
    rounds: Rounds,
    /// Modules whose attributes the robot shares. Each module is represented by an entry that reads its attribute
    /// `age`.
    shares: &'static [ModuleRead],
    /// Names of the attributes that other robots share.
    foreign: ForeignNames,
    orders: PlanExchange,
}

/// The newest state of another robot.
struct NewestState {
    state: State,
    /// Arrival time of the state.
    at: Nanos,
    /// `true` until the attributes of the state are on the board.
    is_new: bool,
}

impl StateLink {
    /// Creates the link of the robot `name`. Its odometry is zero at the pose `start`, in the coordinates that all
    /// robots share.
    #[must_use]
    pub fn new(link: Box<dyn Link>, name: &str, start: Pose) -> Self {
        Self {
            link,
            name: name.to_owned(),
            start,
            sent: 0,
            known: Vec::new(),
            rounds: Rounds::default(),
            shares: &[],
            foreign: ForeignNames::default(),
            orders: PlanExchange::of(name),
        }
    }

    /// Shares attributes of these modules with the other robots: all attributes that plans can read as numbers.
    #[must_use]
    pub fn sharing(self, modules: &[String]) -> Self {
        // Like the names of plans, the names exist as long as the program.
        let read = |module: &String| ModuleRead { module: module.clone().leak(), attribute: AGE, unit: None };
        let shares: Vec<_> = modules.iter().map(read).collect();
        Self { shares: shares.leak(), ..self }
    }

    /// Accepts plans as text from the robots `takes_from`, and permits sending plans to the robots `sends_to`.
    #[must_use]
    pub fn exchanging_plans(mut self, takes_from: Vec<String>, sends_to: Vec<String>) -> Self {
        (self.orders.takes_from, self.orders.sends_to) = (takes_from, sends_to);
        self
    }

    /// Returns the names of the robots to which plans can be sent.
    pub(crate) fn recipients(&self) -> &[String] {
        &self.orders.sends_to
    }

    /// Sends a plan to the robot `to`; `plan` contains the plan's name, its text, and the moment at which it takes
    /// over.
    ///
    /// # Errors
    /// Returns a sentence with the reason if the plan cannot be sent.
    pub(crate) fn send_plan(&mut self, to: &str, plan: (&str, &str, When), now: Nanos) -> Result<(), String> {
        self.orders.send(&mut *self.link, to, plan, now)
    }

    /// Starts to compile the plans that have arrived. Returns messages to the operator about refused plans and about
    /// answers of other robots.
    pub(crate) fn take_plans<A: EngineAlphabet>(&mut self, plans: &mut Plans<A>, now: Nanos) -> Vec<String> {
        self.orders.take(&mut *self.link, plans, now)
    }

    /// Answers the plans that have new events; returns messages to the operator about these plans.
    pub(crate) fn answer_plans<A: EngineAlphabet>(&mut self, plans: &mut Plans<A>, now: Nanos) -> Vec<String> {
        self.orders.decide(&mut *self.link, plans, now)
    }

    /// Returns the modules whose attributes the robot shares. Each module is represented by an entry that reads its
    /// attribute `age`.
    pub(crate) fn shares(&self) -> &'static [ModuleRead] {
        self.shares
    }

    /// Processes the states that have arrived by time `now`, and puts their attributes on the board. Returns a message
    /// for each refused attribute, but only once per attribute.
    pub(crate) fn receive(&mut self, now: Nanos, board: &mut dyn Foreign) -> Vec<String> {
        let Self { link, known, name, foreign, .. } = self;
        link.receive(now, &mut |state| match known.iter_mut().find(|known| known.state.name == state.name) {
            // The state that was sent last is kept, regardless of the order of arrival.
            Some(place) if state.replaces(&place.state) => *place = NewestState { state, at: now, is_new: true },
            Some(_) => {}
            None if state.name == *name => {}
            None => known.push(NewestState { state, at: now, is_new: true }),
        });
        let mut messages = Vec::new();
        for NewestState { state, at, .. } in known.iter().filter(|known| known.is_new) {
            foreign.put(state, *at, board, &mut |message| messages.push(message));
        }
        known.iter_mut().for_each(|known| known.is_new = false);
        messages
    }

    /// Returns the states of the robots with these names, as known in the turn at time `now`.
    pub(crate) fn sense(&self, robots: impl Iterator<Item = &'static str>, now: Nanos) -> Links {
        let mut links = Links::NONE;
        for name in robots {
            if links.peer(name).is_none() {
                links.add(self.peer(name, now));
            }
        }
        links
    }

    /// Sends the state of the robot and the shared attributes after a turn of its plan at time `now`.
    pub(crate) fn tell<P: Plan>(
        &mut self,
        y: &P::Output,
        plan: Option<(u64, &Machine<P>)>,
        transitions: &Transitions,
        board: &Board,
        now: Nanos,
    ) {
        if let Some((number, machine)) = plan {
            self.rounds.turn(number, machine.plan(), transitions);
        }
        self.sent = self.sent.saturating_add(1);
        let state = State {
            name: self.name.clone(),
            session: self.link.session(),
            number: self.sent,
            age: Nanos::ZERO,
            pose: outward(&self.start, &y.here()),
            velocity: y.velocities(),
            rounds: self.rounds.counts().map(|(robot, count)| (robot.to_owned(), count)).collect(),
            atom: plan.map_or(0, |(_, machine)| machine.atom().map_or(PeerState::OVER, |atom| u64::from(atom) + 1)),
            attributes: self.shared(board, now),
        };
        self.link.send(&state, now);
    }

    /// Returns the attributes that the robot shares, with their values on the board.
    fn shared(&self, board: &Board, now: Nanos) -> Vec<SharedValue> {
        let posts = self.shares.iter().flat_map(|share| board.of(share.module));
        let shared = posts.filter_map(|post| {
            let Reading { value, at } = post.reading.as_ref()?;
            value.number()?;
            Some(SharedValue { name: post.name.clone(), value: Value::clone(value), age: now.since(*at) })
        });
        shared.take(ATTRIBUTES).collect()
    }

    /// Calls `say` with each message for the operator since the last call.
    pub(crate) fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        self.link.messages(say);
    }

    /// Returns the state of the robot `robot` as far as it is known at time `now`.
    fn peer(&self, robot: &'static str, now: Nanos) -> Peer {
        let known = self.known.iter().find(|known| known.state.name == robot);
        let state = known.map(|NewestState { state, at, .. }| PeerState {
            pose: inward(&self.start, &state.pose),
            velocity: state.velocity,
            age: Nanos(now.since(*at).0.saturating_add(state.age.0)),
            rounds: state.rounds_with(&self.name),
            atom: state.atom,
        });
        Peer { name: robot, rounds: self.rounds.with(robot), state }
    }
}

/// Converts a pose from the robot's own odometry coordinates to the coordinates that all robots share.
fn outward(start: &Pose, own: &Pose) -> Pose {
    let (sin, cos) = (libm::sin(start.theta.0), libm::cos(start.theta.0));
    let (x, y) = (own.x.0, own.y.0);
    Pose {
        x: Meters(start.x.0 + cos * x - sin * y),
        y: Meters(start.y.0 + sin * x + cos * y),
        theta: Radians(start.theta.0 + own.theta.0).wrapped(),
    }
}

/// Converts a pose from the shared coordinates to the robot's own odometry coordinates.
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
mod tests;
