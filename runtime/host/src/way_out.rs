//! Ends a run: stops the robot, and then reports the cause of the end and all faults.

use std::io::{self, Write};

use crate::Judgement;
use crate::Observer as _;
use crate::drive::Drive;
use crate::report::ReportWriter;
use crate::required::Required;
use crate::run_end::{RunEnd, RunFault, say};
use crate::run_log::RunLog;
use crate::safety::{Panicked, shielded};
use crate::views::ByOdometry;

/// Returns the end of a run that was caused by a panic.
pub(crate) fn bug(Panicked(message): Panicked) -> RunEnd {
    RunEnd::Bug(message)
}

/// Stops the robot. Returns the end of the run after the stop, `true` if the robot's code is still reliable, and the
/// faults.
///
/// The null input is sent once more if the robot still accepts inputs; the stop command is always sent.
pub(crate) fn stop(drive: &mut dyn Drive, ending: RunEnd) -> (RunEnd, bool, Vec<RunFault>) {
    let last = if ending.robot_listens() {
        let last = shielded(|| drive.release().map_err(RunEnd::Robot));
        last.unwrap_or_else(|panicked| Err(bug(panicked))).err()
    } else {
        None
    };
    let orderly = last.as_ref().unwrap_or(&ending).is_orderly();
    let stopped = shielded(|| drive.stop());
    let stopped = stopped.unwrap_or_else(|Panicked(message)| Err(format!("its code panicked: {message}")));
    let (ending, stopped) = ending.with_stop(stopped.err());
    let mut faults = Vec::new();
    let stopped = match last {
        Some(last) => {
            let (last, stopped) = last.with_stop(stopped);
            faults.push(RunFault::Exchange(last));
            stopped
        }
        None => stopped,
    };
    faults.extend(stopped.map(RunFault::Stop));
    (ending, orderly, faults)
}

/// Returns [`RunEnd::Over`] if the plan ended as the options and the robot's goal require, and [`RunEnd::Otherwise`] if
/// it ended in another way. Returns the end of a run unchanged if its plan did not end. If the robot has a goal,
/// reports its result.
pub(crate) fn judge(
    drive: &mut dyn Drive,
    ending: RunEnd,
    required: &Required,
    report: &mut ReportWriter<'_>,
) -> RunEnd {
    if ending != RunEnd::Over {
        return ending;
    }
    let judgement = match shielded(|| drive.observer().and_then(|observer| observer.judged())) {
        Ok(judgement) => judgement,
        Err(panicked) => return bug(panicked),
    };
    if let Some(judgement) = &judgement {
        report.judged(judgement);
    }
    if let Some(over) = report.over().filter(|over| !required.allows(over)) {
        let (cause, asked) = (&over.cause, required.words());
        return RunEnd::Otherwise(format!("the plan ended by {cause}, and --require asks for {asked}"));
    }
    match judgement {
        None | Some(Judgement::Arrived) => RunEnd::Over,
        Some(missed @ (Judgement::Bumped | Judgement::Astray(_))) => {
            RunEnd::Otherwise(format!("the run is {missed}, and --goal asks for arrived"))
        }
    }
}

/// Files that a run writes at its end.
pub(crate) struct EndFiles {
    pub(crate) log: Option<RunLog>,
    /// Error that prevented the path from being recorded.
    pub(crate) path: Option<io::Error>,
    /// The views by odometry.
    pub(crate) views: Option<ByOdometry>,
}

/// Reports why the run ended, and all faults, after the robot was stopped; returns the exit status.
pub(crate) fn tell(
    drive: &mut dyn Drive,
    ending: RunEnd,
    orderly: bool,
    mut faults: Vec<RunFault>,
    report: &mut ReportWriter<'_>,
    files: EndFiles,
    err: &mut dyn Write,
) -> u8 {
    let is_stopped = !faults.iter().any(|fault| matches!(fault, RunFault::Stop(_)));
    // A broken log is reported, because a reader would take a short log for a complete run.
    let (logged, ended_before) = match files.log {
        Some(mut log) => (log.close(), log.take_message()),
        None => (Ok(()), None),
    };
    faults.extend(logged.err().filter(|_| !matches!(ending, RunEnd::Log(_))).map(RunFault::Log));
    faults.extend(files.path.map(RunFault::Path));
    report.flush();
    // Reported before the robot writes its files, which may take a while.
    ending.tell(is_stopped, err);
    if orderly {
        let finished = shielded(|| drive.observer().map_or(Ok(()), |observer| observer.finish()));
        let mut views = files.views;
        let drawn = shielded(|| views.as_mut().map_or(Ok(()), ByOdometry::finish));
        for finished in [finished, drawn] {
            let finished = finished.unwrap_or_else(|Panicked(message)| Err(format!("a panic: {message}")));
            faults.extend(finished.err().map(RunFault::Finish));
        }
    }
    if let Some(message) = ended_before {
        say(err, format_args!("{message}"));
    }
    faults.iter().for_each(|fault| fault.tell(is_stopped, err));
    let status = ending.status(&faults);
    // A supervisor that panics must not change the status.
    let _ = shielded(|| drive.ended(&ending.sentence(is_stopped), status));
    status
}
