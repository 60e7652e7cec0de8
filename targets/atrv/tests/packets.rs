//! Compares the driver's implementation of the protocol with all known example packets, in both directions: the bytes
//! of commands, and the contents of reports.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test fails by panicking")]

use mdle_atrv::{Axis, AxisMotion, Command, Escape, Garbled, Packet, Reader, Report, Unreadable};

fn bytes(hex: &str) -> Vec<u8> {
    hex.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

/// A packet: its port, id, opcode and data.
type Owned = (u8, u8, u8, Vec<u8>);

/// Returns the results of a reader for these bytes: each packet with its data, and each error.
fn read(bytes: &[u8]) -> Vec<Result<Owned, Garbled>> {
    let mut reader = Reader::default();
    let mut found = Vec::new();
    for byte in bytes {
        match reader.take(*byte) {
            Ok(None) => {}
            Ok(Some(packet)) => found.push(Ok((packet.port, packet.id, packet.opcode, packet.data.to_vec()))),
            Err(garbled) => found.push(Err(garbled)),
        }
    }
    found
}

/// Returns the packet in these bytes. Panics unless they contain exactly one packet, and writing the packet gives the
/// same bytes.
fn packet(hex: &str) -> Owned {
    let found = read(&bytes(hex));
    assert_eq!(found.len(), 1, "{hex}: {found:?}");
    let (port, id, opcode, data) = found[0].clone().unwrap();
    assert_eq!(Packet { port, id, opcode, data: &data }.written(true).bytes(), bytes(hex), "{hex}");
    (port, id, opcode, data)
}

fn motion(axis: Axis, velocity: i32) -> Command {
    Command::Move(
        axis,
        match axis {
            Axis::Translation => AxisMotion { velocity, acceleration: 69_827, torque: 30_000 },
            Axis::Rotation => AxisMotion { velocity, acceleration: 100_000, torque: 35_000 },
        },
    )
}

#[test]
fn commands_are_the_worked_packets() {
    for (command, hex) in [
        (Command::Status, "1B 02 01 00 01 00 00 1B 03"),
        (Command::Defaults, "1B 02 02 00 0A 00 08 1B 03"),
        (Command::Brake, "1B 02 02 00 0B 00 09 1B 03"),
        (Command::Release, "1B 02 02 00 0C 00 0E 1B 03"),
        (Command::Reports(100_000), "1B 02 02 00 22 08 00 01 86 A0 00 00 00 03 0C 1B 03"),
        (Command::Reports(0), "1B 02 02 00 22 08 00 00 00 00 00 00 00 00 28 1B 03"),
        (Command::Inputs(100_000), "1B 02 05 00 00 04 00 01 86 A0 26 1B 03"),
        (Command::Sonars(30_000), "1B 02 04 04 00 0D 00 00 75 30 00 00 00 00 00 00 00 00 02 4A 1B 03"),
        (Command::Deaf, "1B 02 04 04 00 0D 00 00 00 00 00 00 00 00 00 00 00 00 00 0D 1B 03"),
        (motion(Axis::Translation, 27_930), "1B 02 02 00 07 0E 00 00 00 6D 1A 00 01 10 C3 00 00 75 30 01 EA 1B 03"),
        (motion(Axis::Rotation, 17_922), "1B 02 02 00 07 0E 01 00 00 46 02 00 01 86 A0 00 00 88 B8 01 58 1B 03"),
        (motion(Axis::Rotation, -17_922), "1B 02 02 00 07 0E 01 00 00 46 02 00 01 86 A0 00 00 88 B8 00 59 1B 03"),
        (motion(Axis::Translation, 1), "1B 02 02 00 07 0E 00 00 00 00 01 00 01 10 C3 00 00 75 30 01 9C 1B 03"),
    ] {
        for escape in [Escape::Avoid, Escape::Mark] {
            assert_eq!(command.frame(escape).bytes(), bytes(hex), "{command:?} {escape:?}");
        }
        let (port, id, opcode, data) = packet(hex);
        assert_eq!(Packet { port, id, opcode, data: &data }.written(true), command.frame(Escape::Mark));
    }
}

/// Calls `is` with the id and the content of the report in these bytes.
fn message(hex: &str, is: impl FnOnce(u8, Report<'_>)) {
    let (port, id, opcode, data) = packet(hex);
    is(id, Report::read(&Packet { port, id, opcode, data: &data }).unwrap());
}

#[test]
fn reports_say_what_the_worked_packets_should() {
    message(
        "1B 02 02 07 21 19 00 00 00 00 00 01 23 45 00 00 03 32 4A 00 00 6D 1A 00 01 10 C3 00 00 75 30 C1 1B 03",
        |id, report| {
            let wanted = Report::Axis { axis: Axis::Translation, position: 209_482, velocity: 27_930, time: 0x12345 };
            assert_eq!((id, report), (7, wanted));
        },
    );
    message(
        "1B 02 02 08 21 19 00 00 00 00 00 01 23 46 01 FF FE CE 87 00 00 46 02 00 01 86 A0 00 00 88 B8 4C 1B 03",
        |id, report| {
            let wanted = Report::Axis { axis: Axis::Rotation, position: -78_201, velocity: 17_922, time: 0x12346 };
            assert_eq!((id, report), (8, wanted));
        },
    );
    message("1B 02 01 09 01 09 00 01 23 50 00 00 09 7E 00 05 1B 03", |_, report| {
        assert_eq!(report, Report::Status { battery: 2430, is_braked: false });
    });
    message("1B 02 04 0A 02 14 00 00 00 00 00 01 23 60 00 06 0E 10 04 D8 20 0C 1C 30 03 07 9A 1B 03", |_, report| {
        let Report::Sonars(echoes) = report else { unreachable!("{report:?}") };
        assert_eq!(echoes.each().collect::<Vec<_>>(), [(0, 1550), (16, 1240), (32, 3100), (48, 775)]);
    });
    // The checksum is 1B.
    message("1B 02 05 0B 01 07 00 01 23 70 40 00 01 1B 00 1B 03", |_, report| {
        assert_eq!(report, Report::Input { address: 0x40, state: 1 });
    });
    // The driver does not use the joystick.
    message("1B 02 03 0C 00 0D 00 01 23 80 00 00 00 00 00 00 00 00 01 A1 1B 03", |_, report| {
        assert_eq!(report, Report::Other);
    });
}

#[test]
fn a_value_that_is_1b_is_marked_or_avoided() {
    let turn = |velocity| Command::Move(Axis::Rotation, AxisMotion { velocity, acceleration: 100_000, torque: 35_000 });
    let marked = turn(0x1B40).frame(Escape::Mark);
    let stuffed = bytes("1B 02 02 00 07 0E 01 00 00 1B 00 40 00 01 86 A0 00 00 88 B8 01 47 1B 03");
    assert_eq!((marked.bytes(), stuffed.len()), (&*stuffed, 24));
    let (_, _, _, data) = packet("1B 02 02 00 07 0E 01 00 00 1B 00 40 00 01 86 A0 00 00 88 B8 01 47 1B 03");
    assert_eq!(data[1..5], [0, 0, 0x1B, 0x40]);
    // Without escaping, the frame is 23 bytes long, and no reader can recover its meaning.
    let raw = Packet { port: 2, id: 0, opcode: 7, data: &data }.written(false);
    let hex = "1B 02 02 00 07 0E 01 00 00 1B 40 00 01 86 A0 00 00 88 B8 01 47 1B 03";
    assert_eq!((raw.bytes(), raw.bytes().len()), (&*bytes(hex), 23));
    assert_eq!(read(raw.bytes()), [Err(Garbled::Mark(0x40))]);
    for (velocity, sent) in [(0x1B40, 0x1AFF), (0x1BC0, 0x1C00), (-0x1B40, 0x1AFF)] {
        let avoided = turn(velocity).frame(Escape::Avoid);
        let (_, _, _, data) = read(avoided.bytes())[0].clone().unwrap();
        assert_eq!((&data[1..5], avoided.bytes().len()), (&u32::to_be_bytes(sent)[..], 23));
    }
}

#[test]
fn nothing_that_is_avoided_goes_out_and_it_is_nearly_what_was_meant() {
    for axis in [Axis::Translation, Axis::Rotation] {
        for velocity in (-70_000..70_000).step_by(7).chain([0x1B, 0x1B00, 0x001B_0000, -0x1B]) {
            let frame = motion(axis, velocity).frame(Escape::Avoid);
            let inside = &frame.bytes()[2..frame.bytes().len() - 2];
            assert!(!inside.contains(&0x1B), "{velocity}: {:02X?}", frame.bytes());
            let (_, _, _, data) = read(frame.bytes())[0].clone().unwrap();
            let sent = u32::from_be_bytes([data[1], data[2], data[3], data[4]]);
            let off = sent.abs_diff(velocity.unsigned_abs());
            // The maximum deviation is 128 of 256 if the second-lowest byte is 1B, and 32,768 of 65,536 if it is the
            // third-lowest one.
            assert!(off <= 136 || (0x001A_0000..0x001D_0000).contains(&velocity.unsigned_abs()), "{velocity}: {sent}");
            assert_eq!(data[13], u8::from(velocity >= 0));
        }
    }
    for period in (20_000..200_000).step_by(13) {
        for command in [Command::Reports(period), Command::Inputs(period), Command::Sonars(period)] {
            let frame = command.frame(Escape::Avoid);
            assert!(!frame.bytes()[2..frame.bytes().len() - 2].contains(&0x1B), "{command:?}");
        }
    }
}

const AXIS: &str =
    "1B 02 02 07 21 19 00 00 00 00 00 01 23 45 00 00 03 32 4A 00 00 6D 1A 00 01 10 C3 00 00 75 30 C1 1B 03";

#[test]
fn filler_means_nothing_wherever_it_is() {
    let plain = bytes(AXIS);
    let wanted = read(&plain);
    for place in 0..plain.len() {
        // Filler cannot be placed between the two bytes of a mark.
        if place > 0 && plain[place - 1] == 0x1B {
            continue;
        }
        let filled = [&plain[..place], &[0x1B, 0x01], &plain[place..]].concat();
        assert_eq!(read(&filled), wanted, "{place}");
    }
}

#[test]
fn after_garbage_the_next_frame_is_found() {
    let plain = bytes(AXIS);
    let wanted = read(&plain);
    let good = wanted[0].clone();
    let behind = |before: &[u8]| read(&[before, &plain].concat());
    // Noise is reported once.
    assert_eq!(behind(b"noise"), [Err(Garbled::Outside(b'n')), good.clone()]);
    // A second 1B may be the first byte of the mark.
    assert_eq!(behind(&[0x1B])[..], wanted);
    assert_eq!(behind(&[0x1B, 0x02, 0x1B]), [Err(Garbled::Mark(0x1B)), good.clone()]);
    assert_eq!(behind(&plain[..20]), [Err(Garbled::Length(0x19, 13)), good.clone()]);
    assert_eq!(behind(&[0x1B, 0x02, 0x1B, 0x03]), [Err(Garbled::Length(0, 0)), good.clone()]);
    let with = |place: usize, byte: u8| {
        let mut bytes = plain.clone();
        bytes[place] = byte;
        behind(&bytes)
    };
    assert_eq!(with(20, 0x01), [Err(Garbled::Check(0xC0, 0xC1)), good.clone()]);
    assert_eq!(with(31, 0xC0), [Err(Garbled::Check(0xC1, 0xC0)), good.clone()]);
    assert_eq!(with(5, 0x18), [Err(Garbled::Length(0x18, 0x19)), good.clone()]);
    // A frame without an end becomes longer than any frame can be.
    let endless = [&[0x1B, 0x02][..], &[0x05; 300]].concat();
    assert_eq!(behind(&endless), [Err(Garbled::Length(5, 260)), good]);
}

#[test]
fn reports_that_are_too_short_or_of_no_rflex_are_refused() {
    let of = |port, opcode, length: usize| {
        Report::read(&Packet { port, id: 0, opcode, data: &[0; 32][..length] }).map(|_| ())
    };
    for (port, opcode, least) in [(2, 33, 25), (4, 2, 8), (5, 1, 6), (5, 3, 6), (1, 1, 9)] {
        assert_eq!(of(port, opcode, least), Ok(()));
        assert_eq!(of(port, opcode, least - 1), Err(Unreadable::Short(port, opcode, least - 1)));
    }
    assert_eq!([of(0, 1, 9), of(7, 0, 0)], [Err(Unreadable::Unknown(0, 1)), Err(Unreadable::Unknown(7, 0))]);
    assert_eq!([of(2, 7, 0), of(6, 1, 3)], [Ok(()); 2]);
}
