//! Launches a session: compiles the plan and reads the script.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use mdle_compiler::Compiled;
use mdle_compiler::diagnostic::{Diagnostic, SourceId, Sources, Span, has_errors, judged, most_shown};
use mdle_compiler::plan::{Condition, RecordId};
use mdle_compiler::trace::{Reports, Script};
use mdle_files::read::LARGEST_DATA;
use mdle_files::{Input, InputError, Settings};
use mdle_language_service::lines::LineStarts;
use serde::Deserialize;

/// Arguments of the request `launch`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Launch {
    /// Path of the plan file.
    program: PathBuf,
    /// Path of the script.
    script: PathBuf,
    /// Robot to use for a plan without an `mdle.toml`.
    target: Option<String>,
    /// Name of the plan; required if the file contains several plans.
    plan: Option<String>,
    /// `true` to stop at the entry of the plan.
    #[serde(default)]
    pub(crate) stop_on_entry: bool,
}

/// A compiled plan with its script.
#[derive(Debug)]
pub(crate) struct LaunchedPlan {
    pub(crate) compiled: Compiled,
    input: Input,
    script: Script,
    /// Positions of the lines of each file that was read.
    lines: BTreeMap<SourceId, LineStarts>,
    /// Texts of the `after` conditions. The key of each text is the fact that the condition tests.
    facts: BTreeMap<(RecordId, u32), String>,
}

impl LaunchedPlan {
    /// Compiles the plan and reads the script.
    ///
    /// # Errors
    /// Fails if a file cannot be read or contains errors; the message has one line for each error.
    pub(crate) fn read(launch: &Launch) -> Result<Self, String> {
        let Launch { program, script, target, plan, .. } = launch;
        let settings = Settings::beside(program).map_err(words)?;
        let target = target.as_deref().filter(|target| !target.is_empty() && !settings.names_target(None));
        let target = settings.target(target).map_err(words)?;
        let mut input = mdle_files::read_plan(program, &target).map_err(words)?;
        let plan = plan.as_deref().filter(|plan| !plan.is_empty());
        if let Some(plan) = plan {
            input.must_have(plan).map_err(words)?;
        }
        let (compiled, found) = input.compile(&target.alphabet, plan);
        if has_errors(&found) {
            return Err(rendered(&input.sources, &found));
        }
        let named = compiled.into_iter().map(|compiled| (compiled.plan.root.name.clone(), compiled)).collect();
        let compiled: Compiled = input.only(named).map_err(words)?;
        let text = mdle_files::read_text(script, LARGEST_DATA).map_err(words)?;
        let script = Script::read(&text)
            .and_then(|script| compiled.worded(script, &target.alphabet))
            .map_err(|error| format!("{}:{}: {}", launch.script.display(), error.line, error.message))?;
        if script.turns().is_empty() {
            return Err(format!(
                "{}: the script has no turns\nhelp: a turn is a line such as {{\"t\": 0.0, \"fired\": [\"bumper\"]}}",
                launch.script.display()
            ));
        }
        let facts = facts(&compiled);
        let mut loaded = Self { compiled, input, script, lines: BTreeMap::new(), facts };
        loaded.lines =
            loaded.sources().into_iter().map(|source| (source, LineStarts::of(loaded.text(source)))).collect();
        Ok(loaded)
    }

    /// Returns the turns of the script; there is at least one.
    pub(crate) fn turns(&self) -> &[Reports] {
        self.script.turns()
    }

    /// Returns the files that contain parts of the plan.
    fn sources(&self) -> Vec<SourceId> {
        let mut sources: Vec<_> =
            self.compiled.plan.parts().map(|part| self.input.sources.range(part.span()).0).collect();
        sources.sort();
        sources.dedup();
        sources
    }

    fn text(&self, source: SourceId) -> &str {
        self.input.sources.text(source)
    }

    /// Returns the text of the part of a file that `span` describes.
    pub(crate) fn slice(&self, span: Span) -> &str {
        self.input.sources.slice(span)
    }

    /// Returns the absolute path of a file.
    pub(crate) fn path(&self, source: SourceId) -> Option<PathBuf> {
        std::path::absolute(self.input.path(source)?).ok()
    }

    /// Returns the file at a path; `None` if it contains no part of the plan.
    pub(crate) fn source(&self, path: &Path) -> Option<SourceId> {
        let place = mdle_files::place(path).ok()?;
        let is_there = |source: &SourceId| {
            self.input.path(*source).and_then(|path| mdle_files::place(path).ok()).is_some_and(|found| found == place)
        };
        self.lines.keys().copied().find(is_there)
    }

    /// Returns the file of a span, and the line and column of its start, both counted from 0. The column is counted in
    /// UTF-16 units.
    pub(crate) fn place(&self, span: Span) -> (SourceId, u32, u32) {
        let (source, range) = self.input.sources.range(span);
        let at = self.lines.get(&source).map(|lines| lines.position(self.text(source), range.start));
        (source, at.map_or(0, |at| at.line), at.map_or(0, |at| at.character))
    }

    /// Returns the `after` conditions that test facts of a record, with the numbers of the facts.
    pub(crate) fn facts(&self, record: RecordId) -> impl Iterator<Item = (u32, &str)> {
        self.facts.range((record, 0)..=(record, u32::MAX)).map(|((_, fact), text)| (*fact, text.as_str()))
    }
}

/// Returns the texts of a plan's `after` conditions. The key of each text is the fact that the condition tests.
fn facts(compiled: &Compiled) -> BTreeMap<(RecordId, u32), String> {
    let mut facts = BTreeMap::new();
    for interrupt in compiled.plan.parts().filter_map(mdle_compiler::plan::PlanPart::interrupt) {
        interrupt.condition.fold((), &mut |(), part| {
            if let Condition::After(after) = part {
                facts.insert((after.record, after.fact), after.text.clone());
            }
        });
    }
    facts
}

/// Returns the diagnostics of an invalid plan as text, followed by the number of errors.
fn rendered(sources: &Sources, found: &[Diagnostic]) -> String {
    let shown = found.iter().take(most_shown(found)).map(|found| sources.render(found));
    shown.chain(judged(found, false).err()).collect::<Vec<_>>().join("\n")
}

/// Converts an error to text: a message if the file cannot be read, or the diagnostics if the file contains errors.
fn words(error: InputError) -> String {
    let own = error.to_string();
    let found = error.faulty_file().map(|file| rendered(&file.sources, &file.diagnostics));
    found.into_iter().chain(Some(own).filter(|own| !own.is_empty())).collect::<Vec<_>>().join("\n")
}
