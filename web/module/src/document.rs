//! Lets the compiler read the files of a page.

use std::collections::BTreeMap;

use mdle_compiler::alphabet::{Alphabet, did_you_mean};
use mdle_compiler::diagnostic::{Diagnostic, SourceId, Sources, has_errors};
use mdle_compiler::syntax::Loader;
use mdle_compiler::{Compiled, Limit, check_with, compile_within};
use mdle_language_service::view::{View, view};

use crate::draft::{FILE, PageFiles, looked_up};
use crate::robot::robot;

/// The file that is run, the files that it uses, and the files of its robot's alphabet.
pub(crate) struct Document<'d> {
    /// The texts of these files, for messages.
    pub(crate) sources: Sources,
    /// Identifier of the file that is run.
    pub(crate) source: SourceId,
    /// Alphabet of the robot.
    pub(crate) alphabet: &'static Alphabet,
    draft: &'d PageFiles,
    /// Plan files that were read. The keys are their paths without `.` and `..`.
    read: BTreeMap<String, SourceId>,
}

impl Loader for Document<'_> {
    fn find(&mut self, from: SourceId, path: &str) -> Result<SourceId, String> {
        let from = self.place(from).unwrap_or(FILE).to_owned();
        let (name, place) = looked_up(&from, path);
        let missing = || format!("there is no file `{name}`{}", did_you_mean(path, &self.draft.names()));
        let place = place.ok_or_else(missing)?;
        if let Some(source) = self.read.get(&place) {
            return Ok(*source);
        }
        let text = self.draft.at(&place).ok_or_else(missing)?;
        self.add(&name, place, text)
    }

    fn text(&self, source: SourceId) -> &str {
        self.sources.text(source)
    }
}

impl<'d> Document<'d> {
    /// Returns the document for a page's files.
    ///
    /// # Errors
    /// Fails if the text is too long, or if there is no such robot.
    pub(crate) fn of(draft: &'d PageFiles) -> Result<Self, String> {
        Self::for_robot(&draft.robot, draft)
    }

    /// Returns the document for a page's files, but for the robot `name` instead of the robot that the page selects.
    ///
    /// # Errors
    /// Fails if the text is too long, or if there is no such robot.
    pub(crate) fn for_robot(name: &str, draft: &'d PageFiles) -> Result<Self, String> {
        let robot = robot(name)?;
        let mut sources = Sources::default();
        for (name, text) in &robot.files {
            sources.add(name, text);
        }
        if let Some(refusal) = sources.refusal(FILE, draft.text.len()) {
            return Err(refusal);
        }
        let source = sources.add(FILE, &draft.text);
        let read = BTreeMap::from([(FILE.to_owned(), source)]);
        Ok(Self { sources, source, alphabet: &robot.alphabet, draft, read })
    }

    fn add(&mut self, name: &str, place: String, text: &str) -> Result<SourceId, String> {
        if let Some(refusal) = self.sources.refusal(name, text.len()) {
            return Err(refusal);
        }
        let source = self.sources.add(name, text);
        self.read.insert(place, source);
        Ok(source)
    }

    /// Returns the path of a plan file that was read, without `.` and `..`; `None` for other files.
    pub(crate) fn place(&self, source: SourceId) -> Option<&str> {
        self.read.iter().find(|(_, read)| **read == source).map(|(place, _)| place.as_str())
    }

    /// Returns the paths of all plan files that were read, without `.` and `..`.
    pub(crate) fn places(&self) -> BTreeMap<SourceId, String> {
        self.read.iter().map(|(place, source)| (*source, place.clone())).collect()
    }

    /// Returns the file in the page's editor, and `true` if this file is run or was read for the file that is run.
    ///
    /// # Errors
    /// Fails if there is no such file, or if it is too long.
    pub(crate) fn shown(&mut self) -> Result<(SourceId, bool), String> {
        let place = if self.draft.file.is_empty() { FILE } else { &self.draft.file };
        if let Some(source) = self.read.get(place) {
            return Ok((*source, true));
        }
        let text = self.draft.at(place).ok_or_else(|| format!("there is no file `{place}`"))?;
        self.add(place, place.to_owned(), text).map(|source| (source, false))
    }

    /// Returns the text of the file that is run.
    pub(crate) fn text(&self) -> &str {
        self.sources.text(self.source)
    }

    /// Returns the diagnostics of the file that is run, and of the files that it uses.
    pub(crate) fn check(&mut self) -> Vec<Diagnostic> {
        self.check_file(self.source)
    }

    /// Returns the diagnostics of a file, and of the files that it uses.
    pub(crate) fn check_file(&mut self, source: SourceId) -> Vec<Diagnostic> {
        let text = self.sources.text(source).to_owned();
        check_with(source, &text, self.alphabet, self)
    }

    /// Compiles the plan `wanted`, or the only plan that no other plan uses.
    ///
    /// # Errors
    /// Fails with the same messages that `mdlec` prints.
    pub(crate) fn compile(&mut self, wanted: Option<&str>, limit: Limit) -> Result<Compiled, String> {
        let text = self.text().to_owned();
        let (mut compiled, found) = compile_within(self.source, &text, self.alphabet, wanted, self, limit);
        if has_errors(&found) {
            return Err(self.rendered(&found));
        }
        let names: Vec<_> = compiled.iter().map(|compiled| compiled.plan.root.name.clone()).collect();
        match (compiled.pop(), compiled.is_empty()) {
            (Some(only), true) => Ok(only),
            (Some(_), false) => Err(format!("choose the plan to run: {}", names.join(", "))),
            (None, _) => Err("there is no plan to run: every plan is used by another or takes parameters".to_owned()),
        }
    }

    /// Returns diagnostics as text for a user.
    pub(crate) fn rendered(&self, found: &[Diagnostic]) -> String {
        found.iter().map(|diagnostic| self.sources.render(diagnostic)).collect::<Vec<_>>().join("\n")
    }

    /// Calls a feature of the language service with a view of a file.
    pub(crate) fn view<T>(&mut self, source: SourceId, feature: impl FnOnce(&View<'_>) -> T) -> T {
        let alphabet = self.alphabet;
        view(source, self, |document| &document.sources, alphabet, feature)
    }
}
