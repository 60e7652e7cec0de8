//! Parses and answers the requests of a page.

use mdle_language_service::lines::Position;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::document::Document;
use crate::draft::PageFiles;
use crate::run::Run;
use crate::setup::PageSetup;
use crate::{editing, export, floor, tools, trial};

/// A request of a page.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case")]
enum PageRequest {
    /// Return the messages of `mdlec check --message-format json`.
    Check(PageFiles),
    /// Return the text of `mdlec fmt`.
    Fmt(PageFiles),
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
        draft: PageFiles,
        plan: Option<String>,
    },
    /// Return the picture of `mdlec draw`.
    Draw {
        #[serde(flatten)]
        draft: PageFiles,
        plan: Option<String>,
    },
    /// Return the lines of `mdlec trace`.
    Trace {
        #[serde(flatten)]
        draft: PageFiles,
        plan: Option<String>,
        script: String,
    },
    /// Return diagnostics with their fixes, the names of plans, and semantic tokens.
    Diagnose(PageFiles),
    /// Return completions at a position.
    Complete {
        #[serde(flatten)]
        draft: PageFiles,
        at: TextPosition,
    },
    /// Return the hover text at a position.
    Hover {
        #[serde(flatten)]
        draft: PageFiles,
        at: TextPosition,
    },
    /// Return the signature of the call that encloses a position.
    Signature {
        #[serde(flatten)]
        draft: PageFiles,
        at: TextPosition,
    },
    /// Return the edits that format the text of one file.
    Format { text: String },
    /// Return the floor of a world.
    Floor { world: String },
    /// Check the world, the body and the start pose of a run.
    Ready(PageSetup),
    /// Begin a run.
    Begin(PageSetup),
    /// Advance the run by at most `turns` turns.
    Step { turns: u64 },
    /// Explain a turn of the current run.
    Why { turn: usize },
    /// Perform a complete run, and return the way it ended.
    Trial(PageSetup),
    /// Perform a complete run, and return one of its files.
    Export {
        what: export::ExportKind,
        #[serde(flatten)]
        setup: PageSetup,
    },
}

/// A position in a text, as `{"line":…,"character":…}`: both are counted from 0, and characters are UTF-16 code units.
#[derive(Debug, Clone, Copy, Deserialize)]
struct TextPosition {
    line: u32,
    character: u32,
}

impl From<TextPosition> for Position {
    fn from(TextPosition { line, character }: TextPosition) -> Self {
        Self { line, character }
    }
}

/// Answers the requests of one page, and stores its current run.
#[derive(Default)]
pub struct PageSession {
    run: Option<Run>,
}

impl PageSession {
    /// Returns the answer to a request, or `{"error":SENTENCE}` if the request is refused.
    #[must_use]
    pub fn answer(&mut self, request: &[u8]) -> String {
        let answer = serde_json::from_slice(request)
            .map_err(|error| format!("the request is not one of this version: {error}"))
            .and_then(|request| self.answered(request));
        answer.unwrap_or_else(|sentence| json!({ "error": sentence })).to_string()
    }

    fn answered(&mut self, request: PageRequest) -> Result<Value, String> {
        match request {
            PageRequest::Check(draft) => Document::of(&draft).map(|mut document| tools::check(&mut document)),
            PageRequest::Fmt(draft) => Document::of(&draft).map(|document| tools::fmt(&document)),
            PageRequest::Explain { code } => tools::explain(&code),
            PageRequest::Quarks { robot } => tools::quarks(&robot),
            PageRequest::Analyze { draft, plan } => tools::analyze(&mut Document::of(&draft)?, plan.as_deref()),
            PageRequest::Draw { draft, plan } => tools::draw(&mut Document::of(&draft)?, plan.as_deref()),
            PageRequest::Trace { draft, plan, script } => {
                tools::trace(&mut Document::of(&draft)?, plan.as_deref(), &script)
            }
            PageRequest::Diagnose(draft) => editing::diagnose(&mut Document::of(&draft)?),
            PageRequest::Complete { draft, at } => editing::complete(&mut Document::of(&draft)?, at.into()),
            PageRequest::Hover { draft, at } => editing::hover(&mut Document::of(&draft)?, at.into()),
            PageRequest::Signature { draft, at } => editing::signature(&mut Document::of(&draft)?, at.into()),
            PageRequest::Format { text } => Ok(editing::format(&text)),
            PageRequest::Floor { world } => floor::floor(&world),
            PageRequest::Ready(setup) => setup.ready().and_then(|ready| floor::ready(&ready)),
            PageRequest::Begin(setup) => {
                // The memory of the previous run is freed before the next run is created.
                self.run = None;
                let run = self.run.insert(Run::begin(&setup)?);
                run.description()
            }
            PageRequest::Step { turns } => self.run().map(|run| run.step(turns)),
            PageRequest::Why { turn } => self.run().and_then(|run| run.why(turn)),
            PageRequest::Trial(setup) => trial::trial(&setup),
            PageRequest::Export { what, setup } => export::export(what, &setup),
        }
    }

    fn run(&mut self) -> Result<&mut Run, String> {
        self.run.as_mut().ok_or_else(|| "no run has begun".to_owned())
    }
}
