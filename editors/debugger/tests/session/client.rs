//! A client for tests: sends all requests of a session, and then reads the messages of the debugger.

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;

use mdle_debugger::{ServeError, serve_on};
use serde_json::{Value, json};

/// Plan for the tests. Its lines count from 1.
pub(crate) const PLAN: &str = "{ Tour (wait 100s)
  s1: (Atom (bumper AND wait 2s OR atIsection 1000) (go 20 0))
  { Shake (RISING bumper)
    ((Atom (wait 1s) (go 5 0)) (Atom (null) turn 90))^2
  }
  (Atom (after s1 atIsection 1000 OR wait 5s) stop)
}
";

/// Script for the tests: bumper fires from 3 s to 4 s and at 7 s, and `turn 90` completes at 6.5 s.
pub(crate) const SCRIPT: &str = r#"{"t": 0}
{"t": 1, "fired": ["bumper"]}
{"t": 2.5}
{"t": 3, "fired": ["bumper"]}
{"t": 4, "fired": ["bumper"], "heading": 90}
{"t": 5}
{"t": 6.5, "completed": ["turn 90"]}
{"t": 7, "fired": ["bumper"]}
{"t": 8}
"#;

/// A session with a plan and a script in its own folder.
pub(crate) struct DebugSession {
    pub(crate) folder: PathBuf,
    input: Vec<u8>,
    seq: i64,
}

impl DebugSession {
    /// Writes [`PLAN`] and [`SCRIPT`] to files, and launches the plan.
    pub(crate) fn launched(test: &str) -> Self {
        Self::of(test, PLAN, SCRIPT, &json!({ "stopOnEntry": true }))
    }

    /// Writes a plan and a script to files, and launches the plan with the additional arguments `more`.
    pub(crate) fn of(test: &str, plan: &str, script: &str, more: &Value) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("debugger").join(test);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("plan.mdle"), plan).unwrap();
        fs::write(folder.join("script.jsonl"), script).unwrap();
        let mut session = Self { folder, input: Vec::new(), seq: 0 };
        session.request("initialize", json!({ "adapterID": "mdle" }));
        let mut arguments = json!({ "program": session.path(), "script": session.folder.join("script.jsonl") });
        arguments.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        session.request("launch", arguments);
        session
    }

    pub(crate) fn path(&self) -> PathBuf {
        self.folder.join("plan.mdle")
    }

    /// Sends a request; returns its number.
    pub(crate) fn request(&mut self, command: &str, arguments: Value) -> i64 {
        self.seq += 1;
        let message = json!({ "seq": self.seq, "type": "request", "command": command, "arguments": arguments });
        let text = message.to_string();
        self.input.extend(format!("Content-Length: {}\r\n\r\n{text}", text.len()).bytes());
        self.seq
    }

    /// Sends requests without arguments.
    pub(crate) fn requests(&mut self, commands: &[&str]) {
        for command in commands {
            self.request(command, Value::Null);
        }
    }

    /// Sets breakpoints in the plan at these lines and columns, which count from 1; column 0 sets a breakpoint without
    /// a column. Returns the number of the request.
    pub(crate) fn breakpoints(&mut self, places: &[(u32, u32)]) -> i64 {
        let place = |(line, column): &(u32, u32)| match column {
            0 => json!({ "line": line }),
            column => json!({ "line": line, "column": column }),
        };
        let breakpoints: Vec<Value> = places.iter().map(place).collect();
        self.request("setBreakpoints", json!({ "source": { "path": self.path() }, "breakpoints": breakpoints }))
    }

    /// Ends the session, and returns all messages of the debugger.
    pub(crate) fn end(mut self) -> Messages {
        self.requests(&["disconnect"]);
        let (messages, ended) = served(self.input);
        ended.unwrap();
        messages
    }
}

/// Serves a client that sends the bytes `input`. Returns the messages of the debugger and its result.
pub(crate) fn served(input: Vec<u8>) -> (Messages, Result<(), ServeError>) {
    let mut output = Vec::new();
    let ended = serve_on(Cursor::new(input), &mut output);
    let mut messages = Vec::new();
    let mut rest = std::str::from_utf8(&output).unwrap();
    while let Some((header, after)) = rest.split_once("\r\n\r\n") {
        let length: usize = header.strip_prefix("Content-Length: ").unwrap().parse().unwrap();
        messages.push(serde_json::from_str(&after[..length]).unwrap());
        rest = &after[length..];
    }
    (Messages(messages), ended)
}

/// All messages of the debugger.
pub(crate) struct Messages(pub(crate) Vec<Value>);

impl Messages {
    /// Returns the response to a request.
    pub(crate) fn response(&self, seq: i64) -> &Value {
        self.0.iter().find(|message| message["request_seq"] == seq).unwrap()
    }

    /// Returns the body of a successful response.
    pub(crate) fn body(&self, seq: i64) -> &Value {
        let response = self.response(seq);
        assert_eq!(response["success"], true, "{response}\n{}", self.response(2));
        &response["body"]
    }

    /// Returns the error message of a refused request.
    pub(crate) fn refusal(&self, seq: i64) -> &str {
        let response = self.response(seq);
        assert_eq!(response["success"], false, "{response}");
        response["message"].as_str().unwrap()
    }

    /// Returns the reason of each stop in order, and `terminated` for the end of the session.
    pub(crate) fn stops(&self) -> Vec<&str> {
        let events = self.0.iter().filter(|message| message["type"] == "event");
        let stop = |message: &'_ Value| match message["event"].as_str().unwrap() {
            "stopped" => Some(message["body"]["reason"].as_str().unwrap().to_owned()),
            "terminated" => Some("terminated".to_owned()),
            _ => None,
        };
        events
            .filter_map(|message| stop(message).map(|_| message))
            .map(|message| message["body"]["reason"].as_str().unwrap_or("terminated"))
            .collect()
    }

    /// Returns the names and lines of the frames in a stack trace, innermost first.
    pub(crate) fn stack(&self, seq: i64) -> Vec<String> {
        let frames = self.body(seq)["stackFrames"].as_array().unwrap();
        frames.iter().map(|frame| format!("{} @{}", frame["name"].as_str().unwrap(), frame["line"])).collect()
    }

    /// Returns variables in the form `name = value`.
    pub(crate) fn variables(&self, seq: i64) -> Vec<String> {
        let variables = self.body(seq)["variables"].as_array().unwrap();
        let one = |variable: &Value| {
            format!("{} = {}", variable["name"].as_str().unwrap(), variable["value"].as_str().unwrap())
        };
        variables.iter().map(one).collect()
    }
}
