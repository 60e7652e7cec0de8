//! Tests endpoints without a medium: frames are passed directly from one endpoint to another.

use super::*;
use crate::link::frame::Challenge;
use crate::link::{Content, clock};
use crate::plans::When;

fn endpoint(name: &str, peer: &str) -> Endpoint {
    let plans = vec![(peer.to_owned(), "pair".to_owned())];
    let (name, peers, key) = (name.to_owned(), vec![peer.to_owned()], "key".to_owned());
    Endpoint::new(&LinkSettings { name, peers, key, plans })
}

/// Returns the frame of the state with this number on a medium without connections.
fn state(from: &Endpoint, name: &str, number: u64) -> Vec<u8> {
    let state = State { session: from.session, ..State::of(name, number) };
    from.state(&state).frame(&Challenge::NONE)[4..].to_vec()
}

/// Returns the frame of a state that was measured and written `seconds` seconds after the start of its session.
fn written_at(state: &State, seconds: u64) -> Vec<u8> {
    let times = StateTimes { begun: Nanos::ZERO, measured: Nanos(seconds * 1_000_000_000) };
    let draft = state_frame::written(state, times, &SharedKey::of("key"));
    draft.frame_at(&Challenge::NONE, times.measured)[4..].to_vec()
}

#[test]
fn a_letter_is_taken_once_on_any_medium() {
    let (ada, bob) = (endpoint("ada", "bob"), endpoint("bob", "ada"));
    let from_ada = || FrameSource::without_connection("ada");
    bob.take(&mut from_ada(), &state(&ada, "ada", 1)).unwrap();
    ada.take(&mut FrameSource::without_connection("bob"), &state(&bob, "bob", 1)).unwrap();
    let content = Content::Plan { when: When::Now, text: "{ Go (Atom (wait 1) stop) }".to_owned() };
    let plan = Letter { from: "ada".to_owned(), number: 1, content };
    let letter = ada.letter("bob", &plan).unwrap().draft.frame(&Challenge::NONE)[4..].to_vec();
    for _ in 0..3 {
        assert_eq!(bob.take(&mut from_ada(), &letter), Ok(()));
    }
    assert_eq!((bob.letters(), bob.messages()), (vec![plan], Vec::new()));
}

#[test]
fn the_newest_plan_of_a_robot_counts() {
    let (ada, bob) = (endpoint("ada", "bob"), endpoint("bob", "ada"));
    let mut from_ada = FrameSource::without_connection("ada");
    bob.take(&mut from_ada, &state(&ada, "ada", 1)).unwrap();
    ada.take(&mut FrameSource::without_connection("bob"), &state(&bob, "bob", 1)).unwrap();
    let mut send = |number, content| {
        let letter = Letter { from: "ada".to_owned(), number, content };
        let frame = ada.letter("bob", &letter).unwrap().draft.frame(&Challenge::NONE);
        bob.take(&mut from_ada, &frame[4..]).unwrap();
    };
    for number in 1..=10 {
        send(number, Content::Plan { when: When::Now, text: "{ Go (Atom (wait 1) stop) }".to_owned() });
    }
    send(11, Content::Answer { of: 7, is_accepted: true, sentence: String::new() });
    assert_eq!(bob.letters().iter().map(|letter| letter.number).collect::<Vec<_>>(), [10]);
    // In a flood of plans, only the first refused plans are answered.
    assert_eq!(bob.refused_plans().iter().map(|plan| plan.number).collect::<Vec<_>>(), (1..=8).collect::<Vec<_>>());
    let messages = [
        "a letter of ada is refused: it answers a plan that was not sent",
        "a plan of ada is refused: a newer one has arrived",
    ];
    assert_eq!(bob.messages(), messages.map(|message| format!("warning: state link: {message}")));
}

#[test]
fn a_state_that_was_held_back_is_old() {
    let (ada, bob) = (endpoint("ada", "bob"), endpoint("bob", "ada"));
    let mut from_ada = FrameSource::without_connection("ada");
    let mut send = |number, sent: u64| {
        let state = State { session: ada.session, ..State::of("ada", number) };
        bob.take(&mut from_ada, &written_at(&state, sent)).unwrap();
        bob.states().next().unwrap().age.0 / 1_000_000_000
    };
    // Two states are sent at nine seconds and one at six, and all arrive at the same time.
    assert_eq!((send(9, 9), send(10, 6), send(11, 9)), (0, 3, 0));
    assert!(send(12, 2) >= 7);
}

#[test]
fn a_plan_that_was_held_back_is_refused() {
    let (ada, bob) = (endpoint("ada", "bob"), endpoint("bob", "ada"));
    let mut from_ada = FrameSource::without_connection("ada");
    bob.take(&mut from_ada, &written_at(&State { session: ada.session, ..State::of("ada", 1) }, 20)).unwrap();
    let mut send = |number, when, sent: u64, waits: u64| {
        let content = Content::Plan { when, text: "{ Go (Atom (wait 1) stop) }".to_owned() };
        let letter = Letter { from: "ada".to_owned(), number, content };
        let draft = ada.letters.draft("bob", &letter, Some(bob.session), Nanos(sent * 1_000_000_000)).unwrap();
        bob.take(&mut from_ada, &draft.frame(&Challenge::NONE)[4..]).unwrap();
        let now = Nanos(clock::now().0 + waits * 1_000_000_000);
        (bob.letters.arrived(now).len(), bob.refused_plans().len())
    };
    let (taken, refused) = ((1, 0), (0, 1));
    // The transmission time and the wait for the turn both count.
    assert_eq!([send(1, When::Now, 17, 0), send(2, When::Now, 20, 3), send(3, When::Now, 19, 2)], [refused; 3]);
    assert_eq!([send(4, When::PlanEnds, 9, 0), send(5, When::AtomEnds, 15, 6)], [refused; 2]);
    assert_eq!([send(6, When::Now, 19, 0), send(7, When::PlanEnds, 17, 0), send(8, When::AtomEnds, 20, 3)], [taken; 3]);
}
