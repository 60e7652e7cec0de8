//! Compares the driver's implementation of the protocol with all known example packets, in both directions: the bytes
//! of commands, and the contents of answers.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test fails by panicking")]

use mdle_runtime::Volts;
use mdle_scout::{Command, Frame, Garbled, State};

/// Order in which a Scout's sonars ping.
const ORDER: [u8; 16] = [0, 2, 15, 1, 14, 3, 13, 4, 12, 5, 11, 6, 10, 7, 9, 8];

fn bytes(hex: &str) -> Vec<u8> {
    hex.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

/// Returns the frame in these bytes; panics unless they are exactly one frame.
fn frame(hex: &str) -> Frame {
    let bytes = bytes(hex);
    let (frame, count) = Frame::read(&bytes).unwrap().unwrap();
    assert_eq!(count, bytes.len(), "{hex}");
    frame
}

const GS_REPLY: &str = "01 2C 00 07 3C 3E 46 5F 64 60 58 78 FF 76 50 4B 48 4A 44 3D 01 00 00 D2 04 37 82 84 03 00 00 18 00 18 80 00 00 00 00 0B 40 E2 01 00 C8 D2 99 5C";

#[test]
fn commands_are_the_worked_packets() {
    let mut off = ORDER;
    off[0] = 255;
    for (command, hex) in [
        (Command::State, "01 02 00 07 0A 5C"),
        (Command::Stop, "01 02 00 09 0C 5C"),
        (Command::Limp, "01 02 00 0A 0D 5C"),
        (Command::Zero, "01 02 00 0D 10 5C"),
        (Command::Watchdog(5), "01 03 00 12 05 1B 5C"),
        (Command::Sonars(15, ORDER), "01 13 00 0F 0F 00 02 0F 01 0E 03 0D 04 0C 05 0B 06 0A 07 09 08 AA 5C"),
        (Command::Sonars(15, off), "01 13 00 0F 0F FF 02 0F 01 0E 03 0D 04 0C 05 0B 06 0A 07 09 08 A9 5C"),
        (Command::Accelerations(787, 787), "01 08 00 01 13 03 13 03 00 00 36 5C"),
        (Command::Velocities(78, 78), "01 08 00 05 4E 00 4E 00 00 00 AA 5C"),
        (Command::Velocities(-78, -78), "01 08 00 05 4E 80 4E 80 00 00 AA 5C"),
        (Command::Velocities(24, -24), "01 08 00 05 18 00 18 80 00 00 BE 5C"),
    ] {
        assert_eq!(command.frame().bytes().to_vec(), bytes(hex), "{command:?}");
        assert_eq!(command.frame(), frame(hex));
    }
}

#[test]
fn frames_of_commands_that_a_driver_does_not_need_are_read_and_written_as_well() {
    for (hex, kind, arguments) in [
        ("01 06 00 0C 00 00 00 00 13 5C", 12, vec![0; 4]),
        ("01 06 00 1E 84 03 00 00 AC 5C", 30, vec![0x84, 0x03, 0, 0]),
        ("01 08 00 03 6A 00 6A 80 00 00 60 5C", 3, vec![0x6A, 0, 0x6A, 0x80, 0, 0]),
        ("01 06 00 1F 01 01 00 FF 27 5C", 31, vec![1, 1, 0, 255]),
        ("01 05 00 23 01 00 96 C0 5C", 35, vec![1, 0, 0x96]),
        ("01 09 00 1B 01 00 00 40 E2 01 00 49 5C", 27, vec![1, 0, 0, 0x40, 0xE2, 1, 0]),
        ("01 0A 00 15 D2 04 37 82 84 03 00 00 36 5C", 21, vec![0xD2, 4, 0x37, 0x82, 0x84, 3, 0, 0]),
        ("01 08 00 16 18 00 18 80 00 00 CF 5C", 22, vec![0x18, 0, 0x18, 0x80, 0, 0]),
    ] {
        assert_eq!(frame(hex), Frame { kind, arguments: arguments.into_iter().collect() });
        assert_eq!(frame(hex).bytes().to_vec(), bytes(hex));
    }
}

#[test]
fn the_worked_state_says_what_it_should() {
    let answer = frame(GS_REPLY);
    assert_eq!((answer.kind, answer.bytes().to_vec()), (7, bytes(GS_REPLY)));
    let state = State::read(&answer.arguments).unwrap();
    let sonars = [60, 62, 70, 95, 100, 96, 88, 120, 255, 118, 80, 75, 72, 74, 68, 61];
    let wanted = State {
        sonars,
        bumper: 1,
        x: 1234,
        y: -567,
        heading: 900,
        right: 24,
        left: -24,
        status: 0x0B,
        clock: 123_456,
        cpu: 200,
        motor: 210,
    };
    assert_eq!(state, wanted);
    assert_eq!((state.is_stopped(), state.is_plugged()), (false, false));
    let hundredths = |volts: Volts| (volts.0 * 100.0).round();
    assert_eq!(state.volts().map(hundredths), [1045.0, 1149.0]);
    assert_eq!(State::read(&answer.arguments[..41]), None);
}

#[test]
fn emergency_stop_and_charger_are_bits_of_the_status() {
    let state = State::read(&frame(GS_REPLY).arguments).unwrap();
    let of = |status| State { status, ..state };
    assert_eq!([of(0x40), of(0x3F), of(0x80)].map(|state| state.is_stopped()), [true, false, false]);
    assert_eq!([of(0x10), of(0x20), of(0xCF)].map(|state| state.is_plugged()), [true, true, false]);
}

#[test]
fn what_is_no_frame_is_refused_as_soon_as_it_can_be() {
    let reply = bytes(GS_REPLY);
    // A frame is read only when it is complete, and bytes after it are left for later.
    for count in 0..reply.len() {
        assert_eq!(Frame::read(&reply[..count]), Ok(None), "{count}");
    }
    let two = [&reply[..], &reply[..9]].concat();
    assert_eq!(Frame::read(&two).unwrap().unwrap().1, reply.len());
    let with = |place: usize, byte: u8| {
        let mut bytes = reply.clone();
        bytes[place] = byte;
        Frame::read(&bytes)
    };
    assert_eq!(with(0, 0x02), Err(Garbled::Start(0x02)));
    assert_eq!(with(1, 0x01), Err(Garbled::Length(1)));
    assert_eq!(with(2, 0x01), Err(Garbled::Length(0x012C)));
    assert_eq!(with(20, 0x02), Err(Garbled::Sum(0x9A, 0x99)));
    assert_eq!(with(46, 0x98), Err(Garbled::Sum(0x99, 0x98)));
    assert_eq!(with(47, 0x5D), Err(Garbled::End(0x5D)));
}
