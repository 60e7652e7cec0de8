//! Moments at which plans take over, and events that happen to plans at run time.

use std::fmt;
use std::sync::Arc;

/// Moment at which a new plan takes over. In the turn in which the plan takes over, the robot gets exactly one input:
/// the input of the new plan's first turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// The plan takes over in the next turn.
    Now,
    /// The plan takes over in the turn in which the current atom ends.
    AtomEnds,
    /// The plan takes over in the turn in which the current plan ends.
    PlanEnds,
}

impl When {
    /// All moments, each with its name in commands.
    pub const ALL: [(&'static str, Self); 3] = [("now", Self::Now), ("atom", Self::AtomEnds), ("plan", Self::PlanEnds)];

    /// Returns the number of the moment in records: its index in [`When::ALL`].
    #[must_use]
    pub fn number(self) -> u8 {
        (0..).zip(Self::ALL).find(|(_, (_, when))| *when == self).map_or(u8::MAX, |(number, _)| number)
    }

    /// Returns the moment with this number in records, or `None` if there is none.
    #[must_use]
    pub fn of_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).map(|(_, when)| *when)
    }
}

impl fmt::Display for When {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Now => "in the next turn",
            Self::AtomEnds => "when the atom ends",
            Self::PlanEnds => "when the plan ends",
        })
    }
}

/// An event about a request. Most variants begin with the number of the request; the first plan has number 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PlanEvent {
    /// The request was refused, and nothing has changed; contains the diagnostics of the text, or a sentence with the
    /// reason.
    Refused(u32, String),
    /// The text has warnings, given as diagnostics. Another event for the request follows.
    Warned(u32, String),
    /// The plans of the request are stored; contains their names.
    Stored(u32, Vec<Arc<str>>),
    /// A later request replaces this one, which was not compiled yet.
    Superseded(u32),
    /// The plan with this name was armed, but another plan was armed before it could take over.
    Replaced(u32, Arc<str>),
    /// The plan is compiled, and will take over at its moment.
    Armed(u32),
    /// The plan was cancelled before it took over.
    Cancelled(u32),
    /// The plan has taken over, and made its first turn.
    Began(u32),
    /// The trial of the plan is over, and the plan that was replaced is dropped.
    Accepted(u32),
    /// The plan on trial was ended, and the plan that it replaced continues.
    RolledBack {
        /// Number of the request for the plan that was ended.
        from: u32,
        /// Number of the request for the plan that continues.
        to: u32,
        /// Reason, as a sentence.
        why: String,
    },
}

impl PlanEvent {
    /// Returns the number of the request; for a rollback, the number of the request for the plan that was ended.
    pub(crate) fn request(&self) -> u32 {
        match self {
            Self::Refused(ticket, _)
            | Self::Warned(ticket, _)
            | Self::Stored(ticket, _)
            | Self::Superseded(ticket)
            | Self::Replaced(ticket, _)
            | Self::Armed(ticket)
            | Self::Cancelled(ticket)
            | Self::Began(ticket)
            | Self::Accepted(ticket)
            | Self::RolledBack { from: ticket, .. } => *ticket,
        }
    }

    /// Returns `true` if this event decides the request, because the plan has begun, will never begin, or is stored.
    pub(crate) fn is_decision(&self) -> bool {
        !matches!(self, Self::Warned(..) | Self::Armed(_))
    }
}

/// Error of a rollback: no plan is on trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoTrial;

impl fmt::Display for NoTrial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no plan is on trial, so there is none to roll back to")
    }
}

impl std::error::Error for NoTrial {}
