//! Tests plans from the operator and from other robots at the same time: the operator's plans take precedence.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::mpsc::channel;

use mdle_engine::{PlanEvent, PlanSource, When};

use crate::engine::loaded;
use crate::sent_plans::{Bob, DRIFT, FIRST, IDLE, REPLACED, accepted, refused};

const WAITS: &str = "a plan of the operator waits to take over: send the plan again later";
const LATER: &str = "a later request replaces this one";

fn text(plan: &str) -> PlanSource {
    PlanSource::Text(plan.to_owned())
}

#[test]
fn a_barred_robot_gives_the_compiler_nothing_to_do() {
    let ((compile, gate), (begun, begins)) = (channel(), channel());
    let mut bob = Bob::compiling_for(begun, gate);
    bob.turn();
    bob.retreats();
    bob.gets(DRIFT, When::Now);
    assert_eq!(bob.turn(), "idle");
    assert_eq!(bob.answers(), [refused(1, REPLACED)], "in the turn in which it has come");
    let own = bob.run.plans().swap(text(FIRST), When::Now);
    bob.gets(IDLE, When::Now);
    bob.turn();
    compile.send(()).unwrap();
    bob.until_event(&PlanEvent::Began(own));
    assert_eq!(bob.turn(), "seek");
    assert_eq!(begins.try_iter().count(), 1, "the operator's plan");
    assert_eq!(bob.answers(), [refused(2, REPLACED)]);
}

#[test]
fn a_sent_plan_takes_no_request_of_the_operator_back() {
    let ((compile, gate), (begun, begins)) = (channel(), channel());
    let mut bob = Bob::compiling_for(begun, gate);
    bob.gets(DRIFT, When::Now);
    bob.turn();
    begins.recv().unwrap();
    let own = bob.run.plans().swap(text(IDLE), When::Now);
    // The operator's plan and the sent plan both wait for the compiler.
    bob.gets(DRIFT, When::PlanEnds);
    bob.turn();
    assert_eq!(bob.answers(), []);
    compile.send(()).unwrap();
    assert_eq!(bob.answered(), accepted(1, "Main takes over"));
    begins.recv().unwrap();
    compile.send(()).unwrap();
    bob.until_event(&PlanEvent::Began(own));
    assert_eq!(bob.answers(), []);
    compile.send(()).unwrap();
    assert_eq!(bob.answered(), accepted(2, "Main waits, and takes over when the plan ends"));
    assert_eq!(bob.turn(), "idle");
}

#[test]
fn requests_of_the_operator_are_compiled_first() {
    let ((compile, gate), (begun, begins)) = (channel(), channel());
    let mut bob = Bob::compiling_for(begun, gate);
    bob.gets(DRIFT, When::Now);
    bob.turn();
    begins.recv().unwrap();
    // The second plan waits for the compiler, and the newer third plan replaces it.
    bob.gets(DRIFT, When::Now);
    bob.turn();
    bob.gets(IDLE, When::Now);
    bob.turn();
    assert_eq!(bob.answers(), [refused(2, LATER)]);
    let own = bob.run.plans().load(text(FIRST));
    (0..2).for_each(|_| compile.send(()).unwrap());
    bob.until_event(&PlanEvent::Stored(own, vec!["Main".into()]));
    assert_eq!(bob.answers(), [accepted(1, "Main takes over")]);
    compile.send(()).unwrap();
    assert_eq!(bob.answered(), accepted(3, "Main takes over"));
    // The operator's plan replaces a plan that waits for the compiler.
    bob.run.turns(30);
    bob.gets(DRIFT, When::PlanEnds);
    bob.turn();
    // The compiler has begun with the operator's text, the third plan and the fourth plan.
    (0..3).for_each(|_| begins.recv().unwrap());
    bob.gets(IDLE, When::PlanEnds);
    bob.turn();
    assert_eq!(bob.answers(), []);
    bob.run.plans().run("Main", When::Now).unwrap();
    assert_eq!(bob.answered(), refused(5, LATER));
}

#[test]
fn a_sent_plan_takes_no_place_of_a_plan_of_the_operator() {
    let mut bob = Bob::new();
    bob.run.plans().replace(loaded(IDLE).unwrap().plan(), When::PlanEnds);
    for (number, when) in (1..).zip([When::Now, When::AtomEnds, When::PlanEnds]) {
        bob.gets(DRIFT, when);
        assert_eq!([bob.turn(), bob.turn()], ["seek", "seek"]);
        assert_eq!(bob.answers(), [refused(number, WAITS)], "{when:?}");
        assert_eq!(bob.run.plans().armed(), Some(("Main", When::PlanEnds)));
    }
    // The operator's plan begins and no longer waits.
    bob.run.turn("b");
    assert_eq!(bob.turn(), "idle");
    bob.run.turns(10);
    bob.gets(DRIFT, When::Now);
    assert_eq!([bob.turn(), bob.turn()], ["idle", "drift"]);
}

#[test]
fn a_plan_that_is_being_compiled_takes_no_place_either() {
    let ((compile, gate), (begun, begins)) = (channel(), channel());
    let mut bob = Bob::compiling_for(begun, gate);
    bob.gets(DRIFT, When::Now);
    bob.turn();
    begins.recv().unwrap();
    bob.run.plans().replace(loaded(IDLE).unwrap().plan(), When::PlanEnds);
    bob.turn();
    compile.send(()).unwrap();
    assert_eq!(bob.answered(), refused(1, WAITS));
    assert_eq!(bob.run.plans().armed(), Some(("Main", When::PlanEnds)));
}
