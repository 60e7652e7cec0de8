//! Reads the turns of a record, one after the other: a record of any length takes little memory.

use std::fmt;
use std::io::{self, Read};

use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::frames::{Turns, Undecoded};
use crate::writer::{BEGIN, TURN};
use crate::{Begin, RecordedTurn};
use mdle_runtime::Nanos;

/// Maximum size of a record's part, in bytes: more than a second of a robot.
const LARGEST: usize = 64_000_000;

/// Reason why a record, or the rest of it, cannot be read.
#[derive(Debug)]
pub enum ReadError {
    /// The system's error.
    System(io::Error),
    /// The file is no record of a run.
    NotARecord,
    /// The record is of another version of this format: the encoding of its turns.
    OtherVersion(String),
    /// Bytes of the turn of this number were changed after they had been written.
    Changed(u64),
    /// The file is damaged after this number of turns.
    Damaged(u64, String),
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::System(error) => write!(f, "{error}"),
            Self::NotARecord => write!(f, "it is no record of a run: `--log FILE.mcap` of a run writes one"),
            Self::OtherVersion(found) => {
                write!(f, "its turns are of the format `{found}`, and this program reads `{TURN}`")
            }
            Self::Changed(turn) => write!(f, "turn {turn} was changed after it had been written"),
            Self::Damaged(turns, why) => write!(f, "it is damaged after {turns} turns: {why}"),
        }
    }
}

impl std::error::Error for ReadError {}

/// A message of a record about a turn, for people and viewers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// The kind of the message.
    pub kind: MessageKind,
    /// A JSON object, under the schema of the kind's channel.
    pub json: String,
}

/// The kind of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageKind {
    /// A transition: `/plan/transitions`.
    Transition,
    /// An event: `/engine/events`.
    Event,
}

/// The turns of a record with the messages about them, which a record has after each turn.
pub struct TurnsWithMessages<R> {
    records: Records<R>,
    /// The turn after the one that was returned last.
    peeked: Option<Result<RecordedTurn, ReadError>>,
}

impl<R: Read> TurnsWithMessages<R> {
    /// Returns `true` once the end of the record was read; a run that was killed leaves a record without an end.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.records.is_whole()
    }

    /// Returns the time of the next turn; `None` at the end of the record.
    #[must_use]
    pub fn next_time(&self) -> Option<Nanos> {
        self.peeked.as_ref().and_then(|next| next.as_ref().ok()).map(|next| next.t)
    }
}

impl<R: Read> Iterator for TurnsWithMessages<R> {
    type Item = Result<(RecordedTurn, Vec<Message>), ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        let turn = match self.peeked.take().or_else(|| self.records.next())? {
            Ok(turn) => turn,
            Err(error) => return Some(Err(error)),
        };
        self.peeked = self.records.next();
        Some(Ok((turn, std::mem::take(&mut self.records.messages))))
    }
}

/// The turns of a record.
pub struct Records<R> {
    source: R,
    reader: LinearReader,
    /// Channels of `/exact/begin`, `/exact/turn`, `/plan/transitions` and `/engine/events`.
    channels: [Option<u16>; 4],
    /// The messages that were read since the last turn.
    messages: Vec<Message>,
    turns: Option<Turns>,
    count: u64,
    /// `true` once the end of the record was read: it was not cut short.
    is_whole: bool,
}

impl<R: Read> Records<R> {
    /// Reads the begin of a record.
    ///
    /// # Errors
    /// The source cannot be read, or is no record.
    pub fn open(source: R) -> Result<(Begin, Self), ReadError> {
        let options = LinearReaderOptions::default().with_record_length_limit(LARGEST);
        let reader = LinearReader::new_with_options(options);
        let mut records =
            Self { source, reader, channels: [None; 4], messages: Vec::new(), turns: None, count: 0, is_whole: false };
        match records.message() {
            Ok(Some((0, content))) => {
                let turns = Turns::of(&content).ok_or(ReadError::NotARecord)?;
                let begin = turns.begin.clone();
                records.turns = Some(turns);
                Ok((begin, records))
            }
            Ok(_) | Err(ReadError::Damaged(..)) => Err(ReadError::NotARecord),
            Err(error) => Err(error),
        }
    }

    /// Returns `true` once the end of the record was read; a run that was killed leaves a record without an end.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.is_whole
    }

    /// Returns the turns with the messages about them.
    pub fn with_messages(self) -> TurnsWithMessages<R> {
        TurnsWithMessages { records: self, peeked: None }
    }

    /// Returns the next message of `/exact/begin`, which is 0, or of `/exact/turn`, which is 1; `None` at the end.
    fn message(&mut self) -> Result<Option<(usize, Vec<u8>)>, ReadError> {
        let damaged = |count: u64| move |error: mcap::McapError| ReadError::Damaged(count, error.to_string());
        while let Some(event) = self.reader.next_event() {
            match event {
                Ok(LinearReadEvent::ReadRequest(wanted)) => {
                    let read = self.source.read(self.reader.insert(wanted)).map_err(ReadError::System)?;
                    self.reader.notify_read(read);
                }
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    let record = mcap::parse_record(opcode, data).map_err(damaged(self.count))?;
                    if let Record::Channel(channel) = record {
                        match (channel.topic.as_str(), channel.message_encoding) {
                            ("/exact/begin", encoding) if encoding == BEGIN => self.channels[0] = Some(channel.id),
                            ("/exact/turn", encoding) if encoding == TURN => self.channels[1] = Some(channel.id),
                            ("/plan/transitions", _) => self.channels[2] = Some(channel.id),
                            ("/engine/events", _) => self.channels[3] = Some(channel.id),
                            ("/exact/begin" | "/exact/turn", other) => return Err(ReadError::OtherVersion(other)),
                            _ => {}
                        }
                    } else if let Record::Message { header, data } = record {
                        let kind = self.channels.iter().position(|known| *known == Some(header.channel_id));
                        let text = || String::from_utf8_lossy(&data).into_owned();
                        match kind {
                            Some(2) => self.messages.push(Message { kind: MessageKind::Transition, json: text() }),
                            Some(3) => self.messages.push(Message { kind: MessageKind::Event, json: text() }),
                            Some(kind) => return Ok(Some((kind, data.into_owned()))),
                            None => {}
                        }
                    } else {
                        self.is_whole |= matches!(record, Record::Footer(_));
                    }
                }
                // The file ends in the middle of a chunk: all chunks before it have been read.
                Err(mcap::McapError::UnexpectedEof) if self.turns.is_some() => return Ok(None),
                Err(error) => return Err(damaged(self.count)(error)),
            }
        }
        Ok(None)
    }
}

impl<R: Read> Iterator for Records<R> {
    type Item = Result<RecordedTurn, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.messages.clear();
        let content = match self.message() {
            Ok(Some((1, content))) => content,
            Ok(Some(_)) => return Some(Err(ReadError::Damaged(self.count, "it begins twice".to_owned()))),
            Ok(None) => return None,
            Err(error) => return Some(Err(error)),
        };
        let turn = self.turns.as_mut()?.next(&content).map_err(|why| match why {
            Undecoded::Changed => ReadError::Changed(self.count),
            Undecoded::Unreadable => ReadError::Damaged(self.count, "a turn cannot be read".to_owned()),
        });
        self.count += 1;
        Some(turn)
    }
}
