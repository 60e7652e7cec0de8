//! The client: exchanges messages of the Debug Adapter Protocol. Each message is JSON after a header with its length.

use std::collections::VecDeque;
use std::io::{self, BufRead, Read, Write};
use std::sync::mpsc::{self, Receiver};
use std::thread;

use serde_json::{Value, json};

use crate::ServeError;

/// Maximum length of a message, in bytes. A client sends names and lines, but no file contents.
const LONGEST: usize = 16_000_000;

/// A request from the client.
#[derive(Debug)]
pub(crate) struct ClientRequest {
    pub(crate) seq: i64,
    pub(crate) command: String,
    pub(crate) arguments: Value,
}

/// Connection to the client.
pub(crate) struct Client<'o> {
    /// Messages from the client. A separate thread reads them, so a request can interrupt a run.
    received: Receiver<Result<Value, ServeError>>,
    /// Requests that arrived during a run, in order of arrival.
    waiting: VecDeque<ClientRequest>,
    output: &'o mut dyn Write,
    /// Number of the last message that was sent.
    seq: i64,
}

impl<'o> Client<'o> {
    /// Starts reading messages from `input`.
    pub(crate) fn new(mut input: impl BufRead + Send + 'static, output: &'o mut dyn Write) -> Self {
        let (sender, received) = mpsc::channel();
        thread::spawn(move || {
            loop {
                let message = message(&mut input);
                let is_last = message.is_err();
                if sender.send(message).is_err() || is_last {
                    return;
                }
            }
        });
        Self { received, waiting: VecDeque::new(), output, seq: 0 }
    }

    /// Waits for the next request.
    pub(crate) fn request(&mut self) -> Result<ClientRequest, ServeError> {
        if let Some(request) = self.waiting.pop_front() {
            return Ok(request);
        }
        loop {
            let message = self.received.recv().map_err(|_| ServeError::Vanished)??;
            if let Some(request) = request(message)? {
                return Ok(request);
            }
        }
    }

    /// Returns `true` if the client has sent a request that has to interrupt the run.
    pub(crate) fn interrupts(&mut self) -> Result<bool, ServeError> {
        while let Ok(message) = self.received.try_recv() {
            self.waiting.extend(request(message?)?);
        }
        let is_end = |request: &ClientRequest| matches!(request.command.as_str(), "pause" | "terminate" | "disconnect");
        Ok(self.waiting.iter().any(is_end))
    }

    /// Answers a request.
    pub(crate) fn respond(&mut self, request: &ClientRequest, answer: Result<Value, String>) -> Result<(), ServeError> {
        let ClientRequest { seq, command, .. } = request;
        let mut response = json!({ "type": "response", "request_seq": seq, "command": command });
        match answer {
            Ok(body) => {
                response["success"] = json!(true);
                response["body"] = body;
            }
            Err(message) => {
                // In the protocol, `format` is a template in which braces enclose variables.
                let format = json!({ "id": 1, "format": "{text}", "variables": { "text": message }, "showUser": true });
                response["success"] = json!(false);
                response["message"] = json!(message);
                response["body"] = json!({ "error": format });
            }
        }
        self.send(response)
    }

    /// Sends an event to the client.
    pub(crate) fn event(&mut self, event: &str, body: Value) -> Result<(), ServeError> {
        self.send(json!({ "type": "event", "event": event, "body": body }))
    }

    fn send(&mut self, mut message: Value) -> Result<(), ServeError> {
        self.seq += 1;
        message["seq"] = json!(self.seq);
        let text = message.to_string();
        let written = write!(self.output, "Content-Length: {}\r\n\r\n{text}", text.len());
        written.and_then(|()| self.output.flush()).map_err(|_| ServeError::Vanished)
    }
}

/// Converts a message to a request. Returns `None` for a response, which is ignored because the debugger sends no
/// requests.
fn request(mut message: Value) -> Result<Option<ClientRequest>, ServeError> {
    match message.get("type").and_then(Value::as_str) {
        Some("request") => {}
        Some(_) => return Ok(None),
        None => return Err(ServeError::Protocol("a message has no `type`".into())),
    }
    let seq = message.get("seq").and_then(Value::as_i64);
    let command = message.get("command").and_then(Value::as_str).map(str::to_owned);
    let (Some(seq), Some(command)) = (seq, command) else {
        return Err(ServeError::Protocol("a request has no `seq` or no `command`".into()));
    };
    let arguments = message.get_mut("arguments").map(Value::take).unwrap_or_default();
    Ok(Some(ClientRequest { seq, command, arguments }))
}

/// Reads the next message.
fn message(input: &mut impl BufRead) -> Result<Value, ServeError> {
    let mut length = None;
    loop {
        let mut line = Vec::new();
        match input.by_ref().take(1_000).read_until(b'\n', &mut line) {
            Ok(0) => return Err(ServeError::Vanished),
            Ok(_) => {}
            Err(error) => return Err(vanished(&error)),
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim_end();
        if line.is_empty() {
            break;
        }
        let (name, value) = line.split_once(':').ok_or_else(|| bad_header(line))?;
        if name.eq_ignore_ascii_case("content-length") {
            length = Some(value.trim().parse::<usize>().map_err(|_| bad_header(line))?);
        }
    }
    let length = length.filter(|length| *length <= LONGEST);
    let length = length.ok_or_else(|| ServeError::Protocol("a message has no length, or is too long".into()))?;
    let mut text = vec![0; length];
    input.read_exact(&mut text).map_err(|error| vanished(&error))?;
    serde_json::from_slice(&text).map_err(|error| ServeError::Protocol(error.to_string()))
}

fn bad_header(line: &str) -> ServeError {
    let shown: String = line.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect();
    ServeError::Protocol(format!("`{shown}` is no header"))
}

fn vanished(_: &io::Error) -> ServeError {
    ServeError::Vanished
}
