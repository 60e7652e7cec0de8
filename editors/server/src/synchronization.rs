//! Handles notifications from the client: opened, changed and closed documents, and settings.

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::documents::{Document, DocumentEdit};
use crate::params::RequestError;
use crate::server::Server;
use crate::{requests, uri};

/// Settings of the client, received in `initialize` and in `workspace/didChangeConfiguration`.
#[derive(Debug, Default, Deserialize)]
struct Options {
    target: Option<String>,
    book: Option<String>,
}

#[derive(Deserialize)]
struct Opened {
    #[serde(rename = "textDocument")]
    document: Text,
}

#[derive(Deserialize)]
struct Text {
    uri: String,
    version: i64,
    text: String,
}

#[derive(Deserialize)]
struct Changed {
    #[serde(rename = "textDocument")]
    document: Versioned,
    #[serde(rename = "contentChanges")]
    changes: Vec<DocumentEdit>,
}

#[derive(Deserialize)]
struct Versioned {
    uri: String,
    version: i64,
}

fn read<T: DeserializeOwned>(params: Value) -> Result<T, RequestError> {
    serde_json::from_value(params).map_err(|error| RequestError::params(&error.to_string()))
}

impl Server<'_> {
    /// Handles a notification.
    pub(crate) fn notified(&mut self, method: &str, params: Value) -> Result<(), RequestError> {
        match method {
            "textDocument/didOpen" => {
                let Text { uri, version, text } = read::<Opened>(params)?.document;
                let document = Document { path: uri::path(&uri), text, version };
                self.documents.open.insert(uri.clone(), document);
                self.mark(&uri);
            }
            "textDocument/didChange" => self.change(read(params)?)?,
            "textDocument/didClose" => {
                let uri = requests::uri_of(&params)?;
                self.documents.open.remove(&uri);
                self.mark(&uri);
            }
            "textDocument/didSave" | "workspace/didChangeWatchedFiles" => self.mark_all(),
            "workspace/didChangeConfiguration" => {
                let settings = params.get("settings").cloned().unwrap_or_default();
                self.configure(settings.get("mdle").unwrap_or(&settings));
            }
            // Other notifications, of which an editor sends many, do not change a document.
            _ => {}
        }
        Ok(())
    }

    fn change(
        &mut self,
        Changed { document: Versioned { uri, version }, changes }: Changed,
    ) -> Result<(), RequestError> {
        let document = self.documents.open.get_mut(&uri).ok_or_else(|| RequestError::unknown(&uri))?;
        if version < document.version {
            let known = document.version;
            return Err(RequestError::params(&format!(
                "version {version} of `{uri}` came after version {known}: ignored"
            )));
        }
        document.version = version;
        document.change(changes);
        self.mark(&uri);
        Ok(())
    }

    /// Applies the client's settings.
    pub(crate) fn configure(&mut self, settings: &Value) {
        let Options { target, book } = Options::deserialize(settings).unwrap_or_default();
        self.documents.robot = target.filter(|target| !target.is_empty());
        self.book = book.filter(|book| !book.is_empty());
        self.mark_all();
    }

    /// Marks a document, and all documents that may use it, as documents to check.
    fn mark(&mut self, uri: &str) {
        self.stale.insert(uri.to_owned());
        self.stale.extend(self.users.iter().cloned());
    }

    fn mark_all(&mut self) {
        self.stale.extend(self.documents.open.keys().cloned());
    }
}
