//! Tests of the decoder below the sums, which a changed byte never reaches in a file.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use mdle_runtime::capability::Steering;
use mdle_runtime::{
    Cause, Compass, Meters, MetersPerSecond, Mount, Nanos, PathStore, Ping, Pose, Published, RadiansPerSecond, Sensed,
    Shape, Supply, Twist,
};

use crate::TurnMade;
use crate::bytes::Bytes;
use crate::turn::{put, take};
use crate::{Applied, Begin, Change, Overruled, SafetyTexts, Step};

fn begin() -> Begin {
    let files = vec![("p.mdle".to_owned(), "{ P (null) }".to_owned())];
    let safety = SafetyTexts { name: "s.toml".to_owned(), text: "# none".to_owned(), plans: vec![files.clone()] };
    Begin { plan: "P".to_owned(), period: Nanos(100), files, safety: Some(safety), ..Begin::default() }
}

fn changes() -> Vec<Change> {
    vec![
        Change::Attribute { module: "heading".to_owned(), name: "range".to_owned(), kind: 3 },
        Change::Published { attribute: 0, at: Nanos(7), bits: 1.5_f64.to_bits() },
        Change::Vanished(0),
        Change::Files(begin().files),
        Change::Armed { files: 0, plan: "P".to_owned(), when: 2 },
        Change::Cancelled,
        Change::RolledBack("asked for".to_owned()),
        Change::Trial(Nanos(3)),
        Change::Limit { key: "speed".to_owned(), value: 0.25 },
        Change::Skipped,
        Change::Late,
        Change::Back,
    ]
}

/// An output with an echo.
fn output() -> Sensed {
    let (metres, steering) = (Meters(0.2), Steering { rotate: 1.0, align: 1.0, avoid: 1.0 });
    let [body_radius, half_length, half_width, wheel_base, ring_radius] = [metres; 5];
    let (sonars_apart, confirmation) = (Some(metres), 2);
    let shape =
        Shape { body_radius, half_length, half_width, wheel_base, sonars_apart, ring_radius, confirmation, steering };
    let mut y = Sensed {
        at: Nanos(9),
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

/// The bytes of a begin, and those of a turn with everything that a turn can have.
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
    let step = Step { from: 1, scope: 2, cause: Cause::Fired(1), to: 5, operands: vec![4, 7] };
    put(made, (&output(), None), std::iter::once(step), &mut turn);
    (first, turn)
}

#[test]
fn a_turn_is_read_as_it_was_written() {
    let (first, turn) = encoded();
    let (begun, constants) = Begin::take(&mut Bytes(&first)).unwrap();
    assert_eq!(begun, begin());
    let read = take(&mut Bytes(&turn), None, &constants).unwrap();
    assert_eq!((read.changes, read.overruled.unwrap().rule), (changes(), "speed".to_owned()));
    assert_eq!((read.plan, read.state, read.steps.len()), (2, 5, 1));
}

/// Bytes that no run has written are refused or read as something else, and lengths beyond the end take no memory.
#[test]
fn any_byte_of_a_turn_may_be_another() {
    let (first, turn) = encoded();
    let (_, constants) = Begin::take(&mut Bytes(&first)).unwrap();
    for mask in [0x01, 0x10, 0x80, 0xFF] {
        for place in 0..turn.len() {
            let mut changed = turn.clone();
            changed[place] ^= mask;
            let _ = take(&mut Bytes(&changed), None, &constants);
            assert_eq!(take(&mut Bytes(&turn[..place]), None, &constants), None, "cut at {place}");
        }
        for place in 0..first.len() {
            let mut changed = first.clone();
            changed[place] ^= mask;
            let _ = Begin::take(&mut Bytes(&changed));
        }
    }
}
