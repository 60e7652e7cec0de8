//! Compiles and loads plans while the robot runs. These are the plans of a session, and plans that other robots send.
//! Their texts are compiled in the same way as the text of the first plan.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use codespan_reporting::term::termcolor::NoColor;
use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::analysis::analyze;
use mdle_compiler::diagnostic::{Code, Diagnostic, Sources, judged};
use mdle_compiler::fsm::{self, Machine};
use mdle_compiler::load::{self, LoadError, Loaded, NameBudget};
use mdle_compiler::plan::Bounds;
use mdle_engine::{CompiledPlans, EngineAlphabet, PlanFacts, PlanSource, Plans, StoredPlan};
use mdle_files::{FaultyFile, Input, InputError, Target, plan, read_plan};
use mdle_host::Refusal;

/// Name, in diagnostics, of a text that a user has typed.
const TYPED: &str = "main";
/// Bounds on a plan that another robot sends. They are needed because a short text may require much memory if its plans
/// use other plans.
const SENT: Bounds = Bounds { brackets: 10_000, operands: 10_000, text: 1_000_000, is_written_free: false };

/// Maximum total length, in bytes, of the new names of modules in the plans of one robot. The process keeps these names
/// until it ends.
const NEW_NAMES: usize = 10_000;

/// Stores the first plan of a run, and permits loading further plans for `target`. Plans that other robots send may
/// name only the robots `robots`.
///
/// # Errors
/// Fails if the system cannot create the compiler's thread.
pub(crate) fn begin<A: EngineAlphabet>(
    plans: &mut Plans<A>,
    first: StoredPlan<A>,
    target: &Arc<Target>,
    robots: Vec<String>,
) -> Result<(), Refusal> {
    let (target, known) = (Arc::clone(target), PermittedNames::of(plans, robots));
    let started = plans.compile_with(Box::new(move |source| compiled(source, &target, &known)));
    started.map_err(|error| Refusal::Fault(format!("the system gives no thread for the compiler: {error}")))?;
    plans.store(first).map_err(Refusal::Fault)
}

/// Permits other robots to send plans for `target`; these plans may name only the robots `robots`. Used in simulated
/// time, because turns wait until a sent plan is compiled.
pub(crate) fn begin_at_once<A: EngineAlphabet>(plans: &mut Plans<A>, target: &Arc<Target>, robots: Vec<String>) {
    let (target, known) = (Arc::clone(target), PermittedNames::of(plans, robots));
    plans.compile_at_once_with(Box::new(move |source| compiled(source, &target, &known)));
}

/// Compiles a text, and loads the plans that no other plan of the text uses. A plan from another robot may use only the
/// names in `known`.
///
/// # Errors
/// Fails with a message and the diagnostics, as `mdlec check` prints them.
fn compiled<A: EngineAlphabet>(
    source: &PlanSource,
    target: &Target,
    known: &PermittedNames,
) -> Result<CompiledPlans<A>, String> {
    let sender = if let PlanSource::Peer { robot, .. } = source { Some(robot.as_str()) } else { None };
    let is_sent = sender.is_some();
    let input = match source {
        PlanSource::File(path) => read_plan(path, target),
        PlanSource::Text(text) => plan(Path::new(TYPED), text.clone(), target),
        PlanSource::Peer { robot, text } => {
            plan(Path::new(&format!("plan of {robot}")), text.clone(), target).map(Input::alone)
        }
    };
    let mut input = input.map_err(unread)?;
    let (machines, diagnostics) = if is_sent {
        one_of(&input.roots(&target.alphabet))?;
        input.compile_bounded(&target.alphabet, SENT)
    } else {
        input.compile(&target.alphabet, None)
    };
    let warnings = rendered(&input.sources, &diagnostics);
    if let Err(count) = judged(&diagnostics, false) {
        return Err(faulty(&count, &warnings));
    }
    // For a sent plan, a warning that it never ends counts as an error, because nobody at this robot reads it. The
    // analysis also finds plans without such a warning, as an endless loop is assumed to be intended.
    let is_endless = |machine: &Machine| analyze(machine).shortest.is_none();
    let is_warned = diagnostics.iter().any(|diagnostic| diagnostic.code == Code::W0201);
    if is_sent && (is_warned || machines.iter().any(|compiled| is_endless(&compiled.machine))) {
        let help = "help: give the plan a condition that ends it, as in `{ Name (wait 10min) … }`";
        return Err(format!("the plan never ends, and nothing has changed\n{warnings}{help}"));
    }
    let machines = machines.into_iter().map(|compiled| (compiled.plan.root.name, compiled.machine));
    let machines: Vec<_> = machines.collect();
    if machines.is_empty() {
        return Err(input.only::<()>(Vec::new()).err().map(unread).unwrap_or_default());
    }
    let files: Arc<[(String, String)]> = texts(&input).into();
    let load = |machine: &Machine| match sender {
        Some(sender) => known.load(sender, machine, &input, target),
        None => load::load(machine, &input.sources, &target.alphabet).map_err(|error| error.to_string()),
    };
    let plans = machines.into_iter().map(|(name, machine)| {
        let loaded = Arc::new(load(&machine)?);
        // A sent plan is not stored, so that nobody reads its facts.
        let facts = if is_sent { PlanFacts::default() } else { facts(&machine, &warnings) };
        Ok(StoredPlan { name: name.into(), files: Arc::clone(&files), loaded, facts })
    });
    Ok(CompiledPlans { plans: plans.collect::<Result<_, String>>()?, warnings })
}

/// Returns the facts about a plan, for the operator. `warnings` are the warnings about the plan's file, as `mdlec
/// check` prints them.
pub(crate) fn facts(machine: &Machine, warnings: &str) -> PlanFacts {
    let warnings = if warnings.is_empty() { "no warnings" } else { warnings.trim_end() };
    PlanFacts { diagnostics: warnings.into(), analysis: analyze(machine).figures().trim_end().into() }
}

/// The names that plans from other robots may use.
struct PermittedNames {
    robots: Vec<String>,
    /// Names of the paths that the run's first plan replays.
    paths: Vec<&'static str>,
    /// For each sender, the remaining budget for new names, which stay in memory until the process ends.
    budgets: RefCell<BTreeMap<String, NameBudget>>,
}

impl PermittedNames {
    /// Returns the names that plans from other robots may use: `robots`, and the paths that the first plan replays.
    fn of<A: EngineAlphabet>(plans: &Plans<A>, robots: Vec<String>) -> Self {
        Self { robots, paths: plans.paths().to_vec(), budgets: RefCell::default() }
    }

    /// Loads the plan that another robot has sent, after checking the names that the process would keep.
    ///
    /// # Errors
    /// Fails with a message if the plan contains unknown names or too many new names, or if it cannot be loaded.
    fn load<A: EngineAlphabet>(
        &self,
        sender: &str,
        machine: &Machine,
        input: &Input,
        target: &Target,
    ) -> Result<Loaded<A>, String> {
        let robots: Vec<&str> = self.robots.iter().map(String::as_str).collect();
        if let Some(unknown) = fsm::other_robots(machine).into_iter().find(|name| !robots.contains(name)) {
            let near = did_you_mean(unknown, &robots);
            let robots = robots.join(", ");
            return Err(format!(
                "the plan names the robot `{unknown}`, which this robot does not know{near}; it knows {robots}"
            ));
        }
        let paths = fsm::replayed_files(machine, &target.alphabet);
        if let Some(unknown) = paths.into_iter().find(|name| !self.paths.contains(name)) {
            let near = did_you_mean(unknown, &self.paths);
            return Err(format!(
                "the plan replays the path `{unknown}`, which the first plan of the run does not{near}"
            ));
        }
        let mut budgets = self.budgets.borrow_mut();
        let budget = budgets.entry(sender.to_owned()).or_insert_with(|| NameBudget::new(NEW_NAMES));
        let loaded = load::load_within(machine, &input.sources, &target.alphabet, budget);
        loaded.map_err(|error| {
            if error != LoadError::OverBudget {
                return error.to_string();
            }
            let most = NEW_NAMES / 1000;
            let sentence =
                format!("the plans of {sender} have named modules with more than {most} kB of names in this run");
            format!("{sentence}: use the names of earlier plans")
        })
    }
}

/// Checks, before compilation, that a text from another robot contains at most one plan. `names` contains the names of
/// the plans in the text.
///
/// # Errors
/// Fails with a message if there are several names.
fn one_of(names: &[String]) -> Result<(), String> {
    match names {
        [] | [_] => Ok(()),
        [one, other, ..] => Err(format!("the text has several plans, and one of them can drive: {one}, {other}…")),
    }
}

/// Returns the names and texts of a compiled plan's files; the plan's own file comes first.
pub(crate) fn texts(input: &Input) -> Vec<(String, String)> {
    let names = input.files().map(|path| path.display().to_string());
    names.zip(input.texts().map(str::to_owned)).collect()
}

/// Returns the error message for a text that cannot be read.
fn unread(error: InputError) -> String {
    let message = error.to_string();
    let Some(FaultyFile { sources, diagnostics, .. }) = error.faulty_file() else { return message };
    faulty(&judged(&diagnostics, false).err().unwrap_or_default(), &rendered(&sources, &diagnostics))
}

fn faulty(count: &str, diagnostics: &str) -> String {
    format!("{count} in the plan, and nothing has changed\n{}", diagnostics.trim_end())
}

/// Renders diagnostics in the form that a terminal without colours shows.
pub(crate) fn rendered(sources: &Sources, diagnostics: &[Diagnostic]) -> String {
    let mut text = NoColor::new(Vec::new());
    // Writing to a vector cannot fail.
    let _ = sources.write_all(diagnostics, &mut text);
    String::from_utf8_lossy(&text.into_inner()).into_owned()
}
