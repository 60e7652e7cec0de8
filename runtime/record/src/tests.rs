//! Tests records in memory: the decoder without the checksums that would detect a changed byte before it is decoded,
//! the chain of checksums, and files that are cut short.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_runtime::capability::Steering;
use mdle_runtime::{
    Cause, Compass, Meters, MetersPerSecond, Mount, Nanos, PathStore, PeerState, Ping, Pose, Published, Radians,
    RadiansPerSecond, Sensed, Setpoint, Shape, Supply, Twist,
};

use std::cell::RefCell;
use std::io::Write as _;
use std::rc::Rc;

use crate::bytes::ByteReader;
use crate::frames::{Frames, TurnDecoder, first};
use crate::turn::{Undecoded, put, take};
use crate::{
    Applied, Begin, Overruled, ReadError, RecordFile, RecordedChange, RecordedTransition, Records, SafetyTexts,
    TurnMade,
};

fn begin() -> Begin {
    let files = vec![("p.mdle".to_owned(), "{ P (null) }".to_owned())];
    let safety = SafetyTexts { name: "s.toml".to_owned(), text: "# none".to_owned(), plans: vec![files.clone()] };
    Begin { plan: "P".to_owned(), period: Nanos(100), files, safety: Some(safety), ..Begin::default() }
}

fn changes() -> Vec<RecordedChange> {
    vec![
        RecordedChange::Attribute { module: "heading".to_owned(), name: "range".to_owned(), kind: 3 },
        RecordedChange::Published { attribute: 0, at: Nanos(7), bits: 1.5_f64.to_bits() },
        RecordedChange::Vanished(0),
        RecordedChange::Files(begin().files),
        RecordedChange::Armed { files: 0, plan: "P".to_owned(), when: 2 },
        RecordedChange::Cancelled,
        RecordedChange::RolledBack("asked for".to_owned()),
        RecordedChange::Trial(Nanos(3)),
        RecordedChange::Limit { key: "speed".to_owned(), value: 0.25 },
        RecordedChange::Skipped,
        RecordedChange::Late,
        RecordedChange::Back,
        RecordedChange::SafetyReset,
        RecordedChange::Peer { name: "ada".to_owned(), rounds: 2, state: None },
        RecordedChange::Peer { name: "bob".to_owned(), rounds: 1, state: Some(peer_state()) },
        RecordedChange::Path {
            name: "back".to_owned(),
            setpoints: vec![Setpoint { at: Nanos(5), heading: Radians(0.5), speed: MetersPerSecond(0.25) }],
        },
    ]
}

fn peer_state() -> PeerState {
    let velocity = Twist { v: MetersPerSecond(0.5), omega: RadiansPerSecond(-0.25) };
    PeerState { pose: Pose { x: Meters(1.5), ..Pose::ORIGIN }, velocity, age: Nanos(8), rounds: 3, atom: 4 }
}

/// Returns an output with an echo.
fn output() -> Sensed {
    let (metres, steering) = (Meters(0.2), Steering { rotate: 1.0, align: 1.0, avoid: 1.0 });
    let [body_radius, half_length, half_width, wheel_base, ring_radius] = [metres; 5];
    let (sonars_apart, confirmation) = (Some(metres), 2);
    let shape =
        Shape { body_radius, half_length, half_width, wheel_base, sonars_apart, ring_radius, confirmation, steering };
    let mut y = Sensed {
        at: Nanos(9),
        data_age: Nanos(7),
        odometry: Pose::ORIGIN,
        velocity: Twist::default(),
        switches: 1,
        pings: Default::default(),
        compass: Compass::default(),
        supply: Supply::default(),
        shape,
        paths: PathStore::EMPTY,
        published: Published::NONE,
    };
    y.pings[3].push(Ping { range: Some(metres), at: Nanos(8), pose: Pose::ORIGIN, mount: Mount::default() });
    y
}

/// Returns the bytes of the beginning of a record, and the bytes of a turn with everything that a turn can contain.
fn encoded() -> (Vec<u8>, Vec<u8>) {
    let (mut first, mut turn) = (Vec::new(), Vec::new());
    begin().put(&output(), &mut first);
    let asked = Twist { v: MetersPerSecond(0.5), omega: RadiansPerSecond(-0.0) };
    let overruled = Overruled { asked, rule: "speed".to_owned() };
    let (changes, sent) = (changes(), Twist::default());
    let overruled = Some(&overruled);
    let made = TurnMade {
        number: 3,
        t: Nanos(9),
        sent,
        applied: Applied::Law,
        plan: 2,
        state: 5,
        changes: &changes,
        overruled,
    };
    let step = RecordedTransition { from: 1, scope: 2, cause: Cause::Fired(1), to: 5, operands: vec![4, 7] };
    put(made, (&output(), None), std::iter::once(step), &mut turn);
    (first, turn)
}

#[test]
fn a_turn_is_read_as_it_was_written() {
    let (first, turn) = encoded();
    let (begun, constants) = Begin::take(&mut ByteReader(&first)).unwrap();
    assert_eq!(begun, begin());
    let read = take(&mut ByteReader(&turn), None, &constants).unwrap();
    assert_eq!(read.y, output());
    assert_eq!((read.changes, read.overruled.unwrap().rule), (changes(), "speed".to_owned()));
    assert_eq!((read.plan, read.state, read.steps.len()), (2, 5, 1));
}

/// A changed byte is refused or decoded to other data, and a length beyond the end allocates no memory.
#[test]
fn any_byte_of_a_turn_may_be_another() {
    let (first, turn) = encoded();
    let (_, constants) = Begin::take(&mut ByteReader(&first)).unwrap();
    for mask in [0x01, 0x10, 0x80, 0xFF] {
        for place in 0..turn.len() {
            let mut changed = turn.clone();
            changed[place] ^= mask;
            let _ = take(&mut ByteReader(&changed), None, &constants);
            assert_eq!(take(&mut ByteReader(&turn[..place]), None, &constants), None, "cut at {place}");
        }
        for place in 0..first.len() {
            let mut changed = first.clone();
            changed[place] ^= mask;
            let _ = Begin::take(&mut ByteReader(&changed));
        }
    }
}

/// Returns turn `number` of a run with ten turns per second.
fn made(number: u64) -> TurnMade<'static> {
    TurnMade {
        number,
        t: Nanos(number * 100_000_000),
        sent: Twist::default(),
        applied: Applied::Law,
        plan: 1,
        state: 0,
        changes: &[],
        overruled: None,
    }
}

/// Returns the outputs of a run of this many turns, in each of which every sonar pings.
fn outputs(turns: u64) -> Vec<Sensed> {
    let mut y = output();
    let pinged = (0..turns).map(|number| {
        y.at = Nanos(number * 100_000_000);
        let range = Some(Meters(0.5 + number as f64));
        let ping = Ping { range, at: y.at, pose: y.odometry, mount: Mount::default() };
        y.pings.iter_mut().for_each(|pings| pings.push(ping));
        y
    });
    pinged.collect()
}

/// Returns the contents of the frames of a run of this many turns: the beginning, and each turn.
fn contents(begin: &Begin, turns: u64) -> Vec<Vec<u8>> {
    let (mut frames, mut bytes) = (Frames::default(), Vec::new());
    let outputs = outputs(turns);
    frames.begin(begin, &outputs[0], &mut bytes);
    (0..).zip(&outputs).for_each(|(turn, y)| frames.turn(made(turn), y, std::iter::empty(), &mut bytes));
    let (mut contents, mut rest) = (Vec::new(), &bytes[..]);
    while let Some((_, content, length)) = first(rest) {
        contents.push(content.to_vec());
        rest = &rest[length..];
    }
    contents
}

/// Reads the beginning of a record and its turns; returns the number of turns before the first refused turn, and the
/// reason for the refusal.
fn read(begin: &[u8], turns: &[&[u8]]) -> (usize, Option<Undecoded>) {
    let mut chained = match TurnDecoder::of(begin) {
        Ok(turns) => turns,
        Err(why) => return (0, Some(why)),
    };
    for (number, content) in turns.iter().enumerate() {
        match chained.next(content) {
            Ok(turn) => assert_eq!(turn.number, number as u64),
            Err(why) => return (number, Some(why)),
        }
    }
    (turns.len(), None)
}

#[test]
fn a_flipped_bit_anywhere_breaks_the_chain_of_sums() {
    let contents = contents(&begin(), 3);
    let [first, turns @ ..] = &contents[..] else { panic!("no begin") };
    let turns: Vec<&[u8]> = turns.iter().map(Vec::as_slice).collect();
    assert_eq!(read(first, &turns), (3, None));
    for bit in 0..8 {
        for place in 0..first.len() {
            let mut changed = first.clone();
            changed[place] ^= 1 << bit;
            assert_eq!(read(&changed, &turns), (0, Some(Undecoded::Changed)), "begin, {place}");
        }
        for place in 0..turns[1].len() {
            let mut changed = turns[1].to_vec();
            changed[place] ^= 1 << bit;
            assert_eq!(read(first, &[turns[0], &changed, turns[2]]), (1, Some(Undecoded::Changed)), "turn, {place}");
        }
    }
}

#[test]
fn each_turn_has_its_place_in_the_chain_of_sums() {
    let contents = contents(&begin(), 3);
    let turns: Vec<&[u8]> = contents[1..].iter().map(Vec::as_slice).collect();
    let changed = Some(Undecoded::Changed);
    assert_eq!(read(&contents[0], &[turns[0], turns[2]]), (1, changed), "a turn is missing");
    assert_eq!(read(&contents[0], &[turns[1], turns[0]]), (0, changed), "the turns are in another order");
    assert_eq!(read(&contents[0], &[turns[0], turns[0]]), (1, changed), "a turn is there twice");
    let other = self::contents(&Begin { plan: "Q".to_owned(), ..begin() }, 1);
    assert_eq!(read(&other[0], &turns), (0, changed), "the turns are those of another run");
}

/// Bytes that several owners share.
#[derive(Clone, Default)]
struct SharedBytes(Rc<RefCell<Vec<u8>>>);

impl std::io::Write for SharedBytes {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Returns a record of these outputs, and its length after each turn.
fn written(outputs: &[Sensed]) -> (Vec<u8>, Vec<usize>) {
    let (mut frames, mut bytes, file) = (Frames::default(), Vec::new(), SharedBytes::default());
    let (mut record, mut lengths) = (RecordFile::new(file.clone()), Vec::new());
    frames.begin(&begin(), &outputs[0], &mut bytes);
    for (turn, y) in (0..).zip(outputs) {
        frames.turn(made(turn), y, std::iter::empty(), &mut bytes);
        record.write_all(&std::mem::take(&mut bytes)).unwrap();
        lengths.push(file.0.borrow().len());
    }
    frames.end(&mut bytes);
    record.write_all(&bytes).unwrap();
    let whole = file.0.borrow().clone();
    (whole, lengths)
}

#[test]
fn a_cut_at_any_kilobyte_leaves_all_but_the_last_second() {
    const TURNS: u64 = 60;
    let outputs = outputs(TURNS);
    let (whole, lengths) = written(&outputs);
    assert!(whole.len() > 50_000, "{} bytes", whole.len());
    for cut in (0..whole.len()).step_by(1000) {
        let mut records = match Records::open(&whole[..cut]) {
            Ok((_, records)) => records,
            Err(ReadError::NotARecord) if cut < lengths[0] => continue,
            Err(error) => panic!("cut at {cut}: {error}"),
        };
        let turns: Vec<_> = records.by_ref().map(Result::unwrap).collect();
        assert!(!records.is_whole(), "cut at {cut}");
        assert!((0..).zip(&turns).all(|(number, turn)| turn.number == number));
        assert!(turns.iter().zip(&outputs).all(|(turn, y)| turn.y == *y), "cut at {cut}");
        let written = lengths.iter().take_while(|length| **length <= cut).count();
        let missing = written.saturating_sub(turns.len());
        assert!(missing <= 10, "cut at {cut}: {missing} of {written} turns are missing");
    }
    let (_, mut records) = Records::open(&whole[..]).unwrap();
    assert_eq!(records.by_ref().count() as u64, TURNS);
    assert!(records.is_whole());
}

/// A source whose read fails.
struct Unreadable;

impl std::io::Read for Unreadable {
    fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
        Err(std::io::Error::other("the zeros were read to their end"))
    }
}

/// A system that loses power may leave any number of zeros at the end of a file.
#[test]
fn zeros_after_a_cut_record_are_its_end() {
    use std::io::Read as _;
    let (whole, lengths) = written(&outputs(60));
    let cut = &whole[..lengths[50]];
    let turns = Records::open(cut).unwrap().1.count();
    let zeros = std::io::repeat(0).take(1 << 24).chain(Unreadable);
    let (_, mut records) = Records::open(cut.chain(zeros)).unwrap();
    assert_eq!(records.by_ref().map(Result::unwrap).count(), turns);
    assert!(turns >= 40 && !records.is_whole(), "{turns}");
}

/// A changed length that points beyond the end of the file does not count as a cut, because the file has its end.
#[test]
fn a_flipped_bit_in_the_head_of_any_part_is_noticed() {
    const TURNS: u64 = 12;
    let (whole, _) = written(&outputs(TURNS));
    let mut at = mcap::MAGIC.len();
    let mut parts = 0;
    while let Some(length) = whole.get(at + 1..at + 9) {
        for bit in (0..5 * 8).chain([9 * 8 - 1]) {
            let mut flipped = whole.clone();
            flipped[at + bit / 8] ^= 1 << (bit % 8);
            let Ok((_, mut records)) = Records::open(&flipped[..]) else { continue };
            let turns: Vec<_> = records.by_ref().take(TURNS as usize + 1).collect();
            let is_same = turns.len() as u64 == TURNS && records.is_whole();
            assert!(
                is_same || turns.iter().any(Result::is_err),
                "bit {bit} of the part at {at}: {} turns",
                turns.len()
            );
        }
        at += 9 + u64::from_le_bytes(length.try_into().unwrap()) as usize;
        parts += 1;
    }
    assert!(parts > 5, "{parts} parts");
}

/// Messages describe the run in plain words, because users do not know the terms of MCAP.
#[test]
fn damage_is_described_in_plain_words() {
    let (whole, _) = written(&outputs(12));
    let mut messages = std::collections::BTreeSet::new();
    for at in (0..whole.len()).step_by(17) {
        let mut flipped = whole.clone();
        flipped[at] ^= 0x80;
        let error = match Records::open(&flipped[..]) {
            Ok((_, records)) => records.into_iter().find_map(Result::err),
            Err(error) => Some(error),
        };
        messages.extend(error.map(|error| error.to_string()));
    }
    let cut = Records::open(&[&whole[..], b"more"].concat()[..]).unwrap().1.find_map(Result::err);
    messages.extend(cut.map(|error| error.to_string()));
    assert!(messages.len() > 6, "{messages:#?}");
    for message in &messages {
        let words = message.to_lowercase();
        let terms =
            ["chunk", "crc", "opcode", "record parse", "magic", "section", "schema", "attachment", "channel", "index"];
        assert!(terms.iter().all(|term| !words.contains(term)), "{message}");
    }
}
