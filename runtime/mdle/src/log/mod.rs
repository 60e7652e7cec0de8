//! `mdle log`: shows the contents of a record, writes its first part as a record, or writes its turns as a table or as
//! a script.

mod cut;
mod export;
mod info;
mod script;

use std::fs::File;
use std::io;
use std::path::Path;
use std::process::ExitCode;

use mdle_record::ReadError;

use crate::arguments::Log;
use crate::failure::{self, Failure, exists, unwritten};
use crate::run_time::run_time;

/// Exit status for a record that was changed or is damaged.
const DAMAGED: u8 = 1;

/// Carries out a command about a record.
///
/// # Errors
/// Fails if a file cannot be read or written, or if the usage is wrong.
pub(crate) fn log(arguments: &Log) -> Result<ExitCode, Failure> {
    match arguments {
        Log::Info(log) => info::info(log),
        Log::Cut(log, time, file) => cut::cut(log, run_time(time)?, file),
        Log::Export { log, script: None, file } => export::export(log, file.as_deref()),
        Log::Export { log, script: Some(plan), file } => script::script(log, plan.as_deref(), file.as_deref()),
    }
}

/// Creates a file, which must not exist yet.
///
/// # Errors
/// Fails if the file exists, or if the system cannot create it.
pub(crate) fn created(path: &Path) -> Result<File, Failure> {
    File::create_new(path).map_err(|error| {
        if error.kind() == io::ErrorKind::AlreadyExists {
            return exists(path);
        }
        unwritten(&path.display(), &error)
    })
}

/// Reports that the rest of a record cannot be read; returns the exit status.
pub(crate) fn damaged(log: &Path, error: &ReadError) -> Result<ExitCode, Failure> {
    let sentence = format!("the record {} cannot be read: {error}", log.display());
    if matches!(error, ReadError::System(_)) {
        return Err(Failure::Usage(sentence));
    }
    failure::error(&sentence);
    Ok(ExitCode::from(DAMAGED))
}
