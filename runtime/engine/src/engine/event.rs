//! Events of modules, shown to users and written to the log.

use std::fmt;
use std::sync::Arc;

use crate::attribute::{AttributeName, Value};

/// Reason why a registered module is given up.
pub(super) const UNENDED: &str = "it has not ended its turn";

/// An event at a turn break.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// The module was loaded.
    Loaded(Arc<str>),
    /// The module was unloaded.
    Unloaded(Arc<str>),
    /// The module makes turns, beginning with the next turn.
    Started(Arc<str>),
    /// The module makes no turns until it is started again.
    Stopped(Arc<str>),
    /// The module cannot continue; contains the reason, as a sentence.
    Failed(Arc<str>, String),
    /// The module had not finished its turn at the deadline.
    Late(Arc<str>),
    /// The module was late for too long, and makes no further turn.
    GivenUp(Arc<str>),
    /// The thread of the background module has ended.
    Ended(Arc<str>),
    /// A value of this attribute was NaN for the first time.
    NotANumber(AttributeName),
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Loaded(name) => write!(f, "module `{name}` is loaded"),
            Self::Unloaded(name) => write!(f, "module `{name}` is unloaded"),
            Self::Started(name) => write!(f, "module `{name}` is started"),
            Self::Stopped(name) => write!(f, "module `{name}` is stopped"),
            Self::Failed(name, sentence) => write!(f, "module `{name}` makes no further turn: {sentence}"),
            Self::Late(name) => write!(f, "module `{name}` is late: the turn ended without it"),
            Self::GivenUp(name) => write!(f, "module `{name}` is given up: {UNENDED}"),
            Self::Ended(name) => write!(f, "module `{name}` has ended"),
            Self::NotANumber(name) => write!(f, "{name} was NaN, which is not published"),
        }
    }
}

/// Inputs of a turn break that cannot be recomputed. Together with the robot's outputs, they suffice to replay a run
/// exactly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Arrivals {
    /// Values from background modules, in order of arrival, each with the board position of its attribute.
    pub values: Vec<(usize, Value)>,
    /// Background modules that have ended, each with the reason.
    pub ended: Vec<(Arc<str>, End)>,
    /// Registered modules that had not finished their turn at the deadline.
    pub late: Vec<Arc<str>>,
    /// Registered modules that no thread had started by the deadline.
    pub skipped: Vec<Arc<str>>,
}

/// Reason why a background module has ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// The module's code has returned.
    Returned,
    /// The module cannot continue; contains the reason as a sentence.
    Failed(String),
    /// The module's code panicked; contains the panic message.
    Panicked(String),
    /// In stepped time, the module did not exchange values in time after its latency had passed.
    GivenUp,
}

impl Arrivals {
    pub(crate) fn clear(&mut self) {
        self.values.clear();
        self.ended.clear();
        self.late.clear();
        self.skipped.clear();
    }
}
