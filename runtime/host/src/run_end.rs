//! End of a run: the exit status, and the sentence on standard error. See docs/src/reference/interfaces.md, 6.3.

use std::fmt;
use std::io::{self, Write};
use std::time::Duration;

use mdle_runtime::PrintableLines;

use crate::Refusal;
use crate::signals::Signal;

/// Exit status: the plan is over, by any cause.
pub(crate) const OVER: u8 = 0;
/// Exit status: of several runs, not all ended as required.
pub(crate) const MISSED: u8 = 1;
/// Exit status: a bad option, world or start pose.
pub(crate) const USAGE: u8 = 2;
/// Exit status: a fault stopped the robot.
pub(crate) const FAULT: u8 = 3;
/// Exit status: timeout or turn limit.
pub(crate) const LIMIT: u8 = 4;
/// Exit status: the plan is over, and ended otherwise than required.
pub(crate) const OTHERWISE: u8 = 5;
/// Exit status: a rule of the supervisor ended the plan.
pub(crate) const SAFETY: u8 = 6;

/// Reason of the end of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum RunEnd {
    /// The plan is over.
    Over,
    /// The plan is over, and ended otherwise than `--require` or `--goal` ask: a sentence.
    Otherwise(String),
    /// The plan was not over at this time.
    Timeout(Duration),
    /// The plan was not over after this many turns.
    Turns(u64),
    /// The supervisor of the run asked for it.
    Quit,
    /// A rule of the supervisor ended the plan: its name.
    Safety(String),
    /// A signal asked for it.
    Signal(Signal),
    /// The first exchange failed, before any law was applied: the robot's sentence.
    Unstarted(String),
    /// An exchange failed: the robot's sentence.
    Robot(String),
    /// An exchange failed, and then the stop failed too: the robot's sentence about the exchange.
    Unstopped(String),
    /// The run log could not be written: why.
    Log(String),
    /// Too many turns took too long: how long.
    Overrun(String),
    /// The turns could not go on: why.
    Pilot(String),
    /// The robot went without a command for `gap`, longer than for `longest`, both in nanoseconds.
    Suspended {
        /// Length of the gap, in nanoseconds.
        gap: u64,
        /// Maximum length of a gap, in nanoseconds.
        longest: u64,
    },
    /// Code panicked: its message.
    Bug(String),
}

impl RunEnd {
    /// Returns the exit status of the executable, after these faults on the way out.
    ///
    /// A robot that could not be stopped in good order, or a log that is cut short, is a fault whatever came before.
    /// What [`Observer::finish`](crate::Observer::finish) could not write makes one only of a plan that is over: any
    /// other ending says more.
    pub(crate) fn status(&self, faults: &[RunFault]) -> u8 {
        let grave = faults.iter().any(|fault| match fault {
            RunFault::Exchange(_) | RunFault::Log(_) | RunFault::Stop(_) => true,
            RunFault::Path(_) | RunFault::Finish(_) => matches!(self, Self::Over | Self::Otherwise(_)),
        });
        match self {
            _ if grave => FAULT,
            Self::Over | Self::Quit => OVER,
            Self::Safety(_) => SAFETY,
            Self::Otherwise(_) => OTHERWISE,
            Self::Timeout(_) | Self::Turns(_) => LIMIT,
            Self::Signal(signal) => 128 + signal.number(),
            Self::Unstarted(_)
            | Self::Robot(_)
            | Self::Unstopped(_)
            | Self::Log(_)
            | Self::Overrun(_)
            | Self::Pilot(_)
            | Self::Suspended { .. }
            | Self::Bug(_) => FAULT,
        }
    }

    /// Returns this ending after a stop that failed for the reason `stop`, if any, and the reason if it is still to be
    /// reported: after a failed exchange it is not, as the exchange's error says enough, and is mostly the same.
    pub(crate) fn with_stop(self, stop: Option<String>) -> (Self, Option<String>) {
        match (self, stop) {
            (Self::Unstarted(fault) | Self::Robot(fault), Some(_)) => (Self::Unstopped(fault), None),
            untouched => untouched,
        }
    }

    /// Returns `true` if the robot still takes inputs. It is not used again once an exchange has failed, and after a
    /// panic its state is unknown; its stop command is sent all the same.
    pub(crate) fn robot_listens(&self) -> bool {
        match self {
            Self::Over
            | Self::Otherwise(_)
            | Self::Timeout(_)
            | Self::Turns(_)
            | Self::Quit
            | Self::Safety(_)
            | Self::Signal(_)
            | Self::Log(_)
            | Self::Overrun(_)
            | Self::Pilot(_) => true,
            Self::Unstarted(_) | Self::Robot(_) | Self::Unstopped(_) | Self::Suspended { .. } | Self::Bug(_) => false,
        }
    }

    /// Returns `true` if the robot's own code can still be trusted to write the files that the options name.
    pub(crate) fn is_orderly(&self) -> bool {
        match self {
            Self::Over
            | Self::Otherwise(_)
            | Self::Timeout(_)
            | Self::Turns(_)
            | Self::Quit
            | Self::Safety(_)
            | Self::Signal(_)
            | Self::Unstarted(_)
            | Self::Robot(_)
            | Self::Unstopped(_)
            | Self::Log(_)
            | Self::Overrun(_)
            | Self::Pilot(_)
            | Self::Suspended { .. } => true,
            Self::Bug(_) => false,
        }
    }

    /// Returns a word or two for what ended a run before its plan was over.
    pub(crate) fn brief(&self) -> String {
        match self {
            Self::Over | Self::Otherwise(_) => "plan over".to_owned(),
            Self::Timeout(_) => "--timeout".to_owned(),
            Self::Turns(_) => "--turns".to_owned(),
            Self::Quit => "quit".to_owned(),
            Self::Safety(rule) => format!("safety: {rule}"),
            Self::Signal(signal) => signal.name().into_owned(),
            Self::Unstarted(_)
            | Self::Robot(_)
            | Self::Unstopped(_)
            | Self::Log(_)
            | Self::Overrun(_)
            | Self::Pilot(_)
            | Self::Suspended { .. }
            | Self::Bug(_) => "a fault".to_owned(),
        }
    }

    /// Reports the ending on standard error, and whether the robot was stopped; a plan that is over has been reported
    /// on standard output.
    pub(crate) fn tell(&self, is_stopped: bool, err: &mut dyn Write) {
        let came = if is_stopped { "a fault stopped the robot" } else { "a fault ended the plan" };
        match self {
            Self::Over | Self::Quit => {}
            Self::Safety(rule) => say(err, format_args!("stopped by the safety rules: {rule}")),
            Self::Otherwise(sentence) => say(err, format_args!("not as required: {sentence}")),
            Self::Timeout(limit) => {
                say(err, format_args!("stopped by --timeout: the plan was not over after {} s", limit.as_secs_f64()));
            }
            Self::Turns(limit) => {
                let turns = if *limit == 1 { "turn" } else { "turns" };
                say(err, format_args!("stopped by --turns: the plan was not over after {limit} {turns}"));
            }
            Self::Signal(signal) => say(err, format_args!("stopped by {}", signal.name())),
            Self::Unstarted(fault) => say(err, format_args!("error: the plan was not started: {fault}")),
            Self::Robot(fault) | Self::Overrun(fault) | Self::Pilot(fault) => {
                say(err, format_args!("error: {came}: {fault}"))
            }
            Self::Suspended { gap, longest } => {
                let [gap, longest] = [gap, longest].map(|nanos| Duration::from_nanos(*nanos).as_secs_f64());
                say(
                    err,
                    format_args!(
                        "error: {came}: it had no command for {gap:.1} s, and may go {longest} s \
                         without one: this program or this computer was suspended, or too busy; start the plan again"
                    ),
                );
            }
            Self::Unstopped(fault) => {
                say(err, format_args!("error: a fault ended the plan, and the robot may not have stopped: {fault}"));
            }
            Self::Log(fault) => {
                let so = if is_stopped { ", so the robot was stopped" } else { "" };
                say(err, format_args!("error: the run log cannot be written{so}: {fault}"));
            }
            Self::Bug(message) => {
                say(err, format_args!("error: {came}: its code or the plan's panicked, which is a bug: {message}"))
            }
        }
    }
}

/// Fault on the way out.
#[derive(Debug)]
pub(crate) enum RunFault {
    /// The null input could not be exchanged once more.
    Exchange(RunEnd),
    /// The rest of the run log could not be written.
    Log(io::Error),
    /// The path that was driven could not be written whole.
    Path(io::Error),
    /// The stop command could not be delivered, or the robot did not stop: the robot's sentence.
    Stop(String),
    /// The files that the robot was to write could not be written: the robot's sentence.
    Finish(String),
}

impl RunFault {
    /// Reports the fault on standard error; `is_stopped` is `true` if the robot was stopped.
    pub(crate) fn tell(&self, is_stopped: bool, err: &mut dyn Write) {
        match self {
            Self::Exchange(ending) => ending.tell(is_stopped, err),
            Self::Log(error) => say(err, format_args!("error: the run log cannot be written: {error}")),
            Self::Path(error) => say(err, format_args!("error: the path that was driven cannot be written: {error}")),
            Self::Stop(fault) => say(err, format_args!("error: the robot may not have stopped: {fault}")),
            Self::Finish(sentence) => say(err, format_args!("error: {sentence}")),
        }
    }
}

impl Refusal {
    /// Reports the refusal on standard error, and returns the exit status.
    pub(crate) fn tell(&self, err: &mut dyn Write) -> u8 {
        let (sentence, status) = match self {
            Self::Usage(sentence) => (sentence.as_str(), USAGE),
            Self::Fault(sentence) | Self::Ended(Err(sentence)) => (sentence.as_str(), FAULT),
            Self::Ended(Ok(())) => ("the run was asked to end before it began", FAULT),
        };
        say(err, format_args!("error: {sentence}"));
        status
    }
}

/// Writes a line to standard error.
pub(crate) fn say(err: &mut dyn Write, line: fmt::Arguments<'_>) {
    // When even that fails nobody is left to tell; the exit status still says it.
    let _ = writeln!(err, "{}", PrintableLines(line)).and_then(|()| err.flush());
}
