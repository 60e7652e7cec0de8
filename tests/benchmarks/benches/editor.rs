//! Measures the response times of the language server and, for comparison, of the compiler alone for the same work.
//!
//! A client in the same process types a digit and waits for the diagnostics, requests a completion and a hover, and
//! makes ten thousand edits, between which the memory of the process is measured. The times include the 5 ms that the
//! server waits for more keystrokes before it checks the document.
#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::panic, reason = "this is what a benchmark is for")]

use std::fs;
use std::hint::black_box;
use std::time::{Duration, Instant};

use lsp_server::{Connection, Message, Notification, Request};
use mdle_compiler::check_with;
use mdle_compiler::diagnostic::SourceId;
use mdle_compiler::syntax::NoFiles;
use mdle_tests::golden::alphabet;
use serde_json::{Value, json};

/// Number of times that each answer is measured.
const TIMES: usize = 300;
/// Number of edits between the first and the last measurement of the memory.
const EDITS: usize = 10_000;
/// URI of the client's document, which is not in a file.
const URI: &str = "untitled:plan";

fn main() {
    println!("{:>6} {:22} {:>9} {:>9} {:>9}", "atoms", "", "p50, ms", "p99", "max");
    for atoms in [1_000, 10_000] {
        answers(atoms);
    }
    memory();
}

/// Returns a plan of `atoms` atoms, one per line, in behaviors of ten atoms each.
fn plan(atoms: usize) -> String {
    let atom = |number: usize| format!("    (Atom (bumper OR wait {}s) (go 20 0))\n", number % 50 + 1);
    let behavior = |number: usize| {
        format!("  {{ B{number} (lowBattery OR wait 30min)\n{}  }}\n", (0..10).map(atom).collect::<String>())
    };
    format!("{{ P (wait 600min)\n{}}}\n", (0..atoms / 10).map(behavior).collect::<String>())
}

/// Measures and prints the response times for a plan of `atoms` atoms.
fn answers(atoms: usize) {
    let text = plan(atoms);
    let robot = alphabet(Some("sim"));
    let check = || drop(black_box(check_with(SourceId(0), black_box(&text), &robot, &mut NoFiles)));
    print(atoms, "mdlec check, in memory", (0..TIMES / 10).map(|_| time(check)).collect());
    let mut client = Client::new(&text);
    // Position of the law of a behavior's fourth atom, in the middle of the plan. A behavior has twelve lines.
    let (line, character) = (text.lines().count() as u32 / 24 * 12 + 5, 32);
    let at = json!({ "textDocument": { "uri": URI }, "position": { "line": line, "character": character } });
    print(atoms, "diagnostics", (0..TIMES).map(|_| time(|| client.type_digit(line))).collect());
    for (name, method) in [("completion", "textDocument/completion"), ("hover", "textDocument/hover")] {
        let times = (0..TIMES).map(|_| time(|| drop(black_box(client.ask(method, &at)))));
        print(atoms, name, times.collect());
    }
}

/// Prints the memory of the process before, between and after the edits.
fn memory() {
    let mut client = Client::new(&plan(1_000));
    let line = 500;
    let mut readings = vec![megabytes()];
    for _ in 0..2 {
        (0..EDITS / 2).for_each(|_| client.type_digit(line));
        readings.push(megabytes());
    }
    println!(
        "\nmemory of the process with 1,000 atoms, MB: {:.1} at first, {:.1} after {}, {:.1} after {EDITS} edits",
        readings[0],
        readings[1],
        EDITS / 2,
        readings[2]
    );
}

/// Returns the resident memory of this process, in megabytes.
fn megabytes() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse::<f64>().unwrap() / 1_000.0
}

fn time(work: impl FnOnce()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}

fn print(atoms: usize, name: &str, mut times: Vec<Duration>) {
    times.sort();
    let at = |percent: usize| times[(times.len() * percent / 100).min(times.len() - 1)].as_secs_f64() * 1e3;
    println!("{atoms:>6} {name:22} {:>9.2} {:>9.2} {:>9.2}", at(50), at(99), at(100));
}

/// A client with one open document.
struct Client {
    connection: Connection,
    version: i64,
    /// `true` if the text contains the digit that the client types and deletes.
    has_digit: bool,
}

impl Client {
    /// Starts a server, opens the document, and waits for its diagnostics.
    fn new(text: &str) -> Self {
        let (server, connection) = Connection::memory();
        std::thread::spawn(move || mdle_language_server::serve_on(&server));
        let mut client = Self { connection, version: 1, has_digit: false };
        client.ask("initialize", &json!({ "capabilities": {}, "initializationOptions": { "target": "sim" } }));
        let document = json!({ "uri": URI, "languageId": "mdle", "version": 1, "text": text });
        client.notify("textDocument/didOpen", json!({ "textDocument": document }));
        client.diagnostics();
        client
    }

    fn notify(&self, method: &str, params: Value) {
        self.connection.sender.send(Notification::new(method.to_owned(), params).into()).unwrap();
    }

    fn ask(&mut self, method: &str, params: &Value) -> Value {
        self.connection.sender.send(Request::new(1.into(), method.to_owned(), params).into()).unwrap();
        loop {
            if let Message::Response(response) = self.connection.receiver.recv().unwrap() {
                return response.response_result.unwrap_or_else(|error| panic!("{method}: {error:?}"));
            }
        }
    }

    /// Waits for the diagnostics of the document's current version.
    fn diagnostics(&mut self) {
        loop {
            if let Message::Notification(notification) = self.connection.receiver.recv().unwrap()
                && notification.params["version"] == self.version
            {
                return;
            }
        }
    }

    /// Types a digit into the time of the atom in a line, or deletes the digit if it is already there. Waits for the
    /// diagnostics.
    fn type_digit(&mut self, line: u32) {
        self.version += 1;
        let at = |character: u32| json!({ "line": line, "character": character });
        // The digit is inserted before the time, after `wait `.
        let (end, text) = if self.has_digit { (27, "") } else { (26, "1") };
        let change = json!({ "range": { "start": at(26), "end": at(end) }, "text": text });
        self.has_digit = !self.has_digit;
        let document = json!({ "uri": URI, "version": self.version });
        self.notify("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
        self.diagnostics();
    }
}
