//! The text of the editor as a plan file.

use mdle_compiler::alphabet::Alphabet;
use mdle_compiler::diagnostic::{Diagnostic, SourceId, Sources, has_errors};
use mdle_compiler::syntax::Loader;
use mdle_compiler::{Compiled, Limit, check_with, compile_within};
use mdle_language_service::view::{View, view};

use crate::robot::robot;

/// Name of the file in messages.
pub(crate) const FILE: &str = "plan.mdle";

/// A text with the files of its robot's alphabet.
pub(crate) struct Document {
    /// All these files.
    pub(crate) sources: Sources,
    /// The text.
    pub(crate) source: SourceId,
    /// Alphabet of the robot.
    pub(crate) alphabet: &'static Alphabet,
}

impl Loader for Document {
    fn find(&mut self, _: SourceId, path: &str) -> Result<SourceId, String> {
        Err(format!("`{path}` cannot be used: the playground has one file"))
    }

    fn text(&self, source: SourceId) -> &str {
        self.sources.text(source)
    }
}

impl Document {
    /// Makes the document of a text.
    ///
    /// # Errors
    /// The text is too long: a sentence.
    pub(crate) fn of(text: &str) -> Result<Self, String> {
        let robot = robot()?;
        let mut sources = Sources::default();
        for (name, text) in &robot.files {
            sources.add(name, text);
        }
        if let Some(refusal) = sources.refusal(FILE, text.len()) {
            return Err(refusal);
        }
        let source = sources.add(FILE, text);
        Ok(Self { sources, source, alphabet: &robot.alphabet })
    }

    /// Returns the text.
    pub(crate) fn text(&self) -> &str {
        self.sources.text(self.source)
    }

    /// Returns the diagnostics of the text.
    pub(crate) fn check(&mut self) -> Vec<Diagnostic> {
        let text = self.text().to_owned();
        check_with(self.source, &text, self.alphabet, self)
    }

    /// Compiles the plan `wanted`, or the only plan that no other plan uses.
    ///
    /// # Errors
    /// Messages as `mdlec` prints them.
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

    /// Returns diagnostics as people read them.
    pub(crate) fn rendered(&self, found: &[Diagnostic]) -> String {
        found.iter().map(|diagnostic| self.sources.render(diagnostic)).collect::<Vec<_>>().join("\n")
    }

    /// Shows the document to a feature of the language service.
    pub(crate) fn view<T>(&mut self, feature: impl FnOnce(&View<'_>) -> T) -> T {
        let (source, alphabet) = (self.source, self.alphabet);
        view(source, self, |document| &document.sources, alphabet, feature)
    }
}
