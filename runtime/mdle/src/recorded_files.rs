//! Compiles plans from texts in a record instead of files on the disk.

use std::path::{Path, PathBuf};

use mdle_compiler::alphabet::Alphabet;
use mdle_compiler::diagnostic::{Diagnostic, SourceId, Sources, judged};
use mdle_compiler::fsm::Machine;
use mdle_compiler::syntax::Loader;
use mdle_compiler::{Compiled, compile_with};
use mdle_files::{InputError, Target, normal};

use crate::failure::{self, Failure};

/// Compiles the plan `wanted` from `files`; the first file is the plan's own file. Without a name, compiles the only
/// plan that no other plan uses.
///
/// # Errors
/// Fails if the plan has errors, or if there is no plan.
pub(crate) fn compiled(
    files: &[(String, String)],
    wanted: Option<&str>,
    target: &Target,
) -> Result<(Machine, Sources), Failure> {
    let Some((own, used)) = files.split_first() else {
        return Err(Failure::Usage("the record does not have the text of a plan that took over".to_owned()));
    };
    let mut files = RecordedFiles::new(own, used, target);
    let (plans, diagnostics) = files.compile(&target.alphabet, wanted);
    let machine = only(plans, &diagnostics, &files.sources, wanted)?;
    Ok((machine, files.sources))
}

/// Returns the machine of the only plan. If the diagnostics contain errors, prints them.
///
/// # Errors
/// Fails if the plan has errors, or if there is no plan.
pub(crate) fn only(
    plans: Vec<Compiled>,
    diagnostics: &[Diagnostic],
    sources: &Sources,
    wanted: Option<&str>,
) -> Result<Machine, Failure> {
    // Warnings were already printed before the run.
    if let Err(sentence) = judged(diagnostics, false) {
        failure::print(sources, diagnostics);
        failure::error(&sentence);
        return Err(Failure::Plan);
    }
    let only = plans.into_iter().next().map(|compiled| compiled.machine);
    let name = || InputError::Unusable(format!("the record has no plan `{}`", wanted.unwrap_or_default()));
    Ok(only.ok_or_else(name)?)
}

/// The files of a plan, as its record contains them.
struct RecordedFiles<'b> {
    sources: Sources,
    own: SourceId,
    /// Files that the plan uses, with their names in the record.
    used: &'b [(String, String)],
    /// Names of the files that have been added to the sources.
    names: Vec<(SourceId, PathBuf)>,
}

impl<'b> RecordedFiles<'b> {
    fn new((name, text): &(String, String), used: &'b [(String, String)], target: &Target) -> Self {
        let mut sources = target.sources();
        let own = sources.add(name.clone(), text.clone());
        Self { sources, own, used, names: vec![(own, normal(Path::new(name)))] }
    }

    fn compile(&mut self, alphabet: &Alphabet, wanted: Option<&str>) -> (Vec<Compiled>, Vec<Diagnostic>) {
        let text = self.sources.text(self.own).to_owned();
        compile_with(self.own, &text, alphabet, wanted, self)
    }
}

impl Loader for RecordedFiles<'_> {
    fn find(&mut self, from: SourceId, path: &str) -> Result<SourceId, String> {
        let folder = self.names.iter().find(|(source, _)| *source == from).and_then(|(_, name)| name.parent());
        // Plans may name the same file in different ways, and the record contains only the first of these names.
        let name = normal(&folder.unwrap_or(Path::new("")).join(path));
        if let Some((source, _)) = self.names.iter().find(|(_, known)| *known == name) {
            return Ok(*source);
        }
        let text = self.used.iter().find(|(known, _)| normal(Path::new(known)) == name).map(|(_, text)| text);
        let text = text.ok_or_else(|| format!("the record has no file `{}`", name.display()))?;
        let source = self.sources.add(name.display().to_string(), text.clone());
        self.names.push((source, name));
        Ok(source)
    }

    fn text(&self, source: SourceId) -> &str {
        self.sources.text(source)
    }
}
