//! `mdle log info`: prints the contents of a record.

use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

use mdle_host::Clocked;
use mdle_runtime::Nanos;
use mdle_runtime::{Printable, trace::Seconds};

use super::damaged;
use crate::failure::{self, Failure};
use crate::messages::counted;
use crate::replay;

/// Prints the contents of a record.
///
/// # Errors
/// Fails if the record cannot be read.
pub(super) fn info(log: &Path) -> Result<ExitCode, Failure> {
    let (begin, mut records) = replay::record(log)?;
    let (mut turns, mut transitions, mut end, mut plans, mut error) = (0_u64, 0, Nanos::ZERO, 1, None);
    let mut plan = None;
    for turn in &mut records {
        match turn {
            Ok(turn) => {
                turns += 1;
                let is_other = plan.replace(turn.plan).is_some_and(|before| before != turn.plan);
                transitions += turn.steps.len() + usize::from(is_other);
                (end, plans) = (turn.t, turn.plan.max(plans));
            }
            Err(found) => error = Some(found),
        }
        if error.is_some() {
            break;
        }
    }
    let is_whole = if records.is_whole() { "" } else { "; the record has no end" };
    let files: Vec<_> = begin.files.iter().map(|(name, _)| name.as_str()).collect();
    let files = if files.is_empty() { "without its text".to_owned() } else { files.join(", ") };
    let beside = if begin.beside.is_empty() { "the outputs alone" } else { &begin.beside };
    let lines = [
        ("plan", format!("{} ({files})", begin.plan)),
        ("target", begin.target.clone()),
        ("version", begin.version.clone()),
        ("command", begin.command.clone()),
        ("period", format!("{} s", Seconds(begin.period))),
        ("length", format!("{} up to {}{is_whole}", counted(turns, "turn"), Clocked(end))),
        ("transitions", transitions.to_string()),
        ("plans", plans.to_string()),
        ("depends on", beside.to_owned()),
    ];
    let mut out = io::stdout().lock();
    for (name, value) in lines.into_iter().filter(|(_, value)| !value.is_empty()) {
        writeln!(out, "{name:<12} {}", Printable(value)).map_err(|error| failure::unprinted(&error))?;
    }
    error.map_or(Ok(ExitCode::SUCCESS), |error| damaged(log, &error))
}
