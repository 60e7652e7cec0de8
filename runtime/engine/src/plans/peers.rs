//! Requests of other robots for plans to take over. After a safety rule has replaced or ended a plan, they are refused.

use super::PlanEvent;

/// Reason to bar plans of other robots: a safety rule has replaced the plan.
pub(crate) const REPLACED: &str = "a safety rule has replaced the plan; the robot takes plans again once its operator \
                                   lets one take over in `mdle shell`, or begins a new run";
/// Reason to bar plans of other robots: a safety rule has ended a plan.
pub(crate) const ENDED: &str = "a safety rule has ended a plan; the robot takes plans again once its operator lets one \
                                take over in `mdle shell`, or begins a new run";

/// Requests of other robots, and the bar that a safety rule has imposed on them.
#[derive(Debug, Default)]
pub(super) struct PeerRequests {
    /// Numbers of the requests whose plans have neither begun nor been refused yet.
    open: Vec<u32>,
    /// Events of these requests that have not been taken yet. The events that a session takes contain them as well.
    events: Vec<PlanEvent>,
    bar: Option<Bar>,
}

/// A bar against plans of other robots.
#[derive(Debug)]
struct Bar {
    /// Number of the last request before the bar was imposed.
    last: u32,
    /// Reason for the bar, as a sentence.
    reason: &'static str,
    /// `true` once the bar is lifted, because a plan that the operator requested after the bar has begun. Requests that
    /// other robots made after the bar are then permitted.
    is_lifted: bool,
}

impl PeerRequests {
    /// Adds the request with this number.
    pub(super) fn add(&mut self, ticket: u32) {
        self.open.push(ticket);
    }

    /// Returns `true` if another robot made the request with this number and the request is not decided yet.
    pub(super) fn has(&self, ticket: u32) -> bool {
        self.open.contains(&ticket)
    }

    /// Records an event of any request.
    pub(super) fn note(&mut self, event: &PlanEvent) {
        let Some(place) = self.open.iter().position(|open| *open == event.request()) else { return };
        self.events.push(event.clone());
        if event.is_decision() {
            self.open.remove(place);
        }
    }

    /// Takes the events of other robots' requests.
    pub(super) fn take_events(&mut self) -> Vec<PlanEvent> {
        std::mem::take(&mut self.events)
    }

    /// Bars requests of other robots for this reason: requests up to number `last` permanently, later ones until the
    /// bar is lifted.
    pub(super) fn bar(&mut self, last: u32, reason: &'static str) {
        self.bar = Some(Bar { last, reason, is_lifted: false });
    }

    /// Lifts the bar because a plan has begun that no other robot requested, provided that its request `ticket` was
    /// made after the bar.
    pub(super) fn lift(&mut self, ticket: u32) {
        if let Some(bar) = self.bar.as_mut().filter(|bar| ticket > bar.last) {
            bar.is_lifted = true;
        }
    }

    /// Returns the reason for the bar if another robot made this request and the request is barred; `None` otherwise.
    pub(super) fn barred(&self, ticket: u32) -> Option<&'static str> {
        let bar = self.bar.as_ref().filter(|bar| !bar.is_lifted || ticket <= bar.last)?;
        self.has(ticket).then_some(bar.reason)
    }

    /// Returns the event for a cancelled request: a refusal if the request is barred.
    pub(super) fn cancelled(&self, ticket: u32) -> PlanEvent {
        match self.barred(ticket) {
            Some(reason) => PlanEvent::Refused(ticket, reason.to_owned()),
            None => PlanEvent::Cancelled(ticket),
        }
    }
}
