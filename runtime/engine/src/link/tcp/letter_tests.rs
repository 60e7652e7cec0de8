//! Tests of letters over TCP on this machine: letters that arrive, and frames that are refused.

use std::io::Write as _;
use std::net::{SocketAddr, TcpStream};

use mdle_runtime::Nanos;

use super::tests::{address, assert_goes_on, bound, frame, greeted, message, received, settings, state, wait};
use super::*;
use crate::link::frame::{Challenge, Draft, Key};
use crate::link::letter_frame::{self, Envelope};
use crate::link::{Content, LONGEST_TEXT};
use crate::plans::When;

fn plan(from: &str, number: u64) -> Letter {
    let content = Content::Plan { when: When::Now, text: "{ Go (Atom (wait 1) stop) }".to_owned() };
    Letter { from: from.to_owned(), number, content }
}

/// Returns the settings of a robot that exchanges plans with this peer.
fn exchanging(name: &str, (peer, at): (&str, SocketAddr), key: &str) -> TcpSettings {
    let mut settings = settings(name, &[(peer, at)], "key");
    settings.link.plans.push((peer.to_owned(), key.to_owned()));
    settings
}

fn letters(link: &mut Tcp) -> Vec<Letter> {
    let mut letters = Vec::new();
    link.letters(Nanos::ZERO, &mut |letter| letters.push(letter));
    letters
}

/// Returns the link of `bob`, who takes plans of `ada`, and its address.
fn bob() -> (Tcp, SocketAddr) {
    let (own, nobody) = (bound(), address(&bound()));
    let place = address(&own);
    (Tcp::on(own, &exchanging("bob", ("ada", nobody), "pair")).unwrap(), place)
}

/// Sends the state of `ada`, and then these bytes, which are written for the challenge.
fn sends(place: SocketAddr, bytes: impl FnOnce(&Challenge) -> Vec<u8>) -> TcpStream {
    let (mut stream, challenge) = greeted(place);
    stream.write_all(&frame(&state("ada", 1), "key", &challenge)).unwrap();
    // The connection may be refused meanwhile.
    let _ = stream.write_all(&bytes(&challenge));
    stream
}

#[test]
fn letters_go_both_ways_once_both_are_heard() {
    let (one, other) = (bound(), bound());
    let (at_ada, at_bob) = (address(&one), address(&other));
    let mut ada = Tcp::on(one, &exchanging("ada", ("bob", at_bob), "pair")).unwrap();
    let mut bob = Tcp::on(other, &exchanging("bob", ("ada", at_ada), "pair")).unwrap();
    assert_eq!(ada.post("bob", &plan("ada", 1), Nanos::ZERO), Err("bob has not been heard yet".to_owned()));
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

/// Returns the envelope of a letter of `ada` to a robot in this session.
fn envelope(meant_for: u64) -> Envelope {
    Envelope { from: "ada".to_owned(), to: "bob".to_owned(), sent_in: 5, meant_for, sent: Nanos::ZERO }
}

#[test]
fn what_is_no_letter_of_a_peer_is_refused() {
    let (mut bob, place) = bob();
    let (meant_for, own) = (bob.session(), envelope(bob.session()));
    let letter = |envelope: &Envelope, key| {
        let draft = letter_frame::written(envelope, &plan(&envelope.from, 1), &Key::of_letters(key));
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
    let cases: [(&dyn Fn(&Challenge) -> Vec<u8>, &str); 9] = [
        (&damaged, "it sends no letters"),
        (&long, "it sends no states"),
        (&letter(&own, "another"), "it sends a letter of `ada` with another key `plans`"),
        (&letter(&own, "key"), "it sends a letter of `ada` with another key `plans`"),
        (&recorded, "it sends a letter of `ada` with another key `plans`"),
        (&letter(&Envelope { from: eve(), ..own.clone() }, "pair"), "of `ada` that is not for this run"),
        (&letter(&Envelope { to: eve(), ..own.clone() }, "pair"), "of `ada` that is not for this run"),
        (&letter(&Envelope { sent_in: 6, ..own.clone() }, "pair"), "of `ada` that is not for this run"),
        (&letter(&envelope(meant_for ^ 1), "pair"), "of `ada` that is not for this run"),
    ];
    for (bytes, words) in cases {
        let stream = sends(place, bytes);
        message(&mut bob, words);
        drop(stream);
        assert_eq!(letters(&mut bob), [], "{words}");
    }
    let mut first = greeted(place);
    first.0.write_all(&good(&first.1)).unwrap();
    message(&mut bob, "it sends a letter before its state");
    // The good one is taken, and a copy of it is not.
    let first = sends(place, &good);
    assert_eq!(wait(|| Some(letters(&mut bob)).filter(|letters| !letters.is_empty())), [plan("ada", 1)]);
    let second = sends(place, &good);
    message(&mut bob, "it sends a letter of `ada` once more");
    assert_eq!(letters(&mut bob), []);
    drop((first, second));
    received(&mut bob);
    assert_goes_on(&mut bob, place);
}

#[test]
fn a_flood_of_letters_is_refused() {
    let (mut bob, place) = bob();
    let envelope = envelope(bob.session());
    let draft = |number| -> Draft { letter_frame::written(&envelope, &plan("ada", number), &Key::of_letters("pair")) };
    let stream = sends(place, |challenge| (1..=50).flat_map(|number| draft(number).frame(challenge)).collect());
    message(&mut bob, "more than 8 letters arrive in a turn");
    assert_eq!(letters(&mut bob).len(), 8);
    drop(stream);
    let (mut stream, challenge) = greeted(place);
    stream.write_all(&frame(&state("ada", 2), "key", &challenge)).unwrap();
    let mut number = 100;
    wait(|| {
        number += 1;
        let is_closed = stream.write_all(&draft(number).frame(&challenge)).is_err();
        letters(&mut bob);
        is_closed.then_some(())
    });
    message(&mut bob, "more than 20 letters a second");
    received(&mut bob);
    assert_goes_on(&mut bob, place);
}

#[test]
fn letters_that_nobody_reads_delay_no_turn() {
    let (listener, own) = (bound(), bound());
    let (at_ada, place) = (address(&listener), address(&own));
    let mut bob = Tcp::on(own, &exchanging("bob", ("ada", at_ada), "pair")).unwrap();
    let stream = sends(place, |_| Vec::new());
    wait(|| Some(received(&mut bob)).filter(|states| !states.is_empty()));
    drop(listener);
    let content = Content::Plan { when: When::Now, text: " ".repeat(LONGEST_TEXT) };
    let long = Letter { content, ..plan("bob", 1) };
    let refused = wait(|| bob.post("ada", &long, Nanos::ZERO).err());
    assert_eq!(refused, "8 letters wait for ada already");
    drop(stream);
}
