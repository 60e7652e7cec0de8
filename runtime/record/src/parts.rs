//! Reads the channels and messages of an MCAP file in order, and verifies the checksums of its chunks and of the file.

use std::io::{self, Read};

use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError};

/// Maximum size of a part of the file, in bytes. It is more than the data of a robot in one second.
const LARGEST: usize = 64_000_000;
/// Maximum number of bytes that are read at a time, so that a corrupted length does not allocate more memory.
const STEP: usize = 1 << 18;

/// A part of an MCAP file.
#[derive(Debug)]
pub(crate) enum FilePart {
    /// A channel: its number, its topic, and the encoding of its messages.
    Channel(u16, String, String),
    /// A message: the number of its channel, and its content.
    Message(u16, Vec<u8>),
}

/// Reason why the rest of the file cannot be read.
#[derive(Debug)]
pub(crate) enum Unreadable {
    /// The system reported this error.
    System(io::Error),
    /// The file is damaged; contains a sentence that describes the damage.
    Damaged(String),
}

/// Number of consecutive parts of nine zeros at which the file is treated as ended: more than a megabyte of zeros,
/// which no chunk of a record contains.
const MOST_ZEROS: u32 = 120_000;

/// Reads the parts of an MCAP file.
pub(crate) struct PartReader<R> {
    source: R,
    reader: LinearReader,
    chunk: Option<Chunk>,
    /// The last bytes that were read; they show whether the end of the file is present.
    last: [u8; MAGIC.len()],
    /// Number of consecutive parts that consist of zeros.
    zeros: u32,
    /// `true` if the end of the file has been read, so that the file was not cut short.
    pub(crate) is_whole: bool,
}

/// A chunk whose parts are being read.
#[derive(Debug)]
struct Chunk {
    data: Vec<u8>,
    /// Byte offset of the next part in the chunk.
    at: usize,
    /// `true` if the checksum of the chunk's bytes equals the recorded checksum.
    is_sound: bool,
}

impl<R: Read> PartReader<R> {
    pub(crate) fn new(source: R) -> Self {
        let options = LinearReaderOptions::default()
            .with_record_length_limit(LARGEST)
            .with_emit_chunks(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true);
        Self {
            source,
            reader: LinearReader::new_with_options(options),
            chunk: None,
            last: [0; MAGIC.len()],
            zeros: 0,
            is_whole: false,
        }
    }

    /// Returns the next part; `None` at the end of the file, or where it was cut short.
    pub(crate) fn next(&mut self) -> Result<Option<FilePart>, Unreadable> {
        loop {
            if let Some(chunk) = &mut self.chunk {
                match chunk.next()? {
                    Some(part) => return Ok(Some(part)),
                    None => self.chunk = None,
                }
            }
            match self.reader.next_event() {
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                    let into = self.reader.insert(wanted.min(STEP));
                    let read = self.source.read(into).map_err(Unreadable::System)?;
                    for byte in into.get(..read).unwrap_or_default().iter().rev().take(MAGIC.len()).rev() {
                        self.last.rotate_left(1);
                        self.last[MAGIC.len() - 1] = *byte;
                    }
                    self.reader.notify_read(read);
                }
                // After a power failure, gigabytes of zeros may follow the written data.
                Some(Ok(LinearReadEvent::Record { opcode: 0, data: [] })) => {
                    self.zeros += 1;
                    if self.zeros == MOST_ZEROS {
                        return Ok(None);
                    }
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    self.zeros = 0;
                    self.is_whole |= opcode == op::FOOTER;
                    if opcode == op::CHUNK {
                        self.chunk = Some(Chunk::of(data)?);
                    }
                }
                // A changed length points beyond the end of the file.
                Some(Err(McapError::UnexpectedEof)) | None if !self.is_whole && self.last == *MAGIC => {
                    let why = "nothing leads to its end, so that bytes outside of its turns were changed";
                    return Err(Unreadable::Damaged(why.to_owned()));
                }
                // The file ends in the middle of a chunk: all chunks before it have been read.
                Some(Err(McapError::UnexpectedEof)) | None => return Ok(None),
                Some(Err(error)) => return Err(damage(error)),
            }
        }
    }
}

impl Chunk {
    /// Number of bytes in a chunk's header before and after the name of its compression.
    const HEAD: [usize; 2] = [32, 8];

    /// Reads an uncompressed chunk. A chunk whose length differs from the length in its header is refused, because the
    /// library would panic on a chunk that is too short.
    fn of(data: &[u8]) -> Result<Self, Unreadable> {
        let shorter = || Unreadable::Damaged("one of its seconds has another length than it gives".to_owned());
        let [before, after] = Self::HEAD;
        let name = data.get(before - 4..before).and_then(|bytes| bytes.try_into().ok()).map(u32::from_le_bytes);
        if name.ok_or_else(shorter)? != 0 {
            let why = "its seconds are compressed, which mdle never does: another program has written it anew";
            return Err(Unreadable::Damaged(why.to_owned()));
        }
        let size = data.get(before..before + after).and_then(|bytes| bytes.try_into().ok()).map(u64::from_le_bytes);
        let content = data.get(before + after..).unwrap_or_default();
        if size != Some(content.len() as u64) {
            return Err(shorter());
        }
        match mcap::parse_record(op::CHUNK, data) {
            Ok(Record::Chunk { header, data }) => {
                let is_sound = crc32fast::hash(&data) == header.uncompressed_crc;
                Ok(Self { data: data.into_owned(), at: 0, is_sound })
            }
            Ok(_) => Err(shorter()),
            Err(error) => Err(damage(error)),
        }
    }

    /// Returns the next channel or message. Damage to the chunk is reported only at its end, so that the message can
    /// name the changed turn.
    fn next(&mut self) -> Result<Option<FilePart>, Unreadable> {
        const HEAD: usize = 9;
        let changed = || {
            let why = "the sum of one of its seconds differs, so that bytes besides its turns were changed";
            Unreadable::Damaged(why.to_owned())
        };
        while let Some((head, rest)) = self.data.get(self.at..).and_then(|rest| rest.split_first_chunk::<HEAD>()) {
            let [opcode, length @ ..] = head;
            let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| changed())?;
            let data = rest.get(..length).ok_or_else(changed)?;
            self.at += HEAD + length;
            if !matches!(*opcode, op::CHANNEL | op::MESSAGE) {
                continue;
            }
            match mcap::parse_record(*opcode, data) {
                Ok(Record::Channel(channel)) => {
                    return Ok(Some(FilePart::Channel(channel.id, channel.topic, channel.message_encoding)));
                }
                Ok(Record::Message { header, data }) => {
                    return Ok(Some(FilePart::Message(header.channel_id, data.into_owned())));
                }
                Ok(_) => {}
                Err(_) if !self.is_sound => return Err(changed()),
                Err(error) => return Err(damage(error)),
            }
        }
        if self.is_sound && self.at == self.data.len() { Ok(None) } else { Err(changed()) }
    }
}

/// Converts an error of the library to a description of the damage, without terms of MCAP.
fn damage(error: McapError) -> Unreadable {
    let why = match error {
        McapError::Io(error) => return Unreadable::System(error),
        McapError::BadMagic => "it does not begin or end as a record does",
        McapError::BadDataCrc { .. } => {
            "the sum of the file differs, so that bytes outside of its seconds were changed"
        }
        McapError::BadChunkCrc { .. } => {
            "the sum of one of its seconds differs, so that bytes besides its turns were changed"
        }
        McapError::BadSummaryCrc { .. } => "the sum of its end differs, so that bytes after its turns were changed",
        McapError::BadAttachmentCrc { .. } => {
            "the sum of the text of a file in it differs, so that this text was changed"
        }
        McapError::BytesAfterEndMagic => "bytes follow after its end",
        McapError::UnexpectedEof | McapError::UnexpectedEoc => "it ends in the middle of a part",
        McapError::RecordTooLarge { .. }
        | McapError::ChunkTooLarge(_)
        | McapError::BadAttachmentLength { .. }
        | McapError::BadChunkLength { .. }
        | McapError::BadSchemaLength { .. } => {
            "a part has a length that it cannot have, so that bytes of it were changed"
        }
        McapError::AttachmentNotInProgress
        | McapError::AttachmentTooLarge { .. }
        | McapError::AttachmentIncomplete { .. }
        | McapError::BadFooter
        | McapError::BadIndex
        | McapError::EndBeforeStart
        | McapError::PrivateRecordOpcodeIsReserved { .. }
        | McapError::ConflictingChannels(_)
        | McapError::ConflictingSchemas(_)
        | McapError::Parse(_)
        | McapError::InvalidSchemaId
        | McapError::UnknownChannel(..)
        | McapError::UnknownSchema(..)
        | McapError::UnsupportedCompression(_)
        | McapError::EmptyDecompressorName
        | McapError::DecompressionError(_)
        | McapError::ChunkBufferTooLarge(_)
        | McapError::BadChunkStartOffset(_)
        | McapError::TooManyChannels
        | McapError::TooManySchemas
        | McapError::UnexpectedChunkDataInserted
        | McapError::AttemptedWriteAfterFailure => "a part of it cannot be read, so that bytes of it were changed",
    };
    Unreadable::Damaged(why.to_owned())
}
