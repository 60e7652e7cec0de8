//! What the executable of a plan needs around its turns: arguments, clock, signals, safe stop, report and run log.
//!
//! For people who write a robot: [`Target`], [`Hosted`], [`Time`] and [`Refusal`], and [`Batch`] where it can be started over, [`Replays`] where it replays paths, [`read_file`] where its options name files. For generated code: [`run`].
//!
//! Whatever happens, the robot is stopped: when the plan is over, when an exchange fails, when code panics, when a
//! signal comes, when a limit is reached.
#![forbid(unsafe_code)]

mod arguments;
mod batch;
mod clock;
mod ending;
mod files;
mod held;
mod log;
mod outlet;
mod paths;
mod progress;
mod report;
mod safety;
mod session;
mod signals;
mod stop_request;
mod summary;
mod target;
#[cfg(test)]
mod tests;
mod timing;
mod turns;
mod urgency;

use std::io::{self, BufWriter, IsTerminal, Write};
use std::process::ExitCode;

pub use batch::Batch;
pub use clap;
pub use files::{read_file, read_text};
use mdle_runtime::{Plan, Robot};
pub use paths::Replays;
pub use stop_request::StopRequest;
pub use target::{Around, Hosted, Judgement, Pace, Refusal, Standing, Target, Time};

/// Runs the plan that `plan` makes on the robot of the target `T`, with the arguments of this process: what the `main` of an executable
/// that mdlec builds calls. `name` is the plan's, for `--help`; its usage names the executable as it was called.
///
/// Exit status: 0 the plan is over; 1 of several runs not all arrived; 2 a bad option, world or start pose; 3 a fault stopped the robot, or what was asked
/// for could not be written; 4 `--timeout` or `--turns`; 129, 130 or 143 a signal. In every case the robot was stopped.
pub fn run<T: Target, P>(name: &str, plan: impl Fn() -> P + Sync) -> ExitCode
where
    P: Plan<Output = <T::Robot as Robot>::Output, Input = <T::Robot as Robot>::Input>,
{
    let signals = match signals::Signals::listen() {
        Ok(signals) => signals,
        Err(error) => {
            // Without them Ctrl-C would leave the robot moving.
            ending::say(&mut io::stderr(), format_args!("error: signals cannot be caught: {error}"));
            return ExitCode::from(ending::FAULT);
        }
    };
    let instants = clock::Monotonic::start();
    let begun = std::time::Instant::now();
    let seen = io::stderr().is_terminal().then(|| Box::new(move || begun.elapsed()) as Box<dyn FnMut() -> _>);
    let surroundings = session::Surroundings { instants, signals, out: standard_output, err: &mut io::stderr(), seen };
    ExitCode::from(session::session::<T, P, _, _>(name, std::env::args_os(), &plan, surroundings))
}

/// Standard output for a run in which time passes like this.
fn standard_output(time: Option<Time>) -> Box<dyn Write> {
    match time {
        // A robot must not wait for whoever reads its report; without a thread it must.
        Some(Time::Wall) => match outlet::Outlet::open(io::stdout()) {
            Ok(outlet) => Box::new(outlet),
            Err(_) => Box::new(BufWriter::new(io::stdout())),
        },
        Some(Time::Stepped(_)) | None => Box::new(BufWriter::new(io::stdout())),
    }
}
