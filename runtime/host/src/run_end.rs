//! The end of a run: exit status, and message on standard error. See docs/src/reference/interfaces.md, 6.3.

use std::fmt;
use std::io::{self, Write};
use std::time::Duration;

use mdle_runtime::PrintableLines;

use crate::Refusal;
use crate::signals::ProcessSignal;

/// Exit status when the plan has ended by any cause.
pub(crate) const OVER: u8 = 0;
/// Exit status when some of several runs have not ended as required.
pub(crate) const MISSED: u8 = 1;
/// Exit status after an invalid option, world or start pose.
pub(crate) const USAGE: u8 = 2;
/// Exit status after a fault that stopped the robot.
pub(crate) const FAULT: u8 = 3;
/// Exit status after the time limit or the maximum number of turns.
pub(crate) const LIMIT: u8 = 4;
/// Exit status if the plan has ended, but not as required.
pub(crate) const OTHERWISE: u8 = 5;
/// Exit status if a rule of the supervisor ended the plan.
pub(crate) const SAFETY: u8 = 6;

/// Reason why a run has ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum RunEnd {
    /// The plan has ended.
    Over,
    /// The plan has ended, but not as `--require` or `--goal` demand, for the reason in this sentence.
    Otherwise(String),
    /// The last plan has ended before the pilot's goal; contains the reason.
    Failed(String),
    /// The plan had not ended at the time limit; contains this limit.
    Timeout(Duration),
    /// The plan had not ended after the maximum number of turns; contains this number.
    Turns(u64),
    /// The supervisor of the run requested the end.
    Quit,
    /// A rule of the supervisor ended the plan; contains the name of the rule.
    Safety(String),
    /// A signal requested the end.
    Signal(ProcessSignal),
    /// The first exchange failed, before any law was applied; contains the robot's message.
    Unstarted(String),
    /// An exchange failed; contains the robot's message.
    Robot(String),
    /// An exchange failed, and then the stop failed too; contains the robot's message about the exchange.
    Unstopped(String),
    /// The run log could not be written; contains the reason.
    Log(String),
    /// Too many turns took too long; contains a sentence with the times.
    Overrun(String),
    /// The turns could not continue; contains the reason.
    Pilot(String),
    /// The robot was without a command for `gap`, which is longer than `longest`.
    Suspended {
        /// Time without a command, in nanoseconds.
        gap: u64,
        /// Maximum time without a command, in nanoseconds.
        longest: u64,
    },
    /// Code panicked; contains the panic message.
    Bug(String),
}

impl RunEnd {
    /// Returns the exit status of the executable, given the faults after the end of the turns.
    ///
    /// A failed stop, an incomplete log and a failed exchange of the final null input determine the status after any
    /// end. An incomplete path, or an incomplete file of [`Observer::finish`](crate::Observer::finish), determines it
    /// only after the end of the plan, because any other reason for the end is more important.
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
            | Self::Failed(_)
            | Self::Bug(_) => FAULT,
        }
    }

    /// Combines this end with the result of stopping the robot; `stop` is the reason why the stop failed. Returns the
    /// resulting end, and the reason if it has to be reported separately. After a failed exchange, the reason is not
    /// reported, because the exchange's error is usually the same.
    pub(crate) fn with_stop(self, stop: Option<String>) -> (Self, Option<String>) {
        match (self, stop) {
            (Self::Unstarted(fault) | Self::Robot(fault), Some(_)) => (Self::Unstopped(fault), None),
            untouched => untouched,
        }
    }

    /// Returns `true` if the robot still accepts inputs. After a failed exchange, after too long a time without a
    /// command, and after a panic, the state of the robot is unknown, so it is sent no input. The stop command is
    /// always sent.
    pub(crate) fn robot_listens(&self) -> bool {
        match self {
            Self::Over
            | Self::Otherwise(_)
            | Self::Failed(_)
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

    /// Returns `true` if the robot's code is still reliable enough to write the files that the options name.
    pub(crate) fn is_orderly(&self) -> bool {
        match self {
            Self::Over
            | Self::Otherwise(_)
            | Self::Failed(_)
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

    /// Returns one or two words about why a run ended before its plan.
    pub(crate) fn brief(&self) -> String {
        match self {
            Self::Over | Self::Otherwise(_) | Self::Failed(_) => "plan over".to_owned(),
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

    /// Returns the report of the end as one sentence; empty if [`RunEnd::tell`] reports nothing.
    pub(crate) fn sentence(&self, is_stopped: bool) -> String {
        let mut report = Vec::new();
        self.tell(is_stopped, &mut report);
        let report = String::from_utf8_lossy(&report);
        report.trim_end().trim_start_matches("error: ").to_owned()
    }

    /// Reports the end on standard error, and whether the robot was stopped. The end of a plan has already been
    /// reported on standard output.
    pub(crate) fn tell(&self, is_stopped: bool, err: &mut dyn Write) {
        let came = if is_stopped { "a fault stopped the robot" } else { "a fault ended the plan" };
        match self {
            Self::Over | Self::Quit => {}
            Self::Safety(rule) => say(err, format_args!("stopped by the safety rules: {rule}")),
            Self::Failed(sentence) => say(err, format_args!("error: {sentence}")),
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

/// A fault after the end of the turns.
#[derive(Debug)]
pub(crate) enum RunFault {
    /// The final exchange of the null input failed.
    Exchange(RunEnd),
    /// The rest of the run log could not be written.
    Log(io::Error),
    /// The driven path could not be written completely.
    Path(io::Error),
    /// The stop command could not be delivered, or the robot did not stop; contains the robot's message.
    Stop(String),
    /// Files of the robot or of the views could not be written; contains the message.
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
    // If even this fails, only the exit status reports the end.
    let _ = writeln!(err, "{}", PrintableLines(line)).and_then(|()| err.flush());
}
