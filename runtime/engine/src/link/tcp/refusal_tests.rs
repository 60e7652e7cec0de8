//! Tests that a TCP link rejects unauthenticated frames, replayed frames, floods, and too many connections.

use std::collections::VecDeque;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use mdle_runtime::Nanos;

use super::tests::{
    address, assert_goes_on, bob, bound, frame, greeted, message, read_messages, received, settings, state, wait,
};
use super::*;
use crate::link::frame::{Challenge, GREETING_LENGTH};
use crate::link::state_frame::LONGEST;

/// Bytes that a peer sends in response to a challenge, and the expected message about them.
type Case = (fn(&Challenge) -> Vec<u8>, &'static str);

#[test]
fn what_is_no_state_of_a_peer_is_refused() {
    let (mut bob, place) = bob();
    let cases: [Case; 9] = [
        (|_| b"GET / HTTP/1.1\r\n\r\n".to_vec(), "it sends no states"),
        (|_| u32::MAX.to_le_bytes().to_vec(), "it sends no states"),
        (|_| (LONGEST as u32).to_le_bytes().into_iter().chain([0; LONGEST]).collect(), "it sends no states"),
        (
            |challenge| {
                let mut version = frame(&state("ada", 1), "key", challenge);
                version[8] = 9;
                version
            },
            "its version of the link is 9",
        ),
        (|challenge| frame(&state("ada", 1), "another", challenge), "it has another key"),
        (|_| frame(&state("ada", 1), "key", &Challenge::NONE), "it has another key, or repeats what was recorded"),
        (|challenge| frame(&state("eve\n", 1), "key", challenge), "its robot `eveU+000A` is none of ada"),
        (
            |challenge| {
                let frame = frame(&state("ada", 1), "key", challenge);
                frame[..frame.len() / 2].to_vec()
            },
            "it ended within a frame",
        ),
        (|_| vec![7], "it ended within a frame"),
    ];
    let mut messages = Vec::new();
    for (bytes, words) in cases {
        let (mut stranger, challenge) = greeted(place);
        stranger.write_all(&bytes(&challenge)).unwrap();
        // The connection may have been refused in the meantime.
        let _ = stranger.shutdown(std::net::Shutdown::Write);
        assert_eq!(stranger.read(&mut [0]).unwrap_or_default(), 0, "{words}: it is closed");
        read_messages(&mut bob, &mut messages);
        let is_reported = |message: &String| message.contains("127.0.0.1 is refused: ") && message.contains(words);
        assert!(messages.iter().any(is_reported), "{words}: {messages:?}");
        assert_eq!(received(&mut bob), []);
    }
    assert_goes_on(&mut bob, place);
}

#[test]
fn recorded_states_are_worth_nothing_later() {
    let (mut bob, place) = bob();
    let run = |session, number| State { session, ..state("ada", number) };
    let mut recorded = Vec::new();
    for session in [1, 2] {
        // The second session is accepted only when the first one has ended.
        wait(|| {
            let (mut ada, challenge) = greeted(place);
            let frame = frame(&run(session, 5), "key", &challenge);
            ada.write_all(&frame).unwrap();
            sleep(Duration::from_millis(20));
            recorded.push(frame);
            received(&mut bob).pop()
        });
    }
    for frame in [&recorded[0], recorded.last().unwrap()].into_iter().cycle().take(6) {
        let (mut stranger, _) = greeted(place);
        stranger.write_all(frame).unwrap();
        assert_eq!(stranger.read(&mut [0]).unwrap_or_default(), 0, "it is closed");
        assert_eq!(received(&mut bob), []);
    }
}

#[test]
fn a_flood_and_silence_are_refused() {
    let (mut bob, place) = bob();
    let silent: Vec<_> = (0..3).map(|_| TcpStream::connect(place).unwrap()).collect();
    let (mut flood, challenge) = greeted(place);
    let many = frame(&state("ada", 1), "key", &challenge).repeat(100);
    wait(|| flood.write_all(&many).is_err().then_some(()));
    message(&mut bob, "more than 2000 states a second");
    message(&mut bob, "it has not sent a state within 1 s");
    drop(silent);
    received(&mut bob);
    assert_goes_on(&mut bob, place);
}

#[test]
fn strangers_shut_no_peer_out() {
    let (mut bob, place) = bob();
    let is_over = Arc::<AtomicBool>::default();
    let held: Vec<_> = (0..200).map(|_| TcpStream::connect(place).unwrap()).collect();
    let strangers = [(); 4].map(|()| {
        let is_over = Arc::clone(&is_over);
        std::thread::spawn(move || {
            let mut held = VecDeque::new();
            while !is_over.load(Ordering::Relaxed) {
                let Ok(mut stranger) = TcpStream::connect(place) else { continue };
                let _ = stranger.write_all(&[16]);
                held.push_back(stranger);
                held.drain(..held.len().saturating_sub(20));
                sleep(Duration::from_millis(1));
            }
        })
    });
    message(&mut bob, "64 others have not sent a state yet");
    let (mut ada, challenge) = wait(|| {
        let mut stream = TcpStream::connect(place).unwrap();
        let mut greeting = [0; GREETING_LENGTH];
        stream.read_exact(&mut greeting).ok()?;
        let challenge = Challenge::of_greeting(&greeting).unwrap();
        stream.write_all(&frame(&state("ada", 1), "key", &challenge)).ok()?;
        sleep(Duration::from_millis(20));
        received(&mut bob).pop().map(|_| (stream, challenge))
    });
    for number in 2..30 {
        ada.write_all(&frame(&state("ada", number), "key", &challenge)).unwrap();
        assert_eq!(wait(|| received(&mut bob).pop()), state("ada", number), "the connection stays");
    }
    is_over.store(true, Ordering::Relaxed);
    strangers.into_iter().for_each(|stranger| stranger.join().unwrap());
    drop(held);
}

#[test]
fn a_new_connection_of_a_peer_replaces_the_old_one() {
    let (mut bob, place) = bob();
    let (mut old, challenge) = greeted(place);
    old.write_all(&frame(&state("ada", 1), "key", &challenge)).unwrap();
    wait(|| received(&mut bob).pop());
    let (mut new, of_new) = greeted(place);
    new.write_all(&frame(&state("ada", 2), "key", &of_new)).unwrap();
    assert_eq!(old.read(&mut [0]).unwrap_or_default(), 0, "it is closed");
    wait(|| received(&mut bob).pop());
    let _ = old.write_all(&frame(&state("ada", 9), "key", &challenge));
    new.write_all(&frame(&state("ada", 3), "key", &of_new)).unwrap();
    assert_eq!(wait(|| received(&mut bob).pop()), state("ada", 3));
}

#[test]
fn a_peer_with_another_key_causes_few_messages() {
    let (one, other) = (bound(), bound());
    let (at_ada, at_bob) = (address(&one), address(&other));
    let mut ada = Tcp::on(one, &settings("ada", &[("bob", at_bob)], "another")).unwrap();
    let mut bob = Tcp::on(other, &settings("bob", &[("ada", at_ada)], "key")).unwrap();
    let (begun, mut number, mut messages) = (Instant::now(), 0, Vec::new());
    while begun.elapsed() < Duration::from_secs(2) {
        number += 1;
        ada.send(&state("ada", number), Nanos::ZERO);
        bob.send(&state("bob", number), Nanos::ZERO);
        read_messages(&mut bob, &mut messages);
        sleep(Duration::from_millis(10));
    }
    messages.sort();
    assert_eq!(messages.len(), 2, "{messages:?}");
    assert!(messages[0].contains("127.0.0.1 is refused: it has another key"), "{messages:?}");
    assert!(
        messages[1].contains("ada at 127.0.0.1:") && messages[1].contains("refuses this one and says why"),
        "{messages:?}"
    );
}

#[test]
fn a_robot_with_fast_turns_sends_1000_states_a_second() {
    let listener = bound();
    let mut ada = Tcp::on(bound(), &settings("ada", &[("bob", address(&listener))], "key")).unwrap();
    let is_over = Arc::<AtomicBool>::default();
    let (until, begun) = (Arc::clone(&is_over), Instant::now());
    let turns = std::thread::spawn(move || {
        for number in (1..).take_while(|_| !until.load(Ordering::Relaxed)) {
            ada.send(&state("ada", number), Nanos::ZERO);
        }
    });
    let (mut stream, _) = listener.accept().unwrap();
    stream.write_all(&Challenge::NONE.greeting()).unwrap();
    let mut count = 0;
    while begun.elapsed() < Duration::from_secs(1) {
        let mut length = [0; 4];
        stream.read_exact(&mut length).unwrap();
        stream.read_exact(&mut vec![0; u32::from_le_bytes(length) as usize]).unwrap();
        count += 1;
    }
    let milliseconds = begun.elapsed().as_millis();
    is_over.store(true, Ordering::Relaxed);
    turns.join().unwrap();
    assert!((10..=milliseconds + 1).contains(&count), "{count} states in {milliseconds} ms");
}
