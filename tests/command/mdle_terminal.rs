//! Tests `mdle shell` on a pseudo-terminal: the line that is being typed, its completion and history, and text that is
//! printed above it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs::{self, File};
use std::io::{Read as _, Write as _};
use std::os::unix::ffi::OsStrExt as _;
use std::path::Path;
use std::process::{Child, Command, ExitStatus};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use mdle_tests::executable::{folder, mdle};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Termios, Winsize, tcgetattr, tcsetwinsize};

/// Maximum time to wait for an expected text.
const LONG: Duration = Duration::from_secs(60);

/// A program on a terminal.
struct AtTerminal {
    child: Child,
    keys: File,
    /// The program's end of the terminal.
    screen: File,
    /// Modes of the terminal before the program started.
    before: Termios,
    shown: Arc<Mutex<Vec<u8>>>,
}

impl AtTerminal {
    /// Starts a session with this plan in real time.
    fn start(folder: &Path, plan: &str) -> Self {
        fs::write(folder.join("plan.mdle"), plan).unwrap();
        let keys = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&keys).unwrap();
        unlockpt(&keys).unwrap();
        let name = ptsname(&keys, Vec::new()).unwrap();
        let keys = File::from(keys);
        let screen = Path::new(std::ffi::OsStr::from_bytes(name.as_bytes()));
        let screen = File::options().read(true).write(true).open(screen).unwrap();
        tcsetwinsize(&screen, Winsize { ws_row: 24, ws_col: 80, ws_xpixel: 0, ws_ypixel: 0 }).unwrap();
        let before = tcgetattr(&screen).unwrap();
        let mut command = Command::new(mdle());
        command.args(["shell", "plan.mdle", "--target", "sim", "--speed", "1"]).current_dir(folder);
        command.env("TERM", "xterm").env_remove("NO_COLOR");
        let end = || screen.try_clone().unwrap();
        let child = command.stdin(end()).stdout(end()).stderr(end()).spawn().unwrap();
        let shown = Arc::new(Mutex::new(Vec::new()));
        let (mut reader, all) = (keys.try_clone().unwrap(), Arc::clone(&shown));
        thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(count @ 1..) = reader.read(&mut bytes) {
                all.lock().unwrap().extend_from_slice(&bytes[..count]);
            }
        });
        Self { child, keys, screen, before, shown }
    }

    fn press(&mut self, keys: &str) {
        self.keys.write_all(keys.as_bytes()).unwrap();
    }

    fn shown(&self) -> String {
        String::from_utf8_lossy(&self.shown.lock().unwrap()).into_owned()
    }

    /// Waits until all these texts have appeared in order in the output, from the position `from`. Returns the position
    /// after the last text.
    fn wait_for(&self, from: usize, texts: &[&str]) -> usize {
        let begun = Instant::now();
        loop {
            let shown = self.shown();
            let found = texts
                .iter()
                .try_fold(from, |from, text| shown.get(from..)?.find(text).map(|place| from + place + text.len()));
            if let Some(place) = found {
                return place;
            }
            assert!(begun.elapsed() < LONG, "{texts:?} from {from} on in {shown:?}");
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Waits for the end of the program, and asserts that the modes of the terminal are restored.
    fn end(mut self) -> (ExitStatus, String) {
        let status = self.child.wait().unwrap();
        let after = tcgetattr(&self.screen).unwrap();
        assert_eq!((after.local_modes, after.input_modes), (self.before.local_modes, self.before.input_modes));
        (status, self.shown())
    }
}

const TURNS: &str = "{ Typed (wait 100s)\n  ((Atom (wait 300ms) (go 0 0.1)) (Atom (wait 300ms) (go 0 -0.1)))^100\n}\n";

#[test]
fn a_report_leaves_the_line_alone_that_is_typed() {
    let mut terminal = AtTerminal::start(&folder("terminal_typed"), TURNS);
    let begun = terminal.wait_for(0, &["/ > "]);
    terminal.press("get /usr/mdle/mai");
    let typed = terminal.wait_for(begun, &["mai"]);
    // A report clears the typed line, which is written again below the report.
    let again = terminal.wait_for(typed, &["<- wait", "\n", "/ > ", "get /usr/mdle/mai"]);
    let again = terminal.wait_for(again, &["<- wait", "\n", "/ > ", "get /usr/mdle/mai"]);
    terminal.press("\t\r");
    let answer = terminal.wait_for(again, &["main", "\n", "Typed", "\n", "/ > "]);
    // Recalls the last line of the history.
    terminal.press("\x1b[A\r");
    let answer = terminal.wait_for(answer, &["get /usr/mdle/main", "Typed", "/ > "]);
    terminal.press("watch /clock/turns\r");
    let answer = terminal.wait_for(answer, &["s  /clock/turns ", "s  /clock/turns "]);
    terminal.press("wait 100ms\r");
    terminal.wait_for(answer, &["turns, ", "/ > "]);
    // Several lines are typed, or pasted, at once.
    let answer = answer + terminal.shown().get(answer..).map_or(0, str::len);
    terminal.press("cd /usr/robot\rpwd\rget /clock/period\r");
    terminal.wait_for(answer, &["/usr/robot > ", "pwd", "/usr/robot", "get /clock/period", "0.1s", "/usr/robot > "]);
    // A command continues on the next line.
    let answer = answer + terminal.shown().get(answer..).map_or(0, str::len);
    terminal.press("get \\\r/clock/period\r");
    terminal.wait_for(answer, &["get \\", "/clock/period", "\n0.1s", "/usr/robot > "]);
    terminal.press("\x04");
    let (status, shown) = terminal.end();
    assert_eq!(status.code(), Some(0), "{shown}");
}

#[test]
fn the_end_of_the_plan_does_not_wait_for_the_line() {
    let mut terminal = AtTerminal::start(&folder("terminal_end"), "{ Short (wait 1s)\n  (Atom (null) (go 10 0))\n}\n");
    terminal.wait_for(0, &["/ > "]);
    terminal.press("get /usr/mo");
    terminal.wait_for(0, &["/usr/mo", "1.0 s  plan over: wait 1s (plan.mdle:1)", "\n"]);
    let (status, shown) = terminal.end();
    assert_eq!(status.code(), Some(0), "{shown:?}");
}

#[test]
fn bytes_that_are_no_text_are_refused() {
    let mut terminal = AtTerminal::start(&folder("terminal_bytes"), TURNS);
    let begun = terminal.wait_for(0, &["/ > "]);
    terminal.keys.write_all(b"get \xFF").unwrap();
    let refused = terminal.wait_for(begun, &["error: the line is not UTF-8 text", "/ > "]);
    terminal.press("\rget /clock/period\r");
    terminal.wait_for(refused, &["get /clock/period", "0.1s", "/ > "]);
    terminal.press("quit\r");
    let (status, shown) = terminal.end();
    assert_eq!(status.code(), Some(0), "{shown}");
}

#[test]
fn a_process_that_declares_nothing_yet_blocks_nobody() {
    let mut terminal = AtTerminal::start(&folder("terminal_process"), TURNS);
    let begun = terminal.wait_for(0, &["/ > "]);
    terminal.press("call /lib/process slow sleep 4\r");
    let later = terminal.wait_for(begun, &["the answer comes later, as a report", "/ > "]);
    terminal.press("get /clock/period\r");
    let answered = terminal.wait_for(later, &["get /clock/period", "0.1s", "/ > "]);
    assert!(!terminal.shown().contains("its process has ended"), "{}", terminal.shown());
    let text = "`call /lib/process slow sleep 4`: error: module `slow` cannot be loaded: its process has ended (exit status: 0)";
    terminal.wait_for(answered, &[text]);
    terminal.press("quit\r");
    let (status, shown) = terminal.end();
    assert_eq!(status.code(), Some(0), "{shown}");
}
