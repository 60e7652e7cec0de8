//! Command-line options of every executable, for any target.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};

use crate::call::Call;
use crate::target_options::TargetOptions;
use crate::{Program, Quantity, paths, required, views};

/// Minimum period of a turn; a turn must be long enough for the exchange with the robot.
const PERIOD_LEAST: Duration = Duration::from_micros(100);
/// Maximum period of a turn; a robot that gets less than one command per minute is not under control.
const PERIOD_MOST: Duration = Duration::from_secs(60);
/// Maximum timeout, about 31 years: far below the limit of nanoseconds in 64 bits.
const TIMEOUT_MOST: Duration = Duration::from_secs(1_000_000_000);

/// Exit statuses with their meanings.
const STATUSES: [(&str, &str); 7] = [
    ("0", "the plan ended"),
    ("1", "with --runs: not all runs ended as required"),
    ("2", "invalid option, world or start pose"),
    ("3", "a fault stopped the robot"),
    ("4", "timeout or turn limit"),
    ("5", "the plan ended otherwise than required"),
    ("128+N", "terminated by signal N"),
];

/// Short form of the promise in docs/src/promises.md.
const STOPPED: &str = "The robot is stopped at the end, except after SIGKILL, a crash or a lost line: then only its \
                       own watchdog stops it.";

const TIMING: &str = "On a real robot, SIGUSR1 prints how late turns began and how long they took.";

/// Values of the options that all targets share.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SharedOptions {
    /// Time from the start of a turn to the start of the next.
    pub(crate) period: Duration,
    /// Maximum time of the plan; the run is stopped after this time.
    pub(crate) timeout: Option<Duration>,
    /// Maximum number of turns, at least 1; the run is stopped after this number.
    pub(crate) turns: Option<u64>,
    /// Path of the run log.
    pub(crate) log: Option<PathBuf>,
    /// `true` if the run continues when its log cannot be written.
    pub(crate) log_best_effort: bool,
    /// Path of the file in which the driven path is recorded.
    pub(crate) path: Option<PathBuf>,
}

/// Returns the command-line parser of a program for this target. The usage line begins with the words by which the
/// program was called; if these words are unknown, it begins with the plan's name.
pub(crate) fn command(target: &TargetOptions, program: Program<'_>, call: &Call) -> Command {
    let seconds = target.period.as_secs_f64();
    let name = program.plan;
    let command = Command::new(name.to_owned())
        .about(format!("Run the plan {name} on the robot {}", target.name))
        .arg(
            option("period", "TIME")
                .help(format!("Period of the control loop, in seconds or as in `50ms` [default: {seconds}]"))
                .long_help(format!(
                    "Period of the control loop, in seconds or with a unit, from {PERIOD_LEAST:?} to {PERIOD_MOST:?} \
                     [default: {seconds}]"
                ))
                .allow_negative_numbers(true)
                .value_parser(|text: &str| Quantity::duration(text, "s", PERIOD_LEAST, PERIOD_MOST)),
        )
        .arg(
            option("timeout", "TIME")
                .help(
                    "Maximum duration of the plan, in seconds or as in `5min`; exit status 4 after it [default: none]",
                )
                .allow_negative_numbers(true)
                .value_parser(|text: &str| Quantity::duration(text, "s", Duration::from_nanos(1), TIMEOUT_MOST)),
        )
        .arg(
            option("turns", "N")
                .help("Maximum number of turns; exit status 4 after them [default: none]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64).range(1..)),
        )
        .arg(
            option("log", "FILE")
                .help("File for a log of the run, one JSON object per turn; `FILE.mcap` is a record to replay")
                .long_help(
                    "File for a log of the run, one JSON object per turn, in the format of `mdlec trace`; a file whose \
                     name ends in `.mcap` is a record, which `mdle replay` re-executes",
                )
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("log-best-effort")
                .long("log-best-effort")
                .action(ArgAction::SetTrue)
                .requires("log")
                .help("Let the run go on without its log if that cannot be written, and say so"),
        );
    let command = views::view_options(command);
    let command = match call.several_words() {
        Some(words) if program.version.is_empty() => required::argument(command).bin_name(words),
        // The words are those of `mdle run`, whose plan is inside this executable.
        Some(_) => required::argument(command).bin_name(own_name().unwrap_or_else(|| program.plan.to_owned())),
        None => required::argument(command),
    };
    let command = if program.version.is_empty() { command } else { command.version(program.version.to_owned()) };
    with_statuses((target.arguments)(if target.fastest.is_some() { paths::arguments(command) } else { command }))
}

/// Returns the file name by which this process was called.
fn own_name() -> Option<String> {
    let called = PathBuf::from(std::env::args_os().next()?);
    Some(called.file_name()?.to_string_lossy().into_owned())
}

/// Adds the exit statuses to the help text of `command`, which must already have all its options.
fn with_statuses(command: Command) -> Command {
    let has_runs = command.get_arguments().any(|argument| argument.get_id() == "runs");
    let statuses = STATUSES.into_iter().filter(|(number, _)| *number != "1" || has_runs);
    let lines = statuses.map(|(number, meaning)| format!("  {number:<5}  {meaning}\n")).collect::<String>();
    command
        .after_help(format!("Exit status:\n{lines}{STOPPED}"))
        .after_long_help(format!("Exit status:\n{lines}{STOPPED} {TIMING}"))
}

/// Reads the values of the options that all targets share.
pub(crate) fn options(target: &TargetOptions, matches: &ArgMatches) -> SharedOptions {
    SharedOptions {
        period: matches.get_one("period").copied().unwrap_or(target.period),
        timeout: matches.get_one("timeout").copied(),
        turns: matches.get_one("turns").copied(),
        log: matches.get_one("log").cloned(),
        log_best_effort: matches.get_flag("log-best-effort"),
        path: paths::recording(target, matches),
    }
}

/// Returns a long option with a value.
fn option(name: &'static str, value: &'static str) -> Arg {
    Arg::new(name).long(name).value_name(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_period_is_a_sane_time() {
        let period = |text| Quantity::duration(text, "s", PERIOD_LEAST, PERIOD_MOST);
        assert_eq!(period("0.1"), Ok(Duration::from_millis(100)));
        assert_eq!(period("1e-4"), Ok(Duration::from_micros(100)));
        assert_eq!(period("60"), Ok(Duration::from_secs(60)));
        assert_eq!(period("1min"), Ok(Duration::from_secs(60)));
        for wrong in ["0", "-0", "-1", "NaN", "inf", "-inf", "1e300", "60.1", "0.00001", "", " 1", "2min", "١"] {
            assert!(period(wrong).is_err(), "{wrong}");
        }
    }
}
