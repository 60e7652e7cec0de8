//! A child process in its own process group. It exchanges lines with this process.
//!
//! A shell in the group guards it: when this process ends for any reason, the shell kills the group.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::os::unix::process::CommandExt as _;
use std::process::{self, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::ioctl_fionbio;
use rustix::process::{Pid, Signal, kill_process_group};

use super::shown;

/// Maximum length of a line, in bytes.
const LONGEST: usize = 65_536;
/// Grace period for a child process to exit after its input is closed, and again after SIGTERM is sent.
const FAREWELL: Duration = Duration::from_millis(300);
/// Maximum time that ending a child takes.
pub(super) const LONGEST_FAREWELL: Duration = Duration::from_secs(2);
/// Interval at which a waiting function checks whether the wait is over.
const LOOK: Duration = Duration::from_millis(10);
/// Script of the guarding shell, which kills the group when its input ends because this process has ended.
const GUARD: &str = "trap '' HUP INT TERM; read line; kill -KILL 0";
const SHELL: &str = "/bin/sh";

/// A child process; dropping it ends its process group.
#[derive(Debug)]
pub(super) struct Child {
    process: process::Child,
    /// Standard input of the child; `None` once it is closed.
    stdin: Option<ChildStdin>,
    stdout: ChildStdout,
    /// The guarding shell; `None` once the group is killed.
    guard: Option<process::Child>,
    /// Bytes that were read but belong to later lines.
    unread: Vec<u8>,
}

/// Reason why a child sent no line.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Silence {
    /// The line is no longer needed.
    Over,
    /// The child did not send the line within the maximum wait.
    Late,
    /// The child cannot continue; contains the reason as a sentence.
    Fault(String),
}

impl Child {
    /// Starts a child with this shell command line. The child shares the standard error of this process.
    pub(super) fn start(command: &str) -> io::Result<Self> {
        let shell = || Command::new(SHELL);
        let mut guard = shell();
        guard.args(["-c", GUARD]).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null()).process_group(0);
        let mut guard = guard.spawn()?;
        let mut child = shell();
        child.args(["-c", command]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let started = child.process_group(group(&guard).as_raw_nonzero().get()).spawn();
        let mut process = started.inspect_err(|_| kill(&mut guard))?;
        let (stdin, stdout) = (process.stdin.take(), process.stdout.take());
        let no_pipe = || io::Error::other("the system gave no pipe");
        let mut child = Self {
            stdin,
            stdout: stdout.ok_or_else(no_pipe).inspect_err(|_| kill(&mut guard))?,
            process,
            guard: Some(guard),
            unread: Vec::new(),
        };
        ioctl_fionbio(child.stdin.as_ref().ok_or_else(no_pipe)?, true)?;
        ioctl_fionbio(&child.stdout, true)?;
        child.unread.reserve(1024);
        Ok(child)
    }

    /// Returns the child's next line, without its line break. Fails once `is_over` returns `true`, or after the time
    /// `patience`.
    pub(super) fn line(&mut self, patience: Duration, is_over: impl Fn() -> bool) -> Result<Vec<u8>, Silence> {
        self.exchange(&[], patience, is_over)
    }

    /// Sends a line, and returns the answer as [`Child::line`] does. Refuses a child that has printed something before
    /// the line is sent, because the child's answers would be one line ahead from then on.
    pub(super) fn ask(
        &mut self,
        line: &[u8],
        patience: Duration,
        is_over: impl Fn() -> bool,
    ) -> Result<Vec<u8>, Silence> {
        let _ = self.read();
        if !self.unread.is_empty() {
            let line = self.unread.split(|byte| *byte == b'\n').next().unwrap_or_default();
            let sentence = format!("its process printed more than one line in answer to one: {}", shown(line));
            return Err(Silence::Fault(sentence));
        }
        self.exchange(line, patience, is_over)
    }

    fn exchange(
        &mut self,
        mut unsent: &[u8],
        patience: Duration,
        is_over: impl Fn() -> bool,
    ) -> Result<Vec<u8>, Silence> {
        let begun = Instant::now();
        loop {
            unsent = self.write(unsent).map_err(|_| self.ended("standard input"))?;
            if let Some(end) = self.unread.iter().position(|byte| *byte == b'\n').filter(|_| unsent.is_empty()) {
                let rest = self.unread.split_off(end + 1);
                let mut line = std::mem::replace(&mut self.unread, rest);
                line.truncate(end);
                return Ok(line);
            }
            if self.unread.len() > LONGEST {
                let start = shown(&self.unread);
                return Err(Silence::Fault(format!("its process printed a line of over {LONGEST} bytes: {start}")));
            }
            if is_over() {
                return Err(Silence::Over);
            }
            if begun.elapsed() >= patience {
                return Err(Silence::Late);
            }
            self.wait(!unsent.is_empty());
            if self.read().is_none() {
                return Err(self.ended("standard output"));
            }
        }
    }

    /// Waits briefly until data can be read or, if `writes` is `true`, until the pipe accepts more data.
    fn wait(&self, writes: bool) {
        let stdin = self.stdin.as_ref().filter(|_| writes);
        let mut fds = vec![PollFd::new(&self.stdout, PollFlags::IN)];
        fds.extend(stdin.map(|stdin| PollFd::new(stdin, PollFlags::OUT)));
        let look = Timespec { tv_sec: 0, tv_nsec: i64::from(LOOK.subsec_nanos()) };
        if poll(&mut fds, Some(&look)).is_err() {
            thread::sleep(LOOK);
        }
    }

    /// Writes as much as the pipe accepts; returns the rest.
    fn write<'l>(&mut self, line: &'l [u8]) -> io::Result<&'l [u8]> {
        let Some(stdin) = &mut self.stdin else { return Ok(line) };
        if line.is_empty() {
            return Ok(line);
        }
        match stdin.write(line) {
            Ok(count) => Ok(line.get(count..).unwrap_or_default()),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(line),
            Err(error) => Err(error),
        }
    }

    /// Reads the available data; `None` at the end of the child's output.
    fn read(&mut self) -> Option<()> {
        let mut bytes = [0; 4096];
        while self.unread.len() <= LONGEST {
            match self.stdout.read(&mut bytes) {
                Ok(0) => return None,
                Ok(count) => self.unread.extend_from_slice(bytes.get(..count)?),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Some(()),
                Err(_) => return None,
            }
        }
        Some(())
    }

    /// Kills the process group at once.
    pub(super) fn kill(&mut self) {
        // Once the leader of the group is waited for, its number may be reused: nothing may be sent to the group then.
        if let Some(mut guard) = self.guard.take() {
            kill(&mut guard);
        }
    }

    /// Returns the reason why the child cannot continue, after it has closed the stream with this name.
    fn ended(&mut self, stream: &str) -> Silence {
        let _ = self.read();
        let half = self.unread.rsplit(|byte| *byte == b'\n').next().filter(|half| !half.is_empty());
        let half = half.map_or_else(String::new, |half| format!(" in the middle of the line {}", shown(half)));
        Silence::Fault(match self.status_within(FAREWELL) {
            Some(status) => format!("its process has ended ({status}){half}"),
            None => format!("its process has closed its {stream}{half}"),
        })
    }

    /// Waits at most `time` for the child to end; returns its status if it has ended.
    fn status_within(&mut self, time: Duration) -> Option<ExitStatus> {
        let begun = Instant::now();
        loop {
            let status = self.process.try_wait().ok().flatten();
            if status.is_some() || begun.elapsed() >= time {
                return status;
            }
            thread::sleep(LOOK);
        }
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        drop(self.stdin.take());
        if let Some(guard) = &self.guard {
            let group = group(guard);
            if self.status_within(FAREWELL).is_none() {
                let _ = kill_process_group(group, Signal::TERM);
                let _ = self.status_within(FAREWELL);
            }
        }
        self.kill();
        let _ = self.process.wait();
    }
}

/// Returns the process group that a shell guards. The group exists until this process has waited for the shell to end.
fn group(guard: &process::Child) -> Pid {
    Pid::from_child(guard)
}

/// Kills a process group, including its guard.
fn kill(guard: &mut process::Child) {
    let _ = kill_process_group(group(guard), Signal::KILL);
    let _ = guard.wait();
}
