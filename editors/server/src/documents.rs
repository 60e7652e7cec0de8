//! The documents that are open in the editor, and what they need to be checked: the robot, and each other's texts.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use mdle_files::{Input, InputError, Settings, Target, Unsaved, place, plan, target};
use serde::Deserialize;

use crate::uri;
use mdle_language_service::lines::{Lines, Position};

/// A document that is open in the editor.
#[derive(Debug, Clone)]
pub(crate) struct Document {
    pub(crate) path: PathBuf,
    pub(crate) text: String,
    pub(crate) version: i64,
}

/// An edit of the protocol: without a range it replaces the text.
#[derive(Debug, Deserialize)]
pub(crate) struct Change {
    range: Option<Positions>,
    text: String,
}

/// Two positions of the protocol.
#[derive(Debug, Clone, Copy, Deserialize)]
pub(crate) struct Positions {
    pub(crate) start: At,
    pub(crate) end: At,
}

/// A position of the protocol.
#[derive(Debug, Clone, Copy, Deserialize)]
pub(crate) struct At {
    line: u32,
    character: u32,
}

impl From<At> for Position {
    fn from(at: At) -> Self {
        Self { line: at.line, character: at.character }
    }
}

impl Document {
    /// Makes the edits, each in the text that the one before it left.
    pub(crate) fn change(&mut self, changes: Vec<Change>) {
        for change in changes {
            match change.range {
                None => self.text = change.text,
                Some(Positions { start, end }) => {
                    let range = Lines::of(&self.text).range(&self.text, start.into(), end.into());
                    self.text.replace_range(range, &change.text);
                }
            }
        }
    }
}

/// All open documents by their URIs, as the client writes them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Documents {
    pub(crate) open: BTreeMap<String, Document>,
    /// Robot that the client's settings name, for plans without an `mdle.toml`.
    pub(crate) robot: Option<String>,
}

/// A plan file with its robot.
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

    /// Reads the plan in an open document, for a robot with every capability if the document's own is unknown.
    pub(crate) fn plan_for_any(&self, document: &Document) -> Result<Plan, InputError> {
        let robot = self.robot(&document.path).or_else(|_| target(None))?;
        self.with_robot(document, robot)
    }

    fn with_robot(&self, document: &Document, target: Target) -> Result<Plan, InputError> {
        let input = plan(&document.path, document.text.clone(), &target)?.with_unsaved(self.unsaved());
        Ok(Plan { input, target })
    }

    /// The robot of the `mdle.toml` beside a plan, or else that of the client's settings.
    fn robot(&self, path: &Path) -> Result<Target, InputError> {
        let settings = Settings::beside(path)?;
        let option = self.robot.as_deref().filter(|_| !settings.names_target(None));
        settings.target(option)
    }

    /// Texts of the open documents.
    fn unsaved(&self) -> Unsaved {
        let mut unsaved = Unsaved::default();
        self.open.values().for_each(|document| unsaved.insert(&document.path, &document.text));
        unsaved
    }

    /// URI of a file: that of the open document if there is one.
    pub(crate) fn uri(&self, path: &Path) -> String {
        let at = place(path).ok();
        let mut open = self.open.iter();
        let own =
            open.find(|(_, document)| document.path == path || (at.is_some() && place(&document.path).ok() == at));
        own.map_or_else(|| uri::of(path), |(uri, _)| uri.clone())
    }

    /// Plan files that may use each other: the open ones, and those in the same folders and below.
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

/// Maximum number of entries that are looked at in the folders of the open documents.
const MOST_FILES: usize = 10_000;
/// Number of levels of folders that are searched below the folder of an open document.
const DEEPEST: usize = 6;

/// Adds the plan files of a folder.
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

/// Returns `true` for a file of plans, by its name.
fn is_plan(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "mdle") && !is_alphabet(path)
}

/// Returns `true` for the file of an alphabet, which is written in a language of its own.
pub(crate) fn is_alphabet(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name == "alphabet.mdle")
}
