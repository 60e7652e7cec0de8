//! Tests of letters over TCP on this machine: letters that arrive, and frames that are refused.

use std::io::Write as _;
use std::net::{SocketAddr, TcpStream};

use mdle_runtime::Nanos;

use super::tests::{address, assert_goes_on, bound, message, received, settings, state, wait};
use super::*;
use crate::link::frame::written;
use crate::link::letter_frame::{self, Envelope};
use crate::link::{Content, LONGEST_TEXT};
use crate::plans::When;

fn plan(from: &str, number: u64) -> Letter {
    let content = Content::Plan { when: When::Now, text: "{ Go (Atom (wait 1) stop) }".to_owned() };
    Letter { from: from.to_owned(), number, content }
}

/// Returns the settings of a robot that exchanges plans with this peer.
fn exchanging(name: &str, (peer, at): (&str, SocketAddr), key: &str) -> TcpSettings {
    TcpSettings { plans: vec![(peer.to_owned(), key.to_owned())], ..settings(name, &[(peer, at)], "key") }
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

/// Sends the state of `ada`, and then these bytes.
fn sends(place: SocketAddr, bytes: &[u8]) -> TcpStream {
    let mut stream = TcpStream::connect(place).unwrap();
    stream.write_all(&written(&state("ada", 1), &Key::of("key"))).unwrap();
    // The connection may be refused meanwhile.
    let _ = stream.write_all(bytes);
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

#[test]
fn what_is_no_letter_of_a_peer_is_refused() {
    let (mut bob, place) = bob();
    let (meant_for, key) = (bob.session(), Key::of_letters("pair"));
    let own = Envelope { from: "ada".to_owned(), to: "bob".to_owned(), sent_in: 5, meant_for };
    let letter = |envelope: &Envelope, key: &Key| letter_frame::written(envelope, &plan(&envelope.from, 1), key);
    let mut damaged = letter(&own, &key);
    *damaged.last_mut().unwrap() ^= 1;
    let mut long = letter(&own, &key);
    long.resize(LONGEST_TEXT + 4096, b' ');
    long[..4].copy_from_slice(&(LONGEST_TEXT as u32 + 4092).to_le_bytes());
    let cases = [
        (damaged, "it sends no letters"),
        (long, "it sends no states"),
        (letter(&own, &Key::of_letters("another")), "it sends a plan as `ada` with another key"),
        (letter(&own, &Key::of("key")), "it sends a plan as `ada` with another key"),
        (letter(&Envelope { from: "eve".to_owned(), ..own.clone() }, &key), "as `eve`, from which no plans are taken"),
        (letter(&Envelope { to: "eve".to_owned(), ..own.clone() }, &key), "of `ada` that is not for this run"),
        (letter(&Envelope { sent_in: 6, ..own.clone() }, &key), "of `ada` that is not for this run"),
        (letter(&Envelope { meant_for: meant_for ^ 1, ..own.clone() }, &key), "of `ada` that is not for this run"),
    ];
    for (bytes, words) in cases {
        let stream = sends(place, &bytes);
        message(&mut bob, words);
        drop(stream);
        assert_eq!(letters(&mut bob), [], "{words}");
    }
    // The good one is taken, and a copy of it is not.
    let good = letter(&own, &key);
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
    let envelope = Envelope { from: "ada".to_owned(), to: "bob".to_owned(), sent_in: 5, meant_for: bob.session() };
    let frame = |number| letter_frame::written(&envelope, &plan("ada", number), &Key::of_letters("pair"));
    let stream = sends(place, &(1..=50).flat_map(frame).collect::<Vec<_>>());
    message(&mut bob, "more than 8 letters arrive in a turn");
    assert_eq!(letters(&mut bob).len(), 8);
    drop(stream);
    let mut stream = sends(place, &[]);
    let mut number = 100;
    wait(|| {
        number += 1;
        let is_closed = stream.write_all(&frame(number)).is_err();
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
    let stream = sends(place, &[]);
    wait(|| Some(received(&mut bob)).filter(|states| !states.is_empty()));
    drop(listener);
    let content = Content::Plan { when: When::Now, text: " ".repeat(LONGEST_TEXT) };
    let long = Letter { content, ..plan("bob", 1) };
    let refused = wait(|| bob.post("ada", &long, Nanos::ZERO).err());
    assert_eq!(refused, "8 letters wait for ada already");
    drop(stream);
}
