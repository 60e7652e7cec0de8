//! Tests plans that other robots send while the robot runs: which plans they replace, and the answers to the senders.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

use mdle_engine::link::{Content, Letter, Link, RefusedPlan, State, StateLink};
use mdle_engine::{CompiledPlans, PlanEvent, PlanFacts, PlanSource, StoredPlan, When};
use mdle_host::{Pilot, PilotTurn};
use mdle_runtime::{Nanos, Pose};
use mdle_scripted::Output;
use mdle_scripted::alphabet::Alphabet;

use crate::engine::{Run, loaded};

/// Letters to and from a robot.
#[derive(Default)]
struct Mail {
    arrived: Vec<Letter>,
    refused: Vec<RefusedPlan>,
    sent: Vec<Letter>,
}

/// A link on which a test puts letters for a robot and reads the robot's letters.
struct Post(Arc<Mutex<Mail>>);

impl Link for Post {
    fn send(&mut self, _: &State, _: Nanos) {}

    fn receive(&mut self, _: Nanos, _: &mut dyn FnMut(State)) {}

    fn post(&mut self, _: &str, letter: &Letter, _: Nanos) -> Result<(), String> {
        self.0.lock().unwrap().sent.push(letter.clone());
        Ok(())
    }

    fn letters(&mut self, _: Nanos, take: &mut dyn FnMut(Letter)) {
        self.0.lock().unwrap().arrived.drain(..).for_each(take);
    }

    fn refused_plans(&mut self, take: &mut dyn FnMut(RefusedPlan)) {
        self.0.lock().unwrap().refused.drain(..).for_each(take);
    }
}

/// The robot `bob`, which runs a plan and accepts plans from `ada`.
pub(crate) struct Bob {
    pub(crate) run: Run,
    mail: Arc<Mutex<Mail>>,
    letters: u64,
}

pub(crate) const FIRST: &str = "{ Main (b) (Atom (a) seek) (Atom (null) climb) }";
pub(crate) const DRIFT: &str = "{ Main (c) (Atom (f) drift) }";
pub(crate) const IDLE: &str = "{ Main (e) (Atom (null) idle) }";

/// A plan about which the compiler warns.
const WARNED: &str = "{ Main (b) (Atom (null) idle) }";

/// Compiles the plan `Main` of a text.
fn compiled(source: &PlanSource) -> Result<CompiledPlans<Alphabet>, String> {
    let (PlanSource::Text(text) | PlanSource::Peer { text, .. }) = source else {
        return Err("there is no such file".to_owned());
    };
    let files = [("main".to_owned(), text.clone())].into();
    let plan = StoredPlan { name: "Main".into(), files, loaded: loaded(text)?, facts: PlanFacts::default() };
    let warnings = if text == WARNED { "warning: careful\n".to_owned() } else { String::new() };
    Ok(CompiledPlans { plans: vec![plan], warnings })
}

impl Bob {
    pub(crate) fn new() -> Self {
        let mail = Arc::default();
        let link = StateLink::new(Box::new(Post(Arc::clone(&mail))), "bob", Pose::ORIGIN);
        let link = link.exchanging_plans(vec!["ada".to_owned()], Vec::new());
        let Run { engine, turns, way, journal } = Run::of(FIRST);
        let run = Run { engine: engine.linked(link).unwrap(), turns, way, journal };
        let mut bob = Self { run, mail, letters: 0 };
        bob.run.plans().compile_at_once_with(Box::new(compiled));
        bob
    }

    /// Returns the robot with a compiler that sends a message when it begins, and compiles when it receives a message.
    pub(crate) fn compiling_for(begun: Sender<()>, gate: Receiver<()>) -> Self {
        let mut bob = Self::new();
        let compile = move |source: &PlanSource| {
            let _ = (begun.send(()), gate.recv());
            compiled(source)
        };
        bob.run.plans().compile_with(Box::new(compile)).unwrap();
        bob
    }

    /// Delivers a plan from `ada` before the end of the next turn.
    pub(crate) fn gets(&mut self, text: &str, when: When) {
        self.letters += 1;
        let content = Content::Plan { when, text: text.to_owned() };
        self.mail.lock().unwrap().arrived.push(Letter { from: "ada".to_owned(), number: self.letters, content });
    }

    /// Returns the answers since the last call, each with the number of the plan, `true` if the plan is accepted, and
    /// the robot's sentence.
    pub(crate) fn answers(&mut self) -> Vec<(u64, bool, String)> {
        let sent: Vec<_> = self.mail.lock().unwrap().sent.drain(..).collect();
        let answer = |letter: Letter| match letter.content {
            Content::Answer { of, is_accepted, sentence } => (of, is_accepted, sentence),
            Content::Plan { text, .. } => panic!("{text}"),
        };
        sent.into_iter().map(answer).collect()
    }

    /// Runs a turn, and returns its law.
    pub(crate) fn turn(&mut self) -> String {
        let turn = self.run.turn("");
        turn.split(' ').nth(1).unwrap_or(&turn).to_owned()
    }

    /// Runs turns until an answer has been sent, and returns the answer.
    pub(crate) fn answered(&mut self) -> (u64, bool, String) {
        self.until(|bob| bob.answers().pop())
    }

    /// Runs turns until `find`, which is called after each turn, returns a value, and returns this value.
    pub(crate) fn until<T>(&mut self, find: impl Fn(&mut Self) -> Option<T>) -> T {
        let turns = (0..10_000).find_map(|_| {
            self.turn();
            // The compiler runs in a separate thread and needs time.
            std::thread::sleep(std::time::Duration::from_millis(1));
            find(self)
        });
        turns.expect("something happens within ten seconds")
    }

    /// Runs turns until this event has been reported.
    pub(crate) fn until_event(&mut self, event: &PlanEvent) {
        self.until(|bob| bob.run.journal.contains(event).then_some(()));
    }

    /// Replaces the plan as a safety rule does.
    pub(crate) fn retreats(&mut self) {
        let y = Output::default();
        let t = Nanos(self.run.turns * 100_000_000);
        self.run.engine.divert(loaded(IDLE).unwrap().plan(), PilotTurn { y: &y, t, number: self.run.turns });
    }
}

/// Returns the answer that refuses the plan with the number `of`.
pub(crate) fn refused(of: u64, reason: &str) -> (u64, bool, String) {
    (of, false, reason.to_owned())
}

pub(crate) const REPLACED: &str = "a safety rule has replaced the plan; the robot takes plans again once its operator lets one \
                                   take over in `mdle shell`, or begins a new run";
const ENDED: &str = "a safety rule has ended a plan; the robot takes plans again once its operator lets one take over \
                     in `mdle shell`, or begins a new run";
pub(crate) const TAKEN: &str = "another plan takes its place";

#[test]
fn no_sent_plan_replaces_that_of_a_safety_rule() {
    let mut bob = Bob::new();
    bob.turn();
    bob.retreats();
    for (number, when) in (1..).zip([When::Now, When::AtomEnds, When::PlanEnds]) {
        bob.gets(DRIFT, when);
        assert_eq!([bob.turn(), bob.turn()], ["idle", "idle"], "{when:?}");
        assert_eq!(bob.answers(), [refused(number, REPLACED)]);
    }
    // The operator replaces the plan again.
    bob.run.plans().replace(loaded(FIRST).unwrap().plan(), When::Now);
    assert_eq!(bob.turn(), "seek");
    bob.gets(DRIFT, When::Now);
    assert_eq!([bob.turn(), bob.turn()], ["seek", "drift"]);
}

#[test]
fn a_safety_rule_overrules_plans_that_wait() {
    let mut bob = Bob::new();
    bob.turn();
    bob.gets(DRIFT, When::PlanEnds);
    bob.turn();
    bob.answers();
    bob.retreats();
    assert_eq!([bob.turn(), bob.run.turn("e"), bob.turn()], ["idle", "over", "over"]);
    assert_eq!(bob.answers(), [refused(1, REPLACED)]);
    assert_eq!(bob.run.plans().armed(), None);
}

#[test]
fn a_safety_rule_overrules_plans_being_compiled() {
    let ((compile, gate), (begun, begins)) = (channel(), channel());
    let mut bob = Bob::compiling_for(begun, gate);
    bob.gets(DRIFT, When::Now);
    bob.turn();
    begins.recv().unwrap();
    bob.retreats();
    bob.turn();
    compile.send(()).unwrap();
    assert_eq!(bob.answered(), refused(1, REPLACED));
    assert_eq!([bob.turn(), bob.turn()], ["idle", "idle"]);
    // The same holds for a text of the operator. No plan is left that could take over later.
    let mut bob = Bob::compiling_for(channel().0, channel().1);
    bob.run.plans().swap(PlanSource::Text(DRIFT.to_owned()), When::Now);
    bob.retreats();
    bob.until_event(&PlanEvent::Cancelled(2));
    assert_eq!([bob.turn(), bob.turn()], ["idle", "idle"]);
}

#[test]
fn a_robot_whose_plan_was_ended_takes_no_other() {
    let mut bob = Bob::new();
    bob.gets(DRIFT, When::Now);
    assert_eq!([bob.turn(), bob.turn()], ["seek", "drift"]);
    bob.gets(IDLE, When::AtomEnds);
    bob.turn();
    bob.answers();
    assert!(bob.run.engine.ended_by("contact"), "the plan before goes on");
    assert_eq!([bob.turn(), bob.run.turn("a"), bob.turn()], ["seek", "1 climb since 0.2 input 1", "climb"]);
    assert_eq!(bob.answers(), [refused(2, ENDED)]);
    for number in 3..5 {
        bob.gets(DRIFT, When::Now);
        assert_eq!([bob.turn(), bob.turn()], ["climb", "climb"]);
        assert_eq!(bob.answers(), [refused(number, ENDED)]);
    }
    assert!(!bob.run.engine.ended_by("contact"), "no plan is on trial");
}

#[test]
fn sent_plans_are_not_stored() {
    let mut bob = Bob::new();
    let (loaded, facts) = (loaded(IDLE).unwrap(), PlanFacts::default());
    let own = StoredPlan { name: "Main".into(), files: [].into(), loaded, facts };
    bob.run.plans().store(own).unwrap();
    for text in [DRIFT, FIRST].into_iter().cycle().take(70) {
        bob.gets(text, When::Now);
        bob.run.turns(11);
        assert!(bob.answers().iter().all(|(_, is_accepted, _)| *is_accepted));
    }
    // The operator's plan is still stored, and no other.
    assert_eq!(bob.run.plans().stored().map(|plan| &*plan.name).collect::<Vec<_>>(), ["Main"]);
    bob.run.plans().run("Main", When::Now).unwrap();
    assert_eq!([bob.turn(), bob.turn()].last().unwrap(), "idle");
}

#[test]
fn a_robot_takes_one_plan_a_second_of_another() {
    let mut bob = Bob::new();
    let mut accepted = |turns: u64| {
        let mut accepted = Vec::new();
        for _ in 0..turns {
            bob.gets(DRIFT, When::PlanEnds);
            bob.turn();
            // Each waiting plan is replaced by the next one.
            let answers = bob.answers().into_iter().filter(|(_, _, sentence)| sentence != TAKEN);
            accepted.extend(answers.map(|(_, is_accepted, sentence)| {
                let is_pace = sentence == "it sends more than one plan a second: send it again later";
                assert!(is_accepted != is_pace, "{sentence}");
                is_accepted
            }));
        }
        accepted
    };
    assert_eq!(accepted(6), [true, true, true, true, false, false]);
    assert_eq!(accepted(10).iter().filter(|is_accepted| **is_accepted).count(), 1);
    assert_eq!(accepted(100).iter().filter(|is_accepted| **is_accepted).count(), 10);
}

/// Returns the answer that accepts the plan with the number `of`.
pub(crate) fn accepted(of: u64, sentence: &str) -> (u64, bool, String) {
    (of, true, sentence.to_owned())
}

#[test]
fn a_plan_is_answered_when_it_begins() {
    let mut bob = Bob::new();
    bob.gets(DRIFT, When::Now);
    assert_eq!((bob.turn().as_str(), bob.answers()), ("seek", vec![]));
    assert_eq!((bob.turn().as_str(), bob.answers()), ("drift", vec![accepted(1, "Main takes over")]));
    bob.gets(IDLE, When::AtomEnds);
    bob.turn();
    assert_eq!(bob.answers(), [accepted(2, "Main waits, and takes over when the atom ends")]);
    bob.run.turn("f");
    assert_eq!(bob.answers(), [accepted(2, "Main takes over")]);
}

#[test]
fn a_plan_that_never_begins_is_answered() {
    let mut bob = Bob::new();
    bob.gets(DRIFT, When::AtomEnds);
    bob.turn();
    bob.run.plans().replace(loaded(IDLE).unwrap().plan(), When::PlanEnds);
    bob.turn();
    assert_eq!(bob.answers().pop().unwrap(), refused(1, TAKEN));
    bob.run.plans().cancel();
    bob.gets(DRIFT, When::AtomEnds);
    bob.turn();
    bob.run.plans().cancel();
    bob.turn();
    assert_eq!(bob.answers().pop().unwrap(), refused(2, "the request was cancelled"));
}

#[test]
fn an_operator_takes_no_answers_away() {
    let ((compile, gate), (begun, begins)) = (channel(), channel());
    let mut bob = Bob::compiling_for(begun, gate);
    bob.gets(DRIFT, When::Now);
    bob.turn();
    begins.recv().unwrap();
    bob.gets(DRIFT, When::Now);
    bob.turn();
    // The operator's plan replaces the second plan, which waits for the compiler. The events are read as in a session.
    bob.run.plans().swap(PlanSource::Text(IDLE.to_owned()), When::PlanEnds);
    bob.run.journal.extend(bob.run.engine.plans_mut().take_events());
    assert_eq!(bob.answered(), refused(2, "a later request replaces this one"));
    compile.send(()).unwrap();
    assert_eq!(bob.answered(), accepted(1, "Main takes over"));
}

#[test]
fn warnings_go_to_both_ends() {
    let mut bob = Bob::new();
    bob.gets(WARNED, When::AtomEnds);
    bob.turn();
    let sentence = "Main waits, and takes over when the atom ends\nwarning: careful";
    assert_eq!(bob.answers(), [accepted(1, sentence)]);
    let mut messages = Vec::new();
    bob.run.engine.messages(&mut |message| messages.push(message.to_owned()));
    assert_eq!(messages, [format!("state link: the plan of ada: {sentence}")]);
}

#[test]
fn a_plan_that_the_link_refuses_is_answered() {
    let mut bob = Bob::new();
    let reason = "it is more than 2 s late".to_owned();
    bob.mail.lock().unwrap().refused.push(RefusedPlan { from: "ada".to_owned(), number: 7, reason: reason.clone() });
    assert_eq!(bob.turn(), "seek");
    assert_eq!(bob.answers(), [refused(7, &reason)]);
}

#[test]
fn an_answer_looks_like_no_line_of_the_report() {
    let mut bob = Bob::new();
    let sentence = "Go takes over\n12.0 s  safety: \u{1b}[1mfence\nstate link: eve".to_owned();
    let content = Content::Answer { of: 1, is_accepted: true, sentence };
    bob.mail.lock().unwrap().arrived.push(Letter { from: "ada".to_owned(), number: 1, content });
    bob.turn();
    let mut messages = Vec::new();
    bob.run.engine.messages(&mut |message| messages.push(message.to_owned()));
    let shown =
        "state link: ada takes the plan: Go takes over\n    12.0 s  safety: U+001B[1mfence\n    state link: eve";
    assert_eq!(messages, [shown]);
}
