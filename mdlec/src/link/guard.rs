//! Kills a running cargo if the mdlec that started it has been killed. Otherwise this cargo would delay the next build
//! until it finishes.

use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};

use rustix::process::Pid;

const SHELL: &str = "/bin/sh";

/// Script of the shell that guards a process group. Its standard input is closed when this process ends for any reason,
/// and the shell then kills its process group. The shell ignores the signals that usually end a process group.
const PROGRAM: &str = "trap '' HUP INT QUIT TERM; read line; kill -KILL 0";

/// A shell that leads a process group. It kills the group if this process ends before the guard is dropped.
#[derive(Debug)]
pub(super) struct GroupGuard(Child);

impl GroupGuard {
    /// Starts the shell in a process group of its own.
    pub(super) fn start() -> io::Result<Self> {
        let mut shell = Command::new(SHELL);
        shell.args(["-c", PROGRAM]).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
        shell.process_group(0).spawn().map(Self)
    }

    /// Returns the process group. It exists until the guard is dropped.
    pub(super) fn group(&self) -> Pid {
        Pid::from_child(&self.0)
    }
}

impl Drop for GroupGuard {
    fn drop(&mut self) {
        // Only the shell is killed. Background processes that cargo left running on purpose, such as a compiler cache,
        // continue.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::process::{CommandExt, ExitStatusExt};
    use std::process::{Child, Command};

    use super::GroupGuard;

    fn sleep(guard: &GroupGuard) -> Child {
        Command::new("sleep").arg("20").process_group(guard.group().as_raw_nonzero().get()).spawn().unwrap()
    }

    #[test]
    fn the_group_ends_with_the_input_of_its_guard() {
        let mut guard = GroupGuard::start().unwrap();
        let mut child = sleep(&guard);
        // The same happens when this process is killed: the system closes the pipe.
        drop(guard.0.stdin.take());
        assert_eq!(child.wait().unwrap().signal(), Some(9));
    }

    #[test]
    fn the_group_goes_on_when_the_guard_is_dropped() {
        let guard = GroupGuard::start().unwrap();
        let mut child = sleep(&guard);
        drop(guard);
        assert_eq!(child.try_wait().unwrap(), None);
        child.kill().unwrap();
        assert_eq!(child.wait().unwrap().signal(), Some(9));
    }
}
