//! The screen of a terminal, taken and given back: whatever happens, the terminal is left as it was found.

use std::io::{IsTerminal, Write, stdout};
use std::panic;
use std::sync::{Mutex, Once};

use rustix::termios::{
    LocalModes, OptionalActions, QueueSelector, Termios, tcflush, tcgetattr, tcgetwinsize, tcsetattr,
};

/// The other screen, without a cursor.
const ENTER: &str = "\x1b[?1049h\x1b[?25l\x1b[2J";
/// Colours, cursor and screen as they were.
const LEAVE: &str = "\x1b[0m\x1b[?25h\x1b[?1049l";

/// How the terminal was found, as long as its screen is taken: a process has one, and so has its panic hook.
static FOUND: Mutex<Option<Found>> = Mutex::new(None);

struct Found(Option<Termios>);

/// A screen that is taken; dropped, it is given back.
#[derive(Debug)]
pub(super) struct Screen;

/// Whether standard output is a terminal.
pub(super) fn is_there() -> bool {
    stdout().is_terminal()
}

/// The columns and rows of the terminal; the usual ones where it does not say.
pub(super) fn size() -> (usize, usize) {
    let size = tcgetwinsize(stdout()).ok().map(|size| (usize::from(size.ws_col), usize::from(size.ws_row)));
    size.filter(|(columns, rows)| *columns > 0 && *rows > 0).unwrap_or((80, 24))
}

impl Screen {
    /// Takes the screen. Keys are not echoed; Ctrl-C is still the signal it always is.
    pub(super) fn enter() -> Self {
        static HOOK: Once = Once::new();
        // A panic tells of itself before anything is dropped: on a screen that goes away nobody would read it.
        HOOK.call_once(|| {
            let hook = panic::take_hook();
            panic::set_hook(Box::new(move |panic| {
                leave();
                hook(panic);
            }));
        });
        let found = tcgetattr(stdout()).ok();
        if let Some(mut quiet) = found.clone() {
            quiet.local_modes &= !(LocalModes::ECHO | LocalModes::ICANON);
            let _ = tcsetattr(stdout(), OptionalActions::Now, &quiet);
        }
        *FOUND.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(Found(found));
        write(ENTER);
        Self
    }

    /// Shows these lines, from the top.
    pub(super) fn show(&mut self, lines: &[String]) {
        // Shown at once by terminals that know how to; the others do not mind.
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

/// Gives the screen back, if it is taken.
fn leave() {
    let Some(Found(found)) = FOUND.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).take() else { return };
    write(LEAVE);
    if let Some(found) = found {
        // What was typed meanwhile was meant for nobody.
        let _ = tcflush(stdout(), QueueSelector::IFlush);
        let _ = tcsetattr(stdout(), OptionalActions::Now, &found);
    }
}

/// A terminal that is gone is no reason to stop a robot; its own signal says so.
fn write(text: &str) {
    let mut out = stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}
