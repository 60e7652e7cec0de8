//! Runs a program in a pseudo-terminal.

use std::fs::File;
use std::io::Read;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Once};

use rustix::fs::{Mode, OFlags, open};
use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{LocalModes, Winsize, tcgetattr, tcsetwinsize};

/// A program, with the terminal in which it runs.
pub(crate) struct Terminal {
    child: Child,
    controller: File,
    modes: LocalModes,
    /// Output of the program so far.
    pub(crate) seen: String,
}

/// Restores the default action of SIGHUP in the programs that the tests start. Under `nohup` they would inherit that
/// SIGHUP is ignored; a signal that this process catches has its default action in the programs that it starts.
fn catch_hang_up() {
    static CAUGHT: Once = Once::new();
    CAUGHT.call_once(|| {
        signal_hook::flag::register(signal_hook::consts::SIGHUP, Arc::default()).unwrap();
    });
}

impl Terminal {
    /// Starts the program in a terminal with 100 columns and 30 rows. If `piped` is `true`, its standard output is
    /// discarded.
    pub(crate) fn start(command: Command, piped: bool) -> Self {
        Self::sized(command, piped, 100, 30)
    }

    /// Starts the program in a terminal of this size; `piped` has the same meaning as in [`Self::start`].
    pub(crate) fn sized(mut command: Command, piped: bool, columns: u16, rows: u16) -> Self {
        catch_hang_up();
        let controller = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&controller).unwrap();
        unlockpt(&controller).unwrap();
        let size = Winsize { ws_row: rows, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 };
        tcsetwinsize(&controller, size).unwrap();
        let name = ptsname(&controller, Vec::new()).unwrap();
        let terminal = open(name.as_c_str(), OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap();
        let modes = tcgetattr(&controller).unwrap().local_modes;
        let side = || Stdio::from(terminal.try_clone().unwrap());
        let out = if piped { Stdio::null() } else { side() };
        let child = command.stdin(side()).stdout(out).stderr(side()).spawn().unwrap();
        let controller = File::from(controller);
        Self { child, controller, modes, seen: String::new() }
    }

    /// Reads output until it contains `text`; panics if the program ends before.
    pub(crate) fn wait_for(&mut self, text: &str) {
        while !self.seen.contains(text) {
            assert!(self.read(), "{text:?} never came: {:?}", self.seen);
        }
    }

    /// Sends the signal of Ctrl-C.
    pub(crate) fn interrupt(&self) {
        self.send(Signal::INT);
    }

    /// Sends a signal.
    pub(crate) fn send(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.child), signal).unwrap();
    }

    /// Waits for the end of the program without reading its output.
    pub(crate) fn end_unread(&mut self) -> ExitStatus {
        self.child.wait().unwrap()
    }

    /// Returns the peak memory of the program, in kB.
    pub(crate) fn memory(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
        most.trim().trim_end_matches(" kB").parse().unwrap()
    }

    /// Waits for the end of the program; returns its output and its exit status.
    pub(crate) fn end(mut self) -> (String, ExitStatus) {
        while self.read() {}
        let status = self.child.wait().unwrap();
        (self.seen, status)
    }

    /// Returns `true` if the terminal echoes keys and edits lines as it did at the start.
    pub(crate) fn echoes(&self) -> bool {
        tcgetattr(&self.controller).unwrap().local_modes.contains(self.modes & (LocalModes::ECHO | LocalModes::ICANON))
    }

    /// Reads more output; returns `false` when the program has ended and its terminal is closed.
    fn read(&mut self) -> bool {
        let mut bytes = [0; 4096];
        match self.controller.read(&mut bytes) {
            Ok(0) | Err(_) => false,
            Ok(count) => {
                self.seen += &String::from_utf8_lossy(&bytes[..count]);
                true
            }
        }
    }
}
