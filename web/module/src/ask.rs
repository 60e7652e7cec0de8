//! Parses and answers the requests of a page.

use mdle_language_service::lines::Position;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::document::Document;
use crate::draft::Draft;
use crate::run::Run;
use crate::setup::Setup;
use crate::{editing, export, floor, tools, trial};

/// A request of a page.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case")]
enum Request {
    /// Return the messages of `mdlec check --message-format json`.
    Check(Draft),
    /// Return the text of `mdlec fmt`.
    Fmt(Draft),
    /// Return the text of `mdlec explain`.
    Explain { code: String },
    /// Return the list of `mdlec quarks`.
    Quarks {
        #[serde(default)]
        robot: String,
    },
    /// Return the report of `mdlec analyze`.
    Analyze {
        #[serde(flatten)]
        draft: Draft,
        plan: Option<String>,
    },
    /// Return the picture of `mdlec draw`.
    Draw {
        #[serde(flatten)]
        draft: Draft,
        plan: Option<String>,
    },
    /// Return the lines of `mdlec trace`.
    Trace {
        #[serde(flatten)]
        draft: Draft,
        plan: Option<String>,
        script: String,
    },
    /// Return diagnostics with their fixes, the names of plans, and semantic tokens.
    Diagnose(Draft),
    /// Return completions at a position.
    Complete {
        #[serde(flatten)]
        draft: Draft,
        at: At,
    },
    /// Return the hover text at a position.
    Hover {
        #[serde(flatten)]
        draft: Draft,
        at: At,
    },
    /// Return the signature of the call that encloses a position.
    Signature {
        #[serde(flatten)]
        draft: Draft,
        at: At,
    },
    /// Return the edits that format the text of one file.
    Format { text: String },
    /// Return the floor of a world.
    Floor { world: String },
    /// Check the world, the body and the start pose of a run.
    Ready(Setup),
    /// Begin a run.
    Begin(Setup),
    /// Advance the run by at most `turns` turns.
    Step { turns: u64 },
    /// Explain a turn of the current run.
    Why { turn: usize },
    /// Perform a complete run, and return the way it ended.
    Trial(Setup),
    /// Perform a complete run, and return one of its files.
    Export {
        what: export::ExportKind,
        #[serde(flatten)]
        setup: Setup,
    },
}

/// A position in a text, as `{"line":…,"character":…}`: both are counted from 0, and characters are UTF-16 code units.
#[derive(Debug, Clone, Copy, Deserialize)]
struct At {
    line: u32,
    character: u32,
}

impl From<At> for Position {
    fn from(At { line, character }: At) -> Self {
        Self { line, character }
    }
}

/// Answers the requests of one page, and stores its current run.
#[derive(Default)]
pub struct Session {
    run: Option<Run>,
}

impl Session {
    /// Returns the answer to a request, or `{"error":SENTENCE}` if the request is refused.
    #[must_use]
    pub fn answer(&mut self, request: &[u8]) -> String {
        let answer = serde_json::from_slice(request)
            .map_err(|error| format!("the request is not one of this version: {error}"))
            .and_then(|request| self.answered(request));
        answer.unwrap_or_else(|sentence| json!({ "error": sentence })).to_string()
    }

    fn answered(&mut self, request: Request) -> Result<Value, String> {
        match request {
            Request::Check(draft) => Document::of(&draft).map(|mut document| tools::check(&mut document)),
            Request::Fmt(draft) => Document::of(&draft).map(|document| tools::fmt(&document)),
            Request::Explain { code } => tools::explain(&code),
            Request::Quarks { robot } => tools::quarks(&robot),
            Request::Analyze { draft, plan } => tools::analyze(&mut Document::of(&draft)?, plan.as_deref()),
            Request::Draw { draft, plan } => tools::draw(&mut Document::of(&draft)?, plan.as_deref()),
            Request::Trace { draft, plan, script } => {
                tools::trace(&mut Document::of(&draft)?, plan.as_deref(), &script)
            }
            Request::Diagnose(draft) => editing::diagnose(&mut Document::of(&draft)?),
            Request::Complete { draft, at } => editing::complete(&mut Document::of(&draft)?, at.into()),
            Request::Hover { draft, at } => editing::hover(&mut Document::of(&draft)?, at.into()),
            Request::Signature { draft, at } => editing::signature(&mut Document::of(&draft)?, at.into()),
            Request::Format { text } => Ok(editing::format(&text)),
            Request::Floor { world } => floor::floor(&world),
            Request::Ready(setup) => setup.ready().and_then(|ready| floor::ready(&ready)),
            Request::Begin(setup) => {
                // The memory of the previous run is freed before the next run is created.
                self.run = None;
                let run = self.run.insert(Run::begin(&setup)?);
                run.description()
            }
            Request::Step { turns } => self.run().map(|run| run.step(turns)),
            Request::Why { turn } => self.run().and_then(|run| run.why(turn)),
            Request::Trial(setup) => trial::trial(&setup),
            Request::Export { what, setup } => export::export(what, &setup),
        }
    }

    fn run(&mut self) -> Result<&mut Run, String> {
        self.run.as_mut().ok_or_else(|| "no run has begun".to_owned())
    }
}
