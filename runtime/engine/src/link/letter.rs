//! Letters between robots: plans as text, and answers to plans. Unlike a state, a letter never replaces an earlier one.

use std::time::Duration;

use crate::plans::When;

/// Maximum length of the text in a letter, in bytes.
pub const LONGEST_TEXT: usize = 65_536;
/// Maximum length of the sentence in an answer, in bytes.
pub(super) const LONGEST_SENTENCE: usize = 4096;
/// Maximum number of plans in the queue to one robot.
pub(super) const UNREAD: usize = 8;
/// Time within which a plan that takes over at once has to be sent, and has to arrive.
const NOW: Duration = Duration::from_secs(2);
/// Time within which any other letter has to be sent; a plan also has to arrive within this time.
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
        /// Number of the letter with the plan.
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
    /// Number of the letter with the plan.
    pub number: u64,
    /// Reason why the plan was refused, as the end of a sentence.
    pub reason: String,
}

impl Content {
    /// Returns `true` if the letter contains a plan.
    pub(super) fn is_plan(&self) -> bool {
        matches!(self, Self::Plan { .. })
    }

    /// Returns the time within which the letter has to be sent; a plan also has to arrive within this time.
    pub(super) fn limit(&self) -> Duration {
        match self {
            Self::Plan { when: When::Now, .. } => NOW,
            Self::Plan { when: When::AtomEnds | When::PlanEnds, .. } | Self::Answer { .. } => SOON,
        }
    }
}

/// Returns the beginning of a text: as many whole characters as fit into `longest` bytes.
pub(super) fn cut(text: &str, longest: usize) -> &str {
    text.get(..text.floor_char_boundary(longest)).unwrap_or(text)
}
