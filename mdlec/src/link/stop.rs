//! What a signal must not leave behind: a cargo that goes on by itself, a file half written.

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

/// What is under way in this process.
static UNFINISHED: Mutex<Vec<Unfinished>> = Mutex::new(Vec::new());

/// What a signal has to end, or to remove.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Unfinished {
    /// A child, which leads a process group of its own.
    Child(Pid),
    /// A file that is not whole yet.
    File(PathBuf),
}

/// From here on a signal that ends this process ends its cargo first and removes what is half written. The exit status
/// is what a shell says of the signal: 128 more than its number. `farewell` is what else there is to do.
///
/// # Errors
/// When the system does not let a signal be caught.
pub fn leave_nothing_behind(farewell: impl FnOnce() + Send + 'static) -> io::Result<()> {
    let ending = [SIGHUP, SIGINT, SIGQUIT, SIGTERM];
    // Whoever started this with `nohup` wants it to outlive the terminal.
    let ending = ending.into_iter().filter(|signal| *signal != SIGHUP || !is_ignored(*signal));
    // Where it is caught, a write beyond the limit on files is an error that can be told.
    let mut signals = Signals::new(ending.chain([SIGXFSZ]))?;
    thread::spawn(move || {
        if let Some(signal) = signals.forever().find(|signal| *signal != SIGXFSZ) {
            end(signal, farewell)
        }
    });
    Ok(())
}

/// Ends this process.
fn end(signal: i32, farewell: impl FnOnce()) {
    // Never let go again: nothing new begins any more.
    let unfinished = list();
    for what in unfinished.iter() {
        match what {
            // What cannot be ended or removed has ended, or has gone, by itself.
            Unfinished::Child(leader) => {
                let _ = kill_process_group(*leader, Signal::TERM);
                let _ = waitid(WaitId::Pid(*leader), WaitIdOptions::EXITED | WaitIdOptions::NOWAIT);
            }
            Unfinished::File(path) => {
                let _ = fs::remove_file(path);
            }
        }
    }
    farewell();
    process::exit(128 + signal)
}

/// Keeps something on the list as long as it lives.
#[derive(Debug)]
pub(super) struct Watched(Unfinished);

impl Drop for Watched {
    fn drop(&mut self) {
        list().retain(|what| *what != self.0);
    }
}

/// Starts a child that a signal ends together with all children of its own.
pub(super) fn spawn(command: &mut Command) -> io::Result<(Child, Watched)> {
    let mut unfinished = list();
    let child = command.process_group(0).spawn()?;
    let leader = Unfinished::Child(Pid::from_child(&child));
    unfinished.push(leader.clone());
    Ok((child, Watched(leader)))
}

/// Makes a new file that a signal removes.
pub(super) fn create(path: &Path) -> io::Result<(File, Watched)> {
    let mut unfinished = list();
    let file = File::create_new(path)?;
    let path = Unfinished::File(path.to_owned());
    unfinished.push(path.clone());
    Ok((file, Watched(path)))
}

/// The list; it is whole whatever happened to whoever had it before.
fn list() -> MutexGuard<'static, Vec<Unfinished>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether this process was started with the signal ignored; where that cannot be found out, it was not.
fn is_ignored(signal: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask & (1 << (signal - 1)) != 0
}
