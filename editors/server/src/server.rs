//! The loop of the server: takes messages in their order, and checks documents when none is waiting.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId, Response};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::ServeError;
use crate::documents::{Change, Document, Documents};
use crate::params::Refusal;
use crate::requests;
use crate::{check, uri};

/// Pause of the client after which a document is checked: shorter than that between two keystrokes.
const PAUSE: Duration = Duration::from_millis(5);

/// The server of one client, after `initialize`.
struct Server<'c> {
    connection: &'c Connection,
    documents: Documents,
    /// Address of the book, for links to the explanations of messages.
    book: Option<String>,
    /// Messages that were received and wait for their turn.
    waiting: VecDeque<Message>,
    /// Documents to check.
    stale: BTreeSet<String>,
    /// Documents whose diagnostics are published once no document is stale: what one check finds in a file that another
    /// check still has to read would be of two texts.
    concerned: BTreeSet<String>,
    /// Diagnostics by the document whose check found them, and by the document that contains them.
    found: BTreeMap<String, BTreeMap<String, Vec<Value>>>,
    /// Open documents that use other files, or try to.
    users: BTreeSet<String>,
    /// `true` after `shutdown`: only `exit` may follow.
    is_shut_down: bool,
}

/// Settings of the client, in `initialize` and in `workspace/didChangeConfiguration`.
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
    changes: Vec<Change>,
}

#[derive(Deserialize)]
struct Versioned {
    uri: String,
    version: i64,
}

/// Serves one client, until it ends the server.
///
/// # Errors
/// The client vanished.
pub fn serve_on(connection: &Connection) -> Result<(), ServeError> {
    let options = initialize(connection)?;
    let mut server = Server {
        connection,
        documents: Documents::default(),
        book: None,
        waiting: VecDeque::new(),
        stale: BTreeSet::new(),
        concerned: BTreeSet::new(),
        found: BTreeMap::new(),
        users: BTreeSet::new(),
        is_shut_down: false,
    };
    server.configure(&options);
    server.run()
}

/// Answers `initialize`, and refuses every other request before it; returns the client's settings.
fn initialize(connection: &Connection) -> Result<Value, ServeError> {
    loop {
        match connection.receiver.recv().map_err(|_| ServeError::Vanished)? {
            Message::Request(request) if request.method == "initialize" => {
                let result = json!({
                    "capabilities": requests::capabilities(),
                    "serverInfo": { "name": "mdlec", "version": env!("CARGO_PKG_VERSION") },
                });
                send(connection, Response::new_ok(request.id, result))?;
                return Ok(request.params.get("initializationOptions").cloned().unwrap_or_default());
            }
            Message::Request(request) => {
                let message = format!("`{}` came before `initialize`", request.method);
                send(connection, Response::new_err(request.id, ErrorCode::ServerNotInitialized as i32, message))?;
            }
            Message::Notification(notification) if notification.method == "exit" => return Err(ServeError::Vanished),
            Message::Notification(_) | Message::Response(_) => {}
        }
    }
}

fn send(connection: &Connection, message: impl Into<Message>) -> Result<(), ServeError> {
    connection.sender.send(message.into()).map_err(|_| ServeError::Vanished)
}

/// Runs a piece of work; a panic in it is an error of this work alone.
fn guarded<T>(work: impl FnOnce() -> Result<T, Refusal>) -> Result<T, Refusal> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|cause| {
        let text = cause.downcast_ref::<&str>().copied().map(str::to_owned);
        let text = text.or_else(|| cause.downcast_ref::<String>().cloned()).unwrap_or_default();
        Err(Refusal { code: ErrorCode::InternalError, message: format!("a bug in mdlec: {text}") })
    })
}

fn read<T: DeserializeOwned>(params: Value) -> Result<T, Refusal> {
    serde_json::from_value(params).map_err(|error| Refusal::params(&error.to_string()))
}

impl Server<'_> {
    fn run(&mut self) -> Result<(), ServeError> {
        loop {
            let message = match self.next()? {
                Some(message) => message,
                None => {
                    self.check_one()?;
                    continue;
                }
            };
            match message {
                Message::Request(request) => self.request(request)?,
                Message::Notification(notification) if notification.method == "exit" => {
                    return if self.is_shut_down { Ok(()) } else { Err(ServeError::Vanished) };
                }
                Message::Notification(notification) => self.notification(notification)?,
                Message::Response(_) => {}
            }
        }
    }

    /// Returns the next message; `None` if none comes and a document is to be checked.
    fn next(&mut self) -> Result<Option<Message>, ServeError> {
        while let Ok(message) = self.connection.receiver.try_recv() {
            self.receive(message)?;
        }
        if let Some(message) = self.waiting.pop_front() {
            return Ok(Some(message));
        }
        let receiver = &self.connection.receiver;
        if self.stale.is_empty() {
            return receiver.recv().map(Some).map_err(|_| ServeError::Vanished);
        }
        match receiver.recv_timeout(PAUSE) {
            Ok(message) => Ok(Some(message)),
            Err(error) if error.is_timeout() => Ok(None),
            Err(_) => Err(ServeError::Vanished),
        }
    }

    /// Queues a message, or cancels a request that waits.
    fn receive(&mut self, message: Message) -> Result<(), ServeError> {
        let Message::Notification(Notification { method, params }) = &message else {
            self.waiting.push_back(message);
            return Ok(());
        };
        if method != "$/cancelRequest" {
            self.waiting.push_back(message);
            return Ok(());
        }
        let id: Option<RequestId> = params.get("id").and_then(|id| serde_json::from_value(id.clone()).ok());
        let is_meant =
            |waiting: &Message| matches!(waiting, Message::Request(request) if Some(&request.id) == id.as_ref());
        let Some(at) = self.waiting.iter().position(is_meant) else { return Ok(()) };
        let Some(Message::Request(request)) = self.waiting.remove(at) else { return Ok(()) };
        let message = "cancelled by the client".to_owned();
        send(self.connection, Response::new_err(request.id, ErrorCode::RequestCanceled as i32, message))
    }

    fn request(&mut self, request: Request) -> Result<(), ServeError> {
        let Request { id, method, params } = request;
        let answer = if self.is_shut_down {
            Err(Refusal { code: ErrorCode::InvalidRequest, message: format!("`{method}` came after `shutdown`") })
        } else if method == "shutdown" {
            self.is_shut_down = true;
            Ok(Value::Null)
        } else {
            guarded(|| requests::answer(&self.documents, &method, params))
        };
        match answer {
            Ok(result) => send(self.connection, Response::new_ok(id, result)),
            Err(Refusal { code, message }) => {
                if matches!(code, ErrorCode::InternalError) {
                    self.log(&format!("{method}: {message}"))?;
                }
                send(self.connection, Response::new_err(id, code as i32, message))
            }
        }
    }

    fn notification(&mut self, notification: Notification) -> Result<(), ServeError> {
        let Notification { method, params } = notification;
        match guarded(|| self.notified(&method, params)) {
            Ok(()) => Ok(()),
            Err(Refusal { message, .. }) => self.log(&format!("{method}: {message}")),
        }
    }

    fn notified(&mut self, method: &str, params: Value) -> Result<(), Refusal> {
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
            // The others, of which an editor has many, change no document.
            _ => {}
        }
        Ok(())
    }

    fn change(&mut self, Changed { document: Versioned { uri, version }, changes }: Changed) -> Result<(), Refusal> {
        let document = self.documents.open.get_mut(&uri).ok_or_else(|| Refusal::unknown(&uri))?;
        if version < document.version {
            let known = document.version;
            return Err(Refusal::params(&format!("version {version} of `{uri}` came after version {known}: ignored")));
        }
        document.version = version;
        document.change(changes);
        self.mark(&uri);
        Ok(())
    }

    /// Takes the client's settings.
    fn configure(&mut self, settings: &Value) {
        let Options { target, book } = Options::deserialize(settings).unwrap_or_default();
        self.documents.robot = target.filter(|target| !target.is_empty());
        self.book = book.filter(|book| !book.is_empty());
        self.mark_all();
    }

    /// Marks a document, and those that may use it, to be checked.
    fn mark(&mut self, uri: &str) {
        self.stale.insert(uri.to_owned());
        self.stale.extend(self.users.iter().cloned());
    }

    fn mark_all(&mut self) {
        self.stale.extend(self.documents.open.keys().cloned());
    }

    /// Checks one of the marked documents, and after the last of them publishes what changed.
    fn check_one(&mut self) -> Result<(), ServeError> {
        let Some(uri) = self.stale.pop_first() else { return Ok(()) };
        let documents = &self.documents;
        let checked = match documents.open.get(&uri) {
            None => Ok(check::Checked::default()),
            Some(document) => guarded(|| Ok(check::check(documents, &uri, document, self.book.as_deref()))),
        };
        match checked {
            Ok(checked) => self.keep(uri, checked),
            Err(Refusal { message, .. }) => self.log(&format!("check of {uri}: {message}"))?,
        }
        if !self.stale.is_empty() {
            return Ok(());
        }
        let concerned = std::mem::take(&mut self.concerned);
        concerned.iter().try_for_each(|uri| self.publish(uri))
    }

    /// Keeps the diagnostics of a check until they are published.
    fn keep(&mut self, uri: String, checked: check::Checked) {
        if checked.uses_files {
            self.users.insert(uri.clone())
        } else {
            self.users.remove(&uri)
        };
        self.concerned.extend(checked.diagnostics.keys().cloned());
        self.concerned.insert(uri.clone());
        let before = match self.documents.open.contains_key(&uri) {
            true => self.found.insert(uri, checked.diagnostics),
            false => self.found.remove(&uri),
        };
        self.concerned.extend(before.into_iter().flat_map(BTreeMap::into_keys));
    }

    /// Publishes the diagnostics in a document, each once, by whichever check it was found.
    fn publish(&self, uri: &str) -> Result<(), ServeError> {
        let mut diagnostics: Vec<&Value> = Vec::new();
        for diagnostic in self.found.values().filter_map(|found| found.get(uri)).flatten() {
            if !diagnostics.contains(&diagnostic) {
                diagnostics.push(diagnostic);
            }
        }
        let mut params = json!({ "uri": uri, "diagnostics": diagnostics });
        if let Some(document) = self.documents.open.get(uri) {
            params["version"] = json!(document.version);
        }
        send(self.connection, Notification::new("textDocument/publishDiagnostics".into(), params))
    }

    /// Reports an error that no answer can carry, in the client's log.
    fn log(&self, message: &str) -> Result<(), ServeError> {
        let params = json!({ "type": 1, "message": message });
        send(self.connection, Notification::new("window/logMessage".into(), params))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

    use super::*;

    #[test]
    fn a_panic_is_an_error_of_its_request_alone() {
        let refused = guarded(|| -> Result<(), Refusal> { panic!("at {}", 7) }).unwrap_err();
        assert!(matches!(refused.code, ErrorCode::InternalError));
        assert_eq!(refused.message, "a bug in mdlec: at 7");
        assert_eq!(guarded(|| Ok(1)).ok(), Some(1));
    }
}
