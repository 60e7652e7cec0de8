//! Property tests of the rFLEX protocol: no input makes the reader of the driver or of the emulator fail, and each
//! reader understands what the other side writes.
#![allow(clippy::panic, clippy::indexing_slicing, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "the seed is seen where a test fails")]

use mdle_atrv::{Axis, AxisMotion, Command, Escape, Packet, Reader, Report};
use mdle_atrv_emulator::wire::{Incoming, report};
use proptest::collection::vec;
use proptest::prelude::{Just, ProptestConfig, Strategy, any, prop_oneof, proptest};
use proptest::test_runner::RngSeed;

/// Returns random bytes, many of which have a meaning in the protocol.
fn bytes() -> impl Strategy<Value = Vec<u8>> {
    vec(prop_oneof![3 => any::<u8>(), 2 => Just(0x1B), 1 => 0_u8..8], 0..400)
}

/// Returns the packets in these bytes: port, opcode and data.
fn packets(reader: &mut Reader, bytes: &[u8]) -> Vec<(u8, u8, Vec<u8>)> {
    let mut found = Vec::new();
    for byte in bytes {
        if let Ok(Some(packet)) = reader.take(*byte) {
            // Any report must be readable or rejected without a panic.
            if let Ok(Report::Sonars(echoes)) = Report::read(&packet) {
                assert_eq!(echoes.each().count(), (packet.data.len() - 8) / 3);
            }
            found.push((packet.port, packet.opcode, packet.data.to_vec()));
        }
    }
    found
}

/// Returns the commands that the emulated robot finds in these bytes: port, opcode and data.
fn requests(incoming: &mut Incoming, bytes: &[u8]) -> Vec<(u8, u8, Vec<u8>)> {
    incoming.push(bytes);
    std::iter::from_fn(|| incoming.next_request()).map(|found| (found.port, found.code, found.data)).collect()
}

/// Returns `noise` followed by an end mark, which resets a reader from any state.
fn ended(noise: &[u8]) -> Vec<u8> {
    [noise, &[0x1B, 0x03]].concat()
}

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
    fn behind_any_bytes_a_report_is_read(noise in bytes(), port: u8, opcode: u8, data in vec(any::<u8>(), 0..=255), filled: bool) {
        let mut reader = Reader::default();
        packets(&mut reader, &ended(&noise));
        let filler: &[u8] = if filled { &[0x1B, 0x01] } else { &[] };
        let sent = report(port, 0, opcode, &data, filler);
        assert_eq!(packets(&mut reader, &sent), [(port, opcode, data)]);
    }

    #[test]
    fn behind_any_bytes_a_command_is_read(noise in bytes(), axis: bool, velocity: i32, acceleration: u32, torque: u32) {
        let axis = if axis { Axis::Rotation } else { Axis::Translation };
        let command = Command::Move(axis, AxisMotion { velocity, acceleration, torque });
        for (escape, marks) in [(Escape::Mark, true), (Escape::Avoid, false)] {
            let mut incoming = Incoming::new(marks);
            requests(&mut incoming, &ended(&noise));
            let found = requests(&mut incoming, command.frame(escape).bytes());
            let [(2, 7, data)] = &found[..] else { panic!("{found:?}") };
            let velocities = [data[1], data[2], data[3], data[4]];
            if escape == Escape::Mark {
                assert_eq!(u32::from_be_bytes(velocities), velocity.unsigned_abs());
            }
        }
    }

    #[test]
    fn both_readers_find_the_same_packets_in_any_bytes(bytes in bytes()) {
        // Without an end mark, the two readers treat an incomplete packet differently.
        let ended = ended(&bytes);
        assert_eq!(packets(&mut Reader::default(), &ended), requests(&mut Incoming::new(true), &ended));
    }

    #[test]
    fn both_writers_say_the_same(port: u8, id: u8, opcode: u8, data in vec(prop_oneof![any::<u8>(), Just(0x1B)], 0..=32)) {
        let written = Packet { port, id, opcode, data: &data }.written(true);
        assert_eq!(written.bytes(), report(port, id, opcode, &data, &[]));
    }
}
