//! Tests answers over TCP on this machine: plans are refused on arrival, and floods of answers are rejected.

use std::io::{Read as _, Write as _};

use mdle_runtime::Nanos;

use super::letter_tests::{bob, bob_with_listener, envelope, first_letter, letters, plan};
use super::tests::{frame, greeted, message, read_messages, received, state, wait};
use super::*;
use crate::link::frame::{FrameDraft, SharedKey, StateTimes};
use crate::link::letter_frame::{self, Envelope};
use crate::link::state_frame::written;
use crate::plans::When;

/// Returns the frame of a letter from `ada` to `bob`, posted `sent` seconds after the start of the session of `ada`.
fn posted(meant_for: u64, sent: u64, letter: &Letter) -> FrameDraft {
    let envelope = Envelope { sent: Nanos(sent * 1_000_000_000), ..envelope(meant_for) };
    letter_frame::written(&envelope, letter, &SharedKey::of_letters("pair"))
}

#[test]
fn a_plan_that_is_refused_on_arrival_is_answered() {
    let (mut bob, place) = bob();
    let session = bob.session();
    let plan = |number, when| {
        let content = Content::Plan { when, text: "{ Go (Atom (wait 1) stop) }".to_owned() };
        Letter { content, ..plan("ada", number) }
    };
    let drafts = [
        posted(session, 17, &plan(1, When::Now)),
        posted(session, 9, &plan(2, When::AtomEnds)),
        posted(session, 9, &plan(3, When::PlanEnds)),
        posted(session ^ 1, 20, &plan(4, When::PlanEnds)),
        posted(session, 11, &plan(5, When::PlanEnds)),
        posted(session, 19, &plan(6, When::Now)),
    ];
    let (mut stream, challenge) = greeted(place);
    let times = StateTimes { begun: Nanos::ZERO, measured: Nanos(20_000_000_000) };
    let begin = written(&state("ada", 1), times, &SharedKey::of("key")).frame_at(&challenge, times.measured);
    stream.write_all(&begin).unwrap();
    // Each plan is sent on a second connection as well, and answered once.
    for frame in drafts.iter().chain(&drafts).map(|draft| draft.frame(&challenge)) {
        stream.write_all(&frame).unwrap();
    }
    stream.write_all(&frame(&state("ada", 2), "key", &challenge)).unwrap();
    wait(|| received(&mut bob).into_iter().find(|state| state.number == 2));
    let (mut refused, mut messages) = (Vec::new(), Vec::new());
    assert_eq!(letters(&mut bob), [plan(6, When::Now)]);
    bob.refused_plans(&mut |plan| refused.push((plan.number, plan.reason)));
    let reasons = [
        (1, "it is more than 2 s late"),
        (2, "it is more than 10 s late"),
        (3, "it is more than 10 s late"),
        (4, "it was sent to an earlier run of bob"),
        (5, "a newer one has arrived"),
    ];
    assert_eq!(refused, reasons.map(|(number, reason)| (number, reason.to_owned())));
    read_messages(&mut bob, &mut messages);
    for (_, reason) in reasons {
        let message = format!("warning: state link: a plan of ada is refused: {reason}");
        assert_eq!(messages.iter().filter(|other| **other == message).count(), 1, "{messages:?}");
    }
}

#[test]
fn a_flood_of_answers_is_refused() {
    let (mut bob, listener, mut stream) = bob_with_listener();
    bob.send(&state("bob", 1), Nanos::ZERO);
    let ada = std::thread::spawn(move || first_letter(&listener));
    wait(|| bob.post("ada", &plan("bob", 1), Nanos::ZERO).ok());
    assert_eq!(ada.join().unwrap(), plan("bob", 1));
    let (mut again, challenge) = greeted(stream.peer_addr().unwrap());
    again.write_all(&frame(&state("ada", 2), "key", &challenge)).unwrap();
    let answer = |number: u64| {
        let content = Content::Answer { of: 1, is_accepted: true, sentence: number.to_string() };
        Letter { content, ..plan("ada", number) }
    };
    for number in 1..=10 {
        again.write_all(&posted(bob.session(), 0, &answer(number)).frame(&challenge)).unwrap();
    }
    message(&mut bob, "a letter of ada is refused: it is one of more than 3 answers to a plan");
    assert_eq!(letters(&mut bob), [1, 2, 3].map(answer));
    assert_eq!(stream.read(&mut [0]).unwrap_or_default(), 0, "a new connection replaces the old one");
}
