//! Reads the turns of a record one at a time, so that the memory needed does not depend on the record's length.

use std::fmt;
use std::io::{self, Read};

use crate::frames::TurnDecoder;
use crate::parts::{FilePart, PartReader, Unreadable};
use crate::turn::Undecoded;
use crate::writer::{BEGIN, TURN};
use crate::{Begin, RecordedTurn};
use mdle_runtime::Nanos;

/// Reason why a record, or the rest of it, cannot be read.
#[derive(Debug)]
pub enum ReadError {
    /// The system reported this error.
    System(io::Error),
    /// The file is not a record of a run.
    NotARecord,
    /// The record has another version of this format: the first text is the encoding of its messages, the second the
    /// encoding that can be read.
    OtherVersion(String, &'static str),
    /// Bytes in the beginning of the record were changed after they had been written.
    ChangedBegin,
    /// Bytes of the turn with this number were changed after they had been written.
    Changed(u64),
    /// The file is damaged after this number of turns; the sentence explains the damage.
    Damaged(u64, String),
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::System(error) => write!(f, "{error}"),
            Self::NotARecord => write!(f, "it is no record of a run: `--log FILE.mcap` of a run writes one"),
            Self::OtherVersion(found, known) => write!(
                f,
                "it is of the format `{found}`, and this program reads `{known}`: the version of mdle that wrote it reads it"
            ),
            Self::ChangedBegin => write!(f, "its begin was changed after it had been written"),
            Self::Changed(turn) => write!(f, "turn {turn} was changed after it had been written"),
            Self::Damaged(turns, why) => write!(f, "it is damaged after {turns} turns: {why}"),
        }
    }
}

impl std::error::Error for ReadError {}

/// A message about a turn, for users and viewers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// Kind of the message.
    pub kind: MessageKind,
    /// Content of the message: a JSON object with the schema of the kind's channel.
    pub json: String,
}

/// Kind of a message about a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageKind {
    /// A transition, on the channel `/plan/transitions`.
    Transition,
    /// An event, on the channel `/engine/events`.
    Event,
}

/// Turns of a record, each with the messages that follow it in the record.
pub struct TurnsWithMessages<R> {
    records: Records<R>,
    /// The next turn, read in advance; `None` before the first turn has been returned, and at the end of the record.
    peeked: Option<Result<RecordedTurn, ReadError>>,
}

impl<R: Read> TurnsWithMessages<R> {
    /// Returns `true` if the end of the record has been read. A run that was killed leaves a record without an end.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.records.is_whole()
    }

    /// Returns the time of the next turn; `None` before the first turn has been returned, at the end of the record, and
    /// if the rest of the record cannot be read.
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

/// Turns of a record.
pub struct Records<R> {
    parts: PartReader<R>,
    /// Numbers of the channels `/exact/begin`, `/exact/turn`, `/plan/transitions` and `/engine/events`.
    channels: [Option<u16>; 4],
    /// Messages that have been read since the last turn.
    messages: Vec<Message>,
    turns: Option<TurnDecoder>,
    count: u64,
}

impl<R: Read> Records<R> {
    /// Reads the beginning of a record.
    ///
    /// # Errors
    /// Fails if the source cannot be read, or is not a record.
    pub fn open(source: R) -> Result<(Begin, Self), ReadError> {
        let (parts, messages) = (PartReader::new(source), Vec::new());
        let mut records = Self { parts, channels: [None; 4], messages, turns: None, count: 0 };
        match records.message() {
            Ok(Some((0, content))) => {
                let turns = TurnDecoder::of(&content).map_err(|why| match why {
                    Undecoded::Changed => ReadError::ChangedBegin,
                    Undecoded::Unreadable => ReadError::NotARecord,
                })?;
                let begin = turns.begin.clone();
                records.turns = Some(turns);
                Ok((begin, records))
            }
            Ok(_) | Err(ReadError::Damaged(..)) => Err(ReadError::NotARecord),
            Err(error) => Err(error),
        }
    }

    /// Returns `true` if the end of the record has been read. A run that was killed leaves a record without an end.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.parts.is_whole
    }

    /// Returns the turns, each with the messages about it.
    pub fn with_messages(self) -> TurnsWithMessages<R> {
        TurnsWithMessages { records: self, peeked: None }
    }

    /// Returns the next message of the channels `/exact/begin` and `/exact/turn`, with the index of its channel: 0 for
    /// `/exact/begin`, 1 for `/exact/turn`. Returns `None` at the end of the record.
    fn message(&mut self) -> Result<Option<(usize, Vec<u8>)>, ReadError> {
        let unreadable = |why| match why {
            Unreadable::System(error) => ReadError::System(error),
            Unreadable::Damaged(sentence) => ReadError::Damaged(self.count, sentence),
        };
        while let Some(part) = self.parts.next().map_err(unreadable)? {
            match part {
                FilePart::Channel(id, topic, encoding) => match (topic.as_str(), encoding) {
                    ("/exact/begin", encoding) if encoding == BEGIN => self.channels[0] = Some(id),
                    ("/exact/turn", encoding) if encoding == TURN => self.channels[1] = Some(id),
                    ("/plan/transitions", _) => self.channels[2] = Some(id),
                    ("/engine/events", _) => self.channels[3] = Some(id),
                    ("/exact/begin", other) => return Err(ReadError::OtherVersion(other, BEGIN)),
                    ("/exact/turn", other) => return Err(ReadError::OtherVersion(other, TURN)),
                    _ => {}
                },
                FilePart::Message(channel, data) => {
                    let text = || String::from_utf8_lossy(&data).into_owned();
                    match self.channels.iter().position(|known| *known == Some(channel)) {
                        Some(2) => self.messages.push(Message { kind: MessageKind::Transition, json: text() }),
                        Some(3) => self.messages.push(Message { kind: MessageKind::Event, json: text() }),
                        Some(kind) => return Ok(Some((kind, data))),
                        None => {}
                    }
                }
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
