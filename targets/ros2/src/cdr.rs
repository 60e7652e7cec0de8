//! Encodes and decodes messages in Common Data Representation, the format in which ROS 2 sends them over DDS (XCDR1,
//! either byte order).

use rustdds::RepresentationIdentifier;
use rustdds::serialization::{deserialize_from_cdr_with_rep_id, to_writer_with_rep_id};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Maximum number of padding bytes after a message.
const PADDING: usize = 3;

/// An encoded message, without the encapsulation header.
#[derive(Debug, Clone, PartialEq)]
pub struct Payload {
    /// Bytes of the encoded message.
    pub bytes: Vec<u8>,
    /// Byte order and format of the bytes.
    pub encoding: RepresentationIdentifier,
}

impl Payload {
    /// Encodes `message` as little-endian CDR.
    ///
    /// # Errors
    /// Fails if the message has no CDR representation, for example because it contains a list of unknown length.
    pub fn of<T: Serialize>(message: &T) -> Result<Self, String> {
        let (mut bytes, encoding) = (Vec::new(), RepresentationIdentifier::CDR_LE);
        to_writer_with_rep_id(&mut bytes, message, encoding).map_err(|error| error.to_string())?;
        Ok(Self { bytes, encoding })
    }

    /// Decodes the bytes as a message of type `T`.
    ///
    /// # Errors
    /// Returns the reason, as a phrase, if the bytes are malformed or belong to a message with other fields.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, String> {
        let (message, length) = deserialize_from_cdr_with_rep_id(&self.bytes, self.encoding)
            .map_err(|error| format!("{} bytes that cannot be read ({error})", self.bytes.len()))?;
        if self.bytes.len().saturating_sub(length) > PADDING {
            return Err(format!("{} bytes where its fields take {length}", self.bytes.len()));
        }
        Ok(message)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::{Bool, Range, ShortRange};

    #[test]
    fn a_message_is_read_as_it_was_written() {
        let payload = Payload::of(&Bool { data: true }).unwrap();
        assert_eq!(payload.bytes, [1]);
        assert_eq!(payload.read(), Ok(Bool { data: true }));
    }

    #[test]
    fn padding_is_no_field_but_more_is() {
        let padded = |count| Payload { bytes: vec![0; count], encoding: RepresentationIdentifier::CDR_LE };
        assert!(padded(4).read::<Bool>().is_ok());
        assert_eq!(padded(5).read::<Bool>(), Err("5 bytes where its fields take 1".to_owned()));
    }

    #[test]
    fn another_layout_is_noticed() {
        let new = Payload::of(&Range::default()).unwrap();
        let old = Payload::of(&ShortRange::default()).unwrap();
        assert!(new.read::<Range>().is_ok() && old.read::<ShortRange>().is_ok());
        assert!(new.read::<ShortRange>().unwrap_err().contains("where its fields take"));
        assert!(old.read::<Range>().unwrap_err().contains("cannot be read"));
    }
}
