//! Tests `mdlec lsp` and `mdlec dap` as the real binary, on standard input and output. Their features are tested in
//! `editors/server` and `editors/debugger`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::ops::Range;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use mdle_compiler::diagnostic::Diagnostic;
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::executable::{command, folder};
use mdle_tests::pipeline::{LIBRARY, LIBRARY_FILE, diagnostics};
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::repository::root;
use serde_json::{Value, json};

/// A running `mdlec` that serves an editor.
struct Server {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Server {
    fn started(test: &str) -> Self {
        Self::of(test, "lsp")
    }

    /// Starts the command `name` of `mdlec`, which serves an editor.
    fn of(test: &str, name: &str) -> Self {
        let mut command = command(&folder(test), &[name]);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let (input, output) = (child.stdin.take(), BufReader::new(child.stdout.take().unwrap()));
        Self { child, input, output }
    }

    /// Starts a server with these settings, and waits for its answer to `initialize`.
    fn with_options(test: &str, options: &Value) -> Self {
        let mut server = Self::started(test);
        let params = json!({ "capabilities": {}, "initializationOptions": options });
        server.send(&json!({ "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": params }));
        assert_eq!(server.receive()["result"]["capabilities"]["positionEncoding"], "utf-16");
        server
    }

    fn write(&mut self, bytes: &[u8]) {
        self.input.as_mut().unwrap().write_all(bytes).unwrap();
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        self.write(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    }

    fn notify(&mut self, method: &str, params: &Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    fn receive(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert_ne!(self.output.read_line(&mut line).unwrap(), 0, "the server has ended");
            match line.trim_end().strip_prefix("Content-Length: ") {
                Some(number) => length = number.parse().unwrap(),
                None if line == "\r\n" => break,
                None => {}
            }
        }
        let mut text = vec![0; length];
        self.output.read_exact(&mut text).unwrap();
        serde_json::from_slice(&text).unwrap()
    }

    /// Waits for the diagnostics of this version of the document. Returns the code, the severity and the start of each.
    fn diagnostics(&mut self, version: u64) -> Vec<(String, u64, u64, u64)> {
        loop {
            let Value::Object(message) = self.receive() else { panic!("no object") };
            let params = &message["params"];
            if params["version"] != version {
                continue;
            }
            let found = params["diagnostics"].as_array().unwrap().iter();
            let start = |found: &Value, part| found["range"]["start"][part].as_u64().unwrap();
            let one = |found: &Value| {
                let code = found["code"].as_str().unwrap().to_owned();
                (code, found["severity"].as_u64().unwrap(), start(found, "line"), start(found, "character"))
            };
            return found.map(one).collect();
        }
    }

    /// Closes the connection; returns the exit status and standard error.
    fn end(mut self) -> (Option<i32>, String) {
        drop(self.input.take());
        let mut rest = Vec::new();
        self.output.read_to_end(&mut rest).unwrap();
        let output = self.child.wait_with_output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    }
}

#[test]
fn a_server_that_is_asked_to_end_succeeds() {
    let mut server = Server::with_options("asked_to_end", &Value::Null);
    server.send(&json!({ "jsonrpc": "2.0", "id": 2, "method": "shutdown" }));
    assert_eq!(server.receive()["result"], Value::Null);
    server.notify("exit", &Value::Null);
    assert_eq!(server.end(), (Some(0), String::new()));
}

#[test]
fn a_server_ends_with_its_client() {
    let (status, message) = Server::with_options("vanished", &Value::Null).end();
    assert_eq!(
        (status, message.as_str()),
        (Some(1), "error: the client is gone: it closed the connection without `exit`\n")
    );
    assert_eq!(Server::started("silent").end().0, Some(1));
}

#[test]
fn bytes_that_are_no_message_are_refused() {
    for (test, bytes) in [
        ("no_header", &b"hello\r\n\r\n"[..]),
        ("no_number", b"Content-Length: x\r\n\r\n{}"),
        ("no_json", b"Content-Length: 3\r\n\r\n{{{"),
        ("no_text", b"Content-Length: 3\r\n\r\n\xFF\xFE\xFD"),
    ] {
        let mut server = Server::started(test);
        server.write(bytes);
        let (status, message) = server.end();
        assert_eq!(status, Some(2), "{test}: {message}");
        assert!(message.starts_with("error: the client does not speak the Language Server Protocol"), "{message}");
    }
}

#[test]
fn a_debugger_ends_with_its_client() {
    let mut debugger = Server::of("debugger_asked", "dap");
    debugger.send(&json!({ "seq": 1, "type": "request", "command": "initialize", "arguments": {} }));
    assert_eq!(debugger.receive()["body"]["supportsStepBack"], true);
    debugger.send(&json!({ "seq": 2, "type": "request", "command": "disconnect" }));
    assert_eq!(debugger.receive()["command"], "disconnect");
    assert_eq!(debugger.end(), (Some(0), String::new()));
    let (status, message) = Server::of("debugger_vanished", "dap").end();
    assert_eq!(
        (status, message.as_str()),
        (Some(1), "error: the client is gone: it closed the connection without `disconnect`\n")
    );
    let mut debugger = Server::of("debugger_bytes", "dap");
    debugger.write(b"hello\r\n\r\n");
    let (status, message) = debugger.end();
    assert_eq!(status, Some(2));
    assert!(message.starts_with("error: the client does not speak the Debug Adapter Protocol: `hello`"), "{message}");
}

/// Returns the diagnostics of the compiler: the code, the severity and the start of each, in UTF-16.
fn expected(text: &str) -> Vec<(String, u64, u64, u64)> {
    let one = |(found, range): (Diagnostic, Range<usize>)| {
        let before = &text[..range.start];
        let line = before.split('\n').count() - 1;
        let column = before.rsplit('\n').next().unwrap_or("").encode_utf16().count();
        let severity = if found.code.name().starts_with('E') { 1 } else { 2 };
        (found.code.name().to_owned(), severity, line as u64, column as u64)
    };
    diagnostics(text).into_iter().map(one).collect()
}

/// Texts that a random edit inserts.
const INSERTED: [&str; 14] =
    ["", "", "(", ")", "{", "}", " OR ", "𝒜", "\n", "null", "Atom", "a: ", "// ü\n", "{ P (Atom (a) idle) }\n"];

/// Makes a random edit of `text`, and returns the edit in the form of the protocol.
fn edited(text: &mut String, chance: &mut Chance) -> Value {
    let bounds: Vec<usize> = (0..=text.len()).filter(|at| text.is_char_boundary(*at)).collect();
    let first = chance.below(bounds.len());
    let last = (first + chance.below(6)).min(bounds.len() - 1);
    let (start, end) = (bounds[first], bounds[last]);
    let position = |byte: usize| {
        let before = &text[..byte];
        let character = before.rsplit('\n').next().unwrap_or("").encode_utf16().count();
        json!({ "line": before.matches('\n').count(), "character": character })
    };
    let inserted = chance.pick(&INSERTED);
    let change = json!({ "range": { "start": position(start), "end": position(end) }, "text": inserted });
    text.replace_range(start..end, inserted);
    change
}

#[test]
fn random_edits_leave_the_compilers_diagnostics() {
    let target = root().join("tests/scripted");
    let folder = folder("random_edits_of_files");
    fs::write(folder.join(LIBRARY_FILE), LIBRARY).unwrap();
    let mut server = Server::with_options("random_edits", &json!({ "target": target }));
    let (mut version, mut with_library) = (0, 0);
    for seed in 0..repeated(250) {
        let mut chance = Chance::new(seed);
        let mut text = RandomPlan::new(&mut chance, 12, false).with_commas(&mut chance);
        with_library += u32::from(text.contains("use "));
        version += 1;
        let uri = format!("file://{}/{seed}.mdle", folder.display());
        let document = json!({ "uri": uri, "languageId": "mdle", "version": version, "text": text });
        server.notify("textDocument/didOpen", &json!({ "textDocument": document }));
        assert_eq!(server.diagnostics(version), expected(&text), "{text}");
        for _ in 0..20 {
            let change = edited(&mut text, &mut chance);
            version += 1;
            let document = json!({ "uri": uri, "version": version });
            server.notify("textDocument/didChange", &json!({ "textDocument": document, "contentChanges": [change] }));
            assert_eq!(server.diagnostics(version), expected(&text), "{text}");
        }
        server.notify("textDocument/didClose", &json!({ "textDocument": { "uri": uri } }));
    }
    assert!(with_library > 2, "{with_library} plans use the library");
}
