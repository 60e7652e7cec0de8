//! Events of modules, for people and for the log.

use std::fmt;
use std::sync::Arc;

use crate::attribute::{AttributeName, Value};

/// An event at a turn break.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// The module was loaded.
    Loaded(Arc<str>),
    /// The module was unloaded.
    Unloaded(Arc<str>),
    /// The module makes turns from the next one on.
    Started(Arc<str>),
    /// The module makes no turns for now.
    Stopped(Arc<str>),
    /// The module cannot go on: a sentence.
    Failed(Arc<str>, String),
    /// The module had not ended its turn when the turn had to end.
    Late(Arc<str>),
    /// The module has been late for too long.
    GivenUp(Arc<str>),
    /// The thread of the background module has ended.
    Ended(Arc<str>),
    /// The value of this attribute was NaN for the first time.
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
            Self::GivenUp(name) => write!(f, "module `{name}` is given up: it has not ended its turn"),
            Self::Ended(name) => write!(f, "module `{name}` has ended"),
            Self::NotANumber(name) => write!(f, "{name} was NaN, which is not published"),
        }
    }
}

/// The part of a turn break that no module computes: with the robot's outputs, it repeats a run exactly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Arrivals {
    /// Values from background modules, each with its place on the board, in order.
    pub values: Vec<(usize, Value)>,
    /// Background modules that have ended.
    pub ended: Vec<(Arc<str>, End)>,
    /// Registered modules that had not ended their turn.
    pub late: Vec<Arc<str>>,
    /// Registered modules that no thread had taken when the turn had to end.
    pub skipped: Vec<Arc<str>>,
}

/// End of a background module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// The module's code returned.
    Returned,
    /// It cannot go on: a sentence.
    Failed(String),
    /// The module's code panicked: the message.
    Panicked(String),
    /// In stepped time it did not exchange values when its latency had passed.
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
