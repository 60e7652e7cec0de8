//! Plans that this robot has sent to other robots and that have not been answered yet.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Time after which an unanswered plan is reported.
const ANSWERS: Duration = Duration::from_secs(10);
/// Maximum number of sent plans that are kept.
const KNOWN: usize = 64;
/// Maximum number of answers to one plan: one when the plan waits to take over, one when it begins, and one more.
const MOST: u8 = 3;

/// The plans that were sent last, oldest first; at most `KNOWN` plans.
#[derive(Debug, Default)]
pub(super) struct Questions(VecDeque<UnansweredPlan>);

/// A plan that was sent.
#[derive(Debug)]
struct UnansweredPlan {
    to: String,
    /// Number of the letter that contains the plan.
    number: u64,
    at: Instant,
    /// Number of answers that have arrived.
    answers: u8,
    /// `true` until an answer arrives, or until the lack of an answer has been reported.
    is_open: bool,
}

impl Questions {
    /// Records that a plan was sent in the letter with this number at time `now`.
    pub(super) fn ask(&mut self, to: &str, number: u64, now: Instant) {
        if self.0.len() >= KNOWN {
            self.0.pop_front();
        }
        self.0.push_back(UnansweredPlan { to: to.to_owned(), number, at: now, answers: 0, is_open: true });
    }

    /// Removes the plan in the letter with this number, because the letter was not sent.
    pub(super) fn forget(&mut self, number: u64) {
        self.0.retain(|question| question.number != number);
    }

    /// Records an answer to the plan in the letter with this number.
    ///
    /// # Errors
    /// Returns the end of a sentence if this plan was not sent to the robot, or was answered too often.
    pub(super) fn answer(&mut self, from: &str, number: u64) -> Result<(), String> {
        let question = self.0.iter_mut().find(|question| question.to == from && question.number == number);
        let question = question.ok_or_else(|| "it answers a plan that was not sent".to_owned())?;
        if question.answers >= MOST {
            return Err(format!("it is one of more than {MOST} answers to a plan"));
        }
        (question.answers, question.is_open) = (question.answers + 1, false);
        Ok(())
    }

    /// Returns the recipient of each plan that has waited too long for an answer at time `now`; each plan is reported
    /// only once.
    pub(super) fn unanswered(&mut self, now: Instant) -> Vec<String> {
        let is_late =
            |question: &&mut UnansweredPlan| question.is_open && now.saturating_duration_since(question.at) >= ANSWERS;
        let late = self.0.iter_mut().filter(is_late).map(|question| {
            question.is_open = false;
            question.to.clone()
        });
        late.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_without_an_answer_is_reported_once() {
        let (mut questions, begun) = (Questions::default(), Instant::now());
        let at = |seconds| begun + Duration::from_secs(seconds);
        questions.ask("bob", 1, begun);
        questions.ask("eve", 2, begun);
        questions.ask("bob", 3, begun);
        questions.forget(3);
        assert_eq!(questions.unanswered(at(9)), Vec::<String>::new());
        assert!(questions.answer("eve", 1).is_err(), "a plan for another robot");
        assert_eq!(questions.answer("bob", 3).unwrap_err(), "it answers a plan that was not sent");
        // A plan may have several answers: it is waiting, and it has taken over.
        assert_eq!([(); 3].map(|()| questions.answer("bob", 1)), [const { Ok(()) }; 3]);
        assert_eq!(questions.answer("bob", 1).unwrap_err(), "it is one of more than 3 answers to a plan");
        assert_eq!((questions.unanswered(at(10)), questions.unanswered(at(11))), (vec!["eve".to_owned()], vec![]));
        assert_eq!(questions.answer("eve", 2), Ok(()), "late, and an answer");
    }
}
