//! Cleans up when a signal ends this process: terminates a running cargo, and removes incomplete files.

use std::fs::{self, File};
use std::io;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{self, Child, Command};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXFSZ};
use signal_hook::iterator::Signals;

use super::guard::GroupGuard;

/// Child processes and files that are cleaned up when a signal arrives.
static UNFINISHED: Mutex<Vec<CleanupTask>> = Mutex::new(Vec::new());

/// A child process to terminate, or a file to remove, when a signal arrives.
#[derive(Debug, Clone, PartialEq, Eq)]
enum CleanupTask {
    /// A child process, and the process group of its guard, to which the child belongs.
    Child { process: Pid, group: Pid },
    /// A file that is not complete yet.
    File(PathBuf),
}

/// Installs signal handlers. From now on, a signal that ends this process first terminates its cargo and removes
/// incomplete files. The exit status is the same as in shells: 128 plus the signal's number. `farewell` runs last.
///
/// # Errors
/// Fails if the system does not let a signal be caught.
pub fn leave_nothing_behind(farewell: impl FnOnce() + Send + 'static) -> io::Result<()> {
    let ending = [SIGHUP, SIGINT, SIGQUIT, SIGTERM];
    // A process that was started with `nohup` must outlive the terminal.
    let ending = ending.into_iter().filter(|signal| *signal != SIGHUP || !is_ignored(*signal));
    // If SIGXFSZ is caught, a write beyond the limit on file sizes returns an error that can be reported.
    let mut signals = Signals::new(ending.chain([SIGXFSZ]))?;
    thread::spawn(move || {
        if let Some(signal) = signals.forever().find(|signal| *signal != SIGXFSZ) {
            end(signal, farewell)
        }
    });
    Ok(())
}

/// Ends this process after cleaning up.
fn end(signal: i32, farewell: impl FnOnce()) {
    // The lock is never released, so no further process or file can be started.
    let unfinished = list();
    for what in unfinished.iter() {
        match what {
            // An error means that the process has already ended or the file no longer exists.
            CleanupTask::Child { process, group } => {
                let _ = kill_process_group(*group, Signal::TERM);
                let _ = waitid(WaitId::Pid(*process), WaitIdOptions::EXITED | WaitIdOptions::NOWAIT);
            }
            CleanupTask::File(path) => {
                let _ = fs::remove_file(path);
            }
        }
    }
    farewell();
    process::exit(128 + signal)
}

/// An entry of the list `UNFINISHED`. The entry is removed from the list when this value is dropped.
#[derive(Debug)]
pub(super) struct UnfinishedEntry(CleanupTask);

impl Drop for UnfinishedEntry {
    fn drop(&mut self) {
        list().retain(|what| *what != self.0);
    }
}

/// Starts a child process in the process group of `guard`. A signal that ends this process also ends the child process
/// and all its children.
pub(super) fn spawn(command: &mut Command, guard: &GroupGuard) -> io::Result<(Child, UnfinishedEntry)> {
    let mut unfinished = list();
    let group = guard.group();
    let child = command.process_group(group.as_raw_nonzero().get()).spawn()?;
    let entry = CleanupTask::Child { process: Pid::from_child(&child), group };
    unfinished.push(entry.clone());
    Ok((child, UnfinishedEntry(entry)))
}

/// Creates a file. A signal that ends this process removes it, unless the returned [`UnfinishedEntry`] was dropped
/// before.
pub(super) fn create(path: &Path) -> io::Result<(File, UnfinishedEntry)> {
    let mut unfinished = list();
    let file = File::create_new(path)?;
    let path = CleanupTask::File(path.to_owned());
    unfinished.push(path.clone());
    Ok((file, UnfinishedEntry(path)))
}

/// Locks the list. The list is valid even if another thread panicked while holding the lock.
fn list() -> MutexGuard<'static, Vec<CleanupTask>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns `true` if this process was started with the signal ignored; `false` if that cannot be determined.
fn is_ignored(signal: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask & (1 << (signal - 1)) != 0
}
