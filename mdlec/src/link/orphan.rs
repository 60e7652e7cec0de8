//! Ends the cargo of a killed mdlec, which would otherwise delay the next build until it is done.
//!
//! A note in the cache names the process group of the running cargo. A process that holds the lock of the cache
//! and finds a note knows that the mdlec which wrote it has ended.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Child;
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process_group};

/// Name of the note's file in the cache.
const NOTE: &str = "cargo";

/// Maximum time for cargo to end after each signal.
const PATIENCE: Duration = Duration::from_secs(5);

/// Path of the note. Dropping it, when cargo has ended, removes the note.
#[derive(Debug)]
pub(super) struct Note(PathBuf);

impl Drop for Note {
    fn drop(&mut self) {
        // A note that stays names a process that is gone.
        let _ = fs::remove_file(&self.0);
    }
}

/// Writes the note into the folder of the cache that `child`, which leads a process group, is running. Returns `None`
/// if the note cannot be written, such as on a full disk: the build continues without it.
pub(super) fn note(cache: &Path, child: &Child) -> Option<Note> {
    let note = cache.join(NOTE);
    let leader = child.id();
    fs::write(&note, format!("{leader} {}\n", started(leader)?)).ok()?;
    Some(Note(note))
}

/// Ends the cargo that the note in the folder of the cache names, with all its children, if it is still running. Call
/// it with the cache locked.
pub(super) fn end(cache: &Path) {
    let note = cache.join(NOTE);
    let Ok(text) = fs::read_to_string(&note) else { return };
    let numbers = text.trim_end().split_once(' ');
    if let Some((Ok(leader), Ok(start))) = numbers.map(|(leader, start)| (leader.parse(), start.parse())) {
        // Another process may have got the number in the meantime, but it started at another time.
        let is_running = || started(leader) == Some(start);
        for signal in [Signal::TERM, Signal::KILL] {
            let Some(group) = i32::try_from(leader).ok().and_then(Pid::from_raw).filter(|_| is_running()) else {
                break;
            };
            // It may have ended by itself since.
            let _ = kill_process_group(group, signal);
            let deadline = Instant::now() + PATIENCE;
            while is_running() && Instant::now() < deadline {
                thread::sleep(Duration::from_millis(5));
            }
        }
    }
    drop(Note(note));
}

/// Returns the start time of the process group's `leader`, in ticks since the system started; `None` if there is no
/// such leader or it has ended.
fn started(leader: u32) -> Option<u64> {
    let text = fs::read_to_string(format!("/proc/{leader}/stat")).ok()?;
    // The second field is the name of the program in parentheses, which may hold any character.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace();
    let has_ended = matches!(fields.next()?, "Z" | "X");
    let group: u32 = fields.nth(1)?.parse().ok()?;
    // Field 22 of the line; those up to the fifth are read.
    let start = fields.nth(16)?.parse().ok()?;
    (group == leader && !has_ended).then_some(start)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::os::unix::process::{CommandExt, ExitStatusExt};
    use std::process::{Child, Command};

    use super::super::tests::cache;
    use super::{NOTE, end, note, started};

    fn sleep() -> Child {
        Command::new("sleep").arg("600").process_group(0).spawn().unwrap()
    }

    #[test]
    fn a_noted_cargo_is_ended() {
        let cache = cache("orphan");
        let mut child = sleep();
        // The mdlec that was killed did not remove its note.
        std::mem::forget(note(cache.folder(), &child).unwrap());
        end(cache.folder());
        assert_eq!(child.wait().unwrap().signal(), Some(15));
        assert!(!cache.folder().join(NOTE).exists());
    }

    #[test]
    fn another_process_of_that_number_goes_on() {
        let cache = cache("no_orphan");
        let mut child = sleep();
        let start = started(child.id()).unwrap();
        for text in [format!("{} {}\n", child.id(), start + 1), format!("{}\n", child.id()), "garbage 1\n".to_owned()] {
            fs::write(cache.folder().join(NOTE), text).unwrap();
            end(cache.folder());
            assert_eq!(started(child.id()), Some(start));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
}
