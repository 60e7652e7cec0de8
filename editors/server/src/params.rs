//! Parameters of requests, and error answers.

use lsp_server::ErrorCode;
use serde::Deserialize;
use serde_json::Value;

use crate::documents::{Positions, ProtocolPosition};

/// An error as the answer to a request.
#[derive(Debug)]
pub(crate) struct RequestError {
    pub(crate) code: ErrorCode,
    pub(crate) message: String,
}

impl RequestError {
    /// Returns the error for a request whose parameters violate the protocol.
    pub(crate) fn params(message: &str) -> Self {
        Self { code: ErrorCode::InvalidParams, message: message.to_owned() }
    }

    /// Returns the error for a request about a document that the client has not opened.
    pub(crate) fn unknown(uri: &str) -> Self {
        Self::params(&format!("`{uri}` is not open"))
    }

    /// Returns the error for a request that cannot be fulfilled, with the reason for the user.
    pub(crate) fn failed(message: impl Into<String>) -> Self {
        Self { code: ErrorCode::RequestFailed, message: message.into() }
    }
}

/// Parameters of all requests about a document; each request uses only some of the fields.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Params {
    pub(crate) text_document: Named,
    pub(crate) position: Option<ProtocolPosition>,
    pub(crate) range: Option<Positions>,
    pub(crate) positions: Option<Vec<ProtocolPosition>>,
    pub(crate) new_name: Option<String>,
    pub(crate) context: Option<Value>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Named {
    pub(crate) uri: String,
}
