//! Encodes the turns of a run as frames, which the thread that drives a robot passes to the thread that writes the
//! record. A frame consists of a tag, the number of bytes that follow, and these bytes.

use mdle_runtime::{Nanos, Sensed};

use crate::bytes::{ByteReader, put_u32, put_u64};
use crate::turn::{self, TurnMade, Undecoded};
use crate::{Begin, Chain, RecordedTransition, RecordedTurn};

/// Length of a frame's header, in bytes.
const HEAD: usize = 5;

/// Tag that gives the kind of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tag {
    Begin,
    Turn,
    Transition,
    Event,
    End,
}

impl Tag {
    const ALL: [Self; 5] = [Self::Begin, Self::Turn, Self::Transition, Self::Event, Self::End];

    fn of(byte: u8) -> Option<Self> {
        Self::ALL.get(usize::from(byte)).copied()
    }
}

/// Encodes the turns of a run as frames.
#[derive(Debug, Clone, Default)]
pub struct Frames {
    before: Option<Sensed>,
    chain: Chain,
    content: Vec<u8>,
}

impl Frames {
    /// Writes the beginning of a record whose first output is `y`.
    pub fn begin(&mut self, begin: &Begin, y: &Sensed, to: &mut Vec<u8>) {
        self.content.clear();
        begin.put(y, &mut self.content);
        self.chained();
        self.put(Tag::Begin, to);
    }

    /// Writes a turn with the output `y`.
    pub fn turn(
        &mut self,
        made: TurnMade<'_>,
        y: &Sensed,
        steps: impl ExactSizeIterator<Item = RecordedTransition>,
        to: &mut Vec<u8>,
    ) {
        self.content.clear();
        turn::put(made, (y, self.before.as_ref()), steps, &mut self.content);
        self.chained();
        self.before = Some(*y);
        self.put(Tag::Turn, to);
    }

    /// Writes a transition of the turn at time `t` as a JSON object.
    pub fn transition(&mut self, t: Nanos, json: &str, to: &mut Vec<u8>) {
        self.text(Tag::Transition, t, json, to);
    }

    /// Writes an event at time `t` as a JSON object.
    pub fn event(&mut self, t: Nanos, json: &str, to: &mut Vec<u8>) {
        self.text(Tag::Event, t, json, to);
    }

    /// Writes the end of the record.
    pub fn end(&mut self, to: &mut Vec<u8>) {
        self.content.clear();
        self.put(Tag::End, to);
    }

    /// Appends the checksum over the content of this frame and of all earlier frames.
    fn chained(&mut self) {
        self.chain = self.chain.with(&self.content);
        self.content.extend_from_slice(&self.chain.bytes());
    }

    fn text(&mut self, tag: Tag, t: Nanos, json: &str, to: &mut Vec<u8>) {
        self.content.clear();
        put_u64(&mut self.content, t.0);
        self.content.extend_from_slice(json.as_bytes());
        self.put(tag, to);
    }

    fn put(&self, tag: Tag, to: &mut Vec<u8>) {
        to.push(tag as u8);
        put_u32(to, u32::try_from(self.content.len()).unwrap_or(u32::MAX));
        to.extend_from_slice(&self.content);
    }
}

/// Returns the tag and the content of the first frame in `bytes`, and the length of the whole frame; `None` if the
/// frame is incomplete or invalid.
pub(crate) fn first(bytes: &[u8]) -> Option<(Tag, &[u8], usize)> {
    let mut from = ByteReader(bytes);
    let tag = Tag::of(from.u8()?)?;
    let length = from.u32()? as usize;
    Some((tag, from.take(length)?, HEAD + length))
}

/// Decodes the turns of a record.
#[derive(Debug)]
pub(crate) struct TurnDecoder {
    pub(crate) begin: Begin,
    constants: crate::Constants,
    before: Option<Sensed>,
    chain: Chain,
}

impl TurnDecoder {
    /// Reads the content of the first frame of a record.
    pub(crate) fn of(content: &[u8]) -> Result<Self, Undecoded> {
        let mut chain = Chain::default();
        let content = chain.checked(content)?;
        let (begin, constants) = Begin::take(&mut ByteReader(content)).ok_or(Undecoded::Unreadable)?;
        Ok(Self { begin, constants, before: None, chain })
    }

    /// Reads the content of the next frame of a turn.
    pub(crate) fn next(&mut self, content: &[u8]) -> Result<RecordedTurn, Undecoded> {
        let content = self.chain.checked(content)?;
        let turn = turn::take(&mut ByteReader(content), self.before.as_ref(), &self.constants);
        let turn = turn.ok_or(Undecoded::Unreadable)?;
        self.before = Some(turn.y);
        Ok(turn)
    }
}
