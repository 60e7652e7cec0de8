//! A state in binary form: a length, then version, checksum, proof of the key, and the state
//! (docs/src/reference/interfaces.md, 6.5).

use mdle_runtime::{Meters, MetersPerSecond, Nanos, PEERS, Pose, Radians, RadiansPerSecond, Twist};

use super::{SharedValue, State};
use crate::attribute::{AttributeKind, AttributeName, Value};

/// First bytes of every frame.
const MAGIC: [u8; 4] = *b"MDLe";
/// Version of frames.
pub(super) const VERSION: u8 = 3;
/// Maximum length of a frame, in bytes, without the four bytes of the length.
pub(super) const LONGEST: usize = 8192;
/// Maximum number of attributes in a state.
pub(super) const ATTRIBUTES: usize = 40;
/// Maximum length of a robot's name, in bytes.
pub(super) const NAME: usize = 64;
/// Number of bytes before the state: magic, version, checksum, and proof.
const HEAD: usize = 4 + 1 + 4 + 16;

/// The key that all robots of a link share.
#[derive(Clone)]
pub(super) struct Key([u8; 32]);

impl Key {
    pub(super) fn of(text: &str) -> Self {
        Self(blake3::derive_key("mdle state link 1", text.as_bytes()))
    }

    /// Returns the key of letters, which two robots share.
    pub(super) fn of_letters(text: &str) -> Self {
        Self(blake3::derive_key("mdle letters 1", text.as_bytes()))
    }

    /// Returns the proof that the writer of these bytes has the key.
    fn proof(&self, body: &[u8]) -> [u8; 16] {
        blake3::keyed_hash(&self.0, body).as_bytes().first_chunk().copied().unwrap_or_default()
    }
}

/// Reason why a frame is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refused {
    /// The bytes are not a frame, or were changed on the way.
    Garbage,
    /// The frame has another version: its number.
    Version(u8),
    /// The sender has a different key.
    Key,
}

/// Returns the frame of a state, length included.
pub(super) fn written(state: &State, key: &Key) -> Vec<u8> {
    let mut body = Vec::with_capacity(256);
    put_name(&mut body, &state.name);
    body.extend(state.session.to_le_bytes());
    body.extend(state.number.to_le_bytes());
    let Pose { x, y, theta } = state.pose;
    let Twist { v, omega } = state.velocity;
    [x.0, y.0, theta.0, v.0, omega.0].iter().for_each(|number| body.extend(number.to_le_bytes()));
    body.extend(state.atom.to_le_bytes());
    let rounds = state.rounds.get(..state.rounds.len().min(PEERS)).unwrap_or_default();
    body.push(rounds.len() as u8);
    for (robot, count) in rounds {
        put_name(&mut body, robot);
        body.extend(count.to_le_bytes());
    }
    let attributes = state.attributes.get(..state.attributes.len().min(ATTRIBUTES)).unwrap_or_default();
    body.push(attributes.len() as u8);
    for SharedValue { name, value, age } in attributes {
        put_name(&mut body, &name.module);
        put_name(&mut body, &name.attribute);
        body.push(value.kind().number());
        body.extend(value.bits().to_le_bytes());
        body.extend(age.0.to_le_bytes());
    }
    framed(MAGIC, &body, key)
}

/// Returns the frame of a body, length included.
pub(super) fn framed(magic: [u8; 4], body: &[u8], key: &Key) -> Vec<u8> {
    let length = (HEAD + body.len()) as u32;
    let mut frame = length.to_le_bytes().to_vec();
    frame.extend(magic);
    frame.push(VERSION);
    frame.extend(checksum(body));
    frame.extend(key.proof(body));
    frame.extend(body);
    frame
}

fn checksum(body: &[u8]) -> [u8; 4] {
    blake3::hash(body).as_bytes().first_chunk().copied().unwrap_or_default()
}

pub(super) fn put_name(to: &mut Vec<u8>, name: &str) {
    let bytes = name.as_bytes();
    let bytes = bytes.get(..bytes.len().min(NAME)).unwrap_or_default();
    to.push(bytes.len() as u8);
    to.extend(bytes);
}

/// Reads the frame of a state, without its length.
///
/// # Errors
/// Fails if the bytes are not a frame of a robot with this key.
pub(super) fn read(frame: &[u8], key: &Key) -> Result<State, Refused> {
    let mut body = opened(MAGIC, frame, key)?;
    state(&mut body).ok_or(Refused::Garbage)
}

/// Returns the body of a frame with these first bytes, once its checksum and its proof hold.
///
/// # Errors
/// The bytes are no such frame of somebody with this key.
pub(super) fn opened<'b>(magic: [u8; 4], frame: &'b [u8], key: &Key) -> Result<Bytes<'b>, Refused> {
    let mut from = Bytes(frame);
    if from.take() != Some(magic) {
        return Err(Refused::Garbage);
    }
    match from.take::<1>() {
        Some([VERSION]) => {}
        Some([other]) => return Err(Refused::Version(other)),
        None => return Err(Refused::Garbage),
    }
    let (Some(sum), Some(proof)) = (from.take::<4>(), from.take::<16>()) else { return Err(Refused::Garbage) };
    if checksum(from.0) != sum {
        return Err(Refused::Garbage);
    }
    // Only somebody who has the key knows the proof, so nobody gains from the time that the comparison takes.
    if key.proof(from.0) != proof {
        return Err(Refused::Key);
    }
    Ok(from)
}

fn state(from: &mut Bytes<'_>) -> Option<State> {
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
    from.0.is_empty().then_some(State { name, session, number, pose, velocity, rounds, atom, attributes })
}

/// Reads the value of an attribute, which is a number and not NaN.
fn attribute(from: &mut Bytes<'_>) -> Option<SharedValue> {
    let name = AttributeName::new(&from.name()?, &from.name()?);
    let [kind] = from.take()?;
    let value = Value::of_bits(AttributeKind::of_number(kind)?, from.number()?);
    let age = Nanos(from.number()?);
    value.number().filter(|number| !number.is_nan()).map(|_| SharedValue { name, value, age })
}

/// Bytes of a frame, which are read from the front.
pub(super) struct Bytes<'b>(&'b [u8]);

impl<'b> Bytes<'b> {
    /// Returns the bytes of a frame's body, which nothing proves yet.
    pub(super) fn of_body(frame: &'b [u8]) -> Option<Self> {
        frame.get(HEAD..).map(Self)
    }

    /// Takes all bytes that are left, as text.
    pub(super) fn text(&mut self) -> Option<String> {
        String::from_utf8(std::mem::take(&mut self.0).to_vec()).ok()
    }

    pub(super) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    pub(super) fn number(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    pub(super) fn name(&mut self) -> Option<String> {
        let [length] = self.take()?;
        let (name, rest) = self.0.split_at_checked(usize::from(length))?;
        self.0 = rest;
        String::from_utf8(name.to_vec()).ok().filter(|name| !name.is_empty() && name.len() <= NAME)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sent() -> State {
        State {
            name: "ada".to_owned(),
            session: 9,
            number: 7,
            pose: Pose { x: Meters(1.5), y: Meters(-2.0), theta: Radians(0.25) },
            velocity: Twist { v: MetersPerSecond(0.5), omega: RadiansPerSecond(-0.1) },
            rounds: vec![("bob".to_owned(), 3), ("eve".to_owned(), u64::MAX)],
            atom: 4,
            attributes: vec![
                shared("range", Value::Length(Meters(f64::INFINITY))),
                shared("count", Value::Integer(-3)),
            ],
        }
    }

    fn shared(attribute: &str, value: Value) -> SharedValue {
        SharedValue { name: AttributeName::new("heading", attribute), value, age: Nanos(5) }
    }

    #[test]
    fn a_state_is_read_as_it_was_written() {
        let key = Key::of("a key");
        let frame = written(&sent(), &key);
        let (length, rest) = frame.split_first_chunk().unwrap();
        assert_eq!(u32::from_le_bytes(*length) as usize, rest.len());
        assert!(rest.len() < LONGEST);
        assert_eq!(read(rest, &key), Ok(sent()));
    }

    #[test]
    fn any_other_bytes_are_refused() {
        let key = Key::of("a key");
        let frame = written(&sent(), &key)[4..].to_vec();
        assert_eq!(read(&frame, &Key::of("another")), Err(Refused::Key));
        for length in 0..frame.len() {
            assert_eq!(read(&frame[..length], &key), Err(Refused::Garbage), "the first {length} bytes");
        }
        for place in 0..frame.len() {
            let mut changed = frame.clone();
            changed[place] ^= 1;
            let refused = read(&changed, &key).unwrap_err();
            let expected = match place {
                4 => Refused::Version(VERSION ^ 1),
                9..25 => Refused::Key,
                _ => Refused::Garbage,
            };
            assert_eq!(refused, expected, "byte {place}");
        }
        let mut not_finite = sent();
        not_finite.pose.x.0 = f64::NAN;
        assert_eq!(read(&written(&not_finite, &key)[4..], &key), Err(Refused::Garbage));
        for value in [Value::Number(f64::NAN), Value::Flag(true), Value::Text("text".into())] {
            let no_number = State { attributes: vec![shared("range", value)], ..sent() };
            assert_eq!(read(&written(&no_number, &key)[4..], &key), Err(Refused::Garbage));
        }
    }

    #[test]
    fn names_and_rounds_have_limits() {
        let key = Key::of("");
        let name = AttributeName::new(&"m".repeat(300), &"a".repeat(300));
        let attribute = SharedValue { name, ..shared("", Value::Number(1.0)) };
        let (rounds, attributes) = (vec![("r".repeat(300), 1); 20], vec![attribute; 60]);
        let long = State { name: "n".repeat(300), rounds, attributes, ..sent() };
        let frame = written(&long, &key);
        assert!(frame.len() < LONGEST, "{}", frame.len());
        let state = read(&frame[4..], &key).unwrap();
        assert_eq!((state.name.len(), state.rounds.len(), state.attributes.len()), (NAME, PEERS, ATTRIBUTES));
    }
}
