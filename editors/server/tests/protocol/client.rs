//! A client for tests of the language server.

use std::path::PathBuf;
use std::thread::JoinHandle;
use std::time::Duration;

use lsp_server::{Connection, Message, Notification, Request, Response, ResponseError};
use lsp_types::{Diagnostic, PublishDiagnosticsParams};
use mdle_language_server::{ServeError, serve_on};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

/// Maximum wait for an answer.
const PATIENCE: Duration = Duration::from_secs(60);

/// A client with its server, which runs in a thread.
pub(crate) struct Client {
    connection: Option<Connection>,
    server: Option<JoinHandle<Result<(), ServeError>>>,
    requests: i32,
    /// Notifications that arrived while the client waited for an answer.
    pub(crate) notified: Vec<Notification>,
}

impl Client {
    /// Starts a server, without `initialize`.
    pub(crate) fn started() -> Self {
        let (own, servers) = Connection::memory();
        let server = std::thread::spawn(move || serve_on(&servers));
        Self { connection: Some(own), server: Some(server), requests: 0, notified: Vec::new() }
    }

    /// Starts a server with these settings.
    pub(crate) fn with_options(options: Value) -> Self {
        let mut client = Self::started();
        let answer: lsp_types::InitializeResult =
            client.ask("initialize", json!({ "capabilities": {}, "initializationOptions": options }));
        assert_eq!(answer.server_info.unwrap().name, "mdlec");
        client.notify("initialized", json!({}));
        client
    }

    /// Starts a server without settings.
    pub(crate) fn new() -> Self {
        Self::with_options(Value::Null)
    }

    pub(crate) fn send(&self, message: impl Into<Message>) {
        self.connection.as_ref().unwrap().sender.send(message.into()).unwrap();
    }

    pub(crate) fn notify(&self, method: &str, params: Value) {
        self.send(Notification { method: method.into(), params });
    }

    /// Sends a request and returns its number.
    pub(crate) fn request(&mut self, method: &str, params: Value) -> i32 {
        self.requests += 1;
        self.send(Request { id: self.requests.into(), method: method.into(), params });
        self.requests
    }

    pub(crate) fn receive(&self) -> Message {
        self.connection.as_ref().unwrap().receiver.recv_timeout(PATIENCE).expect("the server is silent")
    }

    /// Waits for the answer to a request.
    pub(crate) fn answer(&mut self, request: i32) -> Result<Value, ResponseError> {
        loop {
            match self.receive() {
                Message::Response(Response { id, response_result }) if id == request.into() => return response_result,
                Message::Notification(notification) => self.notified.push(notification),
                other @ (Message::Request(_) | Message::Response(_)) => panic!("unexpected: {other:?}"),
            }
        }
    }

    /// Sends a request and reads its answer.
    pub(crate) fn ask<T: DeserializeOwned>(&mut self, method: &str, params: Value) -> T {
        let request = self.request(method, params);
        let answer = self.answer(request).unwrap();
        serde_json::from_value(answer.clone()).unwrap_or_else(|error| panic!("{method}: {error} in {answer:#}"))
    }

    pub(crate) fn open(&self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "languageId": "mdle", "version": 1, "text": text });
        self.notify("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Notifies the server of edits of a document.
    pub(crate) fn change(&self, uri: &str, version: i32, changes: Value) {
        let document = json!({ "uri": uri, "version": version });
        self.notify("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    /// Waits for the diagnostics of a document; if `version` is given, for those of this version.
    pub(crate) fn diagnostics(&mut self, uri: &str, version: Option<i32>) -> Vec<Diagnostic> {
        loop {
            let notification = match self.notified.is_empty() {
                false => self.notified.remove(0),
                true => match self.receive() {
                    Message::Notification(notification) => notification,
                    other @ (Message::Request(_) | Message::Response(_)) => panic!("unexpected: {other:?}"),
                },
            };
            if notification.method != "textDocument/publishDiagnostics" {
                continue;
            }
            let published: PublishDiagnosticsParams = serde_json::from_value(notification.params).unwrap();
            if published.uri.as_str() == uri && (version.is_none() || published.version == version) {
                return published.diagnostics;
            }
        }
    }

    /// Closes the connection; returns the result of the server.
    pub(crate) fn end(&mut self) -> Result<(), ServeError> {
        self.connection = None;
        self.server.take().unwrap().join().unwrap()
    }
}

/// Returns the codes of diagnostics, in order.
pub(crate) fn codes(diagnostics: &[Diagnostic]) -> Vec<String> {
    let code = |diagnostic: &Diagnostic| match diagnostic.code.clone() {
        Some(lsp_types::NumberOrString::String(code)) => code,
        Some(lsp_types::NumberOrString::Number(_)) | None => "none".into(),
    };
    diagnostics.iter().map(code).collect()
}

/// Returns the path of an empty folder for a test.
#[allow(clippy::disallowed_methods, reason = "a test makes files")]
pub(crate) fn folder(test: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(test);
    drop(std::fs::remove_dir_all(&folder));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}
