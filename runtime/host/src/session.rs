//! A complete run: reads the options, connects to the robot, makes the turns, and always stops the robot at the end.

use std::io::{self, Write};

use clap::ArgMatches;
use mdle_runtime::PathStore;

use crate::answer::{print_answer, unparsed};
use crate::arguments::{self, SharedOptions};
use crate::call::Call;
use crate::executable::Executable;
use crate::instants::Instants;
use crate::one_run::one_run;
use crate::paths;
use crate::progress::ProgressLine;
use crate::ready::bug_before;
use crate::required::{Required, scopes};
use crate::run_end::{RunEnd, say};
use crate::runs::{self, BatchRuns, CommonTerms};
use crate::safety::shielded;
use crate::surroundings::{PlanData, RunSettings, Surroundings};
use crate::target_options::TargetOptions;
use crate::{Pace, Program, Refusal, Time};

/// Runs an executable that was called as `call` describes; returns the exit status.
pub(crate) fn session<'o, I, O>(
    program: Program<'_>,
    call: Call,
    executable: &dyn Executable,
    surroundings: Surroundings<'_, I, O>,
) -> u8
where
    I: Instants,
    O: FnOnce() -> Box<dyn Write + 'o>,
{
    let target = executable.target();
    let matches = match arguments::command(&target, program, &call).try_get_matches_from(call.arguments()) {
        Ok(matches) => matches,
        Err(error) => return unparsed(error, &call.own_options, surroundings.out, surroundings.err),
    };
    let options = arguments::options(&target, &matches);
    match shielded(|| (target.answer)(&matches)).unwrap_or_else(bug_before) {
        Err(refusal) => return refusal.tell(surroundings.err),
        Ok(Some(answer)) => return print_answer(&answer, &mut *(surroundings.out)(), surroundings.err),
        Ok(None) => {}
    }
    let settings = RunSettings { program, call: &call, matches: &matches, options: &options };
    let plan = match prepared(&target, &matches, executable, call.later_path.as_deref()) {
        Err(refusal) => return refusal.tell(surroundings.err),
        Ok(plan) => plan,
    };
    match batch(executable, &matches, &options, plan.store) {
        Err(refusal) => refusal.tell(surroundings.err),
        Ok(Some(batch)) => several(&batch, &settings, &plan.required, surroundings),
        Ok(None) => one_run(executable, &settings, &plan, surroundings),
    }
}

/// Reads the paths that the plan replays, and the causes by which the plan must end. The file of the path `later` may
/// be missing.
fn prepared(
    target: &TargetOptions,
    matches: &ArgMatches,
    executable: &dyn Executable,
    later: Option<&str>,
) -> Result<PlanData, Refusal> {
    let prepared = shielded(|| {
        let plan = executable.plan();
        let required = Required::of(matches, &*plan).map_err(Refusal::Usage)?;
        let laws = (0..).take(plan.fsm().atoms.len()).map(|atom| plan.law(atom));
        let texts: Vec<_> = laws.chain(scopes(plan.fsm()).map(|scope| plan.condition(scope))).collect();
        (target.accepts)(matches, &texts)?;
        let store = paths::load(target, matches, plan.paths(), later)?;
        Ok(PlanData { store, paths: plan.paths().to_vec(), required })
    });
    prepared.unwrap_or_else(bug_before)
}

/// Returns the runs of a batch; `None` if the options request a single run.
fn batch<'p>(
    executable: &'p dyn Executable,
    matches: &ArgMatches,
    options: &SharedOptions,
    store: PathStore,
) -> Result<Option<BatchRuns<'p>>, Refusal> {
    let batch = shielded(|| executable.batch(matches, options.period, store)).unwrap_or_else(bug_before)?;
    let alone =
        [("--log", &options.log), ("--record-path", &options.path)].into_iter().find(|(_, file)| file.is_some());
    if let (Some(_), Some((option, _))) = (&batch, alone) {
        return Err(Refusal::Usage(format!(
            "{option} writes down one run, and there are to be several: leave it out, or run one seed alone"
        )));
    }
    Ok(batch)
}

/// Makes the runs of a batch and reports them; returns the exit status.
fn several<'o, I, O>(
    batch: &BatchRuns<'_>,
    settings: &RunSettings<'_>,
    required: &Required,
    surroundings: Surroundings<'_, I, O>,
) -> u8
where
    O: FnOnce() -> Box<dyn Write + 'o>,
{
    let Surroundings { signals, watch, out, err, elapsed, .. } = surroundings;
    // No real robot has to be stopped.
    signals.robot_runs(Time::Stepped(Pace::Max));
    signals.patience().stop_was_tried(None);
    let terms = CommonTerms {
        period: settings.options.period,
        limits: settings.limits(),
        signals: &signals,
        watch: &watch,
        program: &settings.call.command(settings.program.plan),
        required,
    };
    let progress = elapsed.map(|now| ProgressLine::new(&mut *err, now));
    let (status, unwritten) = runs::run(batch, &terms, &mut *out(), progress);
    if let Some(signal) = signals.caught() {
        RunEnd::Signal(signal).tell(true, err);
    }
    if let Some(error) = unwritten.filter(|error| error.kind() != io::ErrorKind::BrokenPipe) {
        say(err, format_args!("warning: standard output could not be written: {error}"));
    }
    status
}
