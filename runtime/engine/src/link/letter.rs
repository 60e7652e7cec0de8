//! Letters between robots. A letter contains either a plan as text or an answer to a plan. Unlike a state, a letter
//! never replaces an earlier one.

use std::time::Duration;

use crate::plans::When;

/// Maximum length of the text in a letter, in bytes.
pub const LONGEST_TEXT: usize = 65_536;
/// Maximum length of the sentence in an answer, in bytes.
pub(super) const LONGEST_SENTENCE: usize = 4096;
/// Maximum number of plans in the queue to one robot.
pub(super) const UNREAD: usize = 8;
/// Time limit for sending a plan that takes over at once, and also for its arrival.
const NOW: Duration = Duration::from_secs(2);
/// Time limit for sending any other letter; for a plan, also for its arrival.
const SOON: Duration = Duration::from_secs(10);

/// A letter from one robot to another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Letter {
    /// Name of the robot that sent the letter.
    pub from: String,
    /// Number of the letter; each sender counts its letters from 1.
    pub number: u64,
    /// Content of the letter.
    pub content: Content,
}

/// Content of a letter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// A plan that takes over on the recipient.
    Plan {
        /// Moment at which the plan takes over.
        when: When,
        /// Text of the plan.
        text: String,
    },
    /// The answer to a plan.
    Answer {
        /// Number of the letter that contains the plan.
        of: u64,
        /// `true` if the plan takes over.
        is_accepted: bool,
        /// Sentence that says when the plan takes over, or why it does not.
        sentence: String,
    },
}

/// A plan that was refused on arrival and has to be answered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RefusedPlan {
    /// Name of the robot that sent the plan.
    pub from: String,
    /// Number of the letter that contains the plan.
    pub number: u64,
    /// Reason why the plan was refused, as the end of a sentence.
    pub reason: String,
}

impl Content {
    /// Returns `true` if the letter contains a plan.
    pub(super) fn is_plan(&self) -> bool {
        matches!(self, Self::Plan { .. })
    }

    /// Returns the time limit for sending the letter; for a plan, also for its arrival.
    pub(super) fn limit(&self) -> Duration {
        match self {
            Self::Plan { when: When::Now, .. } => NOW,
            Self::Plan { when: When::AtomEnds | When::PlanEnds, .. } | Self::Answer { .. } => SOON,
        }
    }
}

/// Returns the longest beginning of a text that fits into `longest` bytes and consists of whole characters.
pub(super) fn cut(text: &str, longest: usize) -> &str {
    text.get(..text.floor_char_boundary(longest)).unwrap_or(text)
}
