//! Frames, which consist of a length, a magic number, a version, a checksum, a proof of the key, and a body
//! (docs/src/reference/interfaces.md, 6.5).

use std::io;
use std::sync::Arc;

use mdle_runtime::Nanos;
use rustix::rand::{GetRandomFlags, getrandom};

use super::bytes::UnreadBytes;
use super::clock;

/// Version of the frame format.
pub(super) const VERSION: u8 = 5;
/// Magic number of a greeting: its first bytes.
const GREETING: [u8; 4] = *b"MDLg";
/// Length of a greeting, in bytes: magic number, version, and challenge.
pub(super) const GREETING_LENGTH: usize = 4 + 1 + 16;
/// Length of the header before the body, in bytes: magic number, version, checksum, and proof.
const HEAD: usize = 4 + 1 + 4 + 32;

/// A key that several robots share.
#[derive(Clone)]
pub(super) struct SharedKey([u8; 32]);

impl SharedKey {
    /// Returns the key for states, which all robots of a link share.
    pub(super) fn of(text: &str) -> Self {
        Self(blake3::derive_key("mdle state link 1", text.as_bytes()))
    }

    /// Returns the key for letters, which two robots share.
    pub(super) fn of_letters(text: &str) -> Self {
        Self(blake3::derive_key("mdle letters 1", text.as_bytes()))
    }

    /// Returns the proof that a frame's writer has the key, and has written the frame in response to this challenge.
    fn proof(&self, challenge: &Challenge, magic: [u8; 4], body: &[u8]) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new_keyed(&self.0);
        hasher.update(&challenge.0).update(&magic).update(&[VERSION]).update(body);
        hasher.finalize()
    }
}

/// Random bytes that the receiver of a connection sends first. The proof of each frame covers these bytes, so a frame
/// that is replayed on another connection is invalid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Challenge([u8; 16]);

impl Challenge {
    /// Challenge on a medium without connections. There, the proof of a frame does not show when the frame was written.
    pub const NONE: Self = Self([0; 16]);

    /// Returns a new random challenge.
    ///
    /// # Errors
    /// Fails if the system has no random numbers.
    pub(super) fn random() -> io::Result<Self> {
        let mut bytes = [0; 16];
        match getrandom(&mut bytes[..], GetRandomFlags::empty())? {
            16 => Ok(Self(bytes)),
            _ => Err(io::ErrorKind::UnexpectedEof.into()),
        }
    }

    /// Returns the greeting, in which a receiver sends the challenge to a sender.
    pub(super) fn greeting(&self) -> [u8; GREETING_LENGTH] {
        let mut greeting = [0; GREETING_LENGTH];
        let bytes = GREETING.into_iter().chain([VERSION]).chain(self.0);
        greeting.iter_mut().zip(bytes).for_each(|(place, byte)| *place = byte);
        greeting
    }

    /// Reads the challenge from a greeting.
    ///
    /// # Errors
    /// Fails if the bytes are not a greeting of this version.
    pub(super) fn of_greeting(greeting: &[u8; GREETING_LENGTH]) -> Result<Self, RefusedFrame> {
        let mut bytes = UnreadBytes::of(greeting);
        if bytes.take() != Some(GREETING) {
            return Err(RefusedFrame::Garbage);
        }
        match bytes.take::<1>() {
            Some([VERSION]) => bytes.take().map(Self).ok_or(RefusedFrame::Garbage),
            Some([other]) => Err(RefusedFrame::Version(other)),
            None => Err(RefusedFrame::Garbage),
        }
    }
}

/// Reason why a frame is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RefusedFrame {
    /// The bytes are not a frame, or were damaged during transmission.
    Garbage,
    /// The frame has another version than this program; contains the frame's version.
    Version(u8),
    /// The sender has a different key, or wrote the frame for a different connection.
    Key,
    /// The state contains a pose or velocity that no robot can have.
    Impossible,
}

/// A frame without the parts that are computed for each connection: the proof, and the times of a state.
#[derive(Clone)]
pub struct FrameDraft {
    magic: [u8; 4],
    /// Times of a state, with which the body begins; `None` for any other frame.
    times: Option<StateTimes>,
    body: Arc<[u8]>,
    key: SharedKey,
}

/// Timestamps of a state on the clock of its robot.
#[derive(Debug, Clone, Copy)]
pub(super) struct StateTimes {
    /// Start time of the robot's session.
    pub(super) begun: Nanos,
    /// Time at which the state was measured.
    pub(super) measured: Nanos,
}

impl StateTimes {
    /// Returns the times that a frame written at `now` contains: the time since the start of the session, and the age
    /// of the state.
    fn at(self, now: Nanos) -> [Nanos; 2] {
        [now.since(self.begun), now.since(self.measured)]
    }
}

impl FrameDraft {
    /// Creates the draft of a frame with this magic number. `times` contains the times of a state; `None` for any other
    /// frame.
    pub(super) fn new(magic: [u8; 4], times: Option<StateTimes>, body: Vec<u8>, key: &SharedKey) -> Self {
        Self { magic, times, body: body.into(), key: key.clone() }
    }

    /// Returns the frame, including its length field, as written now with a proof for this challenge.
    #[must_use]
    pub fn frame(&self, challenge: &Challenge) -> Vec<u8> {
        self.frame_at(challenge, clock::now())
    }

    /// Returns the frame, including its length field, as written at time `now` with a proof for this challenge.
    pub(super) fn frame_at(&self, challenge: &Challenge, now: Nanos) -> Vec<u8> {
        let Self { magic, times, body, key } = self;
        let times = times.iter().flat_map(|times| times.at(now)).flat_map(|time| time.0.to_le_bytes());
        let body: Vec<u8> = times.chain(body.iter().copied()).collect();
        let body = body.as_slice();
        let length = (HEAD + body.len()) as u32;
        let mut frame = length.to_le_bytes().to_vec();
        frame.extend(magic);
        frame.push(VERSION);
        frame.extend(checksum(body));
        frame.extend(key.proof(challenge, *magic, body).as_bytes());
        frame.extend(body);
        frame
    }

    /// Returns the frame without its length field, for a medium without connections.
    #[must_use]
    pub fn payload(&self) -> Vec<u8> {
        self.frame(&Challenge::NONE).split_off(4)
    }
}

fn checksum(body: &[u8]) -> [u8; 4] {
    blake3::hash(body).as_bytes().first_chunk().copied().unwrap_or_default()
}

/// Checks the magic number, version, checksum and proof of a frame, and returns its body.
///
/// # Errors
/// Fails if the bytes are not a frame of this type, or if its proof is not for this key and this challenge.
pub(super) fn opened<'b>(
    magic: [u8; 4],
    frame: &'b [u8],
    key: &SharedKey,
    challenge: &Challenge,
) -> Result<UnreadBytes<'b>, RefusedFrame> {
    let mut from = UnreadBytes::of(frame);
    if from.take() != Some(magic) {
        return Err(RefusedFrame::Garbage);
    }
    match from.take::<1>() {
        Some([VERSION]) => {}
        Some([other]) => return Err(RefusedFrame::Version(other)),
        None => return Err(RefusedFrame::Garbage),
    }
    let (Some(sum), Some(proof)) = (from.take::<4>(), from.take::<32>()) else { return Err(RefusedFrame::Garbage) };
    if checksum(from.rest()) != sum {
        return Err(RefusedFrame::Garbage);
    }
    // The comparison takes constant time, so its duration reveals nothing about a valid proof.
    if key.proof(challenge, magic, from.rest()) != blake3::Hash::from_bytes(proof) {
        return Err(RefusedFrame::Key);
    }
    Ok(from)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAGIC: [u8; 4] = *b"MDLe";

    #[test]
    fn a_frame_counts_for_its_challenge_alone() {
        let [one, other] = [(); 2].map(|()| Challenge::random().unwrap());
        assert_ne!(one, other);
        let key = SharedKey::of("a key");
        let draft = FrameDraft::new(MAGIC, None, b"body".to_vec(), &key);
        let frame = draft.frame(&one)[4..].to_vec();
        assert_eq!(opened(MAGIC, &frame, &key, &one).unwrap().text().unwrap(), "body");
        for challenge in [other, Challenge::NONE] {
            assert_eq!(opened(MAGIC, &frame, &key, &challenge).err(), Some(RefusedFrame::Key));
        }
    }

    #[test]
    fn the_proof_covers_first_bytes_and_version() {
        let (key, challenge) = (SharedKey::of("a key"), Challenge::NONE);
        let mut frame = FrameDraft::new(MAGIC, None, b"body".to_vec(), &key).frame(&challenge)[4..].to_vec();
        frame[3] = b'l';
        assert_eq!(opened(*b"MDLl", &frame, &key, &challenge).err(), Some(RefusedFrame::Key));
        let older = blake3::keyed_hash(&key.0, b"body");
        frame[3] = b'e';
        frame[9..41].copy_from_slice(older.as_bytes());
        assert_eq!(opened(MAGIC, &frame, &key, &challenge).err(), Some(RefusedFrame::Key));
    }

    #[test]
    fn a_greeting_tells_the_challenge() {
        let challenge = Challenge::random().unwrap();
        let mut greeting = challenge.greeting();
        assert_eq!(Challenge::of_greeting(&greeting), Ok(challenge));
        greeting[4] = 9;
        assert_eq!(Challenge::of_greeting(&greeting), Err(RefusedFrame::Version(9)));
        greeting[0] = 0;
        assert_eq!(Challenge::of_greeting(&greeting), Err(RefusedFrame::Garbage));
    }
}
