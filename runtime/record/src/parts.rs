//! The channels and messages of an MCAP file, one after the other, with the sums of its chunks and of the file.

use std::io::{self, Read};

use mcap::McapError;
use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// Maximum size of a part of the file, in bytes: more than a second of a robot.
const LARGEST: usize = 64_000_000;

/// A part of the file.
#[derive(Debug)]
pub(crate) enum Part {
    /// A channel: its number, its topic, and the encoding of its messages.
    Channel(u16, String, String),
    /// A message, by the number of its channel.
    Message(u16, Vec<u8>),
}

/// Reason why the file cannot be read on.
#[derive(Debug)]
pub(crate) enum Unreadable {
    /// The system's error.
    System(io::Error),
    /// The file is damaged: a sentence.
    Damaged(String),
}

/// The parts of a file that is being read.
pub(crate) struct Parts<R> {
    source: R,
    reader: LinearReader,
    chunk: Option<Chunk>,
    /// `true` once the end of the file was read: it was not cut short.
    pub(crate) is_whole: bool,
}

/// A chunk that is being read.
#[derive(Debug)]
struct Chunk {
    data: Vec<u8>,
    /// Place of the next part.
    at: usize,
    /// `true` if its bytes have the sum that they had.
    is_sound: bool,
}

impl<R: Read> Parts<R> {
    pub(crate) fn new(source: R) -> Self {
        let options = LinearReaderOptions::default()
            .with_record_length_limit(LARGEST)
            .with_emit_chunks(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true);
        Self { source, reader: LinearReader::new_with_options(options), chunk: None, is_whole: false }
    }

    /// Returns the next part; `None` at the end of the file, or where it was cut short.
    pub(crate) fn next(&mut self) -> Result<Option<Part>, Unreadable> {
        loop {
            if let Some(chunk) = &mut self.chunk {
                match chunk.next()? {
                    Some(part) => return Ok(Some(part)),
                    None => self.chunk = None,
                }
            }
            match self.reader.next_event() {
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                    let read = self.source.read(self.reader.insert(wanted)).map_err(Unreadable::System)?;
                    self.reader.notify_read(read);
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    let record = mcap::parse_record(opcode, data).map_err(|error| damage(&error))?;
                    self.is_whole |= matches!(record, Record::Footer(_));
                    if let Record::Chunk { header, data } = record {
                        if !header.compression.is_empty() {
                            return Err(Unreadable::Damaged("its chunks are compressed".to_owned()));
                        }
                        let is_sound = crc32fast::hash(&data) == header.uncompressed_crc;
                        self.chunk = Some(Chunk { data: data.into_owned(), at: 0, is_sound });
                    }
                }
                // The file ends in the middle of a chunk: all chunks before it have been read.
                Some(Err(McapError::UnexpectedEof)) | None => return Ok(None),
                Some(Err(error)) => return Err(damage(&error)),
            }
        }
    }
}

impl Chunk {
    /// Returns the next channel or message; its damage at the end, so that a turn is named that was changed.
    fn next(&mut self) -> Result<Option<Part>, Unreadable> {
        const HEAD: usize = 9;
        let changed = || {
            Unreadable::Damaged("the sum of a chunk differs, so that bytes besides the turns were changed".to_owned())
        };
        while let Some((head, rest)) = self.data.get(self.at..).and_then(|rest| rest.split_first_chunk::<HEAD>()) {
            let [opcode, length @ ..] = head;
            let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| changed())?;
            let data = rest.get(..length).ok_or_else(changed)?;
            self.at += HEAD + length;
            match mcap::parse_record(*opcode, data) {
                Ok(Record::Channel(channel)) => {
                    return Ok(Some(Part::Channel(channel.id, channel.topic, channel.message_encoding)));
                }
                Ok(Record::Message { header, data }) => {
                    return Ok(Some(Part::Message(header.channel_id, data.into_owned())));
                }
                Ok(_) => {}
                Err(_) if !self.is_sound => return Err(changed()),
                Err(error) => return Err(damage(&error)),
            }
        }
        if self.is_sound && self.at == self.data.len() { Ok(None) } else { Err(changed()) }
    }
}

/// The damage of a file, as far as an error of the library says it.
fn damage(error: &McapError) -> Unreadable {
    Unreadable::Damaged(if let McapError::BadDataCrc { .. } = error {
        "the sum of the file differs, so that bytes outside of its chunks were changed".to_owned()
    } else {
        error.to_string()
    })
}
