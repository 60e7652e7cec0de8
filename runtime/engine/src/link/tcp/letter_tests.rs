//! Tests letters over TCP on this machine: valid letters arrive, and invalid frames are rejected.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};

use mdle_runtime::Nanos;

use super::tests::{
    SOON, address, assert_goes_on, bound, frame, greeted, message, read_messages, received, settings, state, wait,
};
use super::*;
use crate::link::frame::{Challenge, FrameDraft, SharedKey};
use crate::link::letter_frame::{self, Envelope, is_letter};
use crate::link::{Content, LONGEST_TEXT};
use crate::plans::When;

pub(super) fn plan(from: &str, number: u64) -> Letter {
    let content = Content::Plan { when: When::Now, text: "{ Go (Atom (wait 1) stop) }".to_owned() };
    Letter { from: from.to_owned(), number, content }
}

/// Returns the settings of a robot that exchanges plans with this peer.
fn exchanging(name: &str, (peer, at): (&str, SocketAddr), key: &str) -> TcpSettings {
    let mut settings = settings(name, &[(peer, at)], "key");
    settings.link.plans.push((peer.to_owned(), key.to_owned()));
    settings
}

pub(super) fn letters(link: &mut Tcp) -> Vec<Letter> {
    let mut letters = Vec::new();
    link.letters(Nanos::ZERO, &mut |letter| letters.push(letter));
    letters
}

/// Returns the link of `bob`, which accepts plans from `ada`, and its address.
pub(super) fn bob() -> (Tcp, SocketAddr) {
    let (own, nobody) = (bound(), address(&bound()));
    let place = address(&own);
    (Tcp::on(own, &exchanging("bob", ("ada", nobody), "pair")).unwrap(), place)
}

/// Sends the state of `ada`, followed by the bytes that `bytes` returns for the challenge.
fn sends(place: SocketAddr, bytes: impl FnOnce(&Challenge) -> Vec<u8>) -> TcpStream {
    let (mut stream, challenge) = greeted(place);
    stream.write_all(&frame(&state("ada", 1), "key", &challenge)).unwrap();
    // The connection may have been refused in the meantime.
    let _ = stream.write_all(&bytes(&challenge));
    stream
}

#[test]
fn letters_go_both_ways_once_both_are_heard() {
    let (one, other) = (bound(), bound());
    let (at_ada, at_bob) = (address(&one), address(&other));
    let mut ada = Tcp::on(one, &exchanging("ada", ("bob", at_bob), "pair")).unwrap();
    let mut bob = Tcp::on(other, &exchanging("bob", ("ada", at_ada), "pair")).unwrap();
    let unheard =
        Err("bob has not been heard yet; send the plan again once it runs with a link to this robot".to_owned());
    assert_eq!(ada.post("bob", &plan("ada", 1), Nanos::ZERO), unheard);
    assert_eq!(ada.post("eve", &plan("ada", 1), Nanos::ZERO), Err("there is no robot `eve`".to_owned()));
    let mut number = 0;
    let mut send = |robot: &str, link: &mut Tcp| {
        number += 1;
        let session = link.session();
        link.send(&State { session, ..state(robot, number) }, Nanos::ZERO);
    };
    wait(|| {
        send("ada", &mut ada);
        send("bob", &mut bob);
        ada.post("bob", &plan("ada", 1), Nanos::ZERO).ok()
    });
    let answer = Content::Answer { of: 1, is_accepted: true, sentence: "Go takes over".to_owned() };
    let answer = Letter { from: "bob".to_owned(), number: 1, content: answer };
    assert_eq!(wait(|| Some(letters(&mut bob)).filter(|letters| !letters.is_empty())), [plan("ada", 1)]);
    wait(|| bob.post("ada", &answer, Nanos::ZERO).ok());
    assert_eq!(wait(|| Some(letters(&mut ada)).filter(|letters| !letters.is_empty())), [answer]);
}

/// Returns the envelope of a letter from `ada` to a robot in this session.
pub(super) fn envelope(meant_for: u64) -> Envelope {
    Envelope { from: "ada".to_owned(), to: "bob".to_owned(), sent_in: 5, meant_for, sent: Nanos::ZERO }
}

/// Bytes that a peer sends in response to a challenge, and the expected message about them.
type Case<'c> = (&'c dyn Fn(&Challenge) -> Vec<u8>, &'c str);

#[test]
fn what_is_no_letter_of_a_peer_is_refused() {
    let (mut bob, place) = bob();
    let own = envelope(bob.session());
    let letter = |envelope: &Envelope, key| {
        let draft = letter_frame::written(envelope, &plan(&envelope.from, 1), &SharedKey::of_letters(key));
        move |challenge: &Challenge| draft.frame(challenge)
    };
    let good = letter(&own, "pair");
    let damaged = |challenge: &Challenge| {
        let mut damaged = good(challenge);
        *damaged.last_mut().unwrap() ^= 1;
        damaged
    };
    let long = |challenge: &Challenge| {
        let mut long = good(challenge);
        long.resize(LONGEST_TEXT + 4096, b' ');
        long[..4].copy_from_slice(&(LONGEST_TEXT as u32 + 4092).to_le_bytes());
        long
    };
    let recorded = |_: &Challenge| good(&Challenge::NONE);
    let eve = || "eve".to_owned();
    let cases: [Case<'_>; 7] = [
        (&damaged, "a letter of ada is refused: it is damaged"),
        (&letter(&own, "another"), "a letter of ada is refused: it has another key `plans`"),
        (&letter(&own, "key"), "it has another key `plans`"),
        (&recorded, "it has another key `plans`, or was recorded"),
        (&letter(&Envelope { from: eve(), ..own.clone() }, "pair"), "of ada is refused: it is not for this run"),
        (&letter(&Envelope { to: eve(), ..own.clone() }, "pair"), "of ada is refused: it is not for this run"),
        (&letter(&Envelope { sent_in: 6, ..own.clone() }, "pair"), "of ada is refused: it is not for this run"),
    ];
    let (mut messages, mut number) = (Vec::new(), 1);
    for (bytes, words) in cases {
        number += 1;
        // When the state after the letter arrives, the letter has been read.
        let after = |challenge: &Challenge| frame(&state("ada", number), "key", challenge);
        let stream = sends(place, |challenge| [bytes(challenge), after(challenge)].concat());
        wait(|| received(&mut bob).into_iter().find(|state| state.number == number));
        read_messages(&mut bob, &mut messages);
        assert!(messages.iter().any(|message| message.contains(words)), "{words}: {messages:?}");
        drop(stream);
        assert_eq!(letters(&mut bob), [], "{words}");
    }
    let stream = sends(place, long);
    message(&mut bob, "the connection of ada is refused: it sends neither states nor letters");
    drop(stream);
    let mut first = greeted(place);
    first.0.write_all(&good(&first.1)).unwrap();
    message(&mut bob, "it sends a letter before its state");
    // The valid letter is accepted, and its copy is ignored.
    let first = sends(place, &good);
    assert_eq!(wait(|| Some(letters(&mut bob)).filter(|letters| !letters.is_empty())), [plan("ada", 1)]);
    received(&mut bob);
    let after = |challenge: &Challenge| frame(&state("ada", 60), "key", challenge);
    let second = sends(place, |challenge| [good(challenge), after(challenge)].concat());
    assert_eq!(wait(|| received(&mut bob).pop()), state("ada", 60));
    assert_eq!(letters(&mut bob), []);
    drop((first, second));
    assert_goes_on(&mut bob, place);
}

#[test]
fn a_flood_of_letters_is_refused() {
    let (mut bob, place) = bob();
    let envelope = envelope(bob.session());
    let draft = |number| -> FrameDraft {
        letter_frame::written(&envelope, &plan("ada", number), &SharedKey::of_letters("pair"))
    };
    let (mut stream, challenge) = greeted(place);
    stream.write_all(&frame(&state("ada", 2), "key", &challenge)).unwrap();
    let mut number = 100;
    wait(|| {
        number += 1;
        let is_closed = stream.write_all(&draft(number).frame(&challenge)).is_err();
        letters(&mut bob);
        is_closed.then_some(())
    });
    message(&mut bob, "more than 40 letters a second");
    received(&mut bob);
    assert_goes_on(&mut bob, place);
}

/// Accepts the connection of a robot as its peer, and returns the letter that arrives first.
pub(super) fn first_letter(listener: &TcpListener) -> Letter {
    let (mut stream, _) = listener.accept().unwrap();
    stream.set_read_timeout(Some(SOON)).unwrap();
    stream.write_all(&Challenge::NONE.greeting()).unwrap();
    let mut frame = || {
        let mut length = [0; 4];
        stream.read_exact(&mut length).unwrap();
        let mut frame = vec![0; u32::from_le_bytes(length) as usize];
        stream.read_exact(&mut frame).unwrap();
        frame
    };
    assert!(!is_letter(&frame()), "a connection begins with the state");
    let begun = Instant::now();
    loop {
        let frame = frame();
        if is_letter(&frame) {
            return letter_frame::read(&frame, &SharedKey::of_letters("pair"), &Challenge::NONE).unwrap().1;
        }
        assert!(begun.elapsed() < SOON, "no letter arrives");
    }
}

/// Returns the link of `bob` after a state of `ada` has arrived, the listener of `ada`, and the connection of `ada` to
/// `bob`.
pub(super) fn bob_with_listener() -> (Tcp, TcpListener, TcpStream) {
    let (listener, own) = (bound(), bound());
    let (at_ada, place) = (address(&listener), address(&own));
    let mut bob = Tcp::on(own, &exchanging("bob", ("ada", at_ada), "pair")).unwrap();
    let heard = sends(place, |_| Vec::new());
    wait(|| received(&mut bob).pop());
    (bob, listener, heard)
}

#[test]
fn a_letter_is_sent_once_more_on_a_new_connection() {
    let content = Content::Plan { when: When::PlanEnds, text: "{ Go (Atom (wait 1) stop) }".to_owned() };
    let patient = Letter { content, ..plan("bob", 2) };
    let content = Content::Answer { of: 1, is_accepted: true, sentence: "Go takes over".to_owned() };
    for letter in [patient, Letter { content, ..plan("bob", 2) }] {
        let (mut bob, listener, heard) = bob_with_listener();
        let refused = bob.post("ada", &plan("bob", 1), Nanos::ZERO);
        assert_eq!(refused, Err("ada cannot be reached at the moment".to_owned()));
        bob.send(&state("bob", 1), Nanos::ZERO);
        let ada = std::thread::spawn(move || [(); 2].map(|()| first_letter(&listener)));
        wait(|| bob.post("ada", &letter, Nanos::ZERO).ok());
        assert_eq!(ada.join().unwrap(), [letter.clone(), letter]);
        drop(heard);
    }
}
