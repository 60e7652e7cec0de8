//! Compiles and loads the conditions of guards for a robot.

use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use mdle_compiler::alphabet;
use mdle_compiler::diagnostic::{Diagnostic, Severity, SourceId, Sources, Span, has_errors};
use mdle_compiler::fsm;
use mdle_compiler::load::{self, LoadError, Loaded, LoadedPlan};
use mdle_runtime as runtime;
use mdle_runtime::{Machine, ModuleRead, Nanos, PUBLISHED, Plan as _};

use super::{ConditionText, Guard};

/// Conditions of the guards in a safety file.
pub struct Conditions<A: runtime::Alphabet> {
    loaded: Vec<Arc<Loaded<A>>>,
    /// Module attributes that the conditions read.
    reads: &'static [ModuleRead],
    warnings: Vec<Diagnostic>,
}

/// Conditions of guards, which are evaluated in each turn of a run.
pub struct WatchedConditions<A: runtime::Alphabet> {
    loaded: Vec<Arc<Loaded<A>>>,
    /// For each condition, a plan that never leaves its first atom; empty before the first output.
    machines: Vec<Machine<LoadedPlan<A>>>,
    fired: Vec<bool>,
}

/// Reason why the condition of a guard cannot be used.
#[derive(Debug)]
pub enum GuardError {
    /// The condition has errors; contains diagnostics with spans in the sources.
    Faulty(Vec<Diagnostic>),
    /// The condition is not permitted for a guard, for example because it depends on more than the output; contains the
    /// line in the safety file, and a sentence.
    Unfit(usize, String),
    /// The condition cannot be loaded; contains the reason.
    Load(LoadError),
}

impl<A: runtime::Alphabet> fmt::Debug for Conditions<A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Conditions of {} guards", self.loaded.len())
    }
}

impl<A: runtime::Alphabet> fmt::Debug for WatchedConditions<A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WatchedConditions").field("fired", &self.fired).finish_non_exhaustive()
    }
}

impl<A: runtime::Alphabet> Conditions<A> {
    /// Compiles the conditions of guards in the safety file with this name and text, for the robot of `alphabet`. The
    /// files of the alphabet have to be among `sources`.
    ///
    /// # Errors
    /// Fails if a condition has errors, depends on more than the output of one turn or cannot be loaded, or if the
    /// guards read too many module attributes.
    pub fn compile(
        (name, text): (&str, &str),
        guards: &[Guard],
        sources: &mut Sources,
        alphabet: &alphabet::Alphabet,
    ) -> Result<Self, GuardError> {
        let file = sources.add(name, text);
        let (mut loaded, mut warnings) = (Vec::new(), Vec::new());
        for Guard { when, .. } in guards {
            let (condition, diagnostics) = compiled(file, when, sources, alphabet)?;
            loaded.push(condition);
            warnings.extend(diagnostics);
        }
        let reads: BTreeSet<_> =
            loaded.iter().flat_map(|loaded| runtime::Plan::reads(&loaded.plan())).copied().collect();
        if reads.len() > PUBLISHED {
            let line = guards.first().map_or(1, |guard| guard.when.line);
            let sentence =
                format!("the guards read {} attributes of modules, and {PUBLISHED} is the most", reads.len());
            return Err(GuardError::Unfit(line, sentence));
        }
        // The leaked memory is small: a process reads only one safety file.
        Ok(Self { loaded, reads: Vec::from_iter(reads).leak(), warnings })
    }

    /// Returns the warnings about the conditions, with spans in the sources.
    #[must_use]
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Returns the conditions for a new run, which has no output yet.
    #[must_use]
    pub fn watch(&self) -> WatchedConditions<A> {
        WatchedConditions { loaded: self.loaded.clone(), machines: Vec::new(), fired: Vec::new() }
    }

    /// Returns the module attributes that the conditions read.
    #[must_use]
    pub fn reads(&self) -> &'static [ModuleRead] {
        self.reads
    }
}

impl<A: runtime::Alphabet> WatchedConditions<A> {
    /// Returns, for each guard, `true` if its condition is true for the output `y`.
    pub fn fired(&mut self, y: &A::Output, t: Nanos) -> &[bool] {
        let Self { loaded, machines, fired } = self;
        if machines.is_empty() {
            machines.extend(loaded.iter().map(|loaded| Machine::begin(loaded.plan(), y, t)));
        }
        fired.clear();
        fired.extend(machines.iter().map(|machine| machine.plan().next(machine.cursor(), y, t).is_some()));
        fired
    }
}

/// Compiles a condition of the safety file `file` as the interrupt of a plan that only stops the robot; returns the
/// condition and the warnings about it.
fn compiled<A: runtime::Alphabet>(
    file: SourceId,
    condition: &ConditionText,
    sources: &mut Sources,
    alphabet: &alphabet::Alphabet,
) -> Result<(Arc<Loaded<A>>, Vec<Diagnostic>), GuardError> {
    let line = condition.line;
    let plan = format!("{BEFORE}{}\n) (Atom (wait inf) stop) }}\n", condition.text);
    let source = sources.add(format!("line {line}"), plan.as_str());
    let (plans, diagnostics) = mdle_compiler::compile(source, &plan, alphabet, None);
    let placed = PlacedCondition { file, plan: source, condition, sources };
    let mut warnings: Vec<_> = diagnostics.into_iter().filter_map(|diagnostic| placed.moved(diagnostic)).collect();
    let machine = match plans.as_slice() {
        _ if has_errors(&warnings) => {
            warnings.retain(|diagnostic| diagnostic.code.severity() == Severity::Error);
            return Err(GuardError::Faulty(warnings));
        }
        [plan] if plan.machine.atoms().count() == 1 => &plan.machine,
        _ => return Err(GuardError::Unfit(line, "`when` has to be one condition".to_owned())),
    };
    let rows = fsm::rows(machine);
    let guard = rows.guards.iter().take(1).map(|guard| &guard.condition);
    if let Some(word) = guard.chain(&rows.operands).find_map(memory) {
        let message = format!("`when` may not contain `{word}`: a guard is about the output of one turn");
        return Err(GuardError::Unfit(line, message));
    }
    let loaded = load::load(machine, sources, alphabet).map_err(GuardError::Load)?;
    Ok((Arc::new(loaded), warnings))
}

/// Text before the condition in the plan that is generated for a condition.
const BEFORE: &str = "{ Guard (";

/// A condition, the plan that is generated for it, and the safety file that contains it.
struct PlacedCondition<'c> {
    file: SourceId,
    plan: SourceId,
    condition: &'c ConditionText,
    sources: &'c Sources,
}

impl PlacedCondition<'_> {
    /// Converts a diagnostic about the generated plan to a diagnostic about the safety file. Returns `None` for a
    /// warning that is not about the condition.
    fn moved(&self, mut diagnostic: Diagnostic) -> Option<Diagnostic> {
        let span = diagnostic.span()?;
        let end = BEFORE.len() + self.condition.text.len();
        let (source, Range { start, .. }) = self.sources.range(span);
        let is_inside = source == self.plan && (BEFORE.len()..end).contains(&start);
        if diagnostic.code.severity() == Severity::Warning && !is_inside {
            return None;
        }
        if start >= end {
            // The bracket exists only in the generated plan.
            diagnostic.message = diagnostic.message.replace("found `)`", "found the end of `when`");
        }
        let edits = diagnostic.help.iter_mut().filter_map(|help| help.edit.as_mut());
        let spans = diagnostic.labels.iter_mut().map(|label| &mut label.span).chain(edits.map(|edit| &mut edit.span));
        spans.for_each(|span| *span = self.in_file(*span));
        Some(diagnostic)
    }

    /// Converts a span in the generated plan to the corresponding span in the safety file.
    fn in_file(&self, span: Span) -> Span {
        let ConditionText { text, bytes, .. } = self.condition;
        let (source, Range { start, end }) = self.sources.range(span);
        if source != self.plan {
            return span;
        }
        if text.len() != bytes.len() {
            return Span::new(self.file, bytes.start, bytes.end);
        }
        let place = |byte: usize| bytes.start + byte.saturating_sub(BEFORE.len()).min(text.len());
        Span::new(self.file, place(start), place(end))
    }
}

/// Returns the keyword of an operand that depends on more than the output of one turn; `None` for any other operand.
fn memory<I>(operand: &runtime::Condition<I>) -> Option<&'static str> {
    match operand {
        runtime::Condition::Null
        | runtime::Condition::Quark(_)
        | runtime::Condition::Or(..)
        | runtime::Condition::And(..)
        | runtime::Condition::Not(_) => None,
        runtime::Condition::Wait(_) => Some("wait"),
        runtime::Condition::Elapsed(..) => Some("t"),
        runtime::Condition::Driven(..) => Some("way"),
        runtime::Condition::Lasting(..) => Some("stuck"),
        runtime::Condition::Rising(..) => Some("RISING"),
        runtime::Condition::After(..) => Some("after"),
    }
}
