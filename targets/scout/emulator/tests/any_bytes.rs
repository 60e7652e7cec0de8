//! Whatever bytes come, both readers go on, and what one of them writes the other one reads.
#![allow(clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "the seed is seen where a test fails")]

use mdle_scout::{Command, Frame, State};
use mdle_scout_emulator::wire::{Incoming, Request, answer};
use proptest::collection::vec;
use proptest::prelude::{Just, ProptestConfig, any, prop_oneof, proptest};
use proptest::test_runner::RngSeed;

/// What each test is run with; it prints the seed, which is seen where the test fails.
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
            // The driver would say it so, and it is in there.
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
}
