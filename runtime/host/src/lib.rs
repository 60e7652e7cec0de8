//! Host of a plan's executable: arguments, clock, signals, safe stop, report and run log around the turns of the plan.
//!
//! Authors of robots use [`Target`], [`Time`] and [`Refusal`]; [`Observer`] for robots that observe their runs;
//! [`Batch`] for robots that can be started over; [`Watch`] and [`WholeFile`] for robots that show and draw runs
//! themselves; [`Replays`] for robots that replay paths; [`read_file`] and [`output_format`] for options that name
//! files; and [`Quantity`] for options with lengths and times. Generated code uses [`run`]. An engine that makes the
//! turns of a run itself implements the trait [`Pilot`].
//!
//! The robot is stopped at every end of a run: when the plan ends, an exchange fails, code panics, a signal arrives, or
//! a limit is reached.
#![forbid(unsafe_code)]

mod answer;
mod arguments;
mod background_writer;
mod batch;
mod call;
mod cause;
mod clock;
mod cycle;
mod drive;
mod executable;
mod files;
mod held_report;
mod helm;
mod holds;
mod instants;
mod interruption;
mod log;
mod microphones;
mod named_file;
mod observation;
mod observer;
mod one_run;
mod operand_text;
mod outcome;
mod output_format;
mod panic_hook;
mod passes;
mod paths;
mod patience;
mod pilot;
mod piped;
mod position;
mod program;
mod progress;
mod ready;
mod record;
mod refusal;
mod replays;
mod report;
mod required;
mod robot_record;
mod robot_settings;
mod run_end;
mod run_log;
mod runs;
mod safety;
mod scheduling;
mod second_signal;
mod session;
mod signals;
mod standing;
mod stop_request;
mod summary;
mod supervised;
mod supervisor;
mod surroundings;
mod target;
mod target_options;
#[cfg(test)]
mod tests;
mod time;
mod timing;
mod transitions;
mod trials;
mod turn_watch;
mod turns;
mod unwinding;
mod views;
mod watch;
mod way_out;
mod whole_file;

use std::fs::File;
use std::io::{self, IsTerminal, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::process::ExitCode;

use background_writer::{Keeps, Outlet};
pub use batch::Batch;
pub use call::{Call, RecordedPlan, determining, quoted};
pub use cause::{CauseText, cause_words, place};
pub use clap;
use executable::{Executable, PlanOnTarget};
pub use files::{read_file, read_text};
pub use helm::{Helm, Supervised};
pub use interruption::Interruption;
pub use mdle_quantity::{Clocked, Quantity, operand_words, rounded};
use mdle_runtime::{Plan, Robot};
pub use microphones::{EarsOf, Microphones};
pub use named_file::NamedFile;
pub use observation::{Observation, SeveralRuns};
pub use observer::{EnclosingScope, Ended, Judgement, Observer, PlanPosition};
pub use operand_text::{is_condition, is_operand};
pub use output_format::output_format;
pub use passes::{Passes, outwards};
pub use paths::setpoints;
use patience::Patience;
use pilot::PlanAlone;
pub use pilot::{AfterPlan, Pilot, PilotFault, PilotTurn, RunTerms};
pub use piped::read_piped_text;
pub use position::Texts;
pub use program::Program;
pub use progress::ProgressLine;
pub use refusal::Refusal;
pub use replays::Replays;
pub use robot_record::{RobotRecord, RobotTurn};
pub use robot_settings::{RobotSettings, SettingsOf, sonar_order};
pub use run_log::is_record;
pub use scheduling::claim_for_worker;
pub use stop_request::StopRequest;
pub use supervisor::{
    Break, BreakOrders, Intervention, LimitedQuantity, MakeSupervisor, PilotInput, PilotOutput, Supervision,
    Supervisor, Verdict,
};
pub use target::Target;
pub use time::{Pace, Time};
pub use timing::Lateness;
pub use transitions::{Operand, Transitions};
pub use trials::{Trials, trials};
pub use turn_watch::at_work;
pub use views::view_options;
pub use watch::Watch;
pub use whole_file::{Unfinished, WholeFile};

/// Runs the plan that `plan` creates on the robot of the target `T`, with the arguments of this process. The `main` of
/// an executable that mdlec builds calls this function. `program` is the plan's name for `--help`; the usage line shows
/// the words by which the executable was called. A [`Program`] also answers `--version`.
///
/// Exit status: 0 the plan has ended; 1 not all of several runs ended as required; 2 an invalid option, world or start
/// pose; 3 a fault stopped the robot, or a requested file could not be written; 4 `--timeout` or `--turns`; 5 the plan
/// has ended, but not as required; 128+N signal N. In all cases, the robot has been stopped.
///
/// The function handles the signals of the process, and replaces its panic hook by a hook that never makes the robot
/// wait.
pub fn run<'a, T: Target, P>(program: impl Into<Program<'a>>, plan: impl Fn() -> P + Sync) -> ExitCode
where
    P: Plan<Output = <T::Robot as Robot>::Output, Input = <T::Robot as Robot>::Input>,
{
    run_called::<T, P>(program, Call::of_executable(std::env::args_os()), plan)
}

/// Runs the plan that `plan` creates on the robot of the target `T`, as [`run`] does, but with the words and options of
/// `call` instead of the arguments of this process.
pub fn run_called<'a, T: Target, P>(
    program: impl Into<Program<'a>>,
    call: Call,
    plan: impl Fn() -> P + Sync,
) -> ExitCode
where
    P: Plan<Output = <T::Robot as Robot>::Output, Input = <T::Robot as Robot>::Input>,
{
    execute(program.into(), call, &PlanOnTarget::<T, P, _>::new(&plan, &|_| Ok(PlanAlone::new(&plan))))
}

/// Runs a plan as [`run_called`] does. The pilot that `pilot` creates makes the turns; a supervisor may change its
/// inputs. The texts and paths of the plan that `plan` creates are read beforehand. Exit status 6: the supervisor ended
/// the plan. The exit status is also 0 if the supervisor ended the run.
pub fn run_piloted<'a, 's, T: Target, B>(
    program: impl Into<Program<'a>>,
    call: Call,
    plan: &(dyn Fn() -> B::Plan + Sync),
    pilot: impl Fn(&RunTerms) -> Result<B, Refusal> + Sync,
    supervision: Option<Supervision<'s, B>>,
) -> ExitCode
where
    B: Pilot<Plan: Plan<Output = <T::Robot as Robot>::Output, Input = <T::Robot as Robot>::Input>>,
{
    execute(program.into(), call, &PlanOnTarget::<T, _, _>::new(plan, &pilot).supervised(supervision))
}

/// Checks the options of `call` for the target `T`, as [`run_called`] does.
///
/// # Errors
/// Returns the message for standard error if an option is invalid.
pub fn check_options<T: Target>(program: Program<'_>, call: &Call) -> Result<(), String> {
    let command = arguments::command(&target_options::TargetOptions::of::<T>(), program, call);
    match command.try_get_matches_from(call.arguments()) {
        Err(error) if error.use_stderr() => Err(error.render().to_string()),
        Ok(_) | Err(_) => Ok(()),
    }
}

/// Runs an executable with the arguments of `call`.
fn execute(program: Program<'_>, call: Call, executable: &dyn Executable) -> ExitCode {
    let signals = signals::Signals::listen();
    let signals = signals.and_then(|signals| second_signal::watch(&signals).map(|()| signals));
    let signals = match signals {
        Ok(signals) => signals,
        Err(error) => {
            // Without signal handlers, Ctrl-C would leave the robot moving.
            run_end::say(&mut io::stderr(), format_args!("error: signals cannot be caught: {error}"));
            return ExitCode::from(run_end::FAULT);
        }
    };
    let (out, mut err) = match standard_streams(signals.patience(), executable.session()) {
        Ok(streams) => streams,
        Err(error) => {
            run_end::say(&mut io::stderr(), format_args!("error: the system gives no threads: {error}"));
            return ExitCode::from(run_end::FAULT);
        }
    };
    panic_hook::tell_to(err.aside());
    let watch = match turn_watch::TurnWatch::begin(err.aside(), watch::leave_screen) {
        Ok(watch) => watch,
        Err(error) => {
            run_end::say(&mut err, format_args!("error: the system gives no threads: {error}"));
            return ExitCode::from(run_end::FAULT);
        }
    };
    let begun = std::time::Instant::now();
    // In a session, a user types where the progress line would be.
    let shows_progress = io::stderr().is_terminal() && executable.session().is_none();
    let elapsed = shows_progress.then(|| Box::new(move || begun.elapsed()) as Box<dyn FnMut() -> _>);
    let out = || Box::new(out) as Box<dyn Write>;
    let surroundings =
        surroundings::Surroundings { instants: instants::SinceBoot, signals, watch, out, err: &mut err, elapsed };
    ExitCode::from(session::session(program, call, executable, surroundings))
}

/// Returns writers to standard output and standard error, each with its own thread. The standard library's buffer of
/// standard output is not used, because its content may be lost when the program ends. In a session, both write to the
/// session's stream.
fn standard_streams(patience: &Patience, session: Option<BorrowedFd<'_>>) -> io::Result<(Outlet, Outlet)> {
    let open = |stream: BorrowedFd<'_>| -> io::Result<Outlet> {
        Outlet::open(File::from(stream.try_clone_to_owned()?), Keeps::WhatIsRead, patience)
    };
    let (stdout, stderr) = (io::stdout(), io::stderr());
    Ok((open(session.unwrap_or(stdout.as_fd()))?, open(session.unwrap_or(stderr.as_fd()))?))
}
