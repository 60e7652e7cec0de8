//! An adapter that passes encoded messages to and from RustDDS without changing them. Other modules decode them.

use std::convert::Infallible;

use rustdds::RepresentationIdentifier;
use rustdds::bytes::Bytes;
use rustdds::no_key::{Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter};

use crate::cdr::Payload;

/// Accepted encodings: plain CDR in either byte order.
static ENCODINGS: [RepresentationIdentifier; 2] = [RepresentationIdentifier::CDR_LE, RepresentationIdentifier::CDR_BE];

/// Adapter between RustDDS and encoded messages.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PayloadAdapter;

/// Decoder that copies the bytes without decoding them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Copied;

impl DeserializerAdapter<Payload> for PayloadAdapter {
    type Error = Infallible;
    type Decoded = Payload;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &ENCODINGS
    }

    fn transform_decoded(decoded: Payload) -> Payload {
        decoded
    }
}

impl DefaultDecoder<Payload> for PayloadAdapter {
    type Decoder = Copied;

    const DECODER: Copied = Copied;
}

impl Decode<'_, Payload> for Copied {
    type Error = Infallible;

    fn decode_bytes(self, bytes: &[u8], encoding: RepresentationIdentifier) -> Result<Payload, Infallible> {
        Ok(Payload { bytes: bytes.to_vec(), encoding })
    }
}

impl SerializerAdapter<Payload> for PayloadAdapter {
    type Error = Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(payload: &Payload) -> Result<Bytes, Infallible> {
        Ok(Bytes::copy_from_slice(&payload.bytes))
    }
}
