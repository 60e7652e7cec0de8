//! The main loop of the server: handles messages in order, and checks documents when no message waits.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::Duration;

use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId, Response};
use serde_json::{Value, json};

use crate::ServeError;
use crate::documents::Documents;
use crate::guard::guarded;
use crate::params::RequestError;
use crate::requests;

/// Time without messages from the client after which a document is checked. It is shorter than the interval between two
/// keystrokes.
const PAUSE: Duration = Duration::from_millis(5);

/// The server of one client, after `initialize`.
pub(crate) struct Server<'c> {
    pub(crate) connection: &'c Connection,
    pub(crate) documents: Documents,
    /// Address of the documentation, for links to the explanations of messages.
    pub(crate) book: Option<String>,
    /// Received messages that have not been handled yet.
    pub(crate) waiting: VecDeque<Message>,
    /// URIs of documents to check.
    pub(crate) stale: BTreeSet<String>,
    /// URIs of documents whose diagnostics are published when all documents are checked. If they were published
    /// earlier, the diagnostics in a file that several documents use could refer to different versions of the file.
    pub(crate) concerned: BTreeSet<String>,
    /// Diagnostics that were found. The first key is the URI of the checked document; the second key is the URI of the
    /// document in which the diagnostics are shown.
    pub(crate) found: BTreeMap<String, BTreeMap<String, Vec<Value>>>,
    /// URIs of open documents that use other files, or refer to files that cannot be read.
    pub(crate) users: BTreeSet<String>,
    /// `true` after `shutdown`: only `exit` may follow.
    pub(crate) is_shut_down: bool,
}

/// Serves one client until the client ends the server.
///
/// # Errors
/// Fails if the client violates the protocol or closes the connection too early.
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

/// Answers `initialize`, and refuses all requests before it. Returns the client's settings.
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

pub(crate) fn send(connection: &Connection, message: impl Into<Message>) -> Result<(), ServeError> {
    connection.sender.send(message.into()).map_err(|_| ServeError::Vanished)
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

    /// Returns the next message. Returns `None` if no message arrives and a document has to be checked.
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

    /// Queues a message, or cancels a queued request.
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
            Err(RequestError { code: ErrorCode::InvalidRequest, message: format!("`{method}` came after `shutdown`") })
        } else if method == "shutdown" {
            self.is_shut_down = true;
            Ok(Value::Null)
        } else {
            guarded(|| requests::answer(&self.documents, &method, params))
        };
        match answer {
            Ok(result) => send(self.connection, Response::new_ok(id, result)),
            Err(RequestError { code, message }) => {
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
            Err(RequestError { message, .. }) => self.log(&format!("{method}: {message}")),
        }
    }

    /// Writes to the client's log an error that does not belong to an answer.
    pub(crate) fn log(&self, message: &str) -> Result<(), ServeError> {
        let params = json!({ "type": 1, "message": message });
        send(self.connection, Notification::new("window/logMessage".into(), params))
    }
}
