//! The documents that are open in the editor, with the data that a check of a document needs: its robot and the other
//! documents.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use mdle_files::{Input, InputError, Settings, Target, Unsaved, place, plan, target};
use serde::Deserialize;

use crate::uri;
use mdle_language_service::lines::{LineStarts, Position};

/// A document that is open in the editor.
#[derive(Debug, Clone)]
pub(crate) struct Document {
    pub(crate) path: PathBuf,
    pub(crate) text: String,
    pub(crate) version: i64,
}

/// An edit as a protocol object. An edit without a range replaces the whole text.
#[derive(Debug, Deserialize)]
pub(crate) struct DocumentEdit {
    range: Option<Positions>,
    text: String,
}

/// A range as a protocol object.
#[derive(Debug, Clone, Copy, Deserialize)]
pub(crate) struct Positions {
    pub(crate) start: ProtocolPosition,
    pub(crate) end: ProtocolPosition,
}

/// A position as a protocol object.
#[derive(Debug, Clone, Copy, Deserialize)]
pub(crate) struct ProtocolPosition {
    line: u32,
    character: u32,
}

impl From<ProtocolPosition> for Position {
    fn from(at: ProtocolPosition) -> Self {
        Self { line: at.line, character: at.character }
    }
}

impl Document {
    /// Applies the edits in order. Each edit refers to the text after the previous edit.
    pub(crate) fn change(&mut self, changes: Vec<DocumentEdit>) {
        for change in changes {
            match change.range {
                None => self.text = change.text,
                Some(Positions { start, end }) => {
                    let range = LineStarts::of(&self.text).range(&self.text, start.into(), end.into());
                    self.text.replace_range(range, &change.text);
                }
            }
        }
    }
}

/// All open documents, by their URIs, written as the client writes them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Documents {
    pub(crate) open: BTreeMap<String, Document>,
    /// Robot in the client's settings, for plans without an `mdle.toml`.
    pub(crate) robot: Option<String>,
}

/// A plan file, with its robot.
#[derive(Debug)]
pub(crate) struct Plan {
    pub(crate) input: Input,
    pub(crate) target: Target,
}

impl Documents {
    /// Reads the plan in an open document.
    pub(crate) fn plan(&self, document: &Document) -> Result<Plan, InputError> {
        self.with_robot(document, self.robot(&document.path)?)
    }

    /// Reads the plan in an open document. If the document's robot is unknown, assumes a robot with every capability.
    pub(crate) fn plan_for_any(&self, document: &Document) -> Result<Plan, InputError> {
        let robot = self.robot(&document.path).or_else(|_| target(None))?;
        self.with_robot(document, robot)
    }

    fn with_robot(&self, document: &Document, target: Target) -> Result<Plan, InputError> {
        let input = plan(&document.path, document.text.clone(), &target)?.with_unsaved(self.unsaved());
        Ok(Plan { input, target })
    }

    /// Returns the robot in the `mdle.toml` next to a plan; if there is no such file, the robot in the client's
    /// settings.
    fn robot(&self, path: &Path) -> Result<Target, InputError> {
        let settings = Settings::beside(path)?;
        let option = self.robot.as_deref().filter(|_| !settings.names_target(None));
        settings.target(option)
    }

    /// Returns the texts of the open documents.
    fn unsaved(&self) -> Unsaved {
        let mut unsaved = Unsaved::default();
        self.open.values().for_each(|document| unsaved.insert(&document.path, &document.text));
        unsaved
    }

    /// Returns the URI of a file; for an open document, the URI as the client writes it.
    pub(crate) fn uri(&self, path: &Path) -> String {
        let at = place(path).ok();
        let mut open = self.open.iter();
        let own =
            open.find(|(_, document)| document.path == path || (at.is_some() && place(&document.path).ok() == at));
        own.map_or_else(|| uri::of(path), |(uri, _)| uri.clone())
    }

    /// Returns the plan files that may use each other: the open files, and all plan files in their folders and
    /// subfolders.
    pub(crate) fn project(&self) -> BTreeSet<PathBuf> {
        let mut files: BTreeSet<PathBuf> = self.open.values().map(|document| document.path.clone()).collect();
        let folders: BTreeSet<_> = files.iter().filter_map(|file| file.parent()).map(Path::to_owned).collect();
        let mut left = MOST_FILES;
        folders
            .iter()
            .filter(|folder| folder.is_absolute())
            .for_each(|folder| plans_in(folder, 0, &mut left, &mut files));
        files
    }
}

/// Maximum number of directory entries that are examined below the folders of the open documents.
const MOST_FILES: usize = 10_000;
/// Maximum depth of the search below the folder of an open document, in levels of folders.
const DEEPEST: usize = 6;

/// Adds the plan files of a folder and of its subfolders to `files`.
#[allow(clippy::disallowed_methods, reason = "the files of a project are found by looking for them")]
fn plans_in(folder: &Path, depth: usize, left: &mut usize, files: &mut BTreeSet<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.filter_map(Result::ok) {
        *left = left.saturating_sub(1);
        if *left == 0 {
            return;
        }
        let (path, name) = (entry.path(), entry.file_name());
        let is_hidden = name.as_encoded_bytes().starts_with(b".") || name == "target" || name == "node_modules";
        match entry.file_type() {
            Ok(kind) if kind.is_dir() && !is_hidden && depth < DEEPEST => plans_in(&path, depth + 1, left, files),
            Ok(kind) if kind.is_file() && is_plan(&path) => {
                files.insert(path);
            }
            Ok(_) | Err(_) => {}
        }
    }
}

/// Returns `true` if a file has the name of a plan file.
fn is_plan(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "mdle") && !is_alphabet(path)
}

/// Returns `true` if a file is an alphabet, which is written in a different language.
pub(crate) fn is_alphabet(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name == "alphabet.mdle")
}
