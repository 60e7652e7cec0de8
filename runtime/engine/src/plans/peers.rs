//! Handles the requests of other robots that a new plan replace the current plan. They are refused after a safety rule
//! has replaced or ended a plan.

use super::PlanEvent;

/// Reason for barring plans of other robots after a safety rule has replaced the plan.
pub(crate) const REPLACED: &str = "a safety rule has replaced the plan; the robot takes plans again once its operator \
                                   lets one take over in `mdle shell`, or begins a new run";
/// Reason for barring plans of other robots after a safety rule has ended a plan.
pub(crate) const ENDED: &str = "a safety rule has ended a plan; the robot takes plans again once its operator lets one \
                                take over in `mdle shell`, or begins a new run";

/// Requests of other robots, and the bar (refusal of requests) that a safety rule has imposed on them.
#[derive(Debug, Default)]
pub(super) struct PeerRequests {
    /// Numbers of the requests whose plans have neither begun nor been refused yet.
    open: Vec<u32>,
    /// Events of these requests that have not been taken yet. A session receives them as well.
    events: Vec<PlanEvent>,
    bar: Option<Bar>,
}

/// The refusal of plans that other robots request, imposed by a safety rule.
#[derive(Debug)]
struct Bar {
    /// Number of the last request that was made before the bar was imposed.
    last: u32,
    /// Reason for the bar, as a sentence.
    reason: &'static str,
    /// `true` once a plan has begun that the operator requested after the bar was imposed. Requests that other robots
    /// have made since the bar was imposed are then permitted.
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

    /// Bars requests of other robots for this reason. Requests up to number `last` stay barred; later ones are barred
    /// until the bar is lifted.
    pub(super) fn bar(&mut self, last: u32, reason: &'static str) {
        self.bar = Some(Bar { last, reason, is_lifted: false });
    }

    /// Permits new requests from other robots again, because the plan that the operator requested with the number
    /// `ticket` has begun. Has no effect if the operator requested the plan before the requests were barred.
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
