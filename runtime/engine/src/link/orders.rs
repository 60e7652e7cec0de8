//! Keeps plans that other robots have sent, until they take over or are refused. Also keeps answers to plans that this
//! robot has sent.

use std::collections::{BTreeMap, VecDeque};

use mdle_runtime::{Nanos, Printable};

use super::pace::{Admission, RateLimiter};
use super::{Content, LONGEST_TEXT, Letter, Link, RefusedPlan};
use crate::plans::{EngineAlphabet, PlanEvent, PlanSource, Plans, When};

/// Answer to a plan from a robot that sends plans too fast.
const TOO_FAST: &str = "it sends more than one plan a second: send it again later";

/// Maximum number of sent plans whose names are kept.
const NAMES: usize = 64;

/// Plans that are exchanged with other robots.
#[derive(Debug, Default)]
pub(super) struct PlanExchange {
    /// Name of this robot.
    own: String,
    /// Names of the robots whose plans are accepted.
    pub(super) takes_from: Vec<String>,
    /// Names of the robots to which plans can be sent.
    pub(super) sends_to: Vec<String>,
    /// Number of the last letter that was sent.
    sent: u64,
    /// Numbers and names of plans that were sent recently, for messages about answers to them.
    names: VecDeque<(u64, String)>,
    /// Plans of other robots that have neither taken over nor been refused yet.
    waiting: Vec<ReceivedPlan>,
    /// Pace of each robot that has sent plans, by name.
    paces: BTreeMap<String, RateLimiter>,
}

/// A plan of another robot.
#[derive(Debug)]
struct ReceivedPlan {
    /// Number of this robot's request to compile the plan.
    ticket: u32,
    from: String,
    /// Number of the letter with the plan.
    number: u64,
    /// Moment at which the plan takes over.
    when: When,
    /// Warnings about the plan that no answer has contained yet; empty if there are none.
    warnings: String,
}

impl PlanExchange {
    /// Creates the plan exchange of the robot `own`, which does not exchange plans with any robot yet.
    pub(super) fn of(own: &str) -> Self {
        Self { own: own.to_owned(), ..Self::default() }
    }

    /// Sends the text of the plan `name` to the robot `to`. The plan takes over there at the moment `when`.
    ///
    /// # Errors
    /// Returns a sentence with the reason if the plan cannot be sent.
    pub(super) fn send(
        &mut self,
        link: &mut dyn Link,
        to: &str,
        (name, text, when): (&str, &str, When),
        now: Nanos,
    ) -> Result<(), String> {
        if text.len() > LONGEST_TEXT {
            return Err(format!("the plan has {} bytes, and one that is sent has {LONGEST_TEXT} at most", text.len()));
        }
        self.post(link, to, Content::Plan { when, text: text.to_owned() }, now)?;
        self.names.truncate(NAMES - 1);
        self.names.push_front((self.sent, name.to_owned()));
        Ok(())
    }

    /// Returns the name, for use in messages, of the plan that this robot sent in letter `number`; "a plan" if the name
    /// is no longer known.
    fn plan(&self, number: u64) -> String {
        let name = self.names.iter().find(|(sent, _)| *sent == number);
        name.map_or_else(|| "a plan".to_owned(), |(_, name)| format!("the plan {name}"))
    }

    fn post(&mut self, link: &mut dyn Link, to: &str, content: Content, now: Nanos) -> Result<(), String> {
        let number = self.sent.saturating_add(1);
        link.post(to, &Letter { from: self.own.clone(), number, content }, now)?;
        self.sent = number;
        Ok(())
    }

    /// Starts to compile the plans that have arrived. Returns messages to the operator about refused plans and about
    /// answers of other robots.
    pub(super) fn take<A: EngineAlphabet>(
        &mut self,
        link: &mut dyn Link,
        plans: &mut Plans<A>,
        now: Nanos,
    ) -> Vec<String> {
        let (mut letters, mut refused) = (Vec::new(), Vec::new());
        link.letters(now, &mut |letter| letters.push(letter));
        link.refused_plans(&mut |plan| refused.push(plan));
        for RefusedPlan { from, number, reason } in refused {
            self.answer(link, &from, number, Err(&reason), now);
        }
        let messages = letters.into_iter().filter_map(|Letter { from, number, content }| match content {
            Content::Answer { is_accepted: true, sentence, .. } => {
                Some(format!("state link: {from} takes the plan: {}", printable(&sentence)))
            }
            Content::Answer { is_accepted: false, sentence, of } => {
                Some(format!("warning: state link: {from} refuses {}: {}", self.plan(of), printable(&sentence)))
            }
            Content::Plan { .. } if !self.takes_from.contains(&from) => {
                let sentence = format!("{} takes no plans of {from}", self.own);
                self.answer(link, &from, number, Err(&sentence), now);
                Some(format!("warning: state link: the plan of {from} is refused: {sentence}"))
            }
            Content::Plan { when, text } => match self.paces.entry(from.clone()).or_default().admits(now) {
                Admission::Taken => {
                    let ticket = plans.swap(PlanSource::Peer { robot: from.clone(), text }, when);
                    self.waiting.push(ReceivedPlan { ticket, from, number, when, warnings: String::new() });
                    None
                }
                admission @ (Admission::TooFast | Admission::StillTooFast) => {
                    self.answer(link, &from, number, Err(TOO_FAST), now);
                    let is_first = admission == Admission::TooFast;
                    is_first.then(|| format!("warning: state link: the plan of {from} is refused: {TOO_FAST}"))
                }
            },
        });
        messages.collect()
    }

    /// Answers the plans that have new events; returns messages to the operator about these plans.
    pub(super) fn decide<A: EngineAlphabet>(
        &mut self,
        link: &mut dyn Link,
        plans: &mut Plans<A>,
        now: Nanos,
    ) -> Vec<String> {
        let mut messages = Vec::new();
        for event in plans.take_peer_events() {
            let place = self.waiting.iter().position(|order| order.ticket == event.request());
            let Some(mut order) = place.map(|place| self.waiting.remove(place)) else { continue };
            let answer = order.answer(&event, plans);
            match &answer {
                Some(Ok(sentence)) => messages.push(format!("state link: the plan of {}: {sentence}", order.from)),
                Some(Err(sentence)) => {
                    messages.push(format!("warning: state link: the plan of {} is refused: {sentence}", order.from));
                }
                None => {}
            }
            if let Some(answer) = answer {
                self.answer(link, &order.from, order.number, answer.as_deref().map_err(String::as_str), now);
            }
            if !event.is_decision() {
                self.waiting.push(order);
            }
        }
        messages
    }

    /// Answers a plan of the robot `to`; without a connection to that robot, the answer is lost.
    fn answer(&mut self, link: &mut dyn Link, to: &str, of: u64, result: Result<&str, &str>, now: Nanos) {
        let (Ok(sentence) | Err(sentence)) = result;
        let content = Content::Answer { of, is_accepted: result.is_ok(), sentence: sentence.to_owned() };
        let _ = self.post(link, to, content, now);
    }
}

impl ReceivedPlan {
    /// Returns the answer that the plan's sender receives after an event of the request; `None` if the event requires
    /// no answer.
    fn answer<A: EngineAlphabet>(&mut self, event: &PlanEvent, plans: &Plans<A>) -> Option<Result<String, String>> {
        let refused = |sentence: &str| Some(Err(sentence.to_owned()));
        match event {
            PlanEvent::Warned(_, warnings) => {
                self.warnings.clone_from(warnings);
                None
            }
            PlanEvent::Armed(_) if self.when == When::Now => None,
            PlanEvent::Armed(ticket) => {
                let name = plans.name_of(*ticket)?;
                Some(Ok(self.warned(format!("{name} waits, and takes over {}", self.when))))
            }
            PlanEvent::Began(ticket) => match plans.name_of(*ticket) {
                Some(name) => Some(Ok(self.warned(format!("{name} takes over")))),
                None => refused("it has taken over, and its trial was ended at once"),
            },
            PlanEvent::Refused(_, sentence) => refused(sentence),
            PlanEvent::Superseded(_) => refused("a later request replaces this one"),
            PlanEvent::Replaced(..) => refused("another plan takes its place"),
            PlanEvent::Cancelled(_) => refused("the request was cancelled"),
            PlanEvent::Stored(..) | PlanEvent::Accepted(_) | PlanEvent::RolledBack { .. } => None,
        }
    }

    /// Returns the sentence, followed by the warnings about the plan if no earlier answer contained them.
    fn warned(&mut self, sentence: String) -> String {
        match std::mem::take(&mut self.warnings).trim_end() {
            "" => sentence,
            warnings => format!("{sentence}\n{warnings}"),
        }
    }
}

/// Returns text from another robot with escaped control characters. Lines after the first are indented, so that no line
/// looks like this robot's own report.
fn printable(text: &str) -> String {
    text.lines().map(|line| Printable(line).to_string()).collect::<Vec<_>>().join("\n    ")
}
