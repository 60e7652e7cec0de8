//! Handles the requests in which other robots ask that a new plan replace the current plan. Such requests are refused
//! after a safety rule has replaced or ended a plan.

use super::PlanEvent;

/// Reason for refusing plans of other robots after a safety rule has replaced the plan.
pub(crate) const REPLACED: &str = "a safety rule has replaced the plan; the robot takes plans again once its operator \
                                   lets one take over in `mdle shell`, or begins a new run";
/// Reason for refusing plans of other robots after a safety rule has ended a plan.
pub(crate) const ENDED: &str = "a safety rule has ended a plan; the robot takes plans again once its operator lets one \
                                take over in `mdle shell`, or begins a new run";

/// Requests of other robots, and the ban on these requests if a safety rule has imposed one.
#[derive(Debug, Default)]
pub(super) struct PeerRequests {
    /// Numbers of the requests whose plans have neither begun nor been refused yet.
    open: Vec<u32>,
    /// Events of these requests that have not been taken yet. A session receives them as well.
    events: Vec<PlanEvent>,
    bar: Option<Bar>,
}

/// A ban on requests of other robots, which a safety rule has imposed. Banned requests are refused.
#[derive(Debug)]
struct Bar {
    /// Number of the last request that was made before the ban.
    last: u32,
    /// Reason why the requests are refused, as a sentence.
    reason: &'static str,
    /// `true` if the ban has been lifted, because a plan has begun that the operator requested after the ban. Requests
    /// that other robots have made since the ban are then permitted.
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

    /// Removes and returns the events of other robots' requests.
    pub(super) fn take_events(&mut self) -> Vec<PlanEvent> {
        std::mem::take(&mut self.events)
    }

    /// Bans requests of other robots for this reason. Requests up to number `last` remain banned; later ones are banned
    /// until the ban is lifted.
    pub(super) fn bar(&mut self, last: u32, reason: &'static str) {
        self.bar = Some(Bar { last, reason, is_lifted: false });
    }

    /// Permits new requests from other robots again, because the plan that the operator requested with the number
    /// `ticket` has begun. Has no effect if the operator requested the plan before the ban.
    pub(super) fn lift(&mut self, ticket: u32) {
        if let Some(bar) = self.bar.as_mut().filter(|bar| ticket > bar.last) {
            bar.is_lifted = true;
        }
    }

    /// Returns the reason for the ban if another robot made this request and the request is banned; `None` otherwise.
    pub(super) fn barred(&self, ticket: u32) -> Option<&'static str> {
        let bar = self.bar.as_ref().filter(|bar| !bar.is_lifted || ticket <= bar.last)?;
        self.has(ticket).then_some(bar.reason)
    }

    /// Returns the event for a cancelled request: a refusal if the request is banned.
    pub(super) fn cancelled(&self, ticket: u32) -> PlanEvent {
        match self.barred(ticket) {
            Some(reason) => PlanEvent::Refused(ticket, reason.to_owned()),
            None => PlanEvent::Cancelled(ticket),
        }
    }
}
