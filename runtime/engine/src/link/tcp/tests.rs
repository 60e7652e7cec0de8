//! Tests TCP links on this machine: states arrive, and peers come and go.

use std::collections::VecDeque;
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::thread::sleep;
use std::time::{Duration, Instant};

use mdle_runtime::{Meters, Nanos, Pose};

use super::sender::WRITES;
use super::*;
use crate::attribute::{AttributeName, Value};
use crate::link::frame::{Challenge, GREETING_LENGTH, SharedKey, StateTimes};
use crate::link::state_frame::written;
use crate::link::{SharedValue, clock};

/// Maximum wait in a test.
pub(super) const SOON: Duration = Duration::from_secs(20);

pub(super) fn bound() -> TcpListener {
    TcpListener::bind("127.0.0.1:0").unwrap()
}

pub(super) fn address(listener: &TcpListener) -> SocketAddr {
    listener.local_addr().unwrap()
}

pub(super) fn settings(name: &str, peers: &[(&str, SocketAddr)], key: &str) -> TcpSettings {
    let addresses = peers.iter().map(|(_, address)| *address).collect();
    let peers = peers.iter().map(|(name, _)| (*name).to_owned()).collect();
    let link = LinkSettings { name: name.to_owned(), peers, key: key.to_owned(), plans: Vec::new() };
    TcpSettings { link, listen: "127.0.0.1:0".parse().unwrap(), addresses }
}

pub(super) fn state(name: &str, number: u64) -> State {
    let pose = Pose { x: Meters(number as f64), ..Pose::ORIGIN };
    State {
        pose,
        rounds: vec![("bob".to_owned(), number)],
        attributes: vec![SharedValue {
            name: AttributeName::new("heading", "range"),
            value: Value::Number(number as f64),
            age: Nanos(3),
        }],
        ..State::of(name, number)
    }
}

/// Connects, and reads the greeting.
pub(super) fn greeted(place: SocketAddr) -> (TcpStream, Challenge) {
    let mut stream = TcpStream::connect(place).unwrap();
    let mut greeting = [0; GREETING_LENGTH];
    stream.set_read_timeout(Some(SOON)).unwrap();
    stream.read_exact(&mut greeting).unwrap();
    (stream, Challenge::of_greeting(&greeting).unwrap())
}

/// Returns the frame of a state for this challenge, written at the start of the session.
pub(super) fn frame(state: &State, key: &str, challenge: &Challenge) -> Vec<u8> {
    let now = clock::now();
    written(state, StateTimes { begun: now, measured: now }, &SharedKey::of(key)).frame_at(challenge, now)
}

/// Returns the link of `bob`, whose only peer is `ada`, and its address. No robot listens at the address of `ada`.
pub(super) fn bob() -> (Tcp, SocketAddr) {
    let (own, nobody) = (bound(), address(&bound()));
    let place = address(&own);
    (Tcp::on(own, &settings("bob", &[("ada", nobody)], "key")).unwrap(), place)
}

/// Calls `happens` until it returns a value.
pub(super) fn wait<T>(mut happens: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(value) = happens() {
            return value;
        }
        assert!(begun.elapsed() < SOON, "it has not happened");
        sleep(Duration::from_millis(5));
    }
}

pub(super) fn received(link: &mut Tcp) -> Vec<State> {
    let mut states = Vec::new();
    // The age depends on the clock, so it is ignored.
    link.receive(Nanos::ZERO, &mut |state| states.push(State { age: Nanos::ZERO, ..state }));
    states
}

/// Waits for a message that contains these words.
pub(super) fn message(link: &mut Tcp, words: &str) -> String {
    wait(|| {
        let mut found = None;
        link.messages(&mut |message| {
            if message.contains(words) {
                found = Some(message.to_owned());
            }
        });
        found
    })
}

/// Appends all waiting messages.
pub(super) fn read_messages(link: &mut Tcp, messages: &mut Vec<String>) {
    link.messages(&mut |message| messages.push(message.to_owned()));
}

/// Asserts that states of a valid peer still arrive.
pub(super) fn assert_goes_on(link: &mut Tcp, place: SocketAddr) {
    let (mut peer, challenge) = greeted(place);
    peer.write_all(&frame(&state("ada", 77), "key", &challenge)).unwrap();
    let states = wait(|| Some(received(link)).filter(|states| !states.is_empty()));
    assert_eq!(states, [state("ada", 77)]);
}

#[test]
fn states_go_both_ways_and_the_newest_counts() {
    let (one, other) = (bound(), bound());
    let (at_ada, at_bob) = (address(&one), address(&other));
    let mut ada = Tcp::on(one, &settings("ada", &[("bob", at_bob)], "key")).unwrap();
    let mut bob = Tcp::on(other, &settings("bob", &[("ada", at_ada)], "key")).unwrap();
    let mut number = 0;
    let (mut heard_by_bob, mut heard_by_ada) = (0, 0);
    wait(|| {
        number += 1;
        ada.send(&state("ada", number), Nanos::ZERO);
        bob.send(&state("bob", number), Nanos::ZERO);
        sleep(Duration::from_millis(2));
        for (link, last) in [(&mut ada, &mut heard_by_ada), (&mut bob, &mut heard_by_bob)] {
            for state in received(link) {
                assert!(state.number >= *last && state.number <= number, "{} after {last}", state.number);
                *last = state.number;
            }
        }
        (heard_by_ada > 20 && heard_by_bob > 20).then_some(())
    });
}

#[test]
fn the_first_state_of_a_connection_is_as_old_as_it_is() {
    let (one, other) = (bound(), bound());
    let (at_ada, at_bob) = (address(&one), address(&other));
    let mut ada = Tcp::on(one, &settings("ada", &[("bob", at_bob)], "key")).unwrap();
    drop(other);
    ada.send(&state("ada", 1), Nanos::ZERO);
    sleep(Duration::from_millis(700));
    let other = TcpListener::bind(at_bob).unwrap();
    let mut bob = Tcp::on(other, &settings("bob", &[("ada", at_ada)], "key")).unwrap();
    let age = wait(|| {
        let mut age = None;
        bob.receive(Nanos::ZERO, &mut |state| age = Some(state.age.0));
        age
    });
    assert!(age >= 700_000_000, "{age} ns");
}

#[test]
fn a_peer_that_comes_back_is_connected_to_again() {
    let listener = bound();
    let at_ada = address(&listener);
    let mut bob = Tcp::on(bound(), &settings("bob", &[("ada", at_ada)], "key")).unwrap();
    let accept = |listener: &TcpListener| {
        let (mut stream, _) = listener.accept().unwrap();
        stream.set_read_timeout(Some(SOON)).unwrap();
        stream.write_all(&Challenge::NONE.greeting()).unwrap();
        let mut length = [0; 4];
        stream.read_exact(&mut length).unwrap();
        (u32::from_le_bytes(length), stream)
    };
    bob.send(&state("bob", 1), Nanos::ZERO);
    assert!(accept(&listener).0 > 0);
    drop(listener);
    let mut number = 1;
    wait(|| {
        number += 1;
        bob.send(&state("bob", number), Nanos::ZERO);
        let mut is_down = false;
        bob.messages(&mut |message| is_down |= message.contains("ada") && message.contains("cannot be reached"));
        is_down.then_some(())
    });
    let again = TcpListener::bind(at_ada).unwrap();
    let (length, stream) = accept(&again);
    assert!(length > 0);
    message(&mut bob, "connected to ada again");
    drop(stream);
}

#[test]
fn a_robot_connects_once_it_has_a_state() {
    let listener = bound();
    listener.set_nonblocking(true).unwrap();
    let mut bob = Tcp::on(bound(), &settings("bob", &[("ada", address(&listener))], "key")).unwrap();
    sleep(Duration::from_millis(300));
    assert!(listener.accept().is_err(), "there is nothing to send");
    bob.send(&state("bob", 1), Nanos::ZERO);
    wait(|| listener.accept().ok());
}

#[test]
fn few_states_wait_for_a_peer_that_reads_slowly() {
    let listener = bound();
    rustix::net::sockopt::set_socket_recv_buffer_size(&listener, 8192).unwrap();
    let mut bob = Tcp::on(bound(), &settings("bob", &[("ada", address(&listener))], "key")).unwrap();
    bob.send(&state("bob", 1), Nanos::ZERO);
    let (mut slow, _) = listener.accept().unwrap();
    slow.write_all(&Challenge::NONE.greeting()).unwrap();
    let (begun, mut number) = (Instant::now(), 1);
    while begun.elapsed() < Duration::from_secs(1) {
        number += 1;
        bob.send(&state("bob", number), Nanos::ZERO);
        std::thread::yield_now();
    }
    // Data that are already in the buffers arrive before the newest state.
    slow.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
    let mut bytes = 0;
    let mut buffer = [0; 65_536];
    while let Ok(count) = slow.read(&mut buffer) {
        bytes += count;
    }
    assert!(bytes < 150_000, "{bytes} bytes of {number} states");
}

#[test]
fn a_peer_that_never_reads_delays_no_turn() {
    let (listener, own) = (bound(), bound());
    let (at_ada, place) = (address(&listener), address(&own));
    let mut bob = Tcp::on(own, &settings("bob", &[("ada", at_ada)], "key")).unwrap();
    bob.send(&state("bob", 1), Nanos::ZERO);
    let (mut deaf, _) = listener.accept().unwrap();
    deaf.write_all(&Challenge::NONE.greeting()).unwrap();
    let (begun, mut number, mut turns) = (Instant::now(), 1, VecDeque::new());
    // Send as fast as possible, so the system's buffers are soon full; the sender then waits for [`WRITES`] before it
    // gives up the peer. A turn that waited as well would be the only one in that time. A busy machine may cause this
    // once.
    loop {
        assert!(begun.elapsed() < SOON, "turns wait for the peer");
        number += 1;
        bob.send(&state("bob", number), Nanos::ZERO);
        received(&mut bob);
        turns.push_back(Instant::now());
        while turns.front().is_some_and(|turn: &Instant| turn.elapsed() > WRITES) {
            turns.pop_front();
        }
        let mut is_given_up = false;
        bob.messages(&mut |message| is_given_up |= message.contains("cannot be reached"));
        if is_given_up && turns.len() > 100 {
            break;
        }
    }
    assert_goes_on(&mut bob, place);
    drop(deaf);
}
