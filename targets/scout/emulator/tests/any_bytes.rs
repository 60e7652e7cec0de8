//! Property tests of the Scout's protocol: no input makes the reader of the driver or of the emulator fail, and each
//! reader understands what the other side writes.
#![allow(clippy::panic, clippy::indexing_slicing, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "the seed is seen where a test fails")]

use mdle_scout::{Command, Frame, Reader, State};
use mdle_scout_emulator::wire::{Incoming, Request, answer};
use proptest::collection::vec;
use proptest::prelude::{Just, ProptestConfig, any, prop_oneof, proptest};
use proptest::test_runner::RngSeed;

/// Configuration of each test; prints the random seed, which is shown if the test fails.
fn config() -> ProptestConfig {
    let default = ProptestConfig::default();
    let rng_seed = match default.rng_seed {
        RngSeed::Random => RngSeed::Fixed(1),
        named @ RngSeed::Fixed(_) => named,
    };
    println!("PROPTEST_RNG_SEED={rng_seed}");
    ProptestConfig { cases: 200, failure_persistence: None, rng_seed, ..default }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn any_bytes_are_read_or_refused(bytes in vec(prop_oneof![any::<u8>(), 0_u8..4, Just(0x5C)], 0..300)) {
        if let Ok(Some((frame, count))) = Frame::read(&bytes) {
            assert!(count <= bytes.len() && frame.bytes() == bytes[..count]);
            assert_eq!(State::read(&frame.arguments).is_some(), frame.arguments.len() >= 42);
        }
        let mut incoming = Incoming::default();
        incoming.push(&bytes);
        while let Some(Request { command, data }) = incoming.next_request() {
            // The driver would write the request in the same way, and the input contains these bytes.
            let frame = Frame { kind: command, arguments: data.into_iter().collect() }.bytes();
            assert!(bytes.windows(frame.len()).any(|some| some == frame.as_slice()));
        }
    }

    #[test]
    fn a_command_is_understood(right: i16, left: i16) {
        let command = Command::Velocities(right, left);
        let mut incoming = Incoming::default();
        incoming.push(&command.frame().bytes());
        let arguments = command.frame().arguments;
        assert_eq!(incoming.next_request(), Some(Request { command: 5, data: arguments.to_vec() }));
        assert_eq!(incoming.next_request(), None);
    }

    #[test]
    fn an_answer_is_understood(kind: u8, body in vec(any::<u8>(), 0..=253)) {
        let bytes = answer(kind, &body);
        assert_eq!(Frame::read(&bytes), Ok(Some((Frame { kind, arguments: body.into_iter().collect() }, bytes.len()))));
    }

    #[test]
    fn after_any_noise_an_answer_is_found(
        noise in vec(prop_oneof![4 => any::<u8>(), 2 => Just(0x01), 2 => Just(0x00), 1 => Just(0x5C)], 0..300),
        body in vec(any::<u8>(), 42),
        kind in 1_u8..44,
        size in 1_usize..80,
    ) {
        let mut reader = Reader::default();
        let sent = [noise.clone(), answer(kind, &body)].concat();
        let mut found = Vec::new();
        for piece in sent.chunks(size) {
            reader.push(piece);
            found.extend(std::iter::from_fn(|| reader.next_frame()));
        }
        // No more bytes arrive.
        found.extend(reader.after_false_start(kind));
        let meant = Frame { kind, arguments: body.iter().copied().collect() };
        assert!(found.contains(&meant), "{noise:02X?}");
        // All other frames found have a correct checksum.
        for frame in found {
            let bytes = frame.bytes();
            assert!(sent.windows(bytes.len()).any(|some| some == bytes.as_slice()));
        }
    }

    #[test]
    fn an_answer_with_a_wrong_byte_is_not_taken(body in vec(any::<u8>(), 42), place in 0_usize..48, change in 1_u8..) {
        let mut bytes = answer(5, &body);
        bytes[place] ^= change;
        let mut reader = Reader::default();
        reader.push(&bytes);
        let found = std::iter::from_fn(|| reader.next_frame()).collect::<Vec<_>>();
        let late = reader.after_false_start(5);
        // A part of the answer may be a frame, but not a state.
        assert!(found.iter().chain(&late).all(|frame| State::read(&frame.arguments).is_none()));
    }
}
