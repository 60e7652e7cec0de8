//! States in binary form (docs/src/reference/interfaces.md, 6.5).

use mdle_runtime::{Meters, MetersPerSecond, Nanos, PEERS, Pose, Radians, RadiansPerSecond, Twist};

use super::bytes::{UnreadBytes, fits, put_name};
use super::frame::{Challenge, FrameDraft, RefusedFrame, SharedKey, StateTimes, opened};
use super::{SharedValue, State};
use crate::attribute::{AttributeKind, AttributeName, Value};

/// Magic number of a state's frame.
const MAGIC: [u8; 4] = *b"MDLe";
/// Maximum length of a state's frame, in bytes, without the four bytes of the length field.
pub(super) const LONGEST: usize = 8192;
/// Maximum number of attributes in a state.
pub(super) const ATTRIBUTES: usize = 40;
/// Maximum absolute value of a robot's coordinates, in metres, and of its velocities, in metres and radians per second.
const FARTHEST: f64 = 1e6;
const FASTEST: f64 = 1e3;

/// Returns the draft of a state with these times. Attributes whose names do not fit are omitted.
pub(super) fn written(state: &State, times: StateTimes, key: &SharedKey) -> FrameDraft {
    let mut body = Vec::with_capacity(256);
    put_name(&mut body, &state.name);
    [state.session, state.number].iter().for_each(|number| body.extend(number.to_le_bytes()));
    let Pose { x, y, theta } = state.pose;
    let Twist { v, omega } = state.velocity;
    [x.0, y.0, theta.0, v.0, omega.0].iter().for_each(|number| body.extend(number.to_le_bytes()));
    body.extend(state.atom.to_le_bytes());
    let rounds: Vec<_> = state.rounds.iter().filter(|(robot, _)| fits(robot)).take(PEERS).collect();
    body.push(rounds.len() as u8);
    for (robot, count) in rounds {
        put_name(&mut body, robot);
        body.extend(count.to_le_bytes());
    }
    let attributes: Vec<_> =
        state.attributes.iter().filter(|shared| has_fitting_name(shared)).take(ATTRIBUTES).collect();
    body.push(attributes.len() as u8);
    for SharedValue { name, value, age } in attributes {
        put_name(&mut body, &name.module);
        put_name(&mut body, &name.attribute);
        body.push(value.kind().number());
        body.extend(value.bits().to_le_bytes());
        body.extend(age.0.to_le_bytes());
    }
    FrameDraft::new(MAGIC, Some(times), body, key)
}

/// Returns `true` if an attribute's name fits into a frame.
pub(super) fn has_fitting_name(SharedValue { name, .. }: &SharedValue) -> bool {
    fits(&name.module) && fits(&name.attribute)
}

/// Parses the frame of a state, given without its length field. Returns the state, with its age when the frame was
/// written, and the time when the frame was written, counted from the start of the sender's session.
///
/// # Errors
/// Fails if the bytes are not the frame of a state, or if its proof is not for this key and this challenge.
pub(super) fn read(frame: &[u8], key: &SharedKey, challenge: &Challenge) -> Result<(State, Nanos), RefusedFrame> {
    let (state, written) = state(&mut opened(MAGIC, frame, key, challenge)?).ok_or(RefusedFrame::Garbage)?;
    let Pose { x, y, theta } = state.pose;
    let Twist { v, omega } = state.velocity;
    // Larger numbers would cause overflows in laws that use them.
    if [x.0, y.0].iter().any(|place| place.abs() > FARTHEST) || [v.0, omega.0].iter().any(|speed| speed.abs() > FASTEST)
    {
        return Err(RefusedFrame::Impossible);
    }
    Ok((State { pose: Pose { x, y, theta: theta.wrapped() }, ..state }, written))
}

fn state(from: &mut UnreadBytes<'_>) -> Option<(State, Nanos)> {
    let (written, age) = (Nanos(from.number()?), Nanos(from.number()?));
    let name = from.name()?;
    let (session, number) = (from.number()?, from.number()?);
    let mut real = || from.take().map(f64::from_le_bytes).filter(|number| number.is_finite());
    let pose = Pose { x: Meters(real()?), y: Meters(real()?), theta: Radians(real()?) };
    let velocity = Twist { v: MetersPerSecond(real()?), omega: RadiansPerSecond(real()?) };
    let atom = from.number()?;
    let [count] = from.take()?;
    let rounds = (0..count).map(|_| Some((from.name()?, from.number()?))).collect::<Option<Vec<_>>>()?;
    let [count] = from.take()?;
    let attributes = (0..count).map(|_| attribute(from)).collect::<Option<Vec<_>>>()?;
    let state = State { name, session, number, age, pose, velocity, rounds, atom, attributes };
    from.is_empty().then_some((state, written))
}

/// Reads an attribute with its value; `None` if the value is not a valid number.
fn attribute(from: &mut UnreadBytes<'_>) -> Option<SharedValue> {
    let name = AttributeName::new(&from.name()?, &from.name()?);
    let [kind] = from.take()?;
    let value = Value::of_bits(AttributeKind::of_number(kind)?, from.number()?);
    let age = Nanos(from.number()?);
    value.number().filter(|number| !number.is_nan()).map(|_| SharedValue { name, value, age })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::bytes::NAME;
    use crate::link::frame::VERSION;

    /// Times of a state that is written 15 ns after the start of the session and is 3 ns old.
    const TIMES: StateTimes = StateTimes { begun: Nanos(5), measured: Nanos(17) };
    const WRITTEN: Nanos = Nanos(20);

    fn sent() -> State {
        State {
            pose: Pose { x: Meters(1.5), y: Meters(-2.0), theta: Radians(0.25) },
            velocity: Twist { v: MetersPerSecond(0.5), omega: RadiansPerSecond(-0.1) },
            rounds: vec![("bob".to_owned(), 3), ("eve".to_owned(), u64::MAX)],
            attributes: vec![
                shared("range", Value::Length(Meters(f64::INFINITY))),
                shared("count", Value::Integer(-3)),
            ],
            ..State::of("ada", 7)
        }
    }

    fn shared(attribute: &str, value: Value) -> SharedValue {
        SharedValue { name: AttributeName::new("heading", attribute), value, age: Nanos(5) }
    }

    /// Returns the frame of a state without its length.
    fn frame(state: &State, key: &SharedKey) -> Vec<u8> {
        written(state, TIMES, key).frame_at(&Challenge::NONE, WRITTEN)[4..].to_vec()
    }

    /// Writes and reads the frame of a state, as if another robot had sent it.
    fn taken(state: &State) -> Result<State, RefusedFrame> {
        let key = SharedKey::of("a key");
        read(&frame(state, &key), &key, &Challenge::NONE).map(|(state, _)| state)
    }

    #[test]
    fn a_state_is_read_as_it_was_written() {
        let key = SharedKey::of("a key");
        let frame = written(&sent(), TIMES, &key).frame_at(&Challenge::NONE, WRITTEN);
        let (length, rest) = frame.split_first_chunk().unwrap();
        assert_eq!(u32::from_le_bytes(*length) as usize, rest.len());
        assert!(rest.len() < LONGEST);
        assert_eq!(read(rest, &key, &Challenge::NONE), Ok((State { age: Nanos(3), ..sent() }, Nanos(15))));
    }

    #[test]
    fn any_other_bytes_are_refused() {
        let key = SharedKey::of("a key");
        let read = |frame: &[u8], key: &SharedKey| read(frame, key, &Challenge::NONE);
        let frame = frame(&sent(), &key);
        assert_eq!(read(&frame, &SharedKey::of("another")), Err(RefusedFrame::Key));
        for length in 0..frame.len() {
            assert_eq!(read(&frame[..length], &key), Err(RefusedFrame::Garbage), "the first {length} bytes");
        }
        for place in 0..frame.len() {
            let mut changed = frame.clone();
            changed[place] ^= 1;
            let expected = match place {
                4 => RefusedFrame::Version(VERSION ^ 1),
                9..41 => RefusedFrame::Key,
                _ => RefusedFrame::Garbage,
            };
            assert_eq!(read(&changed, &key), Err(expected), "byte {place}");
        }
        for value in [Value::Number(f64::NAN), Value::Flag(true), Value::Text("text".into())] {
            let no_number = State { attributes: vec![shared("range", value)], ..sent() };
            assert_eq!(taken(&no_number), Err(RefusedFrame::Garbage));
        }
    }

    #[test]
    fn a_state_that_no_robot_has_is_refused() {
        let with = |change: fn(&mut State)| {
            let mut state = sent();
            change(&mut state);
            taken(&state)
        };
        assert_eq!(with(|state| state.pose.x.0 = f64::NAN), Err(RefusedFrame::Garbage));
        for change in [
            |state: &mut State| state.pose.x.0 = 1.7e308,
            |state: &mut State| state.pose.y.0 = -1.1e6,
            |state: &mut State| state.velocity.v.0 = 1.1e3,
            |state: &mut State| state.velocity.omega.0 = -1.7e308,
        ] {
            assert_eq!(with(change), Err(RefusedFrame::Impossible));
        }
        let turned = with(|state| state.pose.theta = Radians::from_degrees(350.0)).unwrap();
        assert!((turned.pose.theta.0 - Radians::from_degrees(-10.0).0).abs() < 1e-9, "{turned:?}");
    }

    #[test]
    fn names_and_rounds_have_limits() {
        let attribute = |length: usize| {
            let name = AttributeName::new(&"m".repeat(NAME), &"a".repeat(length));
            SharedValue { name, ..shared("", Value::Number(1.0)) }
        };
        let mut attributes = vec![attribute(NAME); 60];
        attributes.insert(0, attribute(NAME + 1));
        let mut rounds = vec![("r".repeat(NAME), 1); 20];
        rounds.insert(0, ("r".repeat(NAME + 1), 1));
        let long = State { name: "n".repeat(NAME), rounds, attributes, ..sent() };
        assert!(frame(&long, &SharedKey::of("")).len() < LONGEST);
        let state = taken(&long).unwrap();
        assert_eq!((state.name.len(), state.rounds.len(), state.attributes.len()), (NAME, PEERS, ATTRIBUTES));
        assert!(state.attributes.iter().all(|shared| *shared == attribute(NAME)), "what is too long is left out");
    }
}
