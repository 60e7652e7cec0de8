//! The alternate screen of a terminal. The terminal's settings are restored at every orderly end and after a panic, and
//! also when the program is ended because of a turn that hangs or a second signal.

use std::fs::File;
use std::io::{self, IsTerminal, Write, stdout};
use std::os::unix::fs::OpenOptionsExt as _;
use std::panic;
use std::sync::{Mutex, MutexGuard, Once, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use rustix::fs::OFlags;
use rustix::termios::{
    LocalModes, OptionalActions, QueueSelector, Termios, tcflush, tcgetattr, tcgetwinsize, tcsetattr,
};

/// Codes that switch to the terminal's alternate screen without a cursor.
const ENTER: &str = "\x1b[?1049h\x1b[?25l\x1b[2J";
/// Codes that restore colours, cursor and screen.
const LEAVE: &str = "\x1b[0m\x1b[?25h\x1b[?1049l";

/// Settings of the terminal before the program switched to the alternate screen; `None` while the program does not use
/// this screen. They are global because the panic hook restores the terminal too.
static SETTINGS: Mutex<Option<SavedSettings>> = Mutex::new(None);

struct SavedSettings(Option<Termios>);

/// The terminal, opened so that writes never wait, and the part of a picture that has not been written yet.
static TERMINAL: Mutex<Option<TerminalState>> = Mutex::new(None);

struct TerminalState {
    file: File,
    left: Vec<u8>,
}

/// Maximum number of columns and rows of the live view, because a terminal may report far more.
const SIZE_MOST: (usize, usize) = (500, 200);
/// Maximum time for restoring the terminal.
const LEAVING: Duration = Duration::from_millis(500);

/// The alternate screen while the live view uses it; dropping this value restores the terminal.
#[derive(Debug)]
pub(super) struct Screen;

/// Returns `true` if standard output is a terminal.
pub(super) fn is_there() -> bool {
    stdout().is_terminal()
}

/// Returns the number of columns and rows of the terminal; 80 and 24 if the terminal does not report them.
pub(super) fn size() -> (usize, usize) {
    let size = tcgetwinsize(stdout()).ok().map(|size| (usize::from(size.ws_col), usize::from(size.ws_row)));
    size.filter(|(columns, rows)| *columns > 0 && *rows > 0)
        .map_or((80, 24), |(columns, rows)| (columns.min(SIZE_MOST.0), rows.min(SIZE_MOST.1)))
}

impl Screen {
    /// Switches to the alternate screen. Keys are not echoed; Ctrl-C still sends its signal.
    pub(super) fn enter() -> Self {
        static HOOK: Once = Once::new();
        // The panic hook runs before values are dropped: without this, its message would disappear with the alternate
        // screen.
        HOOK.call_once(|| {
            let hook = panic::take_hook();
            panic::set_hook(Box::new(move |panic| {
                leave();
                hook(panic);
            }));
        });
        let settings = tcgetattr(stdout()).ok();
        if let Some(mut quiet) = settings.clone() {
            quiet.local_modes &= !(LocalModes::ECHO | LocalModes::ICANON);
            let _ = tcsetattr(stdout(), OptionalActions::Now, &quiet);
        }
        *SETTINGS.lock().unwrap_or_else(PoisonError::into_inner) = Some(SavedSettings(settings));
        *terminal() = opened();
        write(ENTER);
        Self
    }

    /// Shows `lines` from the top of the screen.
    pub(super) fn show(&mut self, lines: &[String]) {
        // Terminals with synchronized updates show the picture at once; all others ignore the code.
        let mut text = "\x1b[?2026h\x1b[H".to_owned();
        for (number, line) in lines.iter().enumerate() {
            text += if number == 0 { "" } else { "\r\n" };
            text += line;
            text += "\x1b[0m\x1b[K";
        }
        text += "\x1b[J\x1b[?2026l";
        write(&text);
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        leave();
    }
}

/// Restores the terminal if the live view uses it.
fn leave() {
    let Some(SavedSettings(settings)) = SETTINGS.lock().unwrap_or_else(PoisonError::into_inner).take() else { return };
    write_to_the_end(LEAVE);
    restore(settings);
}

/// Restores the screen although the thread that uses it hangs. Does not wait for a lock of that thread.
pub(super) fn leave_at_once() {
    if terminal().is_some() {
        return leave();
    }
    let Some(SavedSettings(settings)) = SETTINGS.lock().unwrap_or_else(PoisonError::into_inner).take() else { return };
    restore(settings);
}

/// Discards pending input, and restores the settings of the terminal.
fn restore(settings: Option<Termios>) {
    if let Some(settings) = settings {
        // Keys that were typed during the live view are not meant for the next program.
        let _ = tcflush(stdout(), QueueSelector::IFlush);
        let _ = tcsetattr(stdout(), OptionalActions::Now, &settings);
    }
}

/// Opens the terminal a second time, so that writes to it do not wait. If this is not permitted, writes may wait.
fn opened() -> Option<TerminalState> {
    let flags = (OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32;
    let file = File::options().write(true).custom_flags(flags).open("/proc/self/fd/1").ok()?;
    Some(TerminalState { file, left: Vec::new() })
}

fn terminal() -> MutexGuard<'static, Option<TerminalState>> {
    TERMINAL.lock().unwrap_or_else(PoisonError::into_inner)
}

impl TerminalState {
    /// Writes as much of the remaining picture as the terminal accepts. Returns `true` if nothing remains, or if
    /// nothing can be written any more.
    fn push(&mut self) -> bool {
        while !self.left.is_empty() {
            match self.file.write(&self.left) {
                Ok(count) => drop(self.left.drain(..count)),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return false,
                // A closed terminal is reported by its own signal, SIGHUP; the write error is no reason to stop a
                // robot.
                Err(_) => self.left.clear(),
            }
        }
        true
    }
}

/// Shows a picture, unless the terminal has not yet accepted the previous picture completely.
fn write(text: &str) {
    let mut terminal = terminal();
    if let Some(terminal) = terminal.as_mut() {
        if terminal.push() {
            terminal.left.extend_from_slice(text.as_bytes());
            terminal.push();
        }
        return;
    }
    drop(terminal);
    let mut out = stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Writes the remaining picture and then `text`, but gives up after the maximum time for restoring the terminal.
fn write_to_the_end(text: &str) {
    let mut terminal = terminal();
    let Some(terminal) = terminal.as_mut() else {
        drop(terminal);
        return write(text);
    };
    terminal.left.extend_from_slice(text.as_bytes());
    let begun = Instant::now();
    while !terminal.push() && begun.elapsed() < LEAVING {
        thread::sleep(Duration::from_millis(5));
    }
}
