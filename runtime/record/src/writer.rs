//! Writes the file of a record, by converting frames to an MCAP file.

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, WriteOptions, Writer};
use mdle_runtime::Nanos;

use crate::Begin;
use crate::bytes::ByteReader;
use crate::frames::{Tag, TurnDecoder, first};
use crate::turn::Undecoded;
use crate::viewers::CHANNELS;

/// Duration of a chunk in the time of the run, in nanoseconds.
const CHUNK: u64 = 1_000_000_000;
/// Encoding of the messages of `/exact/begin`.
pub(crate) const BEGIN: &str = "mdle.begin.2";
/// Encoding of the messages of `/exact/turn`.
pub(crate) const TURN: &str = "mdle.turn.2";

/// Writes a record from frames. Each second of the run becomes a chunk, which is written as a whole. A record that is
/// cut short can therefore be read up to its last complete second.
pub struct RecordFile<W: Write> {
    /// Bytes of an incomplete frame.
    pending: Vec<u8>,
    parts: WriterState<W>,
}

/// State of a record that is being written.
enum WriterState<W: Write> {
    /// The beginning of the record has not been written yet.
    Unbegun(Option<W>),
    Begun(Box<OpenRecord<W>>),
    /// The record is complete, or could not be written.
    Closed,
}

/// A record that is being written.
struct OpenRecord<W: Write> {
    writer: Writer<NoSeek<W>>,
    turns: TurnDecoder,
    channels: Channels,
    /// Number of messages written so far.
    sequence: u32,
    /// Time at which the current chunk began.
    chunk: Nanos,
    text: String,
}

/// The channels of a record.
struct Channels {
    begin: u16,
    turn: u16,
    transition: u16,
    event: u16,
    viewers: [u16; CHANNELS.len()],
}

impl<W: Write> RecordFile<W> {
    /// Creates the writer of a record to `to`.
    pub fn new(to: W) -> Self {
        Self { pending: Vec::new(), parts: WriterState::Unbegun(Some(to)) }
    }

    fn frame(&mut self, tag: Tag, content: &[u8]) -> io::Result<()> {
        match (&mut self.parts, tag) {
            (WriterState::Unbegun(to), Tag::Begin) => {
                let to = to.take().ok_or_else(|| invalid("a record begins once"))?;
                self.parts = WriterState::Begun(Box::new(OpenRecord::begin(to, content)?));
                Ok(())
            }
            (WriterState::Begun(open), Tag::Turn) => open.turn(content),
            (WriterState::Begun(open), Tag::Transition) => open.json(open.channels.transition, content),
            (WriterState::Begun(open), Tag::Event) => open.json(open.channels.event, content),
            (WriterState::Begun(open), Tag::End) => {
                open.writer.finish().map_err(unwritten)?;
                self.parts = WriterState::Closed;
                Ok(())
            }
            (WriterState::Unbegun(_), Tag::End) => Ok(()),
            (WriterState::Closed | WriterState::Unbegun(_) | WriterState::Begun(_), _) => {
                Err(invalid("a frame in the wrong place"))
            }
        }
    }

    /// Leaves the record as it is, because the library would panic when it completes a file that cannot be written.
    fn give_up(&mut self) {
        std::mem::forget(std::mem::replace(&mut self.parts, WriterState::Closed));
    }
}

impl<W: Write> Write for RecordFile<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut pending = std::mem::take(&mut self.pending);
        pending.extend_from_slice(bytes);
        let mut at = 0;
        while let Some((tag, content, length)) = pending.get(at..).and_then(first) {
            if let Err(error) = self.frame(tag, content) {
                self.give_up();
                return Err(error);
            }
            at += length;
        }
        pending.drain(..at);
        self.pending = pending;
        Ok(bytes.len())
    }

    /// Does nothing, because chunks are written when they are complete.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<W: Write> Drop for RecordFile<W> {
    fn drop(&mut self) {
        self.give_up();
    }
}

impl<W: Write> OpenRecord<W> {
    fn begin(to: W, content: &[u8]) -> io::Result<Self> {
        let turns = TurnDecoder::of(content).map_err(|_| invalid("the begin cannot be read"))?;
        let options = WriteOptions::new()
            .library(format!("mdle {}", turns.begin.version))
            .compression(None)
            .chunk_size(None)
            .disable_seeking(true);
        let mut writer = options.create(NoSeek::new(to)).map_err(unwritten)?;
        describe(&mut writer, &turns.begin).map_err(unwritten)?;
        let channels = Channels::add(&mut writer).map_err(unwritten)?;
        let mut open = Self { writer, turns, channels, sequence: 0, chunk: Nanos::ZERO, text: String::new() };
        open.message(open.channels.begin, Nanos::ZERO, content)?;
        // Flushed at once, so that a run that is killed early has a record that can be read.
        open.writer.flush().map_err(unwritten)?;
        Ok(open)
    }

    fn message(&mut self, channel_id: u16, t: Nanos, data: &[u8]) -> io::Result<()> {
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time: t.0, publish_time: t.0 };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, data).map_err(unwritten)
    }

    /// Adds a turn, which may complete a chunk of the turns before it.
    fn turn(&mut self, content: &[u8]) -> io::Result<()> {
        let turn = self.turns.next(content).map_err(|why| match why {
            Undecoded::Changed | Undecoded::Unreadable => {
                invalid("the outputs of this robot cannot be recorded exactly")
            }
        })?;
        if turn.t.0 >= self.chunk.0.saturating_add(CHUNK) {
            self.chunk = turn.t;
            self.writer.flush().map_err(unwritten)?;
        }
        self.message(self.channels.turn, turn.t, content)?;
        let mut text = std::mem::take(&mut self.text);
        for (channel, id) in CHANNELS.iter().zip(self.channels.viewers) {
            text.clear();
            (channel.message)(&turn, &mut text).map_err(|_| invalid("a message cannot be written"))?;
            self.message(id, turn.t, text.as_bytes())?;
        }
        self.text = text;
        Ok(())
    }

    fn json(&mut self, channel: u16, content: &[u8]) -> io::Result<()> {
        let mut from = ByteReader(content);
        let t = from.nanos().ok_or_else(|| invalid("a message without a time"))?;
        self.message(channel, t, from.0)
    }
}

impl Channels {
    fn add<W: Write>(writer: &mut Writer<NoSeek<W>>) -> mcap::McapResult<Self> {
        let none = BTreeMap::new();
        let mut shown = |topic: &str, schema: &str, text: &str| {
            let schema = writer.add_schema(schema, "jsonschema", text.as_bytes())?;
            writer.add_channel(schema, topic, "json", &none)
        };
        let mut viewers = [0; CHANNELS.len()];
        for (id, channel) in viewers.iter_mut().zip(&CHANNELS) {
            *id = shown(channel.topic, channel.schema, channel.text)?;
        }
        let transition = shown("/plan/transitions", "mdle.Transition", include_str!("schemas/transition.json"))?;
        let event = shown("/engine/events", "mdle.Event", include_str!("schemas/event.json"))?;
        let begin = writer.add_channel(0, "/exact/begin", BEGIN, &none)?;
        let turn = writer.add_channel(0, "/exact/turn", TURN, &none)?;
        Ok(Self { begin, turn, transition, event, viewers })
    }
}

/// Writes the metadata of the run, which are for users and other programs.
fn describe<W: Write>(writer: &mut Writer<NoSeek<W>>, begin: &Begin) -> mcap::McapResult<()> {
    let Begin { version, target, plan, command, period, files, beside, safety } = begin;
    let facts = [
        ("version", version.clone()),
        ("target", target.clone()),
        ("plan", plan.clone()),
        ("command", command.clone()),
        ("period", format!("{} s", mdle_runtime::trace::Seconds(*period))),
        ("beside", beside.clone()),
    ];
    let metadata = facts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    writer.write_metadata(&Metadata { name: "mdle".to_owned(), metadata })?;
    let rules = safety.iter().map(|safety| (&safety.name, &safety.text));
    let retreats = safety.iter().flat_map(|safety| &safety.plans).flatten().map(|(name, text)| (name, text));
    for (name, text) in files.iter().map(|(name, text)| (name, text)).chain(rules).chain(retreats) {
        let (media_type, data) = ("text/plain".to_owned(), text.as_bytes().into());
        writer.attach(&Attachment { log_time: 0, create_time: 0, name: name.clone(), media_type, data })?;
    }
    Ok(())
}

fn invalid(sentence: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, sentence)
}

/// Returns the system's error that prevented the record from being written.
fn unwritten(error: mcap::McapError) -> io::Error {
    if let mcap::McapError::Io(error) = error { error } else { io::Error::other(error.to_string()) }
}
