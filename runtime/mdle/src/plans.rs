//! Plans that a session loads, and that other robots send, while the robot runs; their texts are compiled like the text
//! of the first plan.

use std::path::Path;
use std::sync::Arc;

use codespan_reporting::term::termcolor::NoColor;
use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::diagnostic::{Code, Diagnostic, Sources, judged};
use mdle_compiler::load;
use mdle_compiler::plan::Nondegenerate;
use mdle_engine::{CompiledPlans, EngineAlphabet, PlanSource, Plans, StoredPlan};
use mdle_files::{FaultyFile, Input, InputError, Target, plan, read_plan};
use mdle_host::Refusal;
use mdle_runtime::{Alphabet, Plan as _};

/// Name of a text that was typed, in diagnostics.
const TYPED: &str = "main";
/// Maximum number of atoms, scopes and loops of a plan that another robot sends, in which other plans are copied. Plans
/// that use plans multiply: a short text may need much memory.
const SENT: usize = 10_000;

/// Stores the first plan of a run, and enables further plans of this target to be loaded, and plans that name these
/// robots to be sent.
///
/// # Errors
/// Fails if the system cannot create the compiler's thread.
pub(crate) fn begin<A: EngineAlphabet>(
    plans: &mut Plans<A>,
    first: StoredPlan<A>,
    target: &Arc<Target>,
    robots: Vec<String>,
) -> Result<(), Refusal> {
    let target = Arc::clone(target);
    let started = plans.compile_with(Box::new(move |source| compiled(source, &target, &robots)));
    started.map_err(|error| Refusal::Fault(format!("the system gives no thread for the compiler: {error}")))?;
    plans.store(first).map_err(Refusal::Fault)
}

/// Enables other robots to send plans for this target that name these robots. In simulated time, turns wait for them.
pub(crate) fn begin_at_once<A: EngineAlphabet>(plans: &mut Plans<A>, target: &Arc<Target>, robots: Vec<String>) {
    let target = Arc::clone(target);
    plans.compile_at_once_with(Box::new(move |source| compiled(source, &target, &robots)));
}

/// Compiles and loads the plans of a text that no other plan of the text uses. `robots` are those that a plan of
/// another robot may name.
///
/// # Errors
/// Fails with a sentence and the diagnostics, as `mdlec check` prints them.
fn compiled<A: EngineAlphabet>(
    source: &PlanSource,
    target: &Target,
    robots: &[String],
) -> Result<CompiledPlans<A>, String> {
    let is_sent = matches!(source, PlanSource::Peer { .. });
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
        input.compile_within(&target.alphabet, None, is_small)
    } else {
        input.compile(&target.alphabet, None)
    };
    let warnings = rendered(&input.sources, &diagnostics);
    if let Err(count) = judged(&diagnostics, false) {
        return Err(faulty(&count, &warnings));
    }
    // Nobody at this robot has read the warning.
    if is_sent && diagnostics.iter().any(|diagnostic| diagnostic.code == Code::W0201) {
        return Err(format!("the plan never ends, and nothing has changed\n{}", warnings.trim_end()));
    }
    let machines = machines.into_iter().map(|compiled| (compiled.plan.root.name, compiled.machine));
    let machines: Vec<_> = machines.collect();
    if machines.is_empty() {
        return Err(input.only::<()>(Vec::new()).err().map(unread).unwrap_or_default());
    }
    let files = texts(&input).into();
    let stored = machines.into_iter().map(|(name, machine)| stored(name, &machine, &input, target, &files));
    let plans: Vec<StoredPlan<A>> = stored.collect::<Result<_, _>>()?;
    if is_sent {
        plans.iter().try_for_each(|plan| names_only(robots, plan.loaded.plan().robots()))?;
    }
    Ok(CompiledPlans { plans, warnings })
}

/// Checks that the robots that a plan names are among these.
///
/// # Errors
/// The plan names another robot: a sentence.
fn names_only(robots: &[String], named: &[&str]) -> Result<(), String> {
    let robots: Vec<&str> = robots.iter().map(String::as_str).collect();
    let Some(unknown) = named.iter().find(|name| !robots.contains(name)) else { return Ok(()) };
    let near = did_you_mean(unknown, &robots);
    let robots = robots.join(", ");
    Err(format!("the plan names the robot `{unknown}`, which this robot does not know{near}; it knows {robots}"))
}

/// Refuses several plans of another robot before they are compiled.
///
/// # Errors
/// The names are those of several plans: a sentence.
fn one_of(names: &[String]) -> Result<(), String> {
    match names {
        [] | [_] => Ok(()),
        [one, other, ..] => Err(format!("the text has several plans, and one of them can drive: {one}, {other}…")),
    }
}

/// Limits the size of a plan of another robot.
fn is_small(plan: &Nondegenerate) -> Result<(), Diagnostic> {
    let plan = plan.plan();
    let parts = plan.parts().count();
    if parts <= SENT {
        return Ok(());
    }
    let message = format!("this plan has {parts} atoms, scopes and loops, and one that is sent has {SENT} at most");
    let help = "use a loop where the same is written many times";
    Err(Diagnostic::new(Code::E0501, message, plan.root.span, "this plan").help(help))
}

/// Returns the names and texts of the files of a compiled plan, its own file first.
pub(crate) fn texts(input: &Input) -> Vec<(String, String)> {
    let names = input.files().map(|path| path.display().to_string());
    names.zip(input.texts().map(str::to_owned)).collect()
}

fn stored<A: Alphabet + EngineAlphabet>(
    name: String,
    machine: &mdle_compiler::fsm::Machine,
    input: &Input,
    target: &Target,
    files: &Arc<[(String, String)]>,
) -> Result<StoredPlan<A>, String> {
    let loaded = load::load(machine, &input.sources, &target.alphabet).map_err(|error| error.to_string())?;
    Ok(StoredPlan { name: name.into(), files: Arc::clone(files), loaded: Arc::new(loaded) })
}

/// Returns the message about a text that cannot be read.
fn unread(error: InputError) -> String {
    let message = error.to_string();
    let Some(FaultyFile { sources, diagnostics, .. }) = error.faulty_file() else { return message };
    faulty(&judged(&diagnostics, false).err().unwrap_or_default(), &rendered(&sources, &diagnostics))
}

fn faulty(count: &str, diagnostics: &str) -> String {
    format!("{count} in the plan, and nothing has changed\n{}", diagnostics.trim_end())
}

/// Returns the diagnostics as on a terminal without colours.
fn rendered(sources: &Sources, diagnostics: &[Diagnostic]) -> String {
    let mut text = NoColor::new(Vec::new());
    // A vector takes everything.
    let _ = sources.write_all(diagnostics, &mut text);
    String::from_utf8_lossy(&text.into_inner()).into_owned()
}
