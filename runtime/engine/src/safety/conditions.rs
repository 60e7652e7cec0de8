//! The conditions of guards, compiled and loaded for a robot.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use mdle_compiler::alphabet;
use mdle_compiler::diagnostic::{Diagnostic, Severity, Sources};
use mdle_compiler::fsm;
use mdle_compiler::load::{self, LoadError, Loaded, LoadedPlan};
use mdle_runtime as runtime;
use mdle_runtime::{Machine, ModuleRead, Nanos, PUBLISHED, Plan as _};

use super::{Condition, Guard};

/// The conditions of the guards of a safety file.
pub struct Conditions<A: runtime::Alphabet> {
    loaded: Vec<Arc<Loaded<A>>>,
    /// Attributes of modules that they read.
    reads: &'static [ModuleRead],
}

/// The conditions in a run.
pub struct Watched<A: runtime::Alphabet> {
    loaded: Vec<Arc<Loaded<A>>>,
    /// A plan for each condition that never leaves its first atom, once there is an output.
    machines: Vec<Machine<LoadedPlan<A>>>,
    fired: Vec<bool>,
}

/// Reason why a guard cannot be watched.
#[derive(Debug)]
pub enum GuardError {
    /// The condition has errors, whose places are in the sources.
    Faulty(Vec<Diagnostic>),
    /// The condition depends on more than the output: the line of the safety file, and a sentence.
    Unfit(usize, String),
    /// The condition cannot be loaded.
    Load(LoadError),
}

impl<A: runtime::Alphabet> fmt::Debug for Conditions<A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Conditions of {} guards", self.loaded.len())
    }
}

impl<A: runtime::Alphabet> fmt::Debug for Watched<A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watched").field("fired", &self.fired).finish_non_exhaustive()
    }
}

impl<A: runtime::Alphabet> Conditions<A> {
    /// Compiles the conditions of guards in the safety file of this name, for the robot of `alphabet`, whose files are
    /// among `sources`.
    ///
    /// # Errors
    /// A condition has errors, or depends on more than the output of one turn.
    pub fn compile(
        file: &str,
        guards: &[Guard],
        sources: &mut Sources,
        alphabet: &alphabet::Alphabet,
    ) -> Result<Self, GuardError> {
        let loaded = guards.iter().map(|guard| compiled(file, &guard.when, sources, alphabet));
        let loaded: Vec<_> = loaded.collect::<Result<_, _>>()?;
        let reads: BTreeSet<_> =
            loaded.iter().flat_map(|loaded| runtime::Plan::reads(&loaded.plan())).copied().collect();
        if reads.len() > PUBLISHED {
            let line = guards.first().map_or(1, |guard| guard.when.line);
            let sentence =
                format!("the guards read {} attributes of modules, and {PUBLISHED} is the most", reads.len());
            return Err(GuardError::Unfit(line, sentence));
        }
        // A process reads one safety file.
        Ok(Self { loaded, reads: Vec::from_iter(reads).leak() })
    }

    /// Returns the conditions before the first output of a run.
    #[must_use]
    pub fn watch(&self) -> Watched<A> {
        Watched { loaded: self.loaded.clone(), machines: Vec::new(), fired: Vec::new() }
    }

    /// Returns the attributes of modules that the conditions read.
    #[must_use]
    pub fn reads(&self) -> &'static [ModuleRead] {
        self.reads
    }
}

impl<A: runtime::Alphabet> Watched<A> {
    /// Returns for each guard `true` if its condition is true of the output `y`.
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

/// Compiles a condition, as the interrupt of a plan that stands still.
fn compiled<A: runtime::Alphabet>(
    file: &str,
    condition: &Condition,
    sources: &mut Sources,
    alphabet: &alphabet::Alphabet,
) -> Result<Arc<Loaded<A>>, GuardError> {
    let Condition { text, line, indent } = condition;
    // The condition is in the line and the column that it has in the file, so that messages show its place.
    let (above, head) = if *line > 1 { (line - 2, "{ Guard (\n") } else { (0, "{ Guard (") };
    let indent = if *line > 1 { *indent } else { indent.saturating_sub(head.len()) };
    let plan = format!("{}{head}{}{text}\n) (Atom (wait inf) stop) }}\n", "\n".repeat(above), " ".repeat(indent));
    let source = sources.add(file, plan.as_str());
    let (plans, mut diagnostics) = mdle_compiler::compile(source, &plan, alphabet, None);
    diagnostics.retain(|diagnostic| diagnostic.code.severity() == Severity::Error);
    let machine = match (plans.as_slice(), diagnostics.as_slice()) {
        ([plan], []) if plan.machine.atoms().count() == 1 => &plan.machine,
        (_, []) => return Err(GuardError::Unfit(*line, "`when` has to be one condition".to_owned())),
        _ => return Err(GuardError::Faulty(diagnostics)),
    };
    let rows = fsm::rows(machine);
    let guard = rows.guards.iter().take(1).map(|guard| &guard.condition);
    if let Some(word) = guard.chain(&rows.operands).find_map(memory) {
        let message = format!("`when` may not contain `{word}`: a guard is about the output of one turn");
        return Err(GuardError::Unfit(*line, message));
    }
    load::load(machine, sources, alphabet).map(Arc::new).map_err(GuardError::Load)
}

/// Returns the word of an operand that depends on more than the output.
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
