//! Properties of any bytes on the line between a robot and its driver, at either end. libFuzzer searches for bytes that
//! violate them, and a test checks the corpus.
//!
//! Each function panics if a property does not hold. The first byte determines the length of the pieces in which the
//! remaining bytes arrive.

use mdle_atrv::{Packet, Reader, Report};
use mdle_atrv_emulator::wire as rflex;
use mdle_scout::{Frame, Reader as Answers, State};
use mdle_scout_emulator::wire;

/// Maximum number of bytes that a reader keeps of an incomplete message.
const KEPT: usize = 1100;

/// Splits the bytes after the first one into pieces. The length of a piece is 1 plus the first byte modulo 100.
fn in_pieces(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let (size, stream) =
        bytes.split_first().map_or((1, bytes), |(size, stream)| (1 + usize::from(*size) % 100, stream));
    stream.chunks(size)
}

/// Asserts the properties of the Scout's line.
pub fn scout(bytes: &[u8]) {
    answers(bytes);
    let whole: Vec<u8> = in_pieces(bytes).flatten().copied().collect();
    let mut robot = wire::Incoming::default();
    let found = requests(&mut robot, in_pieces(bytes));
    assert_eq!(found, requests(&mut wire::Incoming::default(), [whole.as_slice()].into_iter()));
    // The emulator may still wait for the end of an incomplete request, but for at most the maximum length of a
    // request.
    let state = Frame { kind: 7, arguments: [].into_iter().collect() }.bytes();
    let behind = requests(&mut robot, std::iter::repeat_n(state.as_slice(), 64));
    assert!(behind.iter().any(|request| request.command == 7 && request.data.is_empty()), "{behind:?}");

    let message = whole.get(..whole.len().min(253)).unwrap_or_default();
    let answer = wire::answer(5, message);
    let frame = Frame { kind: 5, arguments: message.iter().copied().collect() };
    assert_eq!(Frame::read(&answer), Ok(Some((frame.clone(), answer.len()))));
    let mut robot = wire::Incoming::default();
    let asked = wire::Request { command: 5, data: message.to_vec() };
    assert_eq!(requests(&mut robot, [frame.bytes().as_slice()].into_iter()), [asked]);
}

/// Reads the bytes as the Scout's driver does, and asserts the properties of the answers.
fn answers(bytes: &[u8]) {
    let whole: Vec<u8> = in_pieces(bytes).flatten().copied().collect();
    let mut reader = Answers::default();
    let check = |reader: &mut Answers, frame: Frame| {
        let bytes = frame.bytes();
        assert!(whole.windows(bytes.len()).any(|some| some == bytes.as_slice()), "{frame:?}");
        assert_eq!(State::read(&frame.arguments).is_some(), frame.arguments.len() >= 42);
        assert!(reader.kept() <= KEPT, "{} bytes", reader.kept());
    };
    for piece in in_pieces(bytes) {
        reader.push(piece);
        while let Some(frame) = reader.next_frame() {
            check(&mut reader, frame);
        }
        assert!(reader.kept() <= KEPT, "{} bytes", reader.kept());
    }
    while let Some(frame) = reader.after_false_start(5) {
        check(&mut reader, frame);
    }
    // The next answer is found after any bytes, unless these bytes and the answer together happen to have a correct
    // checksum of 8 bits.
    let state = wire::answer(5, &[7; 42]);
    reader.push(&state);
    let found = std::iter::from_fn(|| reader.next_frame()).last();
    let found = reader.after_false_start(5).or(found).map(|frame| frame.bytes().to_vec());
    assert!(found.as_ref().is_some_and(|found| found.ends_with(&state)), "{found:?}");
}

/// Returns the requests that the Scout's emulator reads from the bytes.
fn requests<'b>(robot: &mut wire::Incoming, pieces: impl Iterator<Item = &'b [u8]>) -> Vec<wire::Request> {
    let mut found = Vec::new();
    for piece in pieces {
        robot.push(piece);
        found.extend(std::iter::from_fn(|| robot.next_request()));
        assert!(robot.kept() <= KEPT, "{} bytes", robot.kept());
    }
    found
}

/// Asserts the properties of the ATRV's line.
pub fn atrv(bytes: &[u8]) {
    let whole: Vec<u8> = in_pieces(bytes).flatten().copied().collect();
    for marks in [true, false] {
        let mut robot = rflex::Incoming::new(marks);
        let found = commands(&mut robot, in_pieces(bytes));
        assert_eq!(found, commands(&mut rflex::Incoming::new(marks), [whole.as_slice()].into_iter()));
        // These bytes end any incomplete packet.
        let defaults = Packet { port: 2, id: 0, opcode: 10, data: &[] };
        let behind = commands(&mut robot, [&[0x1B, 0x03][..], defaults.written(false).bytes()].into_iter());
        assert_eq!(behind.last(), Some(&rflex::Request { port: 2, code: 10, data: Vec::new() }));
    }
    let mut reader = Reader::default();
    packets(&mut reader, &whole);
    packets(&mut reader, &[0x1B, 0x03]);
    let message = whole.get(..whole.len().min(255)).unwrap_or_default();
    assert_eq!(packets(&mut reader, &rflex::report(3, 1, 2, message, &[0x1B, 0x01])), [(3, 2, message.to_vec())]);

    let message = whole.get(..whole.len().min(32)).unwrap_or_default();
    let written = Packet { port: 5, id: 0, opcode: 4, data: message }.written(true);
    let mut robot = rflex::Incoming::new(true);
    let listed = rflex::Request { port: 5, code: 4, data: message.to_vec() };
    assert_eq!(commands(&mut robot, [written.bytes()].into_iter()), [listed]);
}

/// Returns the port, the opcode and the data of each packet that the ATRV's driver reads from the bytes.
fn packets(reader: &mut Reader, bytes: &[u8]) -> Vec<(u8, u8, Vec<u8>)> {
    let mut found = Vec::new();
    for byte in bytes {
        if let Ok(Some(packet)) = reader.take(*byte) {
            if let Ok(Report::Sonars(echoes)) = Report::read(&packet) {
                assert!(echoes.each().count() <= packet.data.len() / 3);
            }
            found.push((packet.port, packet.opcode, packet.data.to_vec()));
        }
    }
    found
}

/// Returns the requests that the ATRV's emulator reads from the bytes.
fn commands<'b>(robot: &mut rflex::Incoming, pieces: impl Iterator<Item = &'b [u8]>) -> Vec<rflex::Request> {
    let mut found = Vec::new();
    for piece in pieces {
        robot.push(piece);
        found.extend(std::iter::from_fn(|| robot.next_request()));
        assert!(robot.kept() <= KEPT, "{} bytes", robot.kept());
    }
    found
}
